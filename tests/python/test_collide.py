# SPDX-License-Identifier: BSD-3-Clause
"""Contacts: formulas, the program otg, batches, memory, options."""

import json
import pickle
import subprocess

import numpy as np
import pytest
from conftest import pose, random_poses

import ode_trimesh_gpu as otg


def rows(contacts):
    """All columns as bytes: equal only if every bit is."""
    return [getattr(contacts, name).tobytes() for name in contacts.__dataclass_fields__]


@pytest.mark.parametrize("axis, sign", [(0, 1), (0, -1), (1, 1), (1, -1), (2, 1), (2, -1)])
def test_depth_and_normal_of_boxes(box, axis, sign):
    placed = np.eye(4)
    placed[axis, 3] = 0.98 * sign
    contacts = otg.collide(box, box, placed)
    # The first mesh leaves to where it is: that way points the normal.
    normal = np.zeros(3)
    normal[axis] = sign
    assert len(contacts) >= 4
    np.testing.assert_allclose(contacts.normals, np.tile(normal, (len(contacts), 1)), atol=1e-12)
    np.testing.assert_allclose(contacts.depths, 0.02, atol=1e-6)
    assert np.ptp(contacts.positions, axis=0).max() == pytest.approx(1)


def test_balls_touch_along_the_line_of_their_middles():
    ball = otg.generate.sphere(0.5, 4)
    for placed in random_poses(20, 1, 8):
        direction = placed[:3, 3] / np.linalg.norm(placed[:3, 3])
        placed[:3, 3] = 0.97 * direction
        contacts = otg.collide(ball, ball, placed)
        assert len(contacts)
        deepest = contacts.depths.argmax()
        assert contacts.depths[deepest] == pytest.approx(0.03, abs=4e-3)
        assert contacts.normals[deepest] @ direction > 0.99


def test_both_orders_have_the_same_contacts(box, ball):
    placed = pose(0.3, 0.2, 0.8, (1, 2, 0), 0.4)
    one, other = otg.collide(box, ball, None, placed), otg.collide(ball, box, placed)
    assert len(one) == len(other) > 0
    order = np.lexsort(one.positions.T), np.lexsort(other.positions.T)
    np.testing.assert_allclose(one.positions[order[0]], other.positions[order[1]], atol=1e-9)
    np.testing.assert_allclose(one.normals[order[0]], -other.normals[order[1]], atol=1e-9)


def write_off(path, mesh):
    lines = ["OFF", f"{len(mesh.vertices)} {len(mesh)} 0"]
    lines += [" ".join(f"{x:.9g}" for x in vertex) for vertex in mesh.vertices.tolist()]
    lines += ["3 " + " ".join(map(str, face)) for face in mesh.faces.tolist()]
    path.write_text("\n".join(lines) + "\n")


def test_contacts_are_those_of_the_program(tmp_path, program):
    """The numbers of `otg collide`: positions, depths and triangles to the last bit, and names."""
    lump, torus = otg.generate.lump(0.5, 3, 0.3, 3), otg.generate.torus(0.6, 0.2)
    write_off(tmp_path / "lump.off", lump)
    write_off(tmp_path / "torus.off", torus)
    for i, placed in enumerate(random_poses(6, 0.6, 9)):
        np.savetxt(tmp_path / "pose.txt", placed, fmt="%.17g")
        command = [program, "collide", "lump.off", "torus.off", "--pose", "pose.txt", "--json"]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        expected = json.loads(run.stdout)["contacts"]
        found = otg.collide(lump, torus, None, placed)
        assert len(found) == len(expected), i
        for k, contact in enumerate(expected):
            assert found.positions[k].tolist() == contact["position"]
            # ODE gets normals whose length is 1 to the last bit that rounding allows.
            np.testing.assert_allclose(found.normals[k], contact["normal"], rtol=0, atol=4e-16)
            assert found.depths[k] == contact["depth"]
            assert found.triangles[k].tolist() == [contact["triangle_a"], contact["triangle_b"]]
            assert found.features[k] == otg.FEATURES.index(contact["feature"])
            assert f"{found.ids[k]:016x}" == contact["id"]
            assert bool(found.inside[k]) == contact["inside"]


