// SPDX-License-Identifier: BSD-3-Clause
#include "truth/contact_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vectors.h"

namespace otg::truth {

std::vector<PlainContact> plain(std::span<const Contact> contacts) {
  std::vector<PlainContact> all;
  for (const Contact& c : contacts) all.push_back({c.position, c.normal, c.depth});
  return all;
}

Wrench wrenchOf(std::span<const PlainContact> contacts, const Vec3d& about) {
  Wrench sum;
  for (const PlainContact& c : contacts) {
    const Vec3d f = c.normal * c.depth;
    sum.force = sum.force + f;
    sum.moment = sum.moment + otgCross(c.position - about, f);
  }
  return sum;
}

double angleBetween(const Vec3d& a, const Vec3d& b) {
  const Vec3d c = otgCross(a, b);
  const double sine = norm(c), cosine = otgDot(a, b);
  if (!(otgDot(a, a) > 0) || !(otgDot(b, b) > 0)) return 180;
  return std::atan2(sine, cosine) * 180 / std::numbers::pi;
}

double armError(const Wrench& a, const Wrench& b) {
  const double fa = std::sqrt(otgDot(a.force, a.force)), fb = std::sqrt(otgDot(b.force, b.force));
  const Vec3d armA = fa > 0 ? a.moment * (1 / fa) : Vec3d{0, 0, 0};
  const Vec3d armB = fb > 0 ? b.moment * (1 / fb) : Vec3d{0, 0, 0};
  const Vec3d d = armA - armB;
  return norm(d);
}

double Errors::quantile(double part) const {
  if (values_.empty()) return 0;
  std::vector<double> sorted = values_;
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::ceil(part * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace otg::truth
