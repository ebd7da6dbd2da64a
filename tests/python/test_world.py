# SPDX-License-Identifier: BSD-3-Clause
"""Worlds: mass, motion, contacts, joints, callbacks, states; judged by formulas of mechanics."""

import pickle

import numpy as np
import pytest
from conftest import pose

import ode_trimesh_gpu as otg


def stack(**settings):
    world = otg.World(**settings)
    world.add(otg.Plane())
    for i in range(3):
        world.add(otg.generate.box([1, 1, 1]), pose(0.05 * i, 0, 0.5 + 1.001 * i))
    return world


def test_free_fall_and_spin():
    world = otg.World(gravity=(0, 0, -10), stepper="exact")
    body = world.add(otg.generate.box([1, 1, 1]), velocity=(1, 0, 5), angular_velocity=(0, 0, 2))
    world.step(dt=0.01, steps=100)
    # Symplectic Euler: z = v t - g dt^2 n (n + 1) / 2.
    np.testing.assert_allclose(body.position, [1, 0, 5 - 10 * 1e-4 * 100 * 101 / 2], atol=1e-9)
    np.testing.assert_allclose(body.linear_velocity, [1, 0, -5], atol=1e-9)
    np.testing.assert_allclose(body.angular_velocity, [0, 0, 2], atol=1e-6)
    assert np.arctan2(body.pose[1, 0], body.pose[0, 0]) == pytest.approx(2, abs=1e-3)
    assert world.time == pytest.approx(1) and world.contacts.positions.shape == (0, 3)


@pytest.mark.parametrize(
    "shape, volume",
    [
        (otg.Box((1, 2, 3)), 6),
        (otg.Sphere(0.5), np.pi / 6),
        (otg.Cylinder(0.5, 2), np.pi / 2),
        (otg.Capsule(0.5, 2), np.pi / 2 + np.pi / 6),
    ],
)
def test_masses_of_shapes(shape, volume):
    world = otg.World()
    assert world.add(shape, density=10).mass == pytest.approx(10 * volume)
    assert world.add(shape, mass=7).mass == pytest.approx(7)


def test_a_body_of_several_shapes_turns_about_its_centre_of_mass(box):
    world = otg.World(gravity=(0, 0, 0), stepper="exact")
    # Two boxes of 1 kg and 3 kg: the centre is at 3/4 of the way.
    body = world.add([(box, pose(0)), (otg.Box((1, 1, 3)), pose(4))], density=1, angular_velocity=(0, 0, 1))
    assert body.mass == pytest.approx(4)
    np.testing.assert_allclose(body.center_of_mass, [3, 0, 0], atol=1e-9)
    np.testing.assert_allclose(body.position, [0, 0, 0], atol=1e-9)
    world.step(dt=0.001, steps=1000)
    np.testing.assert_allclose(body.center_of_mass, [3, 0, 0], atol=1e-9)
    np.testing.assert_allclose(body.position, [3 - 3 * np.cos(1), -3 * np.sin(1), 0], atol=1e-2)
    # Steiner: the inertia about the centre is the sum of both with their distances.
    kinetic, potential = world.energy
    expected = (1 * (2 / 12 + 9) + 3 * (2 / 12 + 1)) / 2
    assert kinetic == pytest.approx(expected, rel=1e-6) and potential == 0


@pytest.mark.parametrize("stepper", ["quick", "exact"])
def test_a_stack_rests_and_carries_its_weight(stepper):
    world = stack(stepper=stepper, iterations=50)
    world.step(steps=600)
    np.testing.assert_allclose(world.poses[1:, 2, 3], [0.5, 1.5, 2.5], atol=0.01)
    assert np.abs(world.linear_velocities).max() < 0.02
    contacts = world.contacts
    on_plane = contacts.select((contacts.bodies == 0).any(axis=1))
    # Normals point into the first body, the plane, and so do forces.
    assert (on_plane.bodies[:, 0] == 0).all() and (on_plane.normals[:, 2] < -0.99).all()
    assert on_plane.forces[:, 2].sum() == pytest.approx(-3 * 1000 * 9.81, rel=0.03)
    upper = contacts.select((contacts.bodies == [2, 3]).all(axis=1))
    assert upper.forces[:, 2].sum() == pytest.approx(-1000 * 9.81, rel=0.05)
    assert (upper.ids != 0).all() and len(contacts.geoms) == len(contacts)