def test_many_pairs_are_what_single_ones_are(box, ball):
    meshes = [box, ball, otg.generate.torus(0.5, 0.2, 24, 12)]
    places = random_poses(60, 0.7, 10)
    first, second = [meshes[i % 3] for i in range(60)], [meshes[i // 3 % 3] for i in range(60)]
    batch = otg.collide_many(first, second, places, pose(0.1))
    assert len(batch) == 60 and batch.first[-1] == len(batch.contacts) > 60
    for i in range(60):
        assert rows(batch[i]) == rows(otg.collide(first[i], second[i], places[i], pose(0.1))), i
    np.testing.assert_array_equal(batch.counts, [len(c) for c in batch])
    np.testing.assert_array_equal(np.bincount(batch.pairs, minlength=60), batch.counts)
    deepest = [c.depths.max() if len(c) else 0 for c in batch]
    np.testing.assert_array_equal(batch.max_depths, deepest)
    assert rows(batch[-1]) == rows(batch[59])
    with pytest.raises(IndexError):
        batch[60]


def test_threads_do_not_change_a_byte(ball):
    places = random_poses(3000, 0.6, 11)
    before = otg.get_threads()
    try:
        results = []
        for threads in (1, 2, 7):
            otg.set_threads(threads)
            assert otg.get_threads() == threads
            results.append(rows(otg.collide_many(ball, ball, places).contacts))
        assert results[0] == results[1] == results[2]
    finally:
        otg.set_threads(before)
    with pytest.raises(otg.ArgumentError):
        otg.set_threads(-1)


def test_no_pairs(ball):
    batch = otg.collide_many([], [], np.empty((0, 4, 4)))
    assert len(batch) == 0 and len(batch.contacts) == 0 and list(batch) == []


def test_pairwise_contacts_have_another_model(ball):
    placed = pose(0.9, 0.1, 0.1, (1, 1, 1), 0.3)
    solid = otg.collide(ball, ball, placed, options=otg.Options(contact_model="solid"))
    pairwise = otg.collide(ball, ball, placed, options=otg.Options(contact_model="pairwise", reduction="none"))
    assert set(pairwise.features) <= {4, 5} and set(solid.features) <= {0, 1, 2, 3}
    assert (pairwise.coherence == -1).all() and (solid.coherence >= 0).all()
    reduced = otg.collide(ball, ball, placed, options=otg.Options(contact_model="pairwise", reduction="cone"))
    assert 0 < len(reduced) < len(pairwise)


@pytest.mark.parametrize("most", [1, 2, 4])
def test_limits_of_contacts(box, most):
    placed = pose(0, 0, 0.97, (0, 0, 1), 0.3)
    assert len(otg.collide(box, box, placed, options=otg.Options(max_contacts=most))) == most
    assert len(otg.collide(box, box, placed, options=otg.Options(contacts_per_region=most))) == most


@pytest.mark.parametrize(
    "options",
    [
        otg.Options(contact_model="soft"),
        otg.Options(max_contacts=0),
        otg.Options(contacts_per_region=65),
        otg.Options(reduction="all"),
        otg.Options(bins=(0, 1, 1, 1, 1, 1)),
        otg.Options(region_merge=-1.0),
        otg.Options(backend="gpu"),
        otg.Options(max_pairs=0),
    ],
)
def test_options_that_are_refused(box, options):
    with pytest.raises(otg.ArgumentError):
        otg.collide(box, box, options=options)


def test_a_query_with_too_many_candidates_is_an_error(ball):
    with pytest.raises(MemoryError):
        otg.collide(ball, ball, pose(0.01), options=otg.Options(max_pairs=10))


def sink(memory, steps, ball, plate):
    """A ball that sinks through a plate: its way out depends on where it came from."""
    for z in steps:
        contacts = otg.collide(ball, plate, pose(0, 0, z), memory=memory)
    return contacts


def test_memory_guides_a_deep_body_and_pickles(ball):
    plate = otg.generate.box([4, 4, 0.3], 4)
    way = np.linspace(0.64, -0.2, 15)
    memory = otg.PairMemory()
    sink(memory, way[:8], ball, plate)
    thawed = pickle.loads(pickle.dumps(memory))
    thawed_twice = pickle.loads(pickle.dumps(thawed))
    expected = sink(memory, way[8:], ball, plate)
    assert rows(sink(thawed, way[8:], ball, plate)) == rows(expected)
    assert rows(sink(thawed_twice, way[8:], ball, plate)) == rows(expected)
    # The middle is below the plate by now. Who remembers pushes up, who does not takes the shorter way.
    assert expected.normals[0, 2] > 0.9
    assert otg.collide(ball, plate, pose(0, 0, way[-1])).normals[0, 2] < -0.9
    memory.forget()
    assert rows(sink(memory, way[-1:], ball, plate)) == rows(
        otg.collide(ball, plate, pose(0, 0, way[-1]), memory=otg.PairMemory())
    )


def test_memory_of_many_pairs(ball):
    plate = otg.generate.box([4, 4, 0.3], 4)
    memory, single = otg.PairMemory(), otg.PairMemory()
    for z in np.linspace(0.64, -0.2, 15):
        places = np.stack([pose(0, 0, z), pose(1, 0, z), pose(0, 0, 5)])
        batch = otg.collide_many(ball, plate, places, memory=memory)
        alone = otg.collide(ball, plate, pose(0, 0, z), memory=single)
    assert rows(batch[0]) == rows(alone) and len(batch[2]) == 0 and batch[1].normals[0, 2] > 0.9


def test_memory_is_about_its_meshes(box, ball):
    memory = otg.PairMemory()
    otg.collide(box, ball, memory=memory)
    with pytest.raises(otg.ArgumentError, match="same meshes"):
        otg.collide(ball, box, memory=memory)
    thawed = pickle.loads(pickle.dumps(memory))
    with pytest.raises(otg.ArgumentError, match="2 meshes"):
        otg.collide_many(box, ball, np.tile(np.eye(4), (3, 1, 1)), memory=thawed)


def test_names_stay_while_a_box_slides(box):
    floor = otg.generate.box([10, 10, 1], 7)
    first = otg.collide(box, floor, pose(0.013, 0.02, 0.99))
    later = otg.collide(box, floor, pose(0.413, 0.22, 0.99))
    corners = first.features == otg.FEATURES.index("vertex")
    assert corners.sum() >= 4 and len(np.unique(first.ids)) == len(first)
    assert set(first.ids[corners]) <= set(later.ids)


def test_frames_and_selections(box):
    contacts = otg.collide(box, box, pose(0, 0, 0.99))
    frame = contacts.to_frame()
    assert len(frame) == len(contacts) and {"positions_x", "normals_z", "depths", "triangles_1", "features"} <= set(
        frame
    )
    assert frame["features"].iloc[0] in otg.FEATURES
    deep = contacts.select(contacts.depths >= contacts.depths.max())
    assert 0 < len(deep) <= len(contacts) and isinstance(deep, otg.Contacts)
    assert "deep at most" in repr(contacts) and len(otg.collide(box, box, pose(9)).to_frame()) == 0


def test_a_device_has_the_same_bytes():
    """With PoCL or a GPU where there is one. Building kernels takes a minute or two the first time on a machine."""
    ball = otg.generate.lump(0.5, 3, 0.3, 3)  # pairs of convex meshes are the CPU's
    places = random_poses(300, 0.6, 12)
    expected = rows(otg.collide_many(ball, ball, places, options=otg.Options(backend="cpu")).contacts)
    try:
        if not otg.set_backend("opencl"):
            pytest.skip("no OpenCL device")
        device = otg.devices()[0]
        found = otg.collide_many(ball, ball, places, options=otg.Options(backend="opencl"))
        assert rows(found.contacts) == expected
        assert otg.devices()[0]["queries"] >= device["queries"] + 300
    finally:
        otg.set_backend("cpu")
    with pytest.raises(otg.ArgumentError):
        otg.set_backend("gpu")
