# SPDX-License-Identifier: BSD-3-Clause
"""Distances, overlaps, nearest points, insides and rays; judged by formulas, by NumPy and by trimesh."""

import numpy as np
import pytest
import trimesh
from conftest import pose, random_poses

import ode_trimesh_gpu as otg


def test_distance_of_boxes(box):
    found = otg.distance(box, box, None, pose(3, 0, 0))
    assert found.distance == pytest.approx(2)
    assert found.point_a[0] == pytest.approx(0.5) and found.point_b[0] == pytest.approx(2.5)
    # A corner turned towards a face: half a diagonal is sqrt(2)/2.
    turned = otg.distance(box, box, None, pose(3, 0, 0, angle=np.pi / 4))
    assert turned.distance == pytest.approx(2.5 - np.sqrt(0.5), rel=1e-7)
    np.testing.assert_allclose(np.linalg.norm(turned.point_a - turned.point_b), turned.distance)
    assert otg.distance(box, box, None, pose(0.5)).distance == 0
    far = otg.distance(box, box, None, pose(3), limit=1)
    assert np.isinf(far.distance) and np.isnan(far.point_a).all() and (far.triangles == -1).all()


def test_distance_of_convex_bodies_equals_an_optimiser(box):
    """The nearest points of two convex bodies by a quadratic programme over their vertices (Frank-Wolfe with steps
    back), which knows nothing of triangles."""
    places = random_poses(12, 3, 1)
    found = otg.distance(box, box, None, places)
    for i, placed in enumerate(places):
        a = box.vertices.astype(float)
        b = a @ placed[:3, :3].T + placed[:3, 3]
        points = (a[:, None] - b[None]).reshape(-1, 3)  # the Minkowski difference's vertices
        expected = nearest_to_origin(points)
        assert found.distance[i] == pytest.approx(expected, abs=1e-6)