@pytest.mark.parametrize("friction, slides", [(0.2, True), (0.6, False)])
def test_friction_on_a_slope(friction, slides):
    angle = np.radians(22)  # tan is 0.404
    world = otg.World(gravity=(9.81 * np.sin(angle), 0, -9.81 * np.cos(angle)), friction=5)
    world.add(otg.Plane())
    body = world.add(otg.generate.box([1, 1, 0.2]), pose(0, 0, 0.1), friction=friction)
    world.step(steps=400)
    expected = 9.81 * (np.sin(angle) - friction * np.cos(angle)) * 2 if slides else 0
    assert body.linear_velocity[0] == pytest.approx(expected, abs=0.1)


def test_bounce():
    world = otg.World(stepper="exact", cfm=0)
    world.add(otg.Plane())
    body = world.add(otg.Sphere(0.1), pose(0, 0, 1.1), bounce=0.5)
    highest = 0
    for _ in range(1600):
        world.step(dt=0.0005)
        if body.linear_velocity[2] > 0:
            highest = max(highest, body.position[2] - 0.1)
    assert highest == pytest.approx(0.25, abs=0.015)  # half the speed, a quarter of the height


def test_shapes_and_terrain_carry_meshes():
    world = otg.World(linear_damping=0.01, angular_damping=0.01)  # without, the ball rolls to and fro for a minute
    x, y = np.meshgrid(np.linspace(-2, 2, 81), np.linspace(-2, 2, 81))
    bowl = world.add(otg.Terrain(0.3 * (x**2 + y**2), (4, 4)))
    ball = otg.generate.sphere(0.3, 4)
    body = world.add(ball, pose(0.5, 0.3, 1), density=100)
    assert bowl.kind == "static"
    world.step(dt=0.005, steps=2500)
    assert np.linalg.norm(body.linear_velocity) < 9.81 * 0.005  # at rest: slower than a step of gravity makes it
    # A ball of facets rests where the slope is less than the angle between a facet's normal and its corner. Farther out
    # all contacts are uphill of its middle. The bowl's slope is 0.6 * outward. A cell of 0.05 is flat, so along each
    # axis its slope is off by 0.3 * 0.05 at most.
    corners = ball.vertices[ball.faces].astype(float)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across = np.linalg.norm(np.cross(normals[:, None], corners), axis=2)
    slope = (across / (normals[:, None] * corners).sum(axis=2)).max() + 0.3 * 0.05 * np.sqrt(2)
    outward = np.hypot(*body.position[:2])
    assert outward < slope / 0.6 < 0.12
    # Its middle is a radius above the bowl. Facets and cells are chords: they take 0.4 mm away, or add as much.
    assert body.position[2] == pytest.approx(0.3 + 0.3 * outward**2, abs=0.001)
    # A row of heights that is not square, the other way round: y up the rows.
    slope = otg.World()
    slope.add(otg.Terrain([[0, 0, 0], [1, 1, 1]], (4, 2)))
    hit = slope.add(otg.generate.sphere(0.2, 2), pose(0, 0.9, 1.1))
    contacts = slope.collide()
    assert len(contacts) and contacts.bodies[0].tolist() == [0, hit.index]
    assert contacts.normals[0] @ [0, 1, -2] > 0  # into the ground


def test_kinematic_bodies_push_and_are_not_pushed(box):
    world = otg.World(friction=0)
    world.add(otg.Plane())
    pusher = world.add(
        otg.Mesh(box.vertices, box.faces[:10]), pose(-1.2, 0, 0.5), kind="kinematic", velocity=(0.5, 0, 0)
    )
    pushed = world.add(box, pose(0, 0, 0.5))
    world.step(steps=400)
    assert pusher.position[0] == pytest.approx(-0.2) and pusher.mass == 0
    assert 0.79 < pushed.position[0] < 0.9 and abs(pushed.position[1]) < 0.05


