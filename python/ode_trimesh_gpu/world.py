# SPDX-License-Identifier: BSD-3-Clause
"""Rigid bodies in an ODE world."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, generate
from ._arrays import PoseLike, blocks, quaternions, single_pose, vector
from .contacts import Contacts
from .errors import ArgumentError, BusyError
from .mesh import Mesh
from .options import Options

if TYPE_CHECKING:
    from .recording import Recording

_KINDS = {"dynamic": _core.BodyKind.dynamic, "static": _core.BodyKind.static, "kinematic": _core.BodyKind.kinematic}


def _positive(**values: float) -> None:
    for name, value in values.items():
        if not 0 < value < np.inf:
            raise ArgumentError(f"{name} must be positive and finite, not {value}")


class _Shape:
    """A shape that is no mesh."""

    def _part(self, pose: NDArray[np.float64]) -> _core.Part:
        raise NotImplementedError

    def _surface(self) -> Mesh | None:
        """A mesh for pictures; None for what has no end."""
        raise NotImplementedError


@dataclass(frozen=True)
class Box(_Shape):
    """A box with its middle at the origin."""

    size: tuple[float, float, float]  #: side lengths

    def _part(self, pose: NDArray[np.float64]) -> _core.Part:
        x, y, z = vector(self.size, "size")
        _positive(x=x, y=y, z=z)
        return _core.Part.shape(_core.ShapeKind.box, [x, y, z, 0], pose)

    def _surface(self) -> Mesh:
        return generate.box(self.size)


@dataclass(frozen=True)
class Sphere(_Shape):
    """A ball with its middle at the origin."""

    radius: float

    def _part(self, pose: NDArray[np.float64]) -> _core.Part:
        _positive(radius=self.radius)
        return _core.Part.shape(_core.ShapeKind.sphere, [self.radius, 0, 0, 0], pose)

    def _surface(self) -> Mesh:
        return generate.sphere(self.radius, 3)


@dataclass(frozen=True)
class Capsule(_Shape):
    """A cylinder along z with half a ball at either end, its middle at the origin."""

    radius: float
    length: float  #: without the balls

    def _part(self, pose: NDArray[np.float64]) -> _core.Part:
        _positive(radius=self.radius, length=self.length)
        return _core.Part.shape(_core.ShapeKind.capsule, [self.radius, self.length, 0, 0], pose)

    def _surface(self) -> Mesh:
        return generate.capsule(self.radius, self.length)


@dataclass(frozen=True)
class Cylinder(_Shape):
    """A cylinder along z, its middle at the origin."""

    radius: float
    length: float

    def _part(self, pose: NDArray[np.float64]) -> _core.Part:
        _positive(radius=self.radius, length=self.length)
        return _core.Part.shape(_core.ShapeKind.cylinder, [self.radius, self.length, 0, 0], pose)

    def _surface(self) -> Mesh:
        return generate.cylinder(self.radius, self.length)


@dataclass(frozen=True)
class Plane(_Shape):
    """The half-space normal · x <= offset, in the world. Static."""

    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    offset: float = 0.0  #: metres along the unit normal

    def _part(self, pose: NDArray[np.float64]) -> _core.Part:
        if not np.array_equal(pose, np.eye(4)):
            raise ArgumentError("a plane has no pose: give its normal and offset in the world")
        normal = np.array(vector(self.normal, "normal"))
        length = float(np.linalg.norm(normal))
        _positive(length_of_normal=length)
        x, y, z = (normal / length).tolist()
        return _core.Part.shape(_core.ShapeKind.plane, [x, y, z, float(self.offset)], pose)

    def _surface(self) -> None:
        return None


class Terrain(_Shape):
    """Ground by heights on a grid, solid below, its middle at the origin. Static; rotations by right angles only.

    heights (rows, columns): z, along y and x; the first row has the smallest y. size: from the first sample to the last
    one along x and y. thickness: solid below the lowest sample.
    """

    def __init__(self, heights: ArrayLike, size: tuple[float, float], thickness: float = 1.0) -> None:
        self.heights = np.ascontiguousarray(heights, dtype=np.float32)
        self.size = (float(size[0]), float(size[1]))
        self.thickness = float(thickness)
        if self.heights.ndim != 2 or min(self.heights.shape) < 2 or not np.isfinite(self.heights).all():
            raise ArgumentError("heights must be finite and have the shape (rows, columns), at least 2 each")
        _positive(x=self.size[0], y=self.size[1], thickness=self.thickness)

    def _part(self, pose: NDArray[np.float64]) -> _core.Part:
        return _core.Part.terrain(self.heights, *self.size, self.thickness, pose)

    def _surface(self) -> Mesh:
        rows, columns = self.heights.shape
        x, y = np.meshgrid(np.linspace(-0.5, 0.5, columns) * self.size[0], np.linspace(-0.5, 0.5, rows) * self.size[1])
        corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
        right, up, over = corner + 1, corner + columns, corner + columns + 1
        faces = np.concatenate([np.stack([corner, right, over], 1), np.stack([corner, over, up], 1)])
        return Mesh(np.stack([x.ravel(), y.ravel(), self.heights.ravel()], 1), faces)


Shape = Mesh | Box | Sphere | Capsule | Cylinder | Plane | Terrain


@dataclass(frozen=True, repr=False)
class WorldContacts(Contacts):
    """The contacts of a step. Normals point into the first body of each."""

    bodies: NDArray[np.int32]  #: (n, 2): `Body.index` of both
    geoms: NDArray[np.int32]  #: (n, 2): shapes, counted over all bodies in their order
    friction: NDArray[np.float64]  #: (n,): coefficients; a contact callback may write them
    bounce: NDArray[np.float64]  #: (n,): restitution; a contact callback may write it
    forces: NDArray[np.float64]  #: (n, 3): newtons on the first body, of the step that followed


class Body:
    """A body of a world. Made by `World.add`."""

    def __init__(
        self, world: World, index: int, name: str, kind: str, shapes: list[tuple[Shape, NDArray[np.float64]]]
    ) -> None:
        self._world = world
        self._index: int | None = index
        self.name = name
        self.kind = kind
        self.shapes = shapes
        self.color: tuple[float, float, float] | None = None

    @property
    def index(self) -> int:
        """Its place in `World.bodies` and row in the world's arrays. Goes down when a body before it is removed."""
        if self._index is None:
            raise ArgumentError(f"{self.name} was removed from its world")
        return self._index

    @property
    def pose(self) -> NDArray[np.float64]:
        """(4, 4): the world from the body's frame. Writing it moves the body at once."""
        return np.array(self._world._core.poses()[self.index])

    @pose.setter
    def pose(self, pose: PoseLike) -> None:
        self._world._core.set_pose(self.index, single_pose(pose))

    @property
    def position(self) -> NDArray[np.float64]:
        """(3,): the origin of the body's frame, world, metres."""
        return self.pose[:3, 3]

    @property
    def center_of_mass(self) -> NDArray[np.float64]:
        """(3,): world, metres."""
        return np.array(self._world._core.centers()[self.index])

    @property
    def mass(self) -> float:
        """Kilograms; 0 for bodies that are not dynamic."""
        return self._world._core.mass(self.index)

    @property
    def linear_velocity(self) -> NDArray[np.float64]:
        """(3,): of the centre of mass, m/s."""
        return np.array(self._world._core.linear_velocities()[self.index])

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """(3,): rad/s, world."""
        return np.array(self._world._core.angular_velocities()[self.index])

    def set_velocity(self, linear: ArrayLike | None = None, angular: ArrayLike | None = None) -> None:
        """Sets velocities (3,) in the world; None leaves one as it is."""
        v = self.linear_velocity if linear is None else linear
        w = self.angular_velocity if angular is None else angular
        self._world._core.set_velocity(self.index, list(vector(v, "linear")), list(vector(w, "angular")))

    def add_force(
        self, force: ArrayLike = (0, 0, 0), torque: ArrayLike = (0, 0, 0), *, at: ArrayLike | None = None
    ) -> None:
        """Newtons (and newton metres) in the world for the next step; `at` a point of the world, else the centre."""
        core = self._world._core
        if at is not None:
            core.add_force_at(self.index, list(vector(force, "force")), list(vector(at, "at")))
            force = (0, 0, 0)
        core.add_force(self.index, list(vector(force, "force")), list(vector(torque, "torque")))

    def __repr__(self) -> str:
        return f"<Body {'removed' if self._index is None else self._index}: {self.name}>"


