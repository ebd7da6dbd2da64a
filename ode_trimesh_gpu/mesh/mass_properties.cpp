// SPDX-License-Identifier: BSD-3-Clause
// Volume integrals of 1, x, x^2 and x y over the signed tetrahedra between a reference point and each triangle.
#include "mesh/mass_properties.h"

#include <Eigen/Geometry>
#include <cmath>

#include "mesh/bounds.h"

namespace otg {

MassProperties computeMassProperties(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  const Bounds bounds = boundsOf(vertices, triangles);
  const Vec3d middle = bounds.middle();
  const Eigen::Vector3d reference(middle.x, middle.y, middle.z);
  const auto point = [&](std::uint32_t v) {
    const Vec3d p = relativeTo(vertices[v], middle);
    return Eigen::Vector3d(p.x, p.y, p.z);
  };

  // For the tetrahedron (0, a, b, c) of signed volume d / 6 and s = a + b + c:
  //   integral of x      = d / 24 s
  //   integral of x x^T  = d / 120 (s s^T + a a^T + b b^T + c c^T)
  double volume6 = 0, area = 0;
  Eigen::Vector3d first24 = Eigen::Vector3d::Zero(), areaFirst3 = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second120 = Eigen::Matrix3d::Zero();
  for (const Triangle& triangle : triangles) {
    const Eigen::Vector3d a = point(triangle.v[0]), b = point(triangle.v[1]), c = point(triangle.v[2]);
    const double d = a.dot(b.cross(c));
    const Eigen::Vector3d s = a + b + c;
    volume6 += d;
    first24 += d * s;
    second120.noalias() += d * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
    const double triangleArea = 0.5 * (b - a).cross(c - a).norm();
    area += triangleArea;
    areaFirst3 += triangleArea * s;
  }

  MassProperties mass;
  mass.volume = volume6 / 6;
  mass.area = area;
  // What is left of terms that cancel is no volume to divide by: a shell's balance point is then that of its area.
  const double extent =
      bounds.empty() ? 0 : (Eigen::Vector3d(bounds.max.x, bounds.max.y, bounds.max.z) - reference).norm();
  Eigen::Vector3d local = Eigen::Vector3d::Zero();
  if (std::abs(mass.volume) > 1e-14 * area * extent)
    local = first24 / 24 / mass.volume;
  else if (area > 0)
    local = areaFirst3 / 3 / area;
  mass.centerOfMass = reference + local;
  const Eigen::Matrix3d second = second120 / 120 - mass.volume * local * local.transpose();
  mass.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return mass;
}

}  // namespace otg