def test_hinge_with_motor_and_limits(box):
    world = otg.World(gravity=(0, 0, 0), stepper="exact", cfm=0)
    body = world.add(box)
    joint = world.add_joint("hinge", body, anchor=(0.5, 0, 0), axis=(0, 0, 1))
    joint.set_motor(2, 1e6)
    world.step(dt=0.01, steps=10)
    assert abs(joint.rate) == pytest.approx(2, rel=1e-2)
    joint.set_limits(-0.5, 0.5)
    world.step(dt=0.01, steps=200)
    assert abs(joint.position) == pytest.approx(0.5, abs=0.02)
    np.testing.assert_allclose(body.pose[:2, :2] @ [0.5, 0] + body.pose[:2, 3], [0.5, 0], atol=1e-3)


def test_slider_carries_weight(box):
    world = otg.World()
    body = world.add(box, pose(0, 0, 3), density=10)
    joint = world.add_joint("slider", body, axis=(1, 0, 0))
    joint.set_motor(0.3, 1000)
    world.step(steps=200)
    np.testing.assert_allclose(body.position, [0.3, 0, 3], atol=0.01)
    assert abs(joint.position) == pytest.approx(0.3, rel=0.02)
    assert joint.force[2] == pytest.approx(98.1, rel=0.02)


@pytest.mark.parametrize("kind", ["ball", "universal", "fixed"])
def test_other_joints_hold(box, kind):
    world = otg.World()
    upper = world.add(box, pose(0, 0, 3), kind="kinematic")
    lower = world.add(box, pose(0, 0, 1.9))
    joint = world.add_joint(kind, upper, lower, anchor=(0, 0, 2.4), axis=(1, 0, 0), axis2=(0, 1, 0))
    world.step(steps=200)
    np.testing.assert_allclose(lower.position, [0, 0, 1.9], atol=0.02)
    with pytest.raises(otg.ArgumentError):
        joint.set_motor(1, 1)


def test_joined_bodies_do_not_collide(box):
    world = otg.World(gravity=(0, 0, 0))
    a, b = world.add(box), world.add(box, pose(0.5))
    assert len(world.collide()) > 0
    world.add_joint("fixed", a, b)
    assert len(world.collide()) == 0


def test_forces(box):
    world = otg.World(gravity=(0, 0, 0), stepper="exact")
    body = world.add(box, mass=2)
    body.add_force((4, 0, 0))
    world.step(dt=0.1)
    np.testing.assert_allclose(body.linear_velocity, [0.2, 0, 0], atol=1e-12)
    body.add_force((0, 1, 0), at=body.center_of_mass + [1, 0, 0])
    world.step(dt=0.1)
    # The cube's inertia is m/6; the lever is 1.
    np.testing.assert_allclose(body.angular_velocity, [0, 0, 0.1 / (2 / 6)], atol=1e-9)
    body.add_force(torque=(0, 0, -1))
    world.step(dt=0.1)
    np.testing.assert_allclose(body.angular_velocity, [0, 0, 0], atol=1e-9)


def test_writing_a_pose_moves_a_body(box):
    world = otg.World()
    still, body = world.add(box, kind="static"), world.add([(box, pose(0, 0, 1))], pose(0, 0, 5))
    body.pose = (np.eye(3), [0, 0, -0.01])
    np.testing.assert_allclose(body.pose, pose(0, 0, -0.01), atol=1e-12)
    np.testing.assert_allclose(body.center_of_mass, [0, 0, 0.99], atol=1e-12)
    assert len(world.collide()) == 4
    still.pose = pose(0, 0, -3)
    assert len(world.collide()) == 0
    with pytest.raises(otg.PoseError):
        body.pose = np.diag([2.0, 1, 1, 1])


def test_saved_states_continue_with_the_same_bytes():
    world = stack()
    world.bodies[3].set_velocity((0.3, 0.2, 0), (1, 1, 0))
    world.step(steps=40)
    state = pickle.loads(pickle.dumps(world.save()))
    np.testing.assert_array_equal(state.poses, world.poses)
    assert state.time == world.time
    world.step(steps=60)
    end, contacts = world.poses.tobytes(), world.contacts.forces.tobytes()
    rebuilt = stack()
    for other in (world, rebuilt):
        other.load(state)
        np.testing.assert_array_equal(other.poses, state.poses)
        other.step(steps=60)
        assert other.poses.tobytes() == end and other.contacts.forces.tobytes() == contacts
        assert other.time == world.time


