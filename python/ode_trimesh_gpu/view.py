# SPDX-License-Identifier: BSD-3-Clause
"""Pictures by PyVista, which is installed with `ode_trimesh_gpu[view]`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import PoseLike, single_pose
from .contacts import ContactBatch, Contacts
from .errors import ArgumentError, Error
from .mesh import Mesh
from .recording import COLORS, body_surface
from .scene import Run
from .world import World

_Piece = tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.float64], tuple[float, float, float]]


def _matrix(position: NDArray[np.float64], q: NDArray[np.float64]) -> NDArray[np.float64]:
    w, x, y, z = q
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    pose[:3, 3] = position
    return pose


def _pieces(what: Any) -> list[_Piece]:
    if isinstance(what, World):
        poses = what.poses
        return [
            (*body_surface(body.shapes), poses[i], body.color or COLORS[i % len(COLORS)])
            for i, body in enumerate(what.bodies)
        ]
    if isinstance(what, Run):
        return [
            (s.vertices, s.faces, _matrix(what.positions[-1, i], what.rotations[-1, i]), s.color)
            for i, s in enumerate(what._surfaces())
        ]
    items: Sequence[Mesh | tuple[Mesh, PoseLike]] = [what] if isinstance(what, (Mesh, tuple)) else list(what)
    pieces: list[_Piece] = []
    for i, item in enumerate(items):
        mesh, pose = item if isinstance(item, tuple) else (item, None)
        if not isinstance(mesh, Mesh):
            raise ArgumentError("what is drawn is a World, a Run, a Mesh, or a list of meshes with their poses")
        pieces.append((mesh.vertices, mesh.faces, single_pose(pose), COLORS[(i + 1) % len(COLORS)]))
    return pieces


def show(
    what: World | Run | Mesh | Sequence[Mesh | tuple[Mesh, PoseLike]],
    contacts: Contacts | ContactBatch | None = None,
    *,
    arrows: float | None = None,
    opacity: float = 1.0,
    screenshot: str | os.PathLike[str] | None = None,
    plotter: Any = None,
    camera: Any = None,
    size: tuple[int, int] = (1024, 768),
) -> Any:
    """Draws meshes, a world or the end of a run, with an arrow for each contact, coloured by its depth.

    what: a World (with the contacts of its last step), a Run, a Mesh, or a list of meshes or (mesh, pose). arrows:
    their length; by the scene's size if None. screenshot: a PNG file, drawn without a window. plotter: a PyVista
    plotter to add to, which is returned without being shown. camera: as Plotter.camera_position takes it.

    Returns what PyVista's `show` returns, or the plotter.
    """
    try:
        import pyvista
    except ImportError as error:
        raise Error("show() needs PyVista: pip install ode_trimesh_gpu[view]") from error
    if contacts is None and isinstance(what, World):
        contacts = what.contacts
    if isinstance(contacts, ContactBatch):
        contacts = contacts.contacts
    scene = plotter or pyvista.Plotter(off_screen=screenshot is not None, window_size=list(size))
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for vertices, faces, pose, color in _pieces(what):
        if len(faces) == 0:
            continue
        placed = vertices @ pose[:3, :3].T + pose[:3, 3]
        low, high = np.minimum(low, placed.min(axis=0)), np.maximum(high, placed.max(axis=0))
        regular: Any = faces.astype(np.int64)
        surface = pyvista.PolyData.from_regular_faces(placed, regular)
        # Colours are linear here and sRGB there.
        shown = tuple(float(c) ** (1 / 2.2) for c in color)
        scene.add_mesh(surface, color=shown, opacity=opacity, smooth_shading=True, split_sharp_edges=True)
    if contacts is not None and len(contacts):
        length = arrows or 0.12 * float(np.linalg.norm(np.where(np.isfinite(high - low), high - low, 1.0)))
        cloud = pyvista.PolyData(contacts.positions)
        cloud["normals"] = contacts.normals
        cloud["depth"] = contacts.depths
        glyphs = cloud.glyph(orient="normals", scale=False, factor=length)
        scene.add_mesh(glyphs, scalars="depth", cmap="viridis", scalar_bar_args={"title": "penetration depth"})
    if camera is not None:
        scene.camera_position = camera
    if plotter is not None:
        return scene
    if screenshot is not None:
        return scene.show(screenshot=os.fspath(screenshot))
    return scene.show()
