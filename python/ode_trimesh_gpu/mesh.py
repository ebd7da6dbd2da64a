# SPDX-License-Identifier: BSD-3-Clause
"""Triangle meshes."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .errors import ArgumentError, MeshError


@dataclass(frozen=True)
class Problem:
    """One kind of problem of a mesh."""

    kind: str  #: such as "boundary_edge"
    count: int  #: how many elements have it
    elements: tuple[int, ...]  #: the first of them: numbers of triangles, vertices or parts
    message: str  #: one sentence with the numbers in it


@dataclass(frozen=True)
class MeshReport:
    """What validation found. Edges are counted on vertices welded by position."""

    valid: bool  #: nothing is wrong but unused vertices
    vertices: int
    triangles: int
    edges: int
    components: int
    closed: bool  #: every edge is used exactly twice
    manifold: bool
    oriented: bool  #: neighbours are wound the same way
    outward: bool  #: closed parts face outward
    solid: bool  #: has an inside: closed, oriented, outward
    degenerate_triangles: int
    duplicate_triangles: int
    boundary_edges: int
    non_manifold_edges: int
    non_manifold_vertices: int
    inconsistent_edges: int
    welded_vertices: int  #: by repair, as the next three
    dropped_degenerate: int
    dropped_duplicates: int
    flipped_triangles: int
    volume: float  #: cubic units, signed
    area: float  #: square units
    problems: tuple[Problem, ...]

    def __str__(self) -> str:
        head = f"{self.triangles} triangles, {self.vertices} vertices, {'solid' if self.solid else 'no solid'}"
        return "\n".join([head, *(f"- {problem.message}" for problem in self.problems)])


@dataclass(frozen=True)
class MassProperties:
    """Of a body of uniform density, in the mesh's frame."""

    mass: float
    center_of_mass: NDArray[np.float64]  #: (3,)
    inertia: NDArray[np.float64]  #: (3, 3), about the centre of mass


def _faces(faces: ArrayLike, vertex_count: int) -> NDArray[np.uint32]:
    array = np.asarray(faces)
    if array.size == 0:
        return np.empty((0, 3), np.uint32)
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"faces must have the shape (m, 3), not {array.shape}")
    if not np.issubdtype(array.dtype, np.integer):
        raise MeshError(f"faces must be integers, not {array.dtype}")
    if array.min() < 0 or array.max() >= vertex_count:
        bad = int(np.argmax(((array < 0) | (array >= vertex_count)).any(axis=1)))
        raise MeshError(f"face {bad} is {array[bad].tolist()}, but there are {vertex_count} vertices")
    return np.ascontiguousarray(array, dtype=np.uint32)


