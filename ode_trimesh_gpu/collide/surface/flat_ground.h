// SPDX-License-Identifier: BSD-3-Clause
// Where all that a mesh shows around another one is one flat face without an end: a half space, to that one.
#pragma once

#include <array>
#include <cstdint>

#include "base/vectors.h"
#include "collide/query.h"
#include "mesh/convex_geometry.h"

namespace otg {

class FlatGround {
 public:
  /// Looks around the other mesh, and `ahead` farther. True if the ground is a plane there, to single precision of its
  /// coordinates, and has no rim. `toGround` takes the other mesh's frame to the ground's. Both meshes have to outlive
  /// what is found.
  bool find(const CollisionMesh& ground, const CollisionMesh& other, const Transformd& toGround, double ahead);

  /// The middle of the other mesh's box, in the ground's frame. It is above the plane.
  const Vec3d& above() const { return box_.t; }
  /// A box with that face as its top, larger than the other mesh. Returns its pose in the ground's frame. Does not
  /// allocate if `box` was one before.
  Transformd makeBox(ConvexGeometry& box) const;
  /// The triangle below a point in the ground's frame, or the nearest.
  std::uint32_t triangleBelow(const Vec3d& point) const;

 private:
  static constexpr std::size_t kMostTriangles = 256;
  bool add(std::uint32_t triangle);
  bool isRim(std::uint32_t triangle) const;
  bool isThere(double reach) const;
  /// How far a point is beyond a triangle's edges, seen along the normal.
  double beyond(std::uint32_t triangle, const Vec3d& point) const;
  bool covers(const Vec3d& point) const;
  bool isBeside(const Vec3d& p, const Vec3d& q, const Vec3d& r) const;
  Vec3d corner(std::uint32_t triangle, std::size_t k) const;

  const CollisionMesh* ground_ = nullptr;
  Transformd box_{};  ///< the other mesh's box in the ground's frame
  Vec3d half_{};
  Vec3d normal_{};
  double offset_ = 0, rounding_ = 0;
  double radius_ = 0;  ///< of the other mesh
  std::array<std::uint32_t, kMostTriangles> triangles_;
  std::size_t count_ = 0;
};

}  // namespace otg