def test_a_world_without_a_removed_body_is_one_that_never_had_it(box):
    def build(with_more):
        world = otg.World()
        plane = world.add(otg.Plane())
        gone = world.add([(box, pose(0)), (otg.Sphere(0.5), pose(0, 0, 1))], pose(0, 0, 1.5)) if with_more else None
        kept = [world.add(box, pose(0.1 * i, 0, 0.5 + 1.001 * i)) for i in range(2)]
        world.add_joint("ball", kept[1], anchor=(0, 0, 2))
        if gone is None:
            return world
        world.add_joint("hinge", gone, kept[0])
        world.collide()
        contacts = world.contacts
        assert (contacts.bodies == gone.index).any()
        world.remove(gone)
        left = world.contacts
        assert len(left) == (contacts.bodies != 1).all(axis=1).sum() > 0
        assert sorted(set(left.bodies.ravel())) == sorted(set(left.geoms.ravel())) == [0, 1]
        assert world.bodies == [plane, *kept] and [body.index for body in world.bodies] == [0, 1, 2]
        assert [(joint.index, joint.kind) for joint in world.joints] == [(0, "ball")]
        return world

    changed, plain = build(True), build(False)
    assert changed.poses.shape == (3, 4, 4)
    for world in (changed, plain):
        world.step(steps=100)
    assert changed.poses.tobytes() == plain.poses.tobytes()
    assert changed.contacts.forces.tobytes() == plain.contacts.forces.tobytes()
    assert changed.joints[0].force.tobytes() == plain.joints[0].force.tobytes()
    state = plain.save()
    assert changed.save().exact == state.exact
    changed.load(state)


def test_what_stood_on_a_removed_body_falls():
    world = stack()
    world.step(steps=100)
    before = world.save()
    world.remove(world.bodies[1])
    world.step(steps=300)
    np.testing.assert_allclose(world.poses[1:, 2, 3], [0.5, 1.5], atol=0.01)
    with pytest.raises(otg.ArgumentError, match="other bodies"):
        world.load(before)
    world.remove(world.bodies[0])
    world.step(steps=100)
    assert world.poses[0, 2, 3] < 0


@pytest.mark.parametrize("others", range(4))
def test_nothing_is_remembered_of_a_removed_shape(others):
    # The ball sinks through the plate. What it remembers of the plate says up; the nearer way out is down.
    def plate(x=0):
        return world.add(otg.Box((4, 4, 0.3)), pose(x, 0, 0), kind="static")

    def up():
        contacts = world.collide()  # normals point into the first body
        return (contacts.normals[:, 2] * np.where(contacts.bodies[:, 0] == ball.index, 1, -1)).tolist()

    world = otg.World()
    sunk = plate()
    ball = world.add(otg.generate.sphere(0.5))
    for height in np.linspace(0.64, -0.2, 15):
        ball.pose = pose(0, 0, height)
        world.collide()
    assert min(up()) > 0.9
    world.remove(sunk)
    # ODE gives the address of a geom that is gone to one of the next.
    for _ in range(others):
        world.remove(plate(10))
    plate()
    assert len(up()) > 0 and max(up()) < -0.9


def test_removed_objects_are_refused(box):
    world, other = stack(), stack()
    body = world.bodies[2]
    joint = world.add_joint("hinge", body)
    second = world.add_joint("slider", world.bodies[3])
    world.remove(joint)
    assert world.joints == [second] and second.index == 0 and second.position == 0
    with pytest.raises(otg.ArgumentError, match="another world"):
        other.remove(body)
    world.remove(body)
    for use in (
        lambda: body.pose,
        lambda: body.index,
        lambda: body.add_force((1, 0, 0)),
        lambda: world.remove(body),
        lambda: world.add_joint("ball", body),
        lambda: joint.position,
        lambda: world.remove(joint),
    ):
        with pytest.raises(otg.ArgumentError, match="removed from its world"):
            use()
    assert "removed" in repr(body) and "removed" in repr(joint) and len(world.bodies) == 3
    world.step(steps=5)

    world.contact_callback = lambda contacts: world.remove(world.bodies[1])
    with pytest.raises(otg.BusyError, match="callback"):
        world.step()
    world.contact_callback = None
    world.step(steps=2, callback=lambda w: w.remove(w.bodies[-1]))
    assert len(world.bodies) == 1


