// SPDX-License-Identifier: BSD-3-Clause
#include "truth/shortest_translation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace otg::truth {
namespace {

/// Half-spaces whose violation is less than this part of the greatest depth hold.
constexpr double kSlack = 1e-10;
/// Boundaries whose normals differ by less than this count as parallel.
constexpr double kParallel = 1e-9;

/// Points of a line, nearest to the origin first.
struct Line {
  Vec3d foot, direction;
};

std::optional<Vec3d> onLine(const Line& line, std::span<const HalfSpace> others, double slack) {
  const double inf = std::numeric_limits<double>::infinity();
  double low = -inf, high = inf;
  for (const HalfSpace& h : others) {
    const double slope = otgDot(h.normal, line.direction), missing = h.depth - otgDot(h.normal, line.foot);
    if (std::fabs(slope) < kParallel) {
      if (missing > slack) return {};
    } else if (slope > 0) {
      low = std::max(low, missing / slope);
    } else {
      high = std::min(high, missing / slope);
    }
  }
  // Three planes that nearly share a line may leave an interval that is empty by rounding only.
  if (low > high + slack) return {};
  const double s = low > 0 ? low : high < 0 ? high : 0.0;
  return otgAdd(line.foot, otgScale(line.direction, s));
}

std::optional<Vec3d> onPlane(const HalfSpace& plane, std::span<const HalfSpace> others, double slack) {
  Vec3d t = otgScale(plane.normal, plane.depth);
  for (std::size_t i = 0; i < others.size(); ++i) {
    const HalfSpace& other = others[i];
    if (otgDot(other.normal, t) >= other.depth - slack) continue;
    const double c = otgDot(plane.normal, other.normal);
    const Vec3d across = otgCross(plane.normal, other.normal);
    const double sine = std::sqrt(otgDot(across, across));
    if (sine < kParallel) return {};
    // In the plane the other boundary is a line at right angles to the part of its normal in the plane.
    const Vec3d inPlane = otgScale(otgSub(other.normal, otgScale(plane.normal, c)), 1 / (sine * sine));
    const Vec3d foot = otgAdd(otgScale(plane.normal, plane.depth), otgScale(inPlane, other.depth - c * plane.depth));
    const std::optional<Vec3d> next = onLine({foot, otgScale(across, 1 / sine)}, others.first(i), slack);
    if (!next) return {};
    t = *next;
  }
  return t;
}

}  // namespace

std::optional<Vec3d> shortestTranslation(std::span<const HalfSpace> halfSpaces) {
  // The deepest first: what follows seldom changes the optimum then.
  std::vector<HalfSpace> all(halfSpaces.begin(), halfSpaces.end());
  std::stable_sort(all.begin(), all.end(), [](const HalfSpace& x, const HalfSpace& y) { return x.depth > y.depth; });
  if (all.empty()) return Vec3d{0, 0, 0};
  const double slack = kSlack * std::max(all.front().depth, 0.0);
  Vec3d t{0, 0, 0};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (otgDot(all[i].normal, t) >= all[i].depth - slack) continue;
    const std::optional<Vec3d> next = onPlane(all[i], std::span(all).first(i), slack);
    if (!next) return {};
    t = *next;
  }
  return t;
}

}  // namespace otg::truth
