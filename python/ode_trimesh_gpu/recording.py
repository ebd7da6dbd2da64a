# SPDX-License-Identifier: BSD-3-Clause
"""Motions as arrays, frames, glTF and pages."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from .errors import ArgumentError
from .mesh import Mesh

if TYPE_CHECKING:
    import pandas

    from .world import Body, World

COLORS = (
    (0.55, 0.55, 0.55),
    (0.80, 0.25, 0.12),
    (0.10, 0.35, 0.75),
    (0.85, 0.60, 0.08),
    (0.15, 0.55, 0.25),
    (0.50, 0.20, 0.60),
)


@dataclass(frozen=True)
class Surface:
    """What is drawn of a body."""

    name: str
    vertices: NDArray[np.float32]  #: (n, 3), in the body's frame
    faces: NDArray[np.int32]  #: (m, 3)
    color: tuple[float, float, float]  #: linear red, green, blue from 0 to 1
    static: bool


def drawn(
    surfaces: list[Surface],
    times: NDArray[np.float64],
    positions: NDArray[np.float64],
    rotations: NDArray[np.float64],
    arrows: list[NDArray[np.float64]],
) -> _core.Recording:
    """Positions (t, n, 3) and quaternions w, x, y, z (t, n, 4) of n bodies at t times; contacts (k, 7) at each time."""
    recording = _core.Recording([float(time) for time in times])
    for i, surface in enumerate(surfaces):
        if len(surface.faces) == 0:
            continue
        frames = slice(0, 1) if surface.static else slice(None)
        recording.add_body(
            surface.name,
            np.ascontiguousarray(surface.vertices, np.float32),
            np.ascontiguousarray(surface.faces, np.uint32),
            list(surface.color),
            np.ascontiguousarray(positions[frames, i]),
            np.ascontiguousarray(rotations[frames, i]),
        )
    for rows in arrows:
        recording.add_arrows(np.ascontiguousarray(rows, np.float64))
    return recording


def poses_frame(
    names: list[str],
    times: NDArray[np.float64],
    positions: NDArray[np.float64],
    rotations: NDArray[np.float64],
) -> pandas.DataFrame:
    """One row for each time and body: time, body, x, y, z, qw, qx, qy, qz."""
    import pandas

    columns: dict[str, Any] = {"time": np.repeat(times, len(names)), "body": names * len(times)}
    columns.update({name: positions[:, :, k].ravel() for k, name in enumerate("xyz")})
    columns.update({"q" + name: rotations[:, :, k].ravel() for k, name in enumerate("wxyz")})
    return pandas.DataFrame(columns)


def body_surface(shapes: list[tuple[Any, NDArray[np.float64]]]) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """All shapes of a body that have a surface, as one mesh in the body's frame."""
    vertices: list[NDArray[Any]] = [np.empty((0, 3), np.float32)]
    faces: list[NDArray[Any]] = [np.empty((0, 3), np.int32)]
    count = 0
    for shape, pose in shapes:
        mesh = shape if isinstance(shape, Mesh) else shape._surface()
        if mesh is None:
            continue
        vertices.append((mesh.vertices @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32))
        faces.append(mesh.faces + count)
        count += len(mesh.vertices)
    return np.concatenate(vertices), np.concatenate(faces)


def body_surfaces(bodies: list[Body]) -> list[Surface]:
    """What is drawn of each body, in their order."""
    surfaces = []
    for i, body in enumerate(bodies):
        vertices, faces = body_surface(body.shapes)
        surfaces.append(
            Surface(body.name, vertices, faces, body.color or COLORS[i % len(COLORS)], body.kind == "static")
        )
    return surfaces


class Recording:
    """Poses and contacts of a world at several times. Made by `World.record`."""

    def __init__(self, world: World, dt: float = 0.005, every: int = 1) -> None:
        self._world = world
        self._bodies = list(world.bodies)
        self._dt = dt
        self._every = every
        self._times: list[float] = []
        self._arrows: list[NDArray[np.float64]] = []
        self._steps: list[tuple[float, float, float]] = []
        self._positions: list[NDArray[np.float64]] = []
        self._rotations: list[NDArray[np.float64]] = []

    def add(self) -> None:
        """Keeps the poses of this moment, and the contacts of the step that led there."""
        if self._world.bodies != self._bodies:
            raise ArgumentError("bodies were added or removed since the recording began: begin another one")
        self._times.append(self._world.time)
        self._arrows.append(self._contact_arrows())
        self._positions.append(self._world.poses[:, :3, 3])
        self._rotations.append(self._world._quaternions())

    def note_step(self) -> None:
        """After each step: its contacts and energy, and the poses where they are kept."""
        self._steps.append((float(len(self._world.contacts)), *self._world.energy))
        if len(self._steps) % self._every == 0:
            self.add()

    def _contact_arrows(self) -> NDArray[np.float64]:
        """(k, 7): position, direction into a body that moves, depth."""
        contacts = self._world.contacts
        static = np.array([body.kind == "static" for body in self._world.bodies], bool)
        first, second = static[contacts.bodies[:, 0]], static[contacts.bodies[:, 1]]
        sign = np.where(first & ~second, -1.0, 1.0)[:, None]
        return np.hstack([contacts.positions, sign * contacts.normals, contacts.depths[:, None]])

    @property
    def times(self) -> NDArray[np.float64]:
        """(t,): seconds."""
        return np.array(self._times)

    @property
    def positions(self) -> NDArray[np.float64]:
        """(t, n, 3): origins of the bodies' frames, world."""
        return np.array(self._positions)

    @property
    def rotations(self) -> NDArray[np.float64]:
        """(t, n, 4): unit quaternions w, x, y, z."""
        return np.array(self._rotations)

    def to_frame(self) -> pandas.DataFrame:
        """One row for each time and body (pandas): time, body, x, y, z, qw, qx, qy, qz."""
        names = [body.name for body in self._bodies]
        return poses_frame(names, self.times, self.positions, self.rotations)

    def to_gltf(self, path: str | os.PathLike[str]) -> None:
        """Writes an animation in binary glTF, with an arrow for each contact. Planes are left out."""
        self._drawn().write_gltf(os.fspath(path))

    def to_html(self, path: str | os.PathLike[str], title: str = "world") -> None:
        """Writes a page that plays the motion in any browser: that of `otg simulate --html`."""
        from .world import Plane

        recording = self._drawn()
        for body in self._bodies:
            for shape, _ in body.shapes:
                if isinstance(shape, Plane):
                    normal = np.asarray(shape.normal, float)
                    recording.add_plane((normal / np.linalg.norm(normal)).tolist(), float(shape.offset))
        recording.set_steps(self._dt, self._every, np.array(self._steps, float).reshape(-1, 3))
        recording.write_html(os.fspath(path), title)

    def _drawn(self) -> _core.Recording:
        return drawn(body_surfaces(self._bodies), self.times, self.positions, self.rotations, self._arrows)

    def __len__(self) -> int:
        return len(self._times)
