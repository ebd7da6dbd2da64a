// SPDX-License-Identifier: BSD-3-Clause
// A convex shape as the planes of its faces: what of triangles and edges is in it, and how far below them it reaches.
#pragma once

#include <array>
#include <cstdint>

#include "base/vectors.h"
#include "primitives/convex_shape.h"

namespace otg {

/// All geometry is in the shape's frame. A cylinder is a prism around it where areas and directions are needed; what is
/// in it and depths are those of the round one. Not for capsules. Keeps scratch: one thread at a time.
class ShapePlanes {
 public:
  static constexpr std::size_t kMostPlanes = 256;
  using Corners = std::array<Vec3d, 3>;

  explicit ShapePlanes(const ConvexShape& shape);
  /// There are more planes than kMostPlanes: nothing else may be called.
  bool areMany() const { return count_ > kMostPlanes; }

  /// Radius of the ball about a point in the shape that touches its nearest plane.
  double roomAround(const Vec3d& inside) const;

  /// Twice the vector area of the part of a triangle that is in the shape: cuts it by one face after the other
  /// (I. Sutherland, G. Hodgman 1974).
  Vec3d areaInside(const Corners& corners);

  /// A part of a segment: from + t along, low <= t <= high.
  struct Stretch {
    Vec3d from, along;
    double low, high;
    Vec3d at(double t) const { return from + along * t; }
  };
  /// Cuts the segment down to what is in the shape (M. Cyrus, J. Beck 1978). False if that is nothing.
  bool cut(Stretch& stretch) const;

  /// How far the shape reaches against `out` (unit) from a point in it or above it; negative where it is neither.
  double depthBelow(const Vec3d& at, const Vec3d& out) const { return depthAlong(at, {0, 0, 0}, out).value; }

  /// Where that is most along a segment. The stretch is what of it is in the shape. Exact for flat shapes; of a
  /// cylinder, only if the prism is deeper than `enough` there.
  double deepest(const Stretch& stretch, const Vec3d& out, double enough) const;

 private:
  struct Depth {
    double value, slope;
  };
  /// depthBelow(), and how it changes along a direction.
  Depth depthAlong(const Vec3d& at, const Vec3d& along, const Vec3d& out) const;

  const ConvexShape& shape_;
  std::size_t count_ = 0;
  std::array<Vec3d, kMostPlanes> normals_;
  std::array<double, kMostPlanes> offsets_;
  std::array<Vec3d, kMostPlanes + 3> polygon_, next_;
  std::size_t facing_ = 0;  ///< a plane that had a triangle in front of it
};

}  // namespace otg