class Joint:
    """A joint of a world. Made by `World.add_joint`."""

    def __init__(self, world: World, index: int, kind: str) -> None:
        self._world = world
        self._index: int | None = index
        self.kind = kind

    @property
    def index(self) -> int:
        """Its place in `World.joints`. Goes down when a joint before it is removed."""
        if self._index is None:
            raise ArgumentError(f"this {self.kind} joint was removed from its world")
        return self._index

    @property
    def position(self) -> float:
        """Radians of a hinge, metres of a slider; 0 where the bodies were when the joint was made."""
        return self._world._core.joint_position(self.index)[0]

    @property
    def rate(self) -> float:
        """Radians or metres in a second."""
        return self._world._core.joint_position(self.index)[1]

    def set_limits(self, low: float, high: float) -> None:
        """Of a hinge (radians, within -pi and pi) or a slider (metres)."""
        if not low <= high:
            raise ArgumentError("the lower limit is above the upper one")
        self._world._core.set_limits(self.index, float(low), float(high))

    def set_motor(self, speed: float, max_force: float) -> None:
        """Drives a hinge (rad/s, newton metres) or a slider (m/s, newtons). A force of 0 switches the motor off."""
        if not max_force >= 0 or not np.isfinite(speed):
            raise ArgumentError("max_force must not be negative, and speed must be finite")
        self._world._core.set_motor(self.index, float(speed), float(max_force))

    @property
    def force(self) -> NDArray[np.float64]:
        """(3,): newtons of the last step on the first body, world."""
        return np.array(self._world._core.joint_force(self.index)[:3])

    def __repr__(self) -> str:
        return f"<Joint {'removed' if self._index is None else self._index}: {self.kind}>"


