// SPDX-License-Identifier: BSD-3-Clause
// What of a mesh is near a convex shape: the triangles that may be in it, and those in its way out.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "base/vectors.h"
#include "bvh/wide_search.h"
#include "collide/query.h"
#include "collide/surface/placed_body.h"
#include "mesh/convex_geometry.h"

namespace otg {

/// How far single precision moves the mesh's vertices.
double vertexRounding(const TriMesh& mesh);

class NearSurface {
 public:
  static constexpr std::size_t kMostTriangles = 512;

  /// The mesh is query.a. Both have to outlive this. A way out that is longer than `longestWay` is none. `looksAhead`:
  /// nor is one into a triangle.
  NearSurface(const Query& query, const ConvexGeometry& shape, bool looksAhead, double longestWay);

  /// Looks for the triangles. False if there are more than kMostTriangles.
  bool collect();

  const Query& query() const { return query_; }
  const ConvexGeometry& shape() const { return shape_; }
  const TriMesh& mesh() const { return mesh_; }
  const PlacedBody& placed() const { return placed_; }
  /// Triangles near the shape's box whose planes cut the shape; ascending, so that nothing depends on the tree.
  std::span<const std::uint32_t> touched() const { return {touched_.data(), count_}; }
  /// A point well inside the shape, in the mesh's frame.
  const Vec3d& inside() const { return inside_; }
  /// Of a depth: less is a touch to rounding.
  double leastDepth() const { return leastDepth_; }
  /// How far single precision moves the mesh's vertices.
  double rounding() const { return rounding_; }
  Vec3d corner(std::uint32_t triangle, std::size_t k) const {
    const Vec3f& v = mesh_.vertices()[mesh_.triangles()[triangle].v[k]];
    return {v.x, v.y, v.z};
  }

  /// Whether the shape, moved by `way` (frame of the mesh), is in no triangle that it was in front of. What is in its
  /// way is in the box around it and the moved one. mayMeet(triangle) is asked where the moved shape is near a triangle
  /// and cuts its plane: whether that is no hindrance.
  template <class MayMeet>
  bool isFree(const Vec3d& way, const MayMeet& mayMeet) const;

 private:
  /// What is around the shape while it moves along a way: a box, and a ball where that is smaller.
  class Around {
   public:
    Around(const NearSurface& near, const Vec3d& way);
    unsigned operator()(const WideNode& node) const;
    /// Whether the triangle is beside the box. The tree knows the boxes of triangles alone.
    bool isBeside(std::uint32_t triangle) const;

   private:
    const NearSurface& near_;
    Vec3d low_, high_;  ///< of the box, in the shape's frame
    BoxQuery box_;
    BallQuery ball_;
    bool isRound_;
  };
  /// Of the shape, moved by `way`, and a triangle's plane.
  bool isInFrontOf(std::uint32_t triangle, const Vec3d& way, double slack, Vec3d& rear) const;
  bool isBehind(std::uint32_t triangle) const;
  bool isTouched(std::uint32_t triangle) const {
    return std::binary_search(touched_.data(), touched_.data() + count_, triangle);
  }
  bool add(std::uint32_t triangle);
  const Query& query_;
  const ConvexGeometry& shape_;
  const TriMesh& mesh_;
  const PlacedBody placed_;
  Vec3d inside_;
  Vec3d rear_;  ///< of the shape along some normal, or inside_
  double leastDepth_, rounding_, longestWay_;
  bool looksAhead_;
  std::array<std::uint32_t, kMostTriangles> touched_;
  std::size_t count_ = 0;
};

template <class MayMeet>
bool NearSurface::isFree(const Vec3d& way, const MayMeet& mayMeet) const {
  if (norm(way) > longestWay_) return false;
  if (!looksAhead_) return true;
  Vec3d rear = rear_;
  const Around around(*this, way);
  return searchWide(query_.a->wide(), around, [&](std::uint32_t t) {
    return mesh_.isDegenerate(t) || isInFrontOf(t, way, 0, rear) || around.isBeside(t) || isBehind(t) ||
           (!isTouched(t) && isInFrontOf(t, way, rounding_, rear)) || mayMeet(t);
  });
}

}  // namespace otg
