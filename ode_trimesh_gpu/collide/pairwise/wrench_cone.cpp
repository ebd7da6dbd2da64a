// SPDX-License-Identifier: BSD-3-Clause
// Projection on the convex cone of a set of wrenches.
#include "collide/pairwise/wrench_cone.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "collide/contact_order.h"

namespace otg {
namespace {

Eigen::Vector3d toEigen(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

/// Relative length below which a slope or a coefficient is taken for rounding.
constexpr double kRoundingSlope = 1e-12;
/// Rays whose part outside the span of the others is smaller than this are dependent on them.
constexpr double kDependent = 1e-9;
constexpr int kMaxSteps = 200;

/// The unconstrained least-squares coefficients on the active rays; a dependent ray gets 0.
using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;
using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

}  // namespace

WrenchFrame::WrenchFrame(std::span<const Contact> contacts) {
  if (contacts.empty()) return;
  // Floating sums depend on their order, and the result must not depend on the order of the contacts: sum by ascending
  // value of each coordinate, relative to the bounds' lower end so that a far-away origin costs no digits.
  std::vector<double> values(contacts.size());
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

void WrenchCone::add(const Wrench& ray) {
  rays_.push_back(ray);
  enabled_.push_back(1);
}

ConeProjection WrenchCone::project(const Wrench& wrench, double enough, const ConeProjection& start) const {
  ConeProjection best = start;
  const auto residualOf = [&](const ConeProjection& p) {
    Wrench r = wrench;
    for (int k = 0; k < p.count; ++k) {
      r -= p.coefficients[static_cast<std::size_t>(k)] * rays_[p.rays[static_cast<std::size_t>(k)]];
    }
    return r;
  };
  best.residual = residualOf(best);
  const double length = wrench.norm();
  for (int step = 0; step < kMaxSteps && best.distance() > enough; ++step) {
    // The ray along which the distance falls fastest. Active rays have slope 0 (the residual is normal to them).
    std::uint32_t steepest = kNone;
    double slope = kRoundingSlope * length;
    for (std::uint32_t i = 0; i < size(); ++i) {
      const double s = rays_[i].dot(best.residual);
      if (s > slope && enabled_[i]) {
        slope = s;
        steepest = i;
      }
    }
    const auto activeEnd = best.rays.begin() + best.count;
    if (steepest == kNone || best.count == 6 || std::find(best.rays.begin(), activeEnd, steepest) != activeEnd) break;

    ConeProjection next = best;
    next.rays[static_cast<std::size_t>(next.count)] = steepest;
    next.coefficients[static_cast<std::size_t>(next.count)] = 0;
    ++next.count;
    // Walk from the feasible coefficients towards the unconstrained optimum on the active rays; a ray whose coefficient
    // reaches zero on the way leaves, and the optimum is recomputed without it.
    while (next.count > 0) {
      Columns columns(6, next.count);
      for (int k = 0; k < next.count; ++k) columns.col(k) = rays_[next.rays[static_cast<std::size_t>(k)]];
      Eigen::ColPivHouseholderQR<Columns> qr(columns);
      qr.setThreshold(kDependent);
      const Coefficients optimum = qr.solve(wrench);
      double fraction = 1;
      int first = -1;
      for (int k = 0; k < next.count; ++k) {
        const double x = next.coefficients[static_cast<std::size_t>(k)];
        if (optimum[k] > 0) continue;
        const double f = x > 0 ? x / (x - optimum[k]) : 0;
        if (first < 0 || f < fraction) {
          fraction = f;
          first = k;
        }
      }
      for (int k = 0; k < next.count; ++k) {
        double& x = next.coefficients[static_cast<std::size_t>(k)];
        x = std::max(0.0, x + fraction * (optimum[k] - x));
      }
      if (first < 0) break;
      for (int k = first; k + 1 < next.count; ++k) {
        next.rays[static_cast<std::size_t>(k)] = next.rays[static_cast<std::size_t>(k) + 1];
        next.coefficients[static_cast<std::size_t>(k)] = next.coefficients[static_cast<std::size_t>(k) + 1];
      }
      --next.count;
    }
    next.residual = residualOf(next);
    // In exact arithmetic every step shortens the residual; when rounding has eaten that, `best` is as good as it gets.
    if (!(next.residual.squaredNorm() < best.residual.squaredNorm())) break;
    best = next;
  }
  return best;
}

}  // namespace otg
