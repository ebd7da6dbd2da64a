// SPDX-License-Identifier: BSD-3-Clause
// What of a mesh is near a convex shape: the triangles that may be in it, and those beside it.
#pragma once

#include <array>
#include <span>

#include "base/vectors.h"
#include "collide/query.h"
#include "collide/surface/placed_body.h"
#include "mesh/convex_geometry.h"

namespace otg {

class NearSurface {
 public:
  static constexpr std::size_t kMostTriangles = 512;

  /// The mesh is query.a. Both have to outlive this. `looksAhead`: what is around the shape, to 5 % of its radius, may
  /// be in its way, and there is no way that is longer.
  NearSurface(const Query& query, const ConvexGeometry& shape, bool looksAhead);

  /// Looks for the triangles. False if there are more than kMostTriangles of either kind.
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
  bool looksAhead() const { return ahead_ > 0; }
  Vec3d corner(std::uint32_t triangle, std::size_t k) const {
    const Vec3f& v = mesh_.vertices()[mesh_.triangles()[triangle].v[k]];
    return {v.x, v.y, v.z};
  }

  /// Whether the shape, moved by `way` (frame of the mesh), comes into none of the triangles that it is in front of.
  bool isFree(const Vec3d& way) const;

 private:
  struct Beside {
    Vec3d normal;
    double offset;
  };
  bool isBesideBox(std::uint32_t triangle) const;
  bool add(std::uint32_t triangle);

  const Query& query_;
  const ConvexGeometry& shape_;
  const TriMesh& mesh_;
  const PlacedBody placed_;
  Transformd frame_;  ///< of the shape's box
  Vec3d half_;        ///< of that box
  Vec3d inside_;
  Vec3d rear_;  ///< of the shape along some normal, or inside_
  double leastDepth_, rounding_, ahead_;
  std::array<std::uint32_t, kMostTriangles> touched_;
  std::array<Beside, kMostTriangles> beside_;
  std::size_t count_ = 0, besideCount_ = 0;
};

}  // namespace otg
