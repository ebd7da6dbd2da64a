# SPDX-License-Identifier: BSD-3-Clause
"""Scene files (docs/scene_format.md), stepped as `otg simulate` does."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import blocks
from .errors import ArgumentError
from .recording import COLORS, Surface, drawn, poses_frame

if TYPE_CHECKING:
    import pandas


class Run:
    """What happened in a scene. Made by `simulate`."""

    def __init__(self, scene: _core.Scene, dt: float, every: int) -> None:
        self._scene = scene
        self._every = every
        self.dt = dt  #: seconds
        self.names = [name for name, _, _ in scene.bodies()]
        self._times: list[float] = []
        self._positions: list[NDArray[np.float64]] = []
        self._rotations: list[NDArray[np.float64]] = []
        self._arrows: list[NDArray[np.float64]] = []

    def _add(self, time: float) -> None:
        positions, rotations, *_ = self._scene.states()
        self._times.append(time)
        self._positions.append(positions)
        self._rotations.append(rotations)
        self._arrows.append(self._scene.arrows())

    @property
    def times(self) -> NDArray[np.float64]:
        """(t,): seconds at which poses were kept, 0 first."""
        return np.array(self._times)

    @property
    def positions(self) -> NDArray[np.float64]:
        """(t, n, 3): origins of the shapes' frames, world, metres."""
        return np.array(self._positions)

    @property
    def rotations(self) -> NDArray[np.float64]:
        """(t, n, 4): unit quaternions w, x, y, z."""
        return np.array(self._rotations)

    @property
    def hash(self) -> str:
        """Over every body's pose and velocity after every step: that of `otg simulate`."""
        return f"{self._scene.hash:016x}"

    @property
    def steps(self) -> pandas.DataFrame:
        """One row for each step (pandas): contacts, times in ms, energies in J."""
        import pandas

        counts, values = self._scene.records()
        number = np.arange(1, len(counts) + 1)
        return pandas.DataFrame(
            {
                "step": number,
                "time": number * self.dt,
                "contacts": counts[:, 0],
                "contacts_before_reduction": counts[:, 1],
                "collide_ms": values[:, 0],
                "step_ms": values[:, 1],
                "kinetic_energy": values[:, 2],
                "potential_energy": values[:, 3],
                "intersecting_pairs": counts[:, 2],
            }
        )

    @property
    def bodies(self) -> pandas.DataFrame:
        """One row for each body at the end (pandas): pose of its shape's frame, velocities, centre of mass."""
        import pandas

        positions, rotations, linear, angular, centers = self._scene.states()
        columns: dict[str, Any] = {"name": self.names, "static": [static for _, static, _ in self._scene.bodies()]}
        for prefix, values, names in (
            ("", positions, "xyz"),
            ("q", rotations, "wxyz"),
            ("v", linear, "xyz"),
            ("w", angular, "xyz"),
            ("c", centers, "xyz"),
        ):
            columns.update({prefix + name: values[:, k] for k, name in enumerate(names)})
        return pandas.DataFrame(columns)

    @property
    def poses(self) -> pandas.DataFrame:
        """One row for each kept time and body (pandas): time, body, x, y, z, qw, qx, qy, qz."""
        return poses_frame(self.names, self.times, self.positions, self.rotations)

    def _surfaces(self) -> list[Surface]:
        surfaces = []
        for i, (name, static, color) in enumerate(self._scene.bodies()):
            vertices, faces = self._scene.surface(i)
            chosen = (color[0], color[1], color[2]) if color else COLORS[i % len(COLORS)]
            surfaces.append(Surface(name, vertices, faces.astype(np.int32), chosen, static))
        return surfaces

    def to_gltf(self, path: str | os.PathLike[str]) -> None:
        """Writes an animation in binary glTF, for Blender and web viewers, with an arrow for each contact."""
        self._drawn().write_gltf(os.fspath(path))

    def to_html(self, path: str | os.PathLike[str], title: str = "scene") -> None:
        """Writes a page that plays the run in any browser, as `otg simulate --html` does."""
        recording = self._drawn()
        for normal, offset in self._scene.planes():
            recording.add_plane(normal, offset)
        counts, values = self._scene.records()
        recording.set_steps(self.dt, self._every, np.hstack([counts[:, :1].astype(float), values[:, 2:4]]))
        recording.write_html(os.fspath(path), title)

    def _drawn(self) -> _core.Recording:
        return drawn(self._surfaces(), self.times, self.positions, self.rotations, self._arrows)

    def show(self, **kwargs: Any) -> Any:
        """Draws the end with PyVista; see `show`."""
        from .view import show

        return show(self, **kwargs)

    def __repr__(self) -> str:
        return f"<Run: {len(self.names)} bodies, hash {self.hash}>"


def _load(scene: Mapping[str, Any] | str | os.PathLike[str], folder: str | os.PathLike[str] | None) -> _core.Scene:
    if isinstance(scene, Mapping):
        try:
            text = json.dumps(dict(scene), default=_plain)
        except (TypeError, ValueError) as error:
            raise ArgumentError(f"the scene cannot be written as JSON: {error}") from error
        return _core.Scene.parse(text, "scene", os.fspath(folder or "."), True)
    path = os.fspath(scene)
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path}: no such file")
    return _core.Scene.load(path, True)


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} has no place in a scene")


def simulate(
    scene: Mapping[str, Any] | str | os.PathLike[str],
    steps: int | None = None,
    dt: float | None = None,
    *,
    folder: str | os.PathLike[str] | None = None,
    every: int | None = None,
    gltf: str | os.PathLike[str] | None = None,
    html: str | os.PathLike[str] | None = None,
    progress: bool = False,
    callback: Callable[[int, Run], Any] | None = None,
) -> Run:
    """Steps a scene: a JSON file, or the same as a dict, whose mesh files are looked for in `folder`.

    steps, dt: in place of the scene's. every: poses are kept of each so many steps, about 30 in a second of the scene's
    time. gltf, html: files for the animation, and for a page that plays it. callback(step, run): called where poses are
    kept. Ctrl-C stops between steps; `progress` shows a bar (tqdm).

    Results are those of `otg simulate`, byte for byte. Raises SceneError for a scene that is wrong: its message names
    the key.
    """
    loaded = _load(scene, folder)
    count = loaded.steps if steps is None else steps
    step = loaded.dt if dt is None else dt
    if count < 0 or not 0 < step <= 10:
        raise ArgumentError("steps must not be negative, and dt must be above 0 and at most 10 seconds")
    keep = every or max(1, round(1 / (30 * step)))
    run = Run(loaded, step, keep)
    run._add(0.0)
    for begin, end in blocks(count, 1, progress, "step"):
        done = begin
        while done < end:
            # Up to the next step whose poses are kept.
            target = min(end, (done // keep + 1) * keep)
            loaded.step(step, target - done)
            done = target
            if done % keep == 0:
                run._add(done * step)
                if callback is not None:
                    callback(done, run)
    if gltf is not None:
        run.to_gltf(gltf)
    if html is not None:
        run.to_html(html)
    return run