def _vertices(vertices: ArrayLike) -> NDArray[Any]:
    array = np.asarray(vertices)
    if array.size == 0:
        array = np.empty((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"vertices must have the shape (n, 3), not {array.shape}")
    return np.ascontiguousarray(array, dtype=np.float32 if array.dtype == np.float32 else np.float64)


def _read(path: str) -> tuple[NDArray[Any], NDArray[Any]]:
    if not os.path.exists(path):
        raise FileNotFoundError(f"{path}: no such file")
    if os.path.splitext(path)[1].lower() not in (".ply", ".off", ".stl", ".obj", ".otg"):
        try:
            import trimesh
        except ImportError:
            pass  # the reader says which formats there are
        else:
            loaded: Any = trimesh.load(path, force="mesh")
            return np.asarray(loaded.vertices), np.asarray(loaded.faces)
    return _core.read_mesh_file(path)


class Mesh:
    """A triangle mesh with its bounding volume hierarchy (BVH). Lengths are in the unit of your world.

    Mesh(vertices, faces): vertices (n, 3), float32 or float64, rounded to float32 once; faces (m, 3), integers,
    counter-clockwise seen from outside. The arrays are copied and need not be contiguous.

    Mesh(path): a file. PLY, OFF, STL, OBJ and cooked meshes are read as they are written; other formats need trimesh.

    Mesh(mesh): an object with `vertices` and `faces`, such as a trimesh.Trimesh.

    With `repair` equal positions are welded, degenerate and duplicate triangles dropped, and the winding is made
    consistent and outward. That changes the numbers of vertices and faces.

    Raises MeshError for what cannot be worked with. Open or badly wound meshes are accepted: see `report`.
    """

    def __init__(self, mesh: Any, faces: ArrayLike | None = None, *, repair: bool = False) -> None:
        vertices: Any
        if faces is not None:
            vertices = mesh
        elif isinstance(mesh, (str, os.PathLike)):
            vertices, faces = _read(os.fspath(mesh))
        elif hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
            vertices, faces = mesh.vertices, mesh.faces
        else:
            raise ArgumentError("a mesh is made of vertices and faces, of a file's path, or of a mesh of trimesh")
        v = _vertices(vertices)
        f = _faces(faces, len(v))
        self._core = _core.Mesh.build(v, f, repair)
        self._repairs: dict[str, int] = {}
        if repair:
            # The compiled mesh has numbers of its own now: take over its triangles and build again with ours.
            counts: dict[str, Any] = self._core.report()
            self._repairs = {
                key: int(counts[key])
                for key in ("welded_vertices", "dropped_degenerate", "dropped_duplicates", "flipped_triangles")
            }
            corners = self._core.corners()
            v, numbers = np.unique(corners, axis=0, return_inverse=True)
            f = np.ascontiguousarray(numbers.reshape(-1, 3), dtype=np.uint32)
            self._core = _core.Mesh.build(v, f, False)
        self._set_arrays(v, f)

    def _set_arrays(self, vertices: NDArray[Any], faces: NDArray[np.uint32]) -> None:
        self._vertices = vertices.astype(np.float32)
        self._faces = faces.astype(np.int32)
        self._vertices.flags.writeable = False
        self._faces.flags.writeable = False

    @property
    def vertices(self) -> NDArray[np.float32]:
        """(n, 3), in the mesh's frame. Read only: see `update`."""
        return self._vertices

    @property
    def faces(self) -> NDArray[np.int32]:
        """(m, 3): numbers of vertices, counter-clockwise seen from outside. Read only."""
        return self._faces

    @property
    def triangles(self) -> NDArray[np.float32]:
        """(m, 3, 3): the corners of each triangle, in the mesh's frame."""
        return self._vertices[self._faces]

    @property
    def report(self) -> MeshReport:
        """What validation found."""
        problems = tuple(Problem(kind, n, tuple(e), text) for kind, n, e, text in self._core.problems())
        columns: dict[str, Any] = {**self._core.report(), **self._repairs}
        return MeshReport(**columns, problems=problems)

    @property
    def is_solid(self) -> bool:
        """Whether the mesh has an inside: closed, consistently wound, facing outward."""
        return bool(self._core.report()["solid"])

    @property
    def volume(self) -> float:
        """Cubic units. Signed: negative if wound inward. Of an open mesh a sum without meaning."""
        return self.report.volume

    @property
    def area(self) -> float:
        """Square units."""
        return self.report.area

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3): the corners of the box around the triangles, in the mesh's frame."""
        if len(self._faces) == 0:
            raise MeshError("a mesh without triangles has no bounds")
        used = self._vertices[np.unique(self._faces)].astype(np.float64)
        return np.array([used.min(axis=0), used.max(axis=0)])

    def mass_properties(self, density: float = 1.0) -> MassProperties:
        """Mass, centre of mass and inertia, exact for the polyhedron. MeshError if the volume is not positive."""
        if not density > 0 or not np.isfinite(density):
            raise ArgumentError("the density must be positive")
        volume, center, about_origin = self._core.mass()
        shifted = about_origin - volume * (np.dot(center, center) * np.eye(3) - np.outer(center, center))
        return MassProperties(density * volume, center, density * shifted)

    @property
    def center_of_mass(self) -> NDArray[np.float64]:
        """(3,): of a body of uniform density, in the mesh's frame."""
        return self.mass_properties().center_of_mass

    @property
    def inertia(self) -> NDArray[np.float64]:
        """(3, 3): about the centre of mass, along the mesh's axes, for the density 1."""
        return self.mass_properties().inertia

    def update(self, vertices: ArrayLike) -> None:
        """Moves the vertices, (n, 3), and refits the BVH: much faster than a new mesh. The faces stay."""
        v = _vertices(vertices)
        if len(v) != len(self._vertices):
            raise MeshError(f"there are {len(self._vertices)} vertices, not {len(v)}")
        if not (np.abs(v) <= np.finfo(np.float32).max).all():
            raise MeshError("vertices must be finite in single precision")
        self._core.update(v)
        self._vertices = v.astype(np.float32)
        self._vertices.flags.writeable = False

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a cooked mesh: vertices, faces, BVH. `Mesh(path)` and `otg` read it."""
        with open(path, "wb") as file:
            file.write(self._core.cook())

    def show(self, **kwargs: Any) -> Any:
        """Draws the mesh with PyVista; see `show`."""
        from .view import show

        return show(self, **kwargs)

    def __len__(self) -> int:
        return len(self._faces)

    def __repr__(self) -> str:
        return f"<Mesh: {len(self._faces)} triangles, {len(self._vertices)} vertices>"

    def __getstate__(self) -> dict[str, Any]:
        return {"vertices": self._vertices, "faces": self._faces, "repairs": self._repairs, "cooked": self._core.cook()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._core = _core.Mesh()
        self._core.uncook(state["cooked"])
        self._repairs = state["repairs"]
        self._set_arrays(state["vertices"], state["faces"])
