// SPDX-License-Identifier: BSD-3-Clause
// Hosts with inner corners, and movers that are pushed into them by known depths.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/generated_meshes.h"
#include "truth/contact_families.h"
#include "truth/pair_oracle.h"

namespace otg::truth {

/// How far bodies are pushed into each other. Depths are drawn in the mover's least side, by the power of ten. Of the
/// pairs that come out those are kept whose overlap is from `least` to `most` of the smaller body.
struct OverlapRange {
  double leastPower, mostPower;
  double least, most;
};
inline constexpr OverlapRange kShallowOverlaps{-6, -2, 1e-7, 1e-2};
/// What a body that moves by a fifth of its size in a step may come to.
inline constexpr OverlapRange kDeepOverlaps{-2, -0.7, 1e-3, 0.3};

/// The host is where normal . p <= offset, near the corner.
struct Wall {
  Vec3d normal;
  double offset;
};
/// The mover's origin is anywhere between along the axis.
struct FreeAxis {
  Vec3d axis;
  double low, high;
};
/// One to three walls that meet, and free axes: three together.
struct Nest {
  std::vector<Wall> walls;
  std::vector<FreeAxis> free;
  Transformd base;                  ///< turns a mover so that its faces lie along the walls
  Vec3d leastSides{0.2, 0.2, 0.2};  ///< full side lengths of movers, before that turn
  Vec3d mostSides{0.45, 0.45, 0.45};
};
struct Host {
  scenes::MeshArrays mesh;
  std::vector<Nest> nests;
};

Host profileL(Random& random);
Host profileU(Random& random);
Host profileT(Random& random);
Host room(Random& random);
Host tray(Random& random);
Host slot(Random& random);
Host steps(Random& random);
Host wedgeSlot(Random& random);
Host vBlock(Random& random);
Host bin(Random& random);

/// How a mover is turned: as the nest has it, by 1e-5 to 1e-2 radians off that, or anyhow.
enum class Settling { kAligned, kSettled, kFree };
Settling drawSettling(Random& random);
const char* nameOf(Settling settling);
Transformd settled(Random& random, Settling settling, const Transformd& base);

enum class MoverKind { kBox, kCylinder, kPrism, kTetrahedron, kL, kSphere, kCapsule };
/// A mesh, or with `shape` one of ODE's shapes with a mesh near to it: box, cylinder, sphere, capsule as they are,
/// prism and tetrahedron as dConvex.
PairBody makeMover(Random& random, MoverKind kind, bool shape, const Vec3d& sides);

struct Pressed {
  double depth;  ///< the deepest wall's
  int walls;     ///< how many walls
};
/// Turns and moves the mover so that it is in one to all of the nest's walls.
Pressed press(Random& random, const Nest& nest, Settling settling, const OverlapRange& overlaps, PairBody& mover);

Transformd turnAbout(const Vec3d& unitAxis, double angle);
Transformd product(const Transformd& outer, const Transformd& inner);

}  // namespace otg::truth
