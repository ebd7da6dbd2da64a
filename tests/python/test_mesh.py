# SPDX-License-Identifier: BSD-3-Clause
"""Meshes: ways in, report, mass, files, pickling; judged by trimesh and by formulas."""

import pickle

import numpy as np
import pytest
import trimesh

import ode_trimesh_gpu as otg


def solids():
    return {
        "box": otg.generate.box([1, 2, 3], 3),
        "sphere": otg.generate.sphere(0.7, 3),
        "torus": otg.generate.torus(1, 0.3, 32, 16),
        "cylinder": otg.generate.cylinder(0.5, 2, 24, 2),
        "capsule": otg.generate.capsule(0.3, 1),
        "bowl": otg.generate.bowl(1, 0.1),
        "gear": otg.generate.gear(12, 0.3, 0.06, 0.1, 0.1),
        "lump": otg.generate.lump(0.5, 3, 0.3, 4),
        "bolt": otg.generate.bolt(0.1, 0.05, 0.3, 24),
        "nut": otg.generate.nut(0.1, 0.05, 0.1, 0.005, 24),
        "tray": otg.generate.tray([1, 1, 0.3], 0.05),
    }


@pytest.mark.parametrize("name", solids())
def test_mass_properties_equal_trimesh(name):
    mesh = solids()[name]
    peer = trimesh.Trimesh(mesh.vertices.astype(np.float64), mesh.faces, process=False)
    assert mesh.is_solid and mesh.report.valid
    assert mesh.volume == pytest.approx(peer.volume, rel=1e-9)
    assert mesh.area == pytest.approx(peer.area, rel=1e-9)
    size = np.ptp(mesh.bounds, axis=0).max()
    np.testing.assert_allclose(mesh.center_of_mass, peer.center_mass, atol=1e-9 * size)
    np.testing.assert_allclose(mesh.inertia, peer.moment_inertia, atol=1e-9 * np.abs(peer.moment_inertia).max())
    np.testing.assert_allclose(mesh.bounds, peer.bounds)


def test_inertia_of_a_box_that_is_off_the_origin():
    shifted = otg.Mesh(otg.generate.box([1, 2, 3]).vertices + np.float32([4, 5, 6]), otg.generate.box([1, 2, 3]).faces)
    mass = shifted.mass_properties(density=10)
    assert mass.mass == pytest.approx(60)
    np.testing.assert_allclose(mass.center_of_mass, [4, 5, 6])
    np.testing.assert_allclose(mass.inertia, np.diag([4 + 9, 1 + 9, 1 + 4]) * 60 / 12, atol=1e-9)


@pytest.mark.parametrize("vertex_type", [np.float32, np.float64, np.float16, np.int64])
@pytest.mark.parametrize("face_type", [np.int32, np.int64, np.uint32, np.uint64, np.uint8])
def test_array_types_and_layouts(vertex_type, face_type):
    plain = otg.generate.box([2, 2, 2])
    vertices, faces = plain.vertices.astype(vertex_type), plain.faces.astype(face_type)
    wide = np.zeros((len(vertices), 6), vertex_type)
    wide[:, ::2] = vertices
    for v, f in ((vertices, faces), (wide[:, ::2], np.asfortranarray(faces)), (vertices.tolist(), faces.tolist())):
        mesh = otg.Mesh(v, f)
        assert mesh.volume == pytest.approx(8)
        np.testing.assert_array_equal(mesh.faces, plain.faces)


def test_arrays_are_copied_and_given_back_read_only(box):
    vertices = box.vertices.copy()
    mesh = otg.Mesh(vertices, box.faces)
    vertices[:] = 7
    assert mesh.volume == pytest.approx(1)
    with pytest.raises(ValueError):
        mesh.vertices[0] = 0
    assert mesh.vertices.dtype == np.float32 and mesh.faces.dtype == np.int32
    assert mesh.triangles.shape == (12, 3, 3)


def test_meshes_of_trimesh(box):
    peer = trimesh.creation.annulus(0.5, 1, 0.3)
    mesh = otg.Mesh(peer)
    assert mesh.volume == pytest.approx(peer.volume, rel=1e-6)
    assert otg.Mesh(box).volume == box.volume


@pytest.mark.parametrize("extension", ["ply", "obj", "off", "stl", "glb"])
def test_files(tmp_path, extension):
    peer = trimesh.creation.icosphere(subdivisions=2, radius=1.5)
    path = tmp_path / f"ball.{extension}"
    peer.export(path)
    mesh = otg.Mesh(path)
    assert len(mesh) == len(peer.faces)
    assert mesh.volume == pytest.approx(peer.volume, rel=1e-5)
    assert otg.Mesh(str(path)).is_solid


