// SPDX-License-Identifier: BSD-3-Clause
// Pairs of bodies in random overlaps whose right contacts are known.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bvh/collision_mesh.h"
#include "truth/separation.h"

namespace otg::truth {

/// The same numbers on every machine.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  double sign() { return engine_() < 0x80000000u ? -1 : 1; }
  int below(int n) { return static_cast<int>((std::uint64_t{engine_()} * static_cast<std::uint64_t>(n)) >> 32); }
  Vec3d direction();
  Transformd rotation();  ///< uniform, without a move

 private:
  std::mt19937 engine_;
};

struct Placement {
  Transformd bInA{};
  /// The direction by formula for the smooth bodies, the depth that of the meshes along it; none where there is no
  /// formula.
  std::optional<Separation> truth;
};

struct ContactFamily {
  std::string name, what;
  std::shared_ptr<const CollisionMesh> a, b;
  double size = 1;  ///< overlaps are given in this unit, a radius or half a side of the smaller body
  /// A pose whose overlap is about `overlap` times `size`.
  std::function<Placement(Random&, double overlap)> place;
};

/// All with a formula, then tori at random.
std::vector<ContactFamily> contactFamilies();
/// How far A must go along `direction` until the triangles of the two no longer meet. By steps of a hundredth of the
/// family's size, and bisection with the exact intersection test. The first gap counts.
double wayOut(const ContactFamily& family, const Transformd& pose, const Vec3d& direction);
/// Two copies of a mesh at random; no formula.
ContactFamily meshFamily(const std::string& name, const std::shared_ptr<const TriMesh>& mesh);

}  // namespace otg::truth
