// SPDX-License-Identifier: BSD-3-Clause
#include "collide/convex_cone.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace otg {
namespace {

/// Relative length below which a slope or a coefficient is taken for rounding.
constexpr double kRoundingSlope = 1e-12;
/// Rays whose part outside the span of the others is smaller than this are dependent on them.
constexpr double kDependent = 1e-9;
constexpr int kMaxSteps = 200;
constexpr std::uint32_t kNoRay = std::numeric_limits<std::uint32_t>::max();

}  // namespace

template <int kDimension>
void ConvexCone<kDimension>::add(const Vector& ray) {
  rays_.push_back(ray);
  enabled_.push_back(1);
}

template <int kDimension>
auto ConvexCone<kDimension>::project(const Vector& vector, double enough, const Projection& start) const -> Projection {
  using Columns = Eigen::Matrix<double, kDimension, Eigen::Dynamic, 0, kDimension, kDimension>;
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kDimension, 1>;
  Projection best = start;
  const auto residualOf = [&](const Projection& p) {
    Vector r = vector;
    for (int k = 0; k < p.count; ++k) {
      r -= p.coefficients[static_cast<std::size_t>(k)] * rays_[p.rays[static_cast<std::size_t>(k)]];
    }
    return r;
  };
  best.residual = residualOf(best);
  const double length = vector.norm();
  for (int step = 0; step < kMaxSteps && best.distance() > enough; ++step) {
    // The ray along which the distance falls fastest. Active rays have slope 0 (the residual is normal to them).
    std::uint32_t steepest = kNoRay;
    double slope = kRoundingSlope * length;
    for (std::uint32_t i = 0; i < size(); ++i) {
      const double s = rays_[i].dot(best.residual);
      if (s > slope && enabled_[i]) {
        slope = s;
        steepest = i;
      }
    }
    const auto active = best.rays.begin(), end = active + best.count;
    if (steepest == kNoRay || best.count == kDimension || std::find(active, end, steepest) != end) break;

    Projection next = best;
    next.rays[static_cast<std::size_t>(next.count)] = steepest;
    next.coefficients[static_cast<std::size_t>(next.count)] = 0;
    ++next.count;
    // Walk from the feasible coefficients towards the unconstrained optimum on the active rays; a ray whose coefficient
    // reaches zero on the way leaves, and the optimum is recomputed without it.
    while (next.count > 0) {
      Columns columns(kDimension, next.count);
      for (int k = 0; k < next.count; ++k) columns.col(k) = rays_[next.rays[static_cast<std::size_t>(k)]];
      Eigen::ColPivHouseholderQR<Columns> qr(columns);
      qr.setThreshold(kDependent);
      // Least squares without the sign; a dependent ray gets 0.
      const Coefficients optimum = qr.solve(vector);
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

template class ConvexCone<6>;
template class ConvexCone<7>;

}  // namespace otg
