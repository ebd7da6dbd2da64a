// SPDX-License-Identifier: BSD-3-Clause
// Meshes made by formula, shared by tests, demos and benchmarks: closed, oriented outward, without data from outside.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "scenes/mesh_arrays.h"

namespace otg::scenes {

/// Axis-aligned box of full side lengths `size`, centred at the origin, each side divided into n x n x 2 triangles.
MeshArrays makeBox(Vec3d size, int n = 1);
/// Icosahedron subdivided `level` times and projected on the sphere: 20 * 4^level triangles.
MeshArrays makeSphere(double radius, int level);
/// Torus around the z axis, 2 * major * minor triangles.
MeshArrays makeTorus(double majorRadius, double minorRadius, int majorSegments, int minorSegments);
/// Closed cylinder along z, centred.
MeshArrays makeCylinder(double radius, double height, int segments, int stacks = 1);
/// Closed capsule along z, centred: a cylinder of the given length with a half ball at either end, in `rings` rings of
/// latitude each. Its vertices lie on the capsule.
MeshArrays makeCapsule(double radius, double length, int segments, int rings);
/// Regular tetrahedron-like solid with the given corners (orientation corrected).
MeshArrays makeTetrahedron(Vec3d a, Vec3d b, Vec3d c, Vec3d d);
/// Hemispherical bowl of the given wall thickness, opening towards +z: a closed solid.
MeshArrays makeBowl(double radius, double thickness, int segments, int rings);
/// Spur gear along z, centred, with a tooth along +x: trapezoidal teeth that take 48% of the pitch circle, so that
/// equal gears mesh with some play. Without a bore if boreRadius is 0.
MeshArrays makeGear(int teeth, double pitchRadius, double toothDepth, double width, double boreRadius);
/// A lump: a sphere whose radius is modulated by smooth bumps of relative height `amplitude`, fixed by `seed`.
MeshArrays makeLump(double radius, int level, double amplitude, std::uint32_t seed);
/// Flat or hilly closed slab from z = -thickness up to height(x, y), n x n cells on top.
MeshArrays makeGround(double size, double thickness, int n, const std::function<double(double, double)>& height = {});
/// The surface of cubes of side 1 in a grid of n x n x n places, from the origin. `isFull(x, y, z)` says which there
/// are. Each corner has one vertex: where two cubes touch along an edge alone, the edge has four triangles.
MeshArrays makeCubes(int n, const std::function<bool(int, int, int)>& isFull);
/// Square block with a square hole through it along z (for pegs).
MeshArrays makeBlockWithHole(Vec3d size, double hole);
/// Hexagonal bolt and matching nut, right-handed; `segments` per turn, a multiple of 6 for sharp hexagons. The bolt's
/// thread runs along z from 0 to `length` with the crests at `radius`, its head lies below; the nut lies between z = 0
/// and `length`. It is farther from the axis than the thread by `clearance` everywhere, wherever it is put by a
/// multiple of the pitch. The thread has the ISO metric profile: 60 degrees, 5/8 of the sharp height.
MeshArrays makeBolt(double radius, double pitch, double length, int segments);
MeshArrays makeNut(double radius, double pitch, double length, double clearance, int segments);

}  // namespace otg::scenes
