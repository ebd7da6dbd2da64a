// SPDX-License-Identifier: BSD-3-Clause
// A convex shape as the planes of its faces: what of triangles and edges is in it, and how far below them it reaches.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "base/vectors.h"
#include "mesh/convex_geometry.h"

namespace otg {

/// All geometry is in the shape's frame. A cylinder is a prism around it where areas are needed; what is in it and
/// depths are those of the round one. Not for capsules. Keeps scratch: one thread at a time.
class ShapePlanes {
 public:
  static constexpr std::size_t kMostPlanes = 256;
  using Corners = std::array<Vec3d, 3>;

  explicit ShapePlanes(const ConvexGeometry& shape);
  /// There are more planes than kMostPlanes: nothing else may be called.
  bool areMany() const { return normals_.size() > kMostPlanes; }

  /// Radius of the ball about a point in the shape that touches its nearest plane.
  double roomAround(const Vec3d& inside) const;

  /// Twice the vector area of the part of a triangle that is in the shape: cuts it by one face after the other
  /// (I. Sutherland, G. Hodgman 1974).
  Vec3d areaInside(const Corners& corners);

  /// The corners of that part, after a call that did not return zero.
  std::span<const Vec3d> polygon() const { return {polygon_.data(), polygonCount_}; }

  /// The face where that part ends: kWithin if it is all of the triangle, kSeveral if it ends at more than one, or at
  /// a side of a cylinder.
  std::uint32_t faceOfPart() const;
  static constexpr std::uint32_t kWithin = 0xffffffff, kSeveral = 0xfffffffe;
  const Vec3d& normal(std::uint32_t face) const { return normals_[face]; }

  /// From now on cut() is quicker where few planes cut this box, which has all stretches.
  void lookAt(const Vec3d& low, const Vec3d& high);

  /// A part of a segment: from + t along, low <= t <= high.
  struct Stretch {
    Vec3d from, along;
    double low, high;
    Vec3d at(double t) const { return from + along * t; }
  };
  /// Cuts the segment down to what is in the shape (M. Cyrus, J. Beck 1978). False if that is nothing.
  bool cut(Stretch& stretch) const;

  /// From now on depths are measured against `out` (unit). That is quicker where few planes cut this box, in which
  /// points of the shape are, and where the lines from them leave it.
  void lookAlong(const Vec3d& out, const Vec3d& low, const Vec3d& high);

  /// How far the shape reaches against `out` from a point in it or above it; negative where it is neither.
  double depthBelow(const Vec3d& at) const { return depthAlong(at, {0, 0, 0}).value; }

  /// Where that is most along a segment. The stretch is what of it is in the shape. Exact for flat shapes; of a
  /// cylinder, only if it is deeper than `enough` there.
  double deepest(const Stretch& stretch, double enough) const;

 private:
  static constexpr std::size_t kSides = 24;  ///< of the prism around a cylinder
  struct Depth {
    double value, slope;
  };
  /// Some of the flat faces. With a direction those come first that face against it, then those that face along it.
  struct Planes {
    std::size_t count = 0, bottoms = 0, tops = 0;
    std::array<Vec3d, kMostPlanes> normals;
    std::array<double, kMostPlanes> offsets, speeds;  ///< speeds: -normal . out
  };
  bool cutsBox(std::size_t face) const;
  void setBox(const Vec3d& low, const Vec3d& high);
  bool isInBox(const Vec3d& p) const;
  bool hasAll() const { return near_.count == shape_.faceNormals.size(); }
  void gather(const Vec3d& out, bool isAll, Planes& planes) const;
  static void cutBy(const Vec3d& normal, double offset, Stretch& stretch);
  /// depthBelow(), and how it changes along a direction.
  Depth depthAlong(const Vec3d& at, const Vec3d& along) const;
  Depth depthBy(const Planes& planes, const Vec3d& at, const Vec3d& along) const;
  double deepestOfRound(const Stretch& stretch, double enough) const;
  /// Whether no side of a cylinder cuts the triangle.
  bool isWithinSides(const Corners& corners) const;

  const ConvexGeometry& shape_;
  std::span<const Vec3d> normals_;  ///< of all faces, and of the sides of the prism
  std::span<const double> offsets_;
  Vec3d low_{}, high_{};  ///< of the box
  Vec3d out_{};
  double slack_;            ///< rounding of distances to planes
  std::size_t facing_ = 0;  ///< a plane that had a triangle in front of it
  std::size_t polygonCount_ = 0, cutCount_ = 0;
  std::array<std::uint16_t, kMostPlanes> cuts_;  ///< planes that cut the last triangle
  Planes near_;                                  ///< those that cut the box
  std::array<Vec3d, kMostPlanes + 3> polygon_, next_;
  std::array<Vec3d, 2 + kSides> prismNormals_;
  std::array<double, 2 + kSides> prismOffsets_;
};

}  // namespace otg
