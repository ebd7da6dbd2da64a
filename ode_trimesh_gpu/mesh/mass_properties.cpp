// SPDX-License-Identifier: BSD-3-Clause
// Volume integrals of 1, x, x^2 and x y over the signed tetrahedra between a reference point and each triangle.
#include "mesh/mass_properties.h"

#include <cmath>

#include "base/bounds.h"
#include "base/vectors.h"

namespace otg {

MassProperties computeMassProperties(std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  const Bounds bounds = boundsOf(vertices, triangles);
  const Vec3d middle = bounds.middle();
  // For the tetrahedron (0, a, b, c) of signed volume d / 6 and s = a + b + c:
  //   integral of x      = d / 24 s
  //   integral of x x^T  = d / 120 (s s^T + a a^T + b b^T + c c^T)
  double volume6 = 0, area2 = 0;
  Vec3d first24{0, 0, 0}, areaFirst6{0, 0, 0}, squares120{0, 0, 0}, products120{0, 0, 0};
  const auto mulAdd = [](Vec3d& sum, double factor, const Vec3d& v) { sum = sum + v * factor; };
  for (const Triangle& triangle : triangles) {
    const Vec3d a = relativeTo(vertices[triangle.v[0]], middle);
    const Vec3d b = relativeTo(vertices[triangle.v[1]], middle);
    const Vec3d c = relativeTo(vertices[triangle.v[2]], middle);
    const Vec3d s = a + b + c;
    const Vec3d n = otgCross(b - a, c - a);
    const double d = otgDot(a, otgCross(b, c));
    const double triangleArea2 = norm(n);
    volume6 += d;
    area2 += triangleArea2;
    mulAdd(first24, d, s);
    mulAdd(areaFirst6, triangleArea2, s);
    mulAdd(squares120, d,
           {s.x * s.x + a.x * a.x + b.x * b.x + c.x * c.x, s.y * s.y + a.y * a.y + b.y * b.y + c.y * c.y,
            s.z * s.z + a.z * a.z + b.z * b.z + c.z * c.z});
    mulAdd(products120, d,
           {s.y * s.z + a.y * a.z + b.y * b.z + c.y * c.z, s.z * s.x + a.z * a.x + b.z * b.x + c.z * c.x,
            s.x * s.y + a.x * a.y + b.x * b.y + c.x * c.y});
  }

  MassProperties mass;
  mass.volume = volume6 / 6;
  mass.area = area2 / 2;
  // What is left of terms that cancel is no volume to divide by: a shell's balance point is then that of its area.
  const Vec3d corner = bounds.empty() ? Vec3d{0, 0, 0} : relativeTo(bounds.max, middle);
  const auto toEigen = [](const Vec3d& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
  Eigen::Vector3d local = Eigen::Vector3d::Zero();
  if (std::abs(mass.volume) > 1e-14 * mass.area * norm(corner))
    local = toEigen(first24) / 24 / mass.volume;
  else if (mass.area > 0)
    local = toEigen(areaFirst6) / 6 / mass.area;
  mass.centerOfMass = toEigen(middle) + local;
  Eigen::Matrix3d second;
  second << squares120.x, products120.z, products120.y,  //
      products120.z, squares120.y, products120.x,        //
      products120.y, products120.x, squares120.z;
  second = (second / 120 - mass.volume * local * local.transpose()).eval();
  mass.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return mass;
}

}  // namespace otg
