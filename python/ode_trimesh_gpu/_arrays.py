# SPDX-License-Identifier: BSD-3-Clause
"""Arguments as arrays that the compiled part takes."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ArgumentError, PoseError

#: One pose: a 4x4 matrix, or a rotation (3x3) and a translation (3); None is the identity.
PoseLike = Any


def points(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """An (n, 3) array of doubles."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ArgumentError(f"{name} must have the shape (n, 3), not {array.shape}")
    return array


def vector(values: ArrayLike, name: str) -> tuple[float, float, float]:
    """Three finite numbers."""
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ArgumentError(f"{name} must be three finite numbers")
    return float(array[0]), float(array[1]), float(array[2])


def _is_pair(pose: Any) -> bool:
    if not isinstance(pose, (tuple, list)) or len(pose) != 2:
        return False
    return np.shape(pose[0])[-2:] == (3, 3) and np.shape(pose[1])[-1:] == (3,)


def poses(pose: PoseLike) -> NDArray[np.float64]:
    """Matrices of the shape (4, 4) or (n, 4, 4)."""
    if pose is None:
        return np.eye(4)
    if _is_pair(pose):
        rotation, translation = (np.asarray(part, dtype=np.float64) for part in pose)
        shape = np.broadcast_shapes(rotation.shape[:-2], translation.shape[:-1])
        matrix = np.zeros((*shape, 4, 4))
        matrix[..., :3, :3] = rotation
        matrix[..., :3, 3] = translation
        matrix[..., 3, 3] = 1
    else:
        try:
            matrix = np.ascontiguousarray(pose, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise PoseError("a pose must be a 4x4 matrix, or a rotation (3x3) and a translation (3)") from error
    if matrix.shape[-2:] != (4, 4) or matrix.ndim not in (2, 3):
        raise PoseError(
            f"a pose must be a 4x4 matrix, or a rotation (3x3) and a translation (3); this has the shape {matrix.shape}"
        )
    return matrix


def single_pose(pose: PoseLike) -> NDArray[np.float64]:
    """One matrix of the shape (4, 4)."""
    matrix = poses(pose)
    if matrix.ndim != 2:
        raise PoseError("here a single pose is needed")
    return matrix


def quaternions(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit quaternions w, x, y, z of the shape (n, 4) from matrices of the shape (n, 3, 3)."""
    r = rotations
    # Of four ways the one with the largest divisor, after Shepperd (1978).
    trace = np.trace(r, axis1=1, axis2=2)
    squares = np.stack([trace, r[:, 0, 0], r[:, 1, 1], r[:, 2, 2]], axis=1)
    result = np.empty((len(r), 4))
    for row, best in enumerate(np.argmax(squares, axis=1)):
        m = r[row]
        if best == 0:
            q = np.array([1 + trace[row], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
        else:
            i = best - 1
            j, k = (i + 1) % 3, (i + 2) % 3
            q = np.empty(4)
            q[0] = m[k, j] - m[j, k]
            q[1 + i] = 1 + m[i, i] - m[j, j] - m[k, k]
            q[1 + j] = m[j, i] + m[i, j]
            q[1 + k] = m[k, i] + m[i, k]
        result[row] = q / np.linalg.norm(q)
    return result


def blocks(count: int, size: int, progress: bool, unit: str) -> Iterator[tuple[int, int]]:
    """Ranges that together are all of `count`, with a bar by tqdm if asked for.

    Ctrl-C is noticed between two of them. The first has `size` elements; the others are sized by the time taken.
    """
    bar = None
    if progress:
        from tqdm.auto import tqdm

        bar = tqdm(total=count, unit=unit)
    try:
        begin = 0
        while begin < count:
            end = min(begin + size, count)
            start = time.perf_counter()
            yield begin, end
            taken = time.perf_counter() - start
            if taken < 0.1:
                size *= 2
            elif taken > 0.4:
                size = max(1, size // 2)
            if bar is not None:
                bar.update(end - begin)
            begin = end
    finally:
        if bar is not None:
            bar.close()
