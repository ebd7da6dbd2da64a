// SPDX-License-Identifier: BSD-3-Clause
#include "collide/contact_wrench.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace otg {
namespace {

Eigen::Vector3d toEigen(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

WrenchFrame::WrenchFrame(std::span<const Contact> contacts, std::pmr::memory_resource* memory) {
  if (contacts.empty()) return;
  // Floating sums depend on their order, and the result must not depend on the order of the contacts: sum by ascending
  // value of each coordinate, relative to the bounds' lower end so that a far-away origin costs no digits.
  std::pmr::vector<double> values(contacts.size(), memory);
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(contacts.begin(), contacts.end(), values.begin(),
                   [axis](const Contact& c) { return toEigen(c.position)[axis]; });
    std::sort(values.begin(), values.end());
    double sum = 0;
    for (const double v : values) sum += v - values.front();
    center_[axis] = values.front() + sum / static_cast<double>(values.size());
  }
  double radius = 0;
  for (const Contact& c : contacts) radius = std::max(radius, (toEigen(c.position) - center_).norm());
  // Positions that differ by rounding only are one point: their torques would be noise blown up to unit size.
  if (radius > 1e-14 * center_.norm()) inverseRadius_ = 1 / radius;
}

Wrench WrenchFrame::wrench(const Contact& contact) const {
  const Eigen::Vector3d n = toEigen(contact.normal);
  Wrench w;
  w << n, ((toEigen(contact.position) - center_) * inverseRadius_).cross(n);
  return w;
}

}  // namespace otg