def test_errors_of_files(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"none\.ply"):
        otg.Mesh(tmp_path / "none.ply")
    broken = tmp_path / "broken.ply"
    broken.write_text("ply\nformat ascii 1.0\nelement vertex 3\n")
    with pytest.raises(otg.MeshError, match=r"broken\.ply"):
        otg.Mesh(broken)


def test_cooked_files_and_pickles(tmp_path, box):
    torus = otg.generate.torus(1, 0.3)
    torus.save(tmp_path / "torus.otg")
    for copy in (otg.Mesh(tmp_path / "torus.otg"), pickle.loads(pickle.dumps(torus))):
        np.testing.assert_array_equal(copy.vertices, torus.vertices)
        np.testing.assert_array_equal(copy.faces, torus.faces)
        assert copy.report == torus.report
        contacts, expected = (otg.collide(mesh, box, None, (np.eye(3), [1.2, 0, 0.2])) for mesh in (copy, torus))
        np.testing.assert_array_equal(contacts.positions, expected.positions)


def test_report_of_an_open_mesh(box):
    mesh = otg.Mesh(box.vertices, box.faces[:-1])
    report = mesh.report
    assert not report.valid and not report.closed and not report.solid and report.boundary_edges == 3
    assert [(problem.kind, problem.count) for problem in report.problems][0] == ("boundary_edge", 3)
    assert report.problems[0].message in str(report)
    assert "no solid" in str(report)
    with pytest.raises(otg.MeshError):
        otg.Mesh(box.vertices[:3], [[0, 1, 2]]).mass_properties()


def test_repair():
    box = otg.generate.box([1, 1, 1])
    soup = box.vertices[box.faces].reshape(-1, 3)
    faces = np.arange(36).reshape(-1, 3)
    faces[4] = faces[4, ::-1]  # one face turned round
    faces = np.concatenate([faces, faces[:2], [[0, 0, 1]]])  # two twice, one without area
    broken = otg.Mesh(soup, faces)
    assert not broken.is_solid
    mesh = otg.Mesh(soup, faces, repair=True)
    assert mesh.is_solid and mesh.volume == pytest.approx(1)
    assert len(mesh.vertices) == 8 and len(mesh) == 12
    report = mesh.report
    assert report.flipped_triangles == 1 and report.dropped_duplicates == 2 and report.dropped_degenerate == 1
    assert report.welded_vertices == 28
    # Numbers of contacts are those of the repaired arrays.
    contacts = otg.collide(mesh, mesh, (np.eye(3), [0, 0, 0.95]))
    assert contacts.triangles.max() < 12 and contacts.vertices.max() < 8


@pytest.mark.parametrize(
    "vertices, faces, message",
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, np.nan]], [[0, 1, 2]], "finite"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 1e300]], [[0, 1, 2]], "finite"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]], r"face 0 is \[0, 1, 3\], but there are 3 vertices"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, -1, 2]], "face 1"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0.0, 1.0, 2.0]], "integers"),
        ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], r"shape \(n, 3\)"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2, 0]], r"shape \(m, 3\)"),
    ],
)
def test_meshes_that_are_refused(vertices, faces, message):
    with pytest.raises(otg.MeshError, match=message):
        otg.Mesh(vertices, faces)


def test_errors_are_of_the_usual_kinds_too():
    for kind in (otg.MeshError, otg.PoseError, otg.ArgumentError, otg.SceneError):
        assert issubclass(kind, ValueError) and issubclass(kind, otg.Error)
    with pytest.raises(otg.ArgumentError):
        otg.Mesh(42)


def test_a_mesh_without_triangles():
    mesh = otg.Mesh(np.empty((0, 3)), np.empty((0, 3), int))
    assert len(mesh) == 0 and len(otg.collide(mesh, mesh)) == 0
    with pytest.raises(otg.MeshError):
        _ = mesh.bounds


def test_update_moves_vertices(box, ball):
    box.update(2 * box.vertices)
    fresh = otg.generate.box([2, 2, 2])
    assert box.volume == pytest.approx(8)
    at = (np.eye(3), [0, 0, 1.4])
    np.testing.assert_array_equal(otg.collide(box, ball, None, at).depths, otg.collide(fresh, ball, None, at).depths)
    with pytest.raises(otg.MeshError):
        box.update(np.zeros((3, 3)))
    with pytest.raises(otg.MeshError):
        box.update(np.full((8, 3), 1e300))
    assert box.volume == pytest.approx(8)


@pytest.mark.parametrize(
    "make",
    [
        lambda: otg.generate.box([1, -1, 1]),
        lambda: otg.generate.box([1, 1]),
        lambda: otg.generate.sphere(0),
        lambda: otg.generate.sphere(1, 30),
        lambda: otg.generate.torus(1, 2),
        lambda: otg.generate.gear(0, 1, 1, 1),
        lambda: otg.generate.lump(1, 3, 5),
    ],
)
def test_sizes_that_make_no_solid(make):
    with pytest.raises(otg.ArgumentError):
        make()
