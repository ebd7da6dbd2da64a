// SPDX-License-Identifier: BSD-3-Clause
// A convex body in the frame of the mesh that it meets.
#pragma once

#include <cmath>

#include "base/vectors.h"
#include "mesh/convex_geometry.h"

namespace otg {

/// Faces whose normals have this cosine or more lie in one plane: 0.1 degrees. Their edge is none.
inline constexpr double kFlatEdge = 0.9999985;

/// A convex body in mesh A's frame, seen from a near origin.
class PlacedBody {
 public:
  /// A cylinder lies on its side up to this sine of its axis' slope, and stands on its end from this cosine on; in
  /// between it stands on a point of its rim.
  static constexpr double kOnSide = 0.2, kOnEnd = 0.98;
  PlacedBody(const ConvexGeometry& body, const Transformd& pose, const Vec3d& origin)
      : body_(&body), pose_(pose), origin_(origin) {}
  const ConvexGeometry& body() const { return *body_; }
  Vec3d direction(const Vec3d& local) const { return otgRotate(pose_, local); }
  Vec3d toLocal(const Vec3d& p) const { return otgRotateBack(pose_, p + origin_ - pose_.t); }
  Vec3d fromLocal(const Vec3d& p) const { return otgTransform(pose_, p) - origin_; }
  Vec3d directionToLocal(const Vec3d& d) const { return otgRotateBack(pose_, d); }
  /// Its point that is last to leave when it moves along d, and how far that is along d.
  Vec3d rear(const Vec3d& d) const { return fromLocal(body_->support(directionToLocal(d) * -1.0)); }
  double rearAlong(const Vec3d& d) const { return otgDot(d, rear(d)); }
  /// Of a curved shape that moves along d: to a point the nearest of those that are about as late.
  class Rear {
   public:
    Rear(const PlacedBody& body, const Vec3d& d);
    Vec3d near(const Vec3d& p) const;

   private:
    const PlacedBody& body_;
    Vec3d back_;  ///< against d, in the body's frame
    double slope_, across_;
  };
  Vec3d rearNear(const Vec3d& d, const Vec3d& p) const { return Rear(*this, d).near(p); }
  /// Whether a curved shape leaves with one point of a rim last.
  bool standsOnPoint(const Vec3d& d) const {
    const double slope = std::fabs(directionToLocal(d).z);
    return body_->kind == ConvexGeometry::Kind::kCylinder && slope >= kOnSide && slope <= kOnEnd;
  }
  double exitDistance(const Vec3d& p, const Vec3d& d) const {
    return body_->exitDistance(toLocal(p), directionToLocal(d));
  }

 private:
  const ConvexGeometry* body_;
  Transformd pose_;
  Vec3d origin_;
};

}  // namespace otg