def nearest_to_origin(points):
    """Length of the shortest vector of a convex hull, by Gilbert's algorithm on faces (scipy's hull)."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    if (hull.equations[:, 3] <= 0).all():
        return 0.0
    best = np.inf
    for a, b, c in points[hull.simplices]:
        best = min(best, np.linalg.norm(trimesh.triangles.closest_point([[a, b, c]], [[0.0, 0, 0]])[0]))
    return best


def test_overlaps_of_balls_follow_the_distance_of_their_middles(ball):
    places = random_poses(400, 1, 2)
    length = np.linalg.norm(places[:, :3, 3], axis=1)
    found = otg.overlaps(ball, ball, None, places)
    inner = 0.5 * np.cos(0.11)  # the tessellation's insphere has at least this radius
    assert found[length < 2 * inner].all() and not found[length > 1].any()
    assert found.dtype == bool and 0 < found.sum() < 400


def test_one_inside_the_other(box):
    small = otg.generate.box([0.1, 0.1, 0.1])
    assert otg.overlaps(box, small) is True
    assert otg.distance(box, small).distance == 0
    shell = otg.Mesh(box.vertices, box.faces[:-1])
    assert otg.overlaps(shell, small) is False


def test_sides_broadcast(box, ball):
    places = random_poses(5, 2, 3)
    many = otg.distance([box] * 5, ball, places, pose(1)).distance
    for i in range(5):
        assert many[i] == otg.distance(box, ball, places[i], pose(1)).distance
    rotations, translations = places[:, :3, :3], places[:, :3, 3]
    np.testing.assert_array_equal(otg.distance(box, ball, (rotations, translations), pose(1)).distance, many)
    assert len(otg.distance(box, ball, np.empty((0, 4, 4)))) == 0
    assert otg.overlaps([], ball).shape == (0,)


@pytest.mark.parametrize(
    "a, b, pose_a, pose_b",
    [(2, 3, None, None), (1, 1, 2, 3), (3, 1, 2, None)],
)
def test_sides_that_do_not_fit(box, a, b, pose_a, pose_b):
    pose_a, pose_b = (np.tile(np.eye(4), (n, 1, 1)) if n else None for n in (pose_a, pose_b))
    with pytest.raises(otg.ArgumentError):
        otg.overlaps([box] * a if a > 1 else box, [box] * b if b > 1 else box, pose_a, pose_b)


def test_closest_points_of_a_box_equal_the_formula(box):
    rng = np.random.default_rng(4)
    points = rng.uniform(-1, 1, (500, 3))
    found = otg.closest_points(box, points)
    clipped = np.clip(points, -0.5, 0.5)
    outside = np.linalg.norm(points - clipped, axis=1)
    depth = (0.5 - np.abs(points)).min(axis=1)
    np.testing.assert_allclose(found.distances, np.where(outside > 0, outside, -depth), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(points - found.points, axis=1), np.abs(found.distances), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1)
    np.testing.assert_array_equal(otg.inside(box, points), found.distances < 0)


def test_closest_points_equal_trimesh_in_any_pose():
    torus = otg.generate.torus(1, 0.3, 24, 12)
    placed = pose(1, 2, 3, (1, 1, 0), 0.7)
    peer = trimesh.Trimesh(torus.vertices.astype(float), torus.faces, process=False).apply_transform(placed)
    points = np.random.default_rng(5).uniform(-1.5, 1.5, (200, 3)) + [1, 2, 3]
    found = otg.closest_points(torus, points, placed)
    near, distance, _ = trimesh.proximity.closest_point(peer, points)
    np.testing.assert_allclose(np.abs(found.distances), distance, atol=1e-9)
    np.testing.assert_allclose(found.points, near, atol=1e-6)
    np.testing.assert_array_equal(otg.inside(torus, points, placed), peer.contains(points))


def brute_force(triangles, starts, directions, length):
    """Every ray against every triangle: where the ray meets the plane, by barycentric coordinates."""
    best = np.full(len(starts), np.inf)
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    for a, b, c in triangles:
        normal = np.cross(b - a, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = ((a - starts) @ normal) / (unit @ normal)
        hit = starts + t[:, None] * unit
        u, v, w = (np.cross(q - p, hit - p) @ normal for p, q in ((a, b), (b, c), (c, a)))
        ok = (u >= 0) & (v >= 0) & (w >= 0) & (t >= 0) & (t <= length)
        best = np.where(ok & (t < best), t, best)
    return best


def test_rays_equal_brute_force():
    lump = otg.generate.lump(0.5, 2, 0.3, 6)
    placed = pose(0.1, 0.2, -0.3, (1, 2, 3), 1.1)
    rng = np.random.default_rng(7)
    starts, directions = rng.uniform(-1, 1, (2000, 3)), rng.normal(size=(2000, 3))
    hits = otg.cast_rays(lump, starts, directions, 1.5, placed)
    triangles = lump.triangles.astype(float) @ placed[:3, :3].T + placed[:3, 3]
    expected = brute_force(triangles, starts, directions, 1.5)
    np.testing.assert_array_equal(hits.hit, np.isfinite(expected))
    np.testing.assert_allclose(hits.distances, expected, atol=1e-9)
    assert 100 < hits.hit.sum() < 1900
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    at = (starts + expected[:, None] * unit)[hits.hit]
    np.testing.assert_allclose(hits.positions[hits.hit], at, atol=1e-9)
    assert np.isnan(hits.positions[~hits.hit]).all()
    # From inside the solid the first face is hit from behind.
    np.testing.assert_array_equal(hits.back[hits.hit], otg.inside(lump, starts, placed)[hits.hit])
    assert ((hits.normals * unit).sum(axis=1)[hits.hit] < 0).all()


def test_rays_broadcast_and_cull(box):
    down = otg.cast_rays(box, [[0, 0, 2], [0.1, 0, 2], [3, 0, 2]], [0, 0, -1])
    np.testing.assert_array_equal(down.hit, [True, True, False])
    assert down.distances[0] == pytest.approx(1.5)
    assert not otg.cast_rays(box, [0, 0, 0], [0, 0, 1], cull_back=True).hit[0]
    assert otg.cast_rays(box, [0, 0, 0], [0, 0, 1]).back[0]
    assert len(otg.cast_rays(box, np.empty((0, 3)), np.empty((0, 3)))) == 0


@pytest.mark.parametrize(
    "call",
    [
        lambda box: otg.cast_rays(box, [0, 0, 0], [0, 0, 0]),
        lambda box: otg.cast_rays(box, [0, 0, np.nan], [0, 0, 1]),
        lambda box: otg.cast_rays(box, [0, 0, 0], [0, 0, 1], -1),
        lambda box: otg.closest_points(box, [[0, 0, np.inf]]),
        lambda box: otg.closest_points(box, [0, 0, 0]),
        lambda box: otg.distance(box, box, limit=-1),
        lambda box: otg.inside("box", [[0, 0, 0]]),
        lambda box: otg.overlaps(box, 3),
    ],
)
def test_arguments_that_are_refused(box, call):
    with pytest.raises((otg.ArgumentError, TypeError)):
        call(box)


@pytest.mark.parametrize(
    "bad",
    [
        np.diag([2.0, 2, 2, 1]),
        np.diag([-1.0, 1, 1, 1]),
        np.full((4, 4), np.nan),
        np.eye(3),
        "home",
        np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1.0]]),
        np.zeros((2, 4, 4)) + np.eye(4),
    ],
)
def test_poses_that_are_refused(box, bad):
    with pytest.raises(otg.PoseError):
        otg.collide(box, box, bad)