@dataclass(frozen=True)
class State:
    """A moment of a world: what `World.load` continues from with the same bytes. Pickles."""

    time: float  #: seconds
    poses: NDArray[np.float64]  #: (n, 4, 4): the world from each body's frame
    linear_velocities: NDArray[np.float64]  #: (n, 3): of the centres of mass
    angular_velocities: NDArray[np.float64]  #: (n, 3)
    exact: bytes  #: all of it to the last bit, with what pairs remember


PairFilter = Callable[[Body, Body], bool]
ContactCallback = Callable[[WorldContacts], "NDArray[np.bool_] | None"]


class World:
    """An ODE world: bodies made of meshes and shapes, joints, contacts. Metres, kilograms, seconds; z up by habit.

    gravity (3,): m/s². stepper: "quick" (`iterations` of an iterative solver) or "exact" (slower). erp, cfm: ODE's
    error reduction and softness. friction, bounce: of bodies that have none of their own; a contact takes the smaller
    friction and the larger bounce of its two. max_contacts: for a pair of shapes. seed: of the quick stepper.

    The same calls give the same bytes.
    """

    def __init__(
        self,
        *,
        gravity: ArrayLike = (0.0, 0.0, -9.81),
        stepper: Literal["quick", "exact"] = "quick",
        iterations: int = 20,
        erp: float = 0.2,
        cfm: float = 1e-5,
        friction: float = 1.0,
        bounce: float = 0.0,
        bounce_velocity: float = 0.01,
        surface_layer: float = 0.0,
        max_correcting_velocity: float = np.inf,
        linear_damping: float = 0.0,
        angular_damping: float = 0.0,
        max_contacts: int = 64,
        seed: int = 0,
    ) -> None:
        settings = _core.WorldSettings()
        settings.gravity = list(vector(gravity, "gravity"))
        if stepper not in ("quick", "exact"):
            raise ArgumentError(f"stepper must be 'quick' or 'exact', not {stepper!r}")
        if not 1 <= max_contacts <= 65535 or iterations < 1:
            raise ArgumentError("max_contacts must be 1 to 65535, and iterations at least 1")
        settings.quick = stepper == "quick"
        for name, value in (
            ("erp", erp),
            ("cfm", cfm),
            ("friction", friction),
            ("bounce", bounce),
            ("bounce_velocity", bounce_velocity),
            ("surface_layer", surface_layer),
            ("max_correcting_velocity", max_correcting_velocity),
            ("linear_damping", linear_damping),
            ("angular_damping", angular_damping),
        ):
            if not value >= 0:
                raise ArgumentError(f"{name} must not be negative")
            setattr(settings, name, float(value))
        settings.iterations = iterations
        settings.max_contacts = max_contacts
        settings.seed = seed
        self._core = _core.World(settings)
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self._solver_waits = False
        #: Asked for each pair of bodies with contacts, in each step: False drops them.
        self.pair_filter: PairFilter | None = None
        #: Called in each step with the contacts, before the solver: may write friction and bounce, and may return a
        #: mask (n,) of those that count.
        self.contact_callback: ContactCallback | None = None

    def add(
        self,
        shape: Shape | Sequence[tuple[Shape, PoseLike]],
        pose: PoseLike = None,
        *,
        name: str | None = None,
        kind: Literal["dynamic", "static", "kinematic"] | None = None,
        density: float = 1000.0,
        mass: float | None = None,
        velocity: ArrayLike | None = None,
        angular_velocity: ArrayLike | None = None,
        friction: float | None = None,
        bounce: float | None = None,
        options: Options | None = None,
        color: tuple[float, float, float] | None = None,
    ) -> Body:
        """Adds a body: one shape, or several with their poses in the body's frame.

        kind: "dynamic", "static" (never pushed), or "kinematic" (moves with the velocity that it is given, whatever it
        meets); planes and terrains are static. density: kg/m³; mass: kg in place of it. Mass, centre of mass and
        inertia are those of the shapes. options: how its meshes collide.
        """
        parts: list[tuple[Shape, PoseLike]]
        parts = [(shape, None)] if isinstance(shape, (Mesh, _Shape)) else list(shape)
        if not parts:
            raise ArgumentError("a body needs a shape")
        fixed = any(isinstance(one, (Plane, Terrain)) for one, _ in parts)
        chosen = kind or ("static" if fixed else "dynamic")
        if chosen not in _KINDS:
            raise ArgumentError(f"kind must be one of {', '.join(_KINDS)}, not {chosen!r}")
        _positive(density=density, mass=1.0 if mass is None else mass)
        placed = [(one, single_pose(at)) for one, at in parts]
        if any(isinstance(one, Plane) for one, _ in parts) and pose is not None:
            raise ArgumentError("a plane has no pose: give its normal and offset in the world")
        for value in (friction, bounce):
            if value is not None and not value >= 0:
                raise ArgumentError("friction and bounce must not be negative")
        if chosen == "static" and not (velocity is None and angular_velocity is None):
            raise ArgumentError("a static body has no velocity")
        made = [_core.Part.mesh(one._core, at) if isinstance(one, Mesh) else one._part(at) for one, at in placed]
        index = self._core.add_body(
            _KINDS[chosen],
            single_pose(pose),
            made,
            density,
            mass or 0.0,
            -1.0 if friction is None else friction,
            -1.0 if bounce is None else bounce,
            (options or Options())._params(),
        )
        body = Body(self, index, name or f"body {index}", chosen, placed)
        body.color = color
        self.bodies.append(body)
        if velocity is not None or angular_velocity is not None:
            body.set_velocity(velocity, angular_velocity)
        return body

    def add_joint(
        self,
        kind: Literal["ball", "hinge", "slider", "universal", "fixed"],
        a: Body,
        b: Body | None = None,
        *,
        anchor: ArrayLike = (0, 0, 0),
        axis: ArrayLike = (0, 0, 1),
        axis2: ArrayLike = (1, 0, 0),
    ) -> Joint:
        """Joins two bodies, or one and the world. anchor (3,), axis (3,) and axis2 (3,; universal) in the world.

        Joined bodies do not collide with each other.
        """
        for body in (a, b):
            if body is not None and body._world is not self:
                raise ArgumentError("the body belongs to another world")
        index = self._core.add_joint(
            kind,
            a.index,
            -1 if b is None else b.index,
            list(vector(anchor, "anchor")),
            list(vector(axis, "axis")),
            list(vector(axis2, "axis2")),
        )
        joint = Joint(self, index, kind)
        self.joints.append(joint)
        return joint

    def remove(self, what: Body | Joint) -> None:
        """Removes a joint, or a body with its joints, its contacts, and what other bodies remember of it.

        `index` of all later ones goes down, as the rows of the world's arrays do. Any use of the removed object is an
        `ArgumentError`. A callback that runs within a step cannot remove; `step`'s `callback`, which runs after each
        step, can.
        """
        if what._world is not self:
            raise ArgumentError(f"the {'body' if isinstance(what, Body) else 'joint'} belongs to another world")
        if self._solver_waits:
            raise BusyError("pair_filter and contact_callback cannot remove: use the callback of step()")
        index = what.index
        if isinstance(what, Joint):
            self._core.remove_joint(index)
            self._take_out(self.joints, index)
            return
        gone = self._core.remove_body(index)
        for joint in gone:
            self._take_out(self.joints, joint)
        self._take_out(self.bodies, index)

    @staticmethod
    def _take_out(objects: list[Body] | list[Joint], index: int) -> None:
        objects.pop(index)._index = None
        for i in range(index, len(objects)):
            objects[i]._index = i

    def step(
        self,
        dt: float = 0.005,
        steps: int = 1,
        *,
        progress: bool = False,
        callback: Callable[[World], Any] | None = None,
    ) -> None:
        """Collides and solves `steps` times with the time step `dt` in seconds.

        `callback` is called after each step. Ctrl-C stops between steps; `progress` shows a bar (tqdm).
        """
        _positive(dt=dt)
        one_by_one = self.pair_filter is not None or self.contact_callback is not None or callback is not None
        for begin, end in blocks(steps, 1, progress, "step"):
            if not one_by_one:
                self._core.step(dt, end - begin)
                continue
            for _ in range(begin, end):
                self._step_with_callbacks(dt)
                if callback is not None:
                    callback(self)

    def _step_with_callbacks(self, dt: float) -> None:
        self._core.collide()
        self._solver_waits = True
        try:
            friction, bounce, used = self._ask_callbacks()
        finally:
            self._solver_waits = False
        self._core.solve(dt, friction, bounce, used)

    def _ask_callbacks(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Of each contact: friction, bounce, and whether it counts."""
        contacts = self.contacts
        used = np.ones(len(contacts), bool)
        if self.pair_filter is not None and len(contacts):
            pairs, inverse = np.unique(contacts.bodies, axis=0, return_inverse=True)
            kept = [bool(self.pair_filter(self.bodies[i], self.bodies[j])) for i, j in pairs]
            used &= np.array(kept)[inverse.ravel()]
        if self.contact_callback is not None:
            mask = self.contact_callback(contacts)
            if mask is not None:
                used &= np.asarray(mask, bool)
        return contacts.friction, contacts.bounce, used

    def collide(self) -> WorldContacts:
        """Finds the contacts of this moment, without a step."""
        self._core.collide()
        return self.contacts

    @property
    def contacts(self) -> WorldContacts:
        """The contacts of the last step, found before the bodies moved."""
        columns, bodies, geoms, friction, bounce, forces = self._core.contacts()
        return WorldContacts(*columns, bodies, geoms, friction, bounce, forces)

    @property
    def time(self) -> float:
        """Seconds of all steps."""
        return self._core.time

    @property
    def poses(self) -> NDArray[np.float64]:
        """(n, 4, 4): the world from each body's frame."""
        return self._core.poses()

    @property
    def centers_of_mass(self) -> NDArray[np.float64]:
        """(n, 3): world, metres."""
        return self._core.centers()

    @property
    def linear_velocities(self) -> NDArray[np.float64]:
        """(n, 3): of the centres of mass, m/s; 0 for static bodies."""
        return self._core.linear_velocities()

    @property
    def angular_velocities(self) -> NDArray[np.float64]:
        """(n, 3): rad/s; 0 for static bodies."""
        return self._core.angular_velocities()

    @property
    def energy(self) -> tuple[float, float]:
        """Joules of the dynamic bodies: kinetic, potential (0 at the origin)."""
        kinetic, potential = self._core.energy()
        return kinetic, potential

    def save(self) -> State:
        """This moment as arrays, and as bytes for `load`."""
        return State(self.time, self.poses, self.linear_velocities, self.angular_velocities, self._core.save())

    def load(self, state: State) -> None:
        """Goes back to a moment of this world, or of one that was built by the same calls."""
        self._core.load(state.exact)

    def record(self, dt: float, steps: int, *, every: int | None = None, progress: bool = False) -> Recording:
        """Steps, and keeps poses and contacts of every `every`-th step (about 30 in a second of the world's time)."""
        from .recording import Recording

        recording = Recording(self, dt, every or max(1, round(1 / (30 * dt))))
        recording.add()
        self.step(dt, steps, progress=progress, callback=lambda world: recording.note_step())
        return recording

    def to_html(self, path: str | os.PathLike[str], dt: float = 0.005, steps: int = 400, title: str = "world") -> None:
        """Steps, and writes a page that plays these steps in any browser. `record(...).to_html(path)` is the same."""
        self.record(dt, steps).to_html(path, title)

    def show(self, **kwargs: Any) -> Any:
        """Draws bodies and contacts with PyVista; see `show`."""
        from .view import show

        return show(self, **kwargs)

    def _quaternions(self) -> NDArray[np.float64]:
        return quaternions(self.poses[:, :3, :3])

    def __repr__(self) -> str:
        return f"<World: {len(self.bodies)} bodies, {len(self.joints)} joints, {self.time:.6g} s>"
