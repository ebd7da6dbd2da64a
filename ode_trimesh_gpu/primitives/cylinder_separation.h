// SPDX-License-Identifier: BSD-3-Clause
// The least overlap of a convex polyhedron and a round cylinder.
#pragma once

#include <array>
#include <limits>
#include <span>

#include "base/vectors.h"
#include "collide/surface/cylinder_points.h"
#include "mesh/convex_polyhedron.h"

namespace otg {

/// The direction of the least overlap, out of the polyhedron; ConvexPair says what the overlap along a direction is.
struct CylinderAxis {
  /// What decides it: a face of the polyhedron, an end of the cylinder, an edge with the cylinder's side or rim, or a
  /// corner with the side. kOther: no feature that was tried is as good.
  enum class Of : std::uint8_t { kNone, kFace, kEnd, kEdge, kCorner, kOther };
  Of of = Of::kNone;  ///< kNone: apart, or nothing found yet
  Vec3d m{0, 0, 0};
  double overlap = std::numeric_limits<double>::infinity();
  std::uint32_t feature = kNone;  ///< the face; of an edge its ConvexPolyhedron::corner; the vertex
};

/// Looks for the least overlap. All directions that some vertices of the polyhedron can have are tried exactly: those
/// of its faces, of the arcs between these, and the nearest point of the round side. A growing polytope says which
/// vertices, and bounds what others can give. Takes no memory.
class CylinderSeparation {
 public:
  CylinderSeparation(const ConvexPolyhedron& body, const PlacedCylinder& cylinder, double size);

  /// `toB`: from the middle of the polyhedron to that of the cylinder.
  CylinderAxis find(const Vec3d& toB);
  /// Whether the normal of a face is sure to be the result of find() -> `axis`. False says nothing.
  bool isStillLeast(std::uint32_t face, CylinderAxis& axis) const;
  /// After find(): its direction, or one along which the two are apart.
  const Vec3d& last() const { return apart_ ? apartAlong_ : best_.m; }
  double overlapAlong(const Vec3d& m) const { return otgDot(m, difference(m).at); }

  // For the polytope.
  struct Difference {
    Vec3d at;
    std::uint32_t vertex;
  };
  Difference difference(const Vec3d& m) const {
    const std::uint32_t vertex = body_.support(m);
    return {body_.vertices()[vertex] - cylinder_.rear(m), vertex};
  }
  bool look(const Vec3d& m, const Difference& difference);
  bool isEnough(double overlap, double distance, double rounding) const;

 private:
  using Of = CylinderAxis::Of;
  void descend(Vec3d m);
  bool visit(std::uint32_t vertex);
  void tryCorner(std::uint32_t corner);
  void tryVertex(std::uint32_t vertex);
  void separate(const Vec3d& m);
  void offer(Of of, const Vec3d& m, double overlap, std::uint32_t feature);
  bool isSure(const CylinderAxis& axis) const;
  double overlapOfFace(std::uint32_t face) const;

  const ConvexPolyhedron& body_;
  const PlacedCylinder& cylinder_;
  const double size_;
  CylinderAxis best_;
  bool apart_ = false;
  Vec3d apartAlong_{0, 0, 0};
  static constexpr std::size_t kMostVisited = 64;
  std::array<std::uint32_t, kMostVisited> visited_;
  std::size_t visitedCount_ = 0;
};

}  // namespace otg
