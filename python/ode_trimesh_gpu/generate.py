# SPDX-License-Identifier: BSD-3-Clause
"""Meshes made by formula: closed and facing outward. The scene format has the same ones."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from . import _core
from ._arrays import vector
from .errors import ArgumentError
from .mesh import Mesh


def _mesh(arrays: tuple[Any, Any]) -> Mesh:
    mesh = Mesh(*arrays)
    if len(mesh) == 0 or not mesh.is_solid:
        raise ArgumentError("these sizes make no solid")
    return mesh


def _check(**values: float) -> None:
    for name, value in values.items():
        if not 0 < value < float("inf"):
            raise ArgumentError(f"{name} must be positive and finite, not {value}")


def _check_count(most: int = 4096, **values: int) -> None:
    for name, value in values.items():
        if not 1 <= value <= most:
            raise ArgumentError(f"{name} must be 1 to {most}, not {value}")


def box(size: ArrayLike, divisions: int = 1) -> Mesh:
    """An axis-aligned box with the sides `size` (3,), its middle at the origin; each side in divisions² squares."""
    sides = vector(size, "size")
    _check(x=sides[0], y=sides[1], z=sides[2])
    _check_count(512, divisions=divisions)
    return _mesh(_core.make_box(list(sides), divisions))


def sphere(radius: float, level: int = 3) -> Mesh:
    """An icosahedron divided `level` times, its vertices on the sphere: 20 * 4^level triangles."""
    _check(radius=radius)
    if not 0 <= level <= 8:
        raise ArgumentError(f"level must be 0 to 8, not {level}")
    return _mesh(_core.make_sphere(radius, level))


def torus(major_radius: float, minor_radius: float, major_segments: int = 48, minor_segments: int = 24) -> Mesh:
    """A torus around the z axis."""
    _check(major_radius=major_radius, minor_radius=minor_radius, hole=major_radius - minor_radius)
    _check_count(major_segments=major_segments, minor_segments=minor_segments)
    return _mesh(_core.make_torus(major_radius, minor_radius, major_segments, minor_segments))


def cylinder(radius: float, height: float, segments: int = 32, stacks: int = 1) -> Mesh:
    """A cylinder along z, its middle at the origin."""
    _check(radius=radius, height=height)
    _check_count(segments=segments, stacks=stacks)
    return _mesh(_core.make_cylinder(radius, height, segments, stacks))


def capsule(radius: float, length: float, segments: int = 32, rings: int = 8) -> Mesh:
    """A cylinder of the given length along z with half a ball at either end, its middle at the origin."""
    _check(radius=radius, length=length)
    _check_count(segments=segments, rings=rings)
    return _mesh(_core.make_capsule(radius, length, segments, rings))


def bowl(radius: float, thickness: float, segments: int = 48, rings: int = 12) -> Mesh:
    """Half a hollow ball that opens towards +z."""
    _check(radius=radius, thickness=thickness)
    _check_count(segments=segments, rings=rings)
    return _mesh(_core.make_bowl(radius, thickness, segments, rings))


def tray(size: ArrayLike, wall: float) -> Mesh:
    """A tray open above: inner sides `size` (3,), the middle of the inner floor at the origin."""
    sides = vector(size, "size")
    _check(x=sides[0], y=sides[1], z=sides[2], wall=wall)
    return _mesh(_core.make_tray(list(sides), wall))


def gear(teeth: int, pitch_radius: float, tooth_depth: float, width: float, bore_radius: float = 0) -> Mesh:
    """A spur gear along z, its middle at the origin, with a tooth along +x."""
    _check(pitch_radius=pitch_radius, tooth_depth=tooth_depth, width=width)
    _check_count(teeth=teeth)
    return _mesh(_core.make_gear(teeth, pitch_radius, tooth_depth, width, bore_radius))


def lump(radius: float, level: int = 4, amplitude: float = 0.3, seed: int = 1) -> Mesh:
    """A bumpy sphere; the same for the same seed."""
    _check(radius=radius)
    if not 0 <= level <= 8 or not 0 <= amplitude < 1:
        raise ArgumentError("level must be 0 to 8, and amplitude 0 to below 1")
    return _mesh(_core.make_lump(radius, level, amplitude, seed))


def bolt(radius: float, pitch: float, length: float, segments: int = 48) -> Mesh:
    """A bolt with an ISO metric thread along z from 0 to `length`, its head below; `segments` for one turn."""
    _check(radius=radius, pitch=pitch, length=length)
    _check_count(segments=segments)
    return _mesh(_core.make_bolt(radius, pitch, length, segments))


def nut(radius: float, pitch: float, length: float, clearance: float, segments: int = 48) -> Mesh:
    """The nut of such a bolt, between z = 0 and `length`."""
    _check(radius=radius, pitch=pitch, length=length)
    _check_count(segments=segments)
    return _mesh(_core.make_nut(radius, pitch, length, clearance, segments))
