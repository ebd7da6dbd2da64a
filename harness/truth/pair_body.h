// SPDX-License-Identifier: BSD-3-Clause
// The bodies of a pair, and the interface of what knows whether they overlap.
#pragma once

#include <optional>
#include <vector>

#include "scenes/generated_meshes.h"
#include "truth/convex_separation.h"

namespace otg::truth {

/// A body of a pair, in its own frame. A shape's mesh is the shape itself where that has flat faces, else near to it.
struct PairBody {
  scenes::MeshArrays mesh;
  std::optional<ConvexBody> shape;
  Transformd pose{};  ///< to the world
};

/// All translations are of A, along the world's axes.
class PairOracle {
 public:
  virtual ~PairOracle() = default;
  /// Whether the interiors meet; bodies that touch, or overlap by less than the grain, don't.
  virtual bool overlapped(const Vec3d& translation) = 0;
  /// Volume of the overlap; none where only formulas know the body, or where rounding hides it.
  virtual std::optional<double> volume(const Vec3d& translation) = 0;
  /// Directions in which faces near the overlap are left by A; unit, none twice.
  virtual std::vector<Vec3d> faceDirections() = 0;
};

/// The pose of b seen from a.
Transformd relativePose(const Transformd& a, const Transformd& b);

}  // namespace otg::truth