def test_bodies_come_and_go(box):
    world = stack()
    size = len(world.save().exact)
    for _ in range(50):
        thrown = world.add(otg.generate.sphere(0.2), pose(0.1, 0, 3.3), velocity=(0, 0, -1))
        ground = world.add(otg.Terrain(np.zeros((4, 4)), (1, 1)), pose(5, 0, 0))
        world.step(steps=5)
        for body in (ground, thrown):
            world.remove(body)
    world.step()
    grown = otg.World()
    assert len(world.save().exact) <= size + 5 * 1000 and len(world.bodies) == 4
    for body in list(world.bodies):
        world.remove(body)
    world.step()
    assert world.poses.shape == (0, 4, 4) and len(world.save().exact) == len(grown.save().exact)


def test_a_run_does_not_depend_on_how_it_is_cut_or_on_callbacks():
    whole, single, watched = stack(), stack(), stack()
    whole.step(steps=60)
    for _ in range(60):
        single.step()
    watched.contact_callback = lambda contacts: None
    watched.pair_filter = lambda a, b: True
    watched.step(steps=60)
    assert whole.poses.tobytes() == single.poses.tobytes() == watched.poses.tobytes()


def test_states_that_do_not_fit(box):
    state = stack().save()
    other = otg.World()
    other.add(box)
    with pytest.raises(otg.ArgumentError, match="other bodies"):
        other.load(state)
    for broken in (b"", b"nonsense" * 40, state.exact[:-1], state.exact[:200] + b"x" + state.exact[201:]):
        bad = otg.State(0, state.poses, state.linear_velocities, state.angular_velocities, broken)
        with pytest.raises(otg.ArgumentError):
            stack().load(bad)


def test_pair_filter_and_contact_callback(box):
    world = otg.World()
    floor = world.add(otg.Plane(), name="floor")
    ghost, solid = world.add(box, pose(0, 0, 0.6), name="ghost"), world.add(box, pose(3, 0, 0.6), name="solid")
    seen = set()

    def keep(a, b):
        seen.add((a.name, b.name))
        return ghost not in (a, b)

    world.pair_filter = keep
    world.step(steps=200)
    assert seen == {("floor", "ghost"), ("floor", "solid")}
    assert ghost.position[2] < 0 and solid.position[2] == pytest.approx(0.5, abs=0.01)
    assert floor.index == 0

    icy = otg.World()
    icy.add(otg.Plane())
    sled = icy.add(box, pose(0, 0, 0.5), velocity=(1, 0, 0))

    def slip(contacts):
        contacts.friction[:] = 0
        contacts.bounce[:] = 0

    icy.contact_callback = slip
    icy.step(steps=100)
    assert sled.linear_velocity[0] == pytest.approx(1, abs=1e-3)
    icy.contact_callback = lambda contacts: contacts.depths < 0
    icy.step(steps=100)
    assert sled.position[2] < 0


def test_an_exception_of_a_callback_comes_through(box):
    world = stack()

    def fail(contacts):
        raise KeyError("mine")

    world.contact_callback = fail
    with pytest.raises(KeyError, match="mine"):
        world.step(steps=3)
    world.contact_callback = None
    world.step(steps=3)


def test_a_step_callback_sees_every_step():
    world = stack()
    times = []
    world.step(dt=0.01, steps=5, callback=lambda w: times.append(w.time))
    np.testing.assert_allclose(times, [0.01, 0.02, 0.03, 0.04, 0.05])


def test_recordings(tmp_path):
    world = stack()
    recording = world.record(dt=0.01, steps=30, every=10)
    assert len(recording) == 4 and recording.positions.shape == (4, 4, 3) and recording.rotations.shape == (4, 4, 4)
    np.testing.assert_allclose(recording.times, [0, 0.1, 0.2, 0.3])
    frame = recording.to_frame()
    assert len(frame) == 16 and list(frame.columns[:3]) == ["time", "body", "x"]
    np.testing.assert_allclose(np.linalg.norm(frame[["qw", "qx", "qy", "qz"]], axis=1), 1)
    recording.to_gltf(tmp_path / "stack.glb")
    import trimesh

    loaded = trimesh.load(tmp_path / "stack.glb")
    assert len(loaded.geometry) >= 1 and loaded.bounds is not None


