// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shortest_translation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

/// Part of a depth that is more than rounding.
constexpr double kWhole = 1 - 1e-6;
/// Sine of the angle below which two boundaries are parallel: where they meet is too far away to be a way out.
constexpr double kParallel = 1e-4;

}  // namespace

bool ShortestTranslation::satisfies(const Vec3d& normal, double depth) const {
  return otgDot(normal, t_) >= kWhole * depth;
}

bool ShortestTranslation::add(const Vec3d& normal, double depth) {
  const HalfSpace added{normal, depth};
  if (!satisfies(normal, depth) && !onBoundary(added, t_)) return false;
  all_.push_back(added);
  return true;
}

/// The shortest one on the boundary of a half-space that satisfies all before.
bool ShortestTranslation::onBoundary(const HalfSpace& touched, Vec3d& t) const {
  const Vec3d start = touched.normal * touched.depth;
  Vec3d x = start;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const HalfSpace& h = all_[i];
    if (otgDot(h.normal, x) >= kWhole * h.depth) continue;
    const double cosine = otgDot(touched.normal, h.normal);
    const Vec3d along = otgCross(touched.normal, h.normal);
    const double sine2 = otgDot(along, along);
    if (sine2 < kParallel * kParallel) return false;
    const Vec3d inPlane = (h.normal - touched.normal * cosine) * (1 / sine2);
    const Vec3d foot = start + inPlane * (h.depth - cosine * touched.depth);
    if (!onLine(foot, along * (1 / std::sqrt(sine2)), i, x)) return false;
  }
  t = x;
  return true;
}

/// The same on a line; `foot` is its place nearest to the origin, and the first `others` half-spaces count.
bool ShortestTranslation::onLine(const Vec3d& foot, const Vec3d& along, std::size_t others, Vec3d& t) const {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  double slack = 0;
  for (std::size_t i = 0; i < others; ++i) {
    const HalfSpace& h = all_[i];
    const double slope = otgDot(h.normal, along), missing = h.depth - otgDot(h.normal, foot);
    slack = std::max(slack, (1 - kWhole) * h.depth);
    if (std::fabs(slope) < kParallel) {
      if (missing > (1 - kWhole) * h.depth) return false;
    } else if (slope > 0) {
      low = std::max(low, missing / slope);
    } else {
      high = std::min(high, missing / slope);
    }
  }
  if (low > high + slack) return false;
  t = foot + along * (low > 0 ? low : high < 0 ? high : 0.0);
  return true;
}

}  // namespace otg
