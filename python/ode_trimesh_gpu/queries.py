# SPDX-License-Identifier: BSD-3-Clause
"""Questions about placed meshes, without a world.

A pose places a mesh in the world: a 4x4 matrix, or a rotation (3x3) and a translation (3); None is the identity. Where
many are allowed, an array (n, 4, 4), or rotations (n, 3, 3) and translations (n, 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import PoseLike, blocks, points, poses, single_pose
from .contacts import ContactBatch, Contacts, concatenate
from .errors import ArgumentError
from .mesh import Mesh
from .options import Options

_MOST_PLACES = 65535
_DEFAULTS = Options()

MeshOrMeshes = Mesh | Sequence[Mesh]


class PairMemory:
    """What pairs of meshes remember from query to query, so that deep bodies leave as they came.

    Give the same object to `collide` or `collide_many` in each step, with the same meshes in the same order. It
    pickles; what it remembers is taken up again when it is used next.
    """

    def __init__(self) -> None:
        self._geoms: _core.Geoms | None = None
        self._key: tuple[Any, ...] = ()
        self._saved: bytes | None = None
        self._count = 0

    def forget(self) -> None:
        """Forgets everything, the meshes as well."""
        self.__init__()  # type: ignore[misc]

    def _open(self, meshes: list[Mesh], options: Options) -> _core.Geoms:
        key = (tuple(id(mesh) for mesh in meshes), options)
        if self._geoms is None:
            if self._saved is not None and self._count != len(meshes):
                raise ArgumentError(f"this memory is about {self._count} meshes, not {len(meshes)}")
            geoms = _core.Geoms([mesh._core for mesh in meshes], options._params())
            if self._saved is not None:
                geoms.load_history(self._saved)
            self._geoms, self._key, self._saved, self._count = geoms, key, None, len(meshes)
            self._meshes = meshes  # keeps their ids
        elif key != self._key:
            raise ArgumentError("a PairMemory takes the same meshes and options every time; forget() starts anew")
        return self._geoms

    def __getstate__(self) -> dict[str, Any]:
        saved = self._saved if self._geoms is None else self._geoms.save_history()
        return {"history": saved, "count": self._count}

    def __setstate__(self, state: dict[str, Any]) -> None:
        PairMemory.__init__(self)
        self._saved, self._count = state["history"], state["count"]


class _Side:
    """One side of many pairs: a single placed mesh, or one for each pair."""

    def __init__(self, mesh: MeshOrMeshes, pose: PoseLike) -> None:
        self.meshes = [mesh] if isinstance(mesh, Mesh) else list(mesh)
        for element in self.meshes:
            if not isinstance(element, Mesh):
                raise ArgumentError(f"a Mesh is needed here, not {type(element).__name__}")
        self.poses = poses(pose)
        counts = [] if isinstance(mesh, Mesh) else [len(self.meshes)]
        if self.poses.ndim == 3:
            counts.append(len(self.poses))
        self.count = None if not counts else counts[0]
        if len(set(counts)) > 1:
            raise ArgumentError(f"there are {counts[0]} meshes, but {counts[1]} poses")

    def cut(self, begin: int, end: int) -> tuple[list[Mesh], NDArray[np.float64]]:
        if self.count is None:
            return self.meshes, self.poses.reshape(1, 4, 4)
        meshes = self.meshes[begin:end] if len(self.meshes) > 1 else self.meshes * (end - begin)
        if self.poses.ndim == 3:
            return meshes, self.poses[begin:end]
        return meshes, np.broadcast_to(self.poses, (end - begin, 4, 4))


class _Many:
    """Pairs of two sides, in blocks."""

    def __init__(self, a: MeshOrMeshes, b: MeshOrMeshes, pose_a: PoseLike, pose_b: PoseLike) -> None:
        self.sides = _Side(a, pose_a), _Side(b, pose_b)
        counts = {side.count for side in self.sides if side.count is not None}
        if len(counts) > 1:
            raise ArgumentError(f"the two sides have {self.sides[0].count} and {self.sides[1].count} elements")
        self.is_single = not counts
        self.count = counts.pop() if counts else 1

    def cut(self, begin: int, end: int) -> tuple[list[Mesh], NDArray[np.float64], NDArray[np.int32]]:
        (meshes_a, poses_a), (meshes_b, poses_b) = (side.cut(begin, end) for side in self.sides)
        pairs = np.zeros((end - begin, 2), np.int32)
        if len(meshes_a) > 1:
            pairs[:, 0] = np.arange(end - begin)
        pairs[:, 1] = len(meshes_a)
        if len(meshes_b) > 1:
            pairs[:, 1] += np.arange(end - begin, dtype=np.int32)
        return meshes_a + meshes_b, np.concatenate([poses_a, poses_b]), pairs

    def open(self, begin: int, end: int, options: Options) -> tuple[_core.Geoms, NDArray[np.int32]]:
        meshes, placed, pairs = self.cut(begin, end)
        geoms = _core.Geoms([mesh._core for mesh in meshes], options._params(history=False))
        geoms.place(placed)
        return geoms, pairs


def collide(
    a: Mesh,
    b: Mesh,
    pose_a: PoseLike = None,
    pose_b: PoseLike = None,
    *,
    options: Options = _DEFAULTS,
    memory: PairMemory | None = None,
) -> Contacts:
    """The contacts of two meshes. The same query has the same bytes, on any backend and in any thread.

    Normals point into `a`: moving `a` by depth * normal separates the two at the contact. Raises PoseError for a pose
    that is not rigid. Without a memory contacts depend on the poses alone.
    """
    return collide_many([a], [b], single_pose(pose_a), single_pose(pose_b), options=options, memory=memory)[0]


def collide_many(
    a: MeshOrMeshes,
    b: MeshOrMeshes,
    pose_a: PoseLike = None,
    pose_b: PoseLike = None,
    *,
    options: Options = _DEFAULTS,
    memory: PairMemory | None = None,
    progress: bool = False,
) -> ContactBatch:
    """The contacts of many pairs, by all threads and by the devices that `set_backend` has opened.

    Each side is one mesh or n of them, with one pose or n of them; one stands for all. Pair i is what `collide` gives
    for the i-th of each. Ctrl-C stops between blocks of pairs; `progress` shows a bar (tqdm).
    """
    many = _Many(a, b, pose_a, pose_b)
    parts: list[Contacts] = []
    first: list[NDArray[np.int64]] = [np.zeros(1, np.int64)]
    done = 0
    kept = kept_pairs = None
    if memory is not None:
        meshes, placed, kept_pairs = many.cut(0, many.count)
        kept = memory._open(meshes, options)
        kept.place(placed)
    for begin, end in blocks(many.count, 1024, progress, "pair"):
        if kept is not None and kept_pairs is not None:
            geoms, pairs = kept, kept_pairs[begin:end]
        else:
            geoms, pairs = many.open(begin, end, options)
        columns, starts = geoms.collide(pairs, min(options.max_contacts, _MOST_PLACES))
        parts.append(Contacts(*columns))
        first.append(starts[1:].astype(np.int64) + done)
        done += len(parts[-1])
    if not parts:
        columns, _ = _core.Geoms([], options._params()).collide(np.empty((0, 2), np.int32), 1)
        parts.append(Contacts(*columns))
    return ContactBatch(parts[0] if len(parts) == 1 else concatenate(parts), np.concatenate(first))


@dataclass(frozen=True)
class Distance:
    """How far two meshes are apart, and where. Of many pairs each field is an array with one more dimension."""

    distance: Any  #: 0 for meshes that overlap; infinite beyond the limit
    point_a: NDArray[np.float64]  #: (3,): the nearest point of `a`, world; NaN beyond the limit
    point_b: NDArray[np.float64]  #: (3,): the nearest point of `b`
    triangles: NDArray[np.int32]  #: (2,): their faces; -1 inside of a solid, and beyond the limit

    def __len__(self) -> int:
        return len(np.atleast_1d(self.distance))


def distance(
    a: MeshOrMeshes,
    b: MeshOrMeshes,
    pose_a: PoseLike = None,
    pose_b: PoseLike = None,
    *,
    limit: float = np.inf,
    options: Options = _DEFAULTS,
    progress: bool = False,
) -> Distance:
    """The distance of two meshes with the points that have it; sides as in `collide_many`.

    Nothing farther apart than `limit` is looked for, which is quicker.
    """
    many = _Many(a, b, pose_a, pose_b)
    results = []
    for begin, end in blocks(many.count, 1024, progress, "pair"):
        geoms, pairs = many.open(begin, end, options)
        results.append(geoms.distances(pairs, float(limit)))
    if not results:
        return Distance(np.empty(0), np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 2), np.int32))
    lengths, point_a, point_b, triangles = (np.concatenate(column) for column in zip(*results, strict=True))
    if many.is_single:
        return Distance(float(lengths[0]), point_a[0], point_b[0], triangles[0])
    return Distance(lengths, point_a, point_b, triangles)


def overlaps(
    a: MeshOrMeshes,
    b: MeshOrMeshes,
    pose_a: PoseLike = None,
    pose_b: PoseLike = None,
    *,
    options: Options = _DEFAULTS,
    progress: bool = False,
) -> Any:
    """Whether two meshes overlap: a bool, or an array of them; sides as in `collide_many`.

    They do if triangles have a point in common, exactly, or a part of one lies inside the other, if that is solid.
    """
    many = _Many(a, b, pose_a, pose_b)
    results = []
    for begin, end in blocks(many.count, 1024, progress, "pair"):
        geoms, pairs = many.open(begin, end, options)
        results.append(geoms.overlaps(pairs))
    if many.is_single:
        return bool(results[0][0])
    return np.concatenate(results) if results else np.empty(0, bool)


def _placed(mesh: Mesh, pose: PoseLike, options: Options) -> _core.Geoms:
    if not isinstance(mesh, Mesh):
        raise ArgumentError(f"a Mesh is needed here, not {type(mesh).__name__}")
    geoms = _core.Geoms([mesh._core], options._params())
    geoms.place(single_pose(pose).reshape(1, 4, 4))
    return geoms


@dataclass(frozen=True)
class ClosestPoints:
    """Nearest points of a surface, in the world."""

    points: NDArray[np.float64]  #: (n, 3)
    normals: NDArray[np.float64]  #: (n, 3): the surface's outward normal there
    distances: NDArray[np.float64]  #: (n,): negative inside of a solid and behind an open surface
    triangles: NDArray[np.int32]  #: (n,): faces; -1 for a mesh without triangles

    def __len__(self) -> int:
        return len(self.distances)


def closest_points(
    mesh: Mesh, at: ArrayLike, pose: PoseLike = None, *, options: Options = _DEFAULTS, progress: bool = False
) -> ClosestPoints:
    """The point of the surface nearest to each of `at` (n, 3), and the signed distance. All in the world."""
    geoms = _placed(mesh, pose, options)
    asked = points(at, "points")
    parts = [geoms.closest_points(0, asked[i:j]) for i, j in blocks(len(asked), 16384, progress, "point")]
    if not parts:
        parts = [geoms.closest_points(0, asked)]
    return ClosestPoints(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def inside(
    mesh: Mesh, at: ArrayLike, pose: PoseLike = None, *, options: Options = _DEFAULTS, progress: bool = False
) -> NDArray[np.bool_]:
    """(n,): which of the points `at` (n, 3) lie inside a solid mesh, or behind an open surface. All in the world."""
    geoms = _placed(mesh, pose, options)
    asked = points(at, "points")
    parts = [geoms.inside(0, asked[i:j]) for i, j in blocks(len(asked), 16384, progress, "point")]
    return np.concatenate(parts) if parts else np.empty(0, bool)


@dataclass(frozen=True)
class RayHits:
    """Where rays meet a mesh first, in the world."""

    positions: NDArray[np.float64]  #: (n, 3); NaN without a hit
    normals: NDArray[np.float64]  #: (n, 3): of the face, on the side from which the ray comes; NaN without a hit
    distances: NDArray[np.float64]  #: (n,): along the ray; infinite without a hit
    triangles: NDArray[np.int32]  #: (n,): faces; -1 without a hit
    back: NDArray[np.bool_]  #: (n,): the face was hit from behind

    @property
    def hit(self) -> NDArray[np.bool_]:
        """(n,): which rays hit."""
        return self.triangles >= 0

    def __len__(self) -> int:
        return len(self.distances)


def cast_rays(
    mesh: Mesh,
    starts: ArrayLike,
    directions: ArrayLike,
    lengths: ArrayLike = np.inf,
    pose: PoseLike = None,
    *,
    cull_back: bool = False,
    options: Options = _DEFAULTS,
    progress: bool = False,
) -> RayHits:
    """The first hit of each ray. Starts (n, 3) or (3,), directions (n, 3) or (3,) of any length, lengths (n,) or one.

    With `cull_back` faces hit from behind do not count. All in the world.
    """
    first, second = np.broadcast_arrays(np.atleast_2d(starts), np.atleast_2d(directions))
    begin_points, toward = points(first, "starts"), points(second, "directions")
    count = len(begin_points)
    far = np.ascontiguousarray(np.broadcast_to(np.asarray(lengths, np.float64), (count,)))
    geoms = _placed(mesh, pose, options)
    parts = [
        geoms.cast_rays(0, begin_points[i:j], toward[i:j], far[i:j], cull_back)
        for i, j in blocks(count, 16384, progress, "ray")
    ]
    if not parts:
        parts = [geoms.cast_rays(0, begin_points, toward, far, cull_back)]
    return RayHits(*(np.concatenate(column) for column in zip(*parts, strict=True)))