def test_a_recording_is_of_the_bodies_that_it_began_with(tmp_path):
    world = stack()
    recording = world.record(dt=0.01, steps=20, every=10)
    world.remove(world.bodies[1])
    assert recording.to_frame()["body"].nunique() == 4
    recording.to_html(tmp_path / "stack.html")
    with pytest.raises(otg.ArgumentError, match="begin another"):
        recording.add()


def test_pages(tmp_path):
    from test_scene import data_of_page

    world = stack()
    recording = world.record(dt=0.005, steps=60)
    recording.to_html(tmp_path / "stack.html", "a stack")
    page = data_of_page(tmp_path / "stack.html")
    assert page["title"] == "a stack" and page["frames"] == len(recording) == 9
    assert page["steps"]["count"] == 60 and page["steps_per_frame"] == 7
    assert page["contacts"]["count"] == sum(len(rows) for rows in recording._arrows) > 0
    stack().to_html(tmp_path / "again.html", steps=20)
    assert data_of_page(tmp_path / "again.html")["steps"]["count"] == 20


def test_quaternions_of_all_rotations():
    from conftest import random_poses
    from ode_trimesh_gpu._arrays import quaternions

    rotations = np.concatenate(
        [random_poses(200, 1, 1)[:, :3, :3], [np.diag(d) for d in ([1.0, -1, -1], [-1, 1, -1], [-1, -1, 1], [1, 1, 1])]]
    )
    w, x, y, z = quaternions(rotations).T
    np.testing.assert_allclose(w * w + x * x - y * y - z * z, rotations[:, 0, 0], atol=1e-12)
    np.testing.assert_allclose(2 * (x * y - w * z), rotations[:, 0, 1], atol=1e-12)
    np.testing.assert_allclose(2 * (x * z - w * y), rotations[:, 2, 0], atol=1e-12)
    np.testing.assert_allclose(2 * (y * z + w * x), rotations[:, 2, 1], atol=1e-12)


def test_a_body_that_flies_away_is_an_error(box):
    world = otg.World()
    body = world.add(box, velocity=(1e9, 0, 0))
    with pytest.raises(otg.OdeError, match="1e8"):
        world.step(dt=1, steps=3)
    body.pose = np.eye(4)
    body.set_velocity((0, 0, 0))
    world.step()


@pytest.mark.parametrize(
    "call",
    [
        lambda w, box: w.add(otg.Box((1, 0, 1))),
        lambda w, box: w.add(otg.Sphere(-1)),
        lambda w, box: w.add(otg.Plane(), pose(1)),
        lambda w, box: w.add(otg.Plane((0, 0, 0))),
        lambda w, box: w.add(otg.Plane(), kind="dynamic"),
        lambda w, box: w.add(box, kind="frozen"),
        lambda w, box: w.add(box, density=0),
        lambda w, box: w.add(box, friction=-1),
        lambda w, box: w.add(otg.Mesh(box.vertices, box.faces[:1])),
        lambda w, box: w.add([]),
        lambda w, box: w.add(box, np.diag([1.0, 1, -1, 1])),
        lambda w, box: w.add(box, kind="static", velocity=(1, 0, 0)),
        lambda w, box: w.add(box).add_force((np.nan, 0, 0)),
        lambda w, box: w.add(box, options=otg.Options(contacts_per_region=0)),
        lambda w, box: w.add_joint("rope", w.add(box)),
        lambda w, box: w.add_joint("ball", w.add(box, kind="static")),
        lambda w, box: w.add_joint("ball", otg.World().add(box)),
        lambda w, box: w.step(dt=0),
        lambda w, box: otg.World(stepper="slow"),
        lambda w, box: otg.World(gravity=(0, 0)),
        lambda w, box: otg.World(max_contacts=0),
        lambda w, box: otg.World(erp=-1),
        lambda w, box: otg.Terrain([[1, 2]], (1, 1)),
    ],
)
def test_arguments_that_are_refused(box, call):
    world = otg.World()
    world.add(otg.Plane())
    with pytest.raises(otg.Error):
        call(world, box)
    world.step(steps=2)  # the world is as it was
