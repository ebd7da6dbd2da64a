// SPDX-License-Identifier: BSD-3-Clause
// Which side of each triangle of the ground is its front.
#pragma once

#include <cstdint>
#include <vector>

#include "base/epoch_array.h"
#include "bvh/collision_mesh.h"

namespace otg {

/// How often the segment between two points crosses the ground, odd or even. Places where it crosses several triangles
/// at once count once. `skip`: what it crosses within this share of its length from `from` does not count.
bool crossesOddly(const CollisionMesh& ground, const Vec3d& from, const Vec3d& to, double skip,
                  std::vector<double>& scratch);

class GroundSides {
 public:
  /// Of a solid or a sheet all of it: `side` +1 for the winding's, -1 for the other one.
  void setWinding(int side) {
    isKnown_ = true;
    side_ = side;
    each_ = nullptr;
  }
  /// Of a ground that would be a solid but for a few faults: CollisionMesh::outwardSides().
  void setEach(const std::vector<std::int8_t>& sides) {
    isKnown_ = true;
    each_ = &sides;
  }
  /// Of any other ground: as seen from a point in front of it. Where an open one is in between, whose rim there is a
  /// way round, as seen from `middle`, that of the visitor.
  void setFront(const CollisionMesh& ground, const Vec3d& front, const Vec3d& middle, double slack);

  /// +1 if the triangle's normal leads to its front, else -1.
  int of(std::uint32_t triangle) {
    if (!isKnown_) return look(triangle);
    return each_ != nullptr ? (*each_)[triangle] : side_;
  }
  /// Whether a point lies behind, as seen from the front point.
  bool isBehind(const Vec3d& point) { return crossesOddly(*ground_, point, front_, 0, scratch_); }

 private:
  int look(std::uint32_t triangle);
  int sideOf(std::uint32_t triangle);

  bool isKnown_ = true;
  int side_ = 1;
  const std::vector<std::int8_t>* each_ = nullptr;
  const CollisionMesh* ground_ = nullptr;
  Vec3d front_{}, middle_{};
  double slack_ = 0;
  EpochArray known_;             ///< by triangle: 1 for +1, 0 for -1
  std::vector<double> scratch_;  ///< of crossesOddly()
};

}  // namespace otg
