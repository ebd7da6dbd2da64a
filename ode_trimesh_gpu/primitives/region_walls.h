// SPDX-License-Identifier: BSD-3-Clause
// Inner corners: where a convex shape is in several walls of a mesh at once, each of them has to be left.
#pragma once

#include <vector>

#include "collide/solid/regions.h"
#include "primitives/convex_patch.h"

namespace otg {

/// The planes of mesh A's surface in a region that is not convex.
///
/// A contact is a point with one direction. A point of the shape that is behind two walls is as deep in one as in the
/// other, so that it needs a contact for each.
class RegionWalls {
 public:
  /// False where there are more planes than are worth a look.
  bool read(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region);

  /// Adds contacts for walls out of which those from `first` on do not take the shape. `closest`: two contacts of a
  /// wall are no nearer to each other.
  void complete(const PlacedShape& shape, double closest, std::vector<Contact>& contacts, std::size_t first) const;

 private:
  struct Wall {
    Vec3d normal;  ///< unit, outward
    double offset;
    std::uint32_t triangle;  ///< one of them
  };
  struct Hold {
    Vec3d point;  ///< of the shape, behind the wall
    double way;   ///< out of the wall along its normal
  };
  void collect(const PlacedShape& shape, const Wall& wall, std::vector<Hold>& out) const;
  bool isHeldBy(const Wall& wall, const Vec3d& point) const;

  const PlacedMeshes* meshes_ = nullptr;
  Vec3d origin_{};
  Vec3d low_{}, high_{};
  double rounding_ = 0, far_ = 0;
  std::vector<Wall> walls_;
  std::vector<Vec3d> points_;  ///< of the region
};

/// What is left of contacts of which there is room for `most`: of each direction the deepest, then the deepest of all.
void keepEachDirection(std::vector<Contact>& contacts, std::size_t first, std::size_t most);

}  // namespace otg
