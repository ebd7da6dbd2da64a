// SPDX-License-Identifier: BSD-3-Clause
#include "collide/surface/cylinder_points.h"

namespace otg {

PlacedCylinder placedCylinder(const Transformd& pose, const ConvexGeometry& body) {
  return {pose.t, unit(otgRotate(pose, Vec3d{0, 0, 1})), body.radius, body.length};
}

CylinderRim::CylinderRim(const Transformd& pose, const Vec3d& at, double radius)
    : centre(at), u(otgRotate(pose, Vec3d{radius, 0, 0})), v(otgRotate(pose, Vec3d{0, radius, 0})) {}

Vec3d CylinderRim::point(std::uint32_t k) const {
  constexpr double kHalf = 0.7071067811865476;
  constexpr double kCosine[kPoints] = {1, kHalf, 0, -kHalf, -1, -kHalf, 0, kHalf};
  return centre + u * kCosine[k] + v * kCosine[(k + 6) % kPoints];
}

}  // namespace otg
