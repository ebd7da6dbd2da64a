# SPDX-License-Identifier: BSD-3-Clause
"""Scenes: the same bytes as `otg simulate`, frames, glTF, errors."""

import json
import subprocess

import numpy as np
import pytest
import trimesh

import ode_trimesh_gpu as otg

SCENE = {
    "steps": 60,
    "planes": [{}],
    "meshes": {"lump": {"generate": "lump", "radius": 0.3, "level": 3}},
    "bodies": [
        {"name": "ground", "box": [3, 3, 0.4], "static": True, "collider": "gpu_trimesh"},
        {"name": "one", "mesh": "lump", "position": [0, 0, 0.6]},
        {"name": "two", "mesh": "lump", "position": [0.1, 0, 1.2], "color": [1, 0, 0]},
    ],
}


def test_a_scene_has_the_bytes_of_the_program(tmp_path, program):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(SCENE))
    run = subprocess.run([program, "simulate", path, "--json"], capture_output=True, text=True, check=True)
    expected = json.loads(run.stdout)
    for scene in (SCENE, path, str(path)):
        found = otg.simulate(scene)
        assert found.hash == expected["hash"]
    assert found.steps["contacts"].tolist() == expected["contacts_per_step"]
    bodies = found.bodies
    for i, body in enumerate(expected["bodies"]):
        assert bodies["name"][i] == body["name"] and bool(bodies["static"][i]) == body["static"]
        assert bodies.loc[i, ["x", "y", "z"]].tolist() == body["position"]
        assert bodies.loc[i, ["qw", "qx", "qy", "qz"]].tolist() == body["rotation"]
        assert bodies.loc[i, ["vx", "vy", "vz"]].tolist() == body["linear_velocity"]
        assert bodies.loc[i, ["wx", "wy", "wz"]].tolist() == body["angular_velocity"]
        assert bodies.loc[i, ["cx", "cy", "cz"]].tolist() == body["center_of_mass"]


def test_frames_and_arrays():
    calls = []
    run = otg.simulate(SCENE, steps=25, dt=0.002, every=10, callback=lambda step, run: calls.append(step))
    assert calls == [10, 20] and run.dt == 0.002
    np.testing.assert_allclose(run.times, [0, 0.02, 0.04])
    assert run.positions.shape == (3, 3, 3) and run.rotations.shape == (3, 3, 4)
    steps = run.steps
    assert len(steps) == 25 and steps["time"].iloc[-1] == pytest.approx(0.05)
    # Nothing touches yet: energy is kept but for the integrator's first order.
    total = steps["kinetic_energy"] + steps["potential_energy"]
    assert total.iloc[5] == pytest.approx(total.iloc[0], rel=1e-3)
    assert len(run.poses) == 9 and set(run.poses["body"]) == {"ground", "one", "two"}
    assert "3 bodies" in repr(run)


def test_gltf(tmp_path):
    run = otg.simulate(SCENE, steps=20, gltf=tmp_path / "run.glb")
    run.to_gltf(tmp_path / "again.glb")
    assert (tmp_path / "run.glb").read_bytes() == (tmp_path / "again.glb").read_bytes()
    loaded = trimesh.load(tmp_path / "run.glb")
    assert len(loaded.graph.nodes_geometry) == 3
    with pytest.raises(OSError, match="written"):
        run.to_gltf(tmp_path / "none" / "run.glb")


def data_of_page(path):
    """What the page of a run was written from."""
    text = path.read_text()
    begin = text.index('{"format":"ode_trimesh_gpu run"')
    return json.JSONDecoder().raw_decode(text[begin:])[0]


def test_html(tmp_path):
    run = otg.simulate(SCENE, steps=200, html=tmp_path / "run.html")
    page = data_of_page(tmp_path / "run.html")
    assert [body["name"] for body in page["bodies"]] == ["ground", "one", "two"]
    assert page["frames"] == len(run.times) and page["steps"]["count"] == 200 and page["dt"] == run.dt
    assert run.steps["contacts"].iloc[-1] > 0 and page["contacts"]["count"] > 0
    # The contacts are arrows in both files.
    run.to_gltf(tmp_path / "run.glb")
    assert len(trimesh.load(tmp_path / "run.glb").graph.nodes_geometry) > 3
    with pytest.raises(OSError, match="written"):
        run.to_html(tmp_path / "none" / "run.html")


def test_mesh_files_and_arrays_in_a_dict(tmp_path):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "box.ply")
    scene = {
        "gravity": np.array([0, 0, -1.0]),
        "meshes": {"box": {"file": "box.ply"}},
        "bodies": [{"name": "a", "mesh": "box", "position": np.array([0, 0, 3])}],
        "steps": np.int64(3),
    }
    run = otg.simulate(scene, folder=tmp_path)
    assert len(run.steps) == 3
    with pytest.raises(otg.MeshError, match=r"box\.ply"):
        otg.simulate(scene, folder=tmp_path / "elsewhere")


@pytest.mark.parametrize(
    "scene, message",
    [
        ({"bodies": [{"name": "a", "sphere": 1, "densty": 1}]}, "densty"),
        ({"bodies": [{"name": "a", "sphere": -1}]}, "sphere"),
        ({}, "bodies"),
        ({"bodies": [{"name": "a", "sphere": 1, "position": [1e9, 0, 0]}]}, "1e"),
    ],
)
def test_scenes_that_are_refused(scene, message):
    with pytest.raises(otg.SceneError, match=message):
        otg.simulate(scene)


def test_other_errors(tmp_path):
    with pytest.raises(FileNotFoundError):
        otg.simulate(tmp_path / "none.json")
    (tmp_path / "broken.json").write_text('{"bodies": [')
    with pytest.raises(otg.SceneError, match=r"broken\.json"):
        otg.simulate(tmp_path / "broken.json")
    with pytest.raises(otg.ArgumentError):
        otg.simulate({"bodies": [object()]})
    with pytest.raises(otg.ArgumentError):
        otg.simulate(SCENE, steps=-1)
    with pytest.raises(otg.ArgumentError):
        otg.simulate(SCENE, dt=0)
    away = {"bodies": [{"name": "a", "sphere": 1, "linear_velocity": [1e9, 0, 0]}], "dt": 1, "steps": 3}
    with pytest.raises(otg.SceneError, match="after step"):
        otg.simulate(away)
