// SPDX-License-Identifier: BSD-3-Clause
// The ground's surface for points near it: the nearest place, and which way is out there. In the ground's frame.
#pragma once

#include <cstdint>

#include "bvh/collision_mesh.h"
#include "collide/shell/ground_sides.h"

namespace otg {

/// A place of the ground, nearest to some point.
struct GroundPlace {
  Vec3d point{};
  double distance = 0;
  std::uint32_t triangle = kNone;
  int part = 0;  ///< OTG_PART_*
};

/// A point beside the ground.
struct GroundDepth {
  GroundPlace place;
  bool isBehind = false;
  /// The nearest place is a rim, and the way there leads past the surface and not through it.
  bool isBeside = false;
  Vec3d out{};        ///< unit, in front of the place
  double height = 0;  ///< of the point over the place, along `out`
  Vec3d way{};        ///< unit: where to move a point that is behind
};

class GroundSurface {
 public:
  GroundSurface(const CollisionMesh& ground, GroundSides& sides, double slack)
      : ground_(ground), mesh_(ground.mesh()), adjacency_(ground.adjacency()), sides_(sides), slack_(slack) {}

  /// The nearest place at most `limit` away, of equally near triangles the smallest number. `hint`: a triangle that
  /// may be near, or kNone. False if there is none.
  bool nearest(const Vec3d& point, double limit, std::uint32_t hint, GroundPlace& place) const;
  /// nearest(), and where the point lies as seen from there.
  bool measure(const Vec3d& point, double limit, std::uint32_t hint, GroundDepth& depth) const;

  /// Unit normal of a triangle, to its front.
  Vec3d front(std::uint32_t triangle) const {
    return otgScale(adjacency_.normal[triangle], sides_.of(triangle) < 0 ? -1.0 : 1.0);
  }
  void corners(std::uint32_t triangle, Vec3d out[3]) const;
  const TriMesh& mesh() const { return mesh_; }
  double slack() const { return slack_; }

 private:
  std::uint32_t guess(const Vec3d& point) const;
  void look(const Vec3d& point, GroundDepth& depth) const;
  /// Calls visit(front normal, weight) for the triangles around the place.
  template <class Visit>
  void around(const GroundPlace& place, const Visit& visit) const;

  const CollisionMesh& ground_;
  const TriMesh& mesh_;
  const Adjacency& adjacency_;
  GroundSides& sides_;
  const double slack_;  ///< lengths below it are none
};

}  // namespace otg
