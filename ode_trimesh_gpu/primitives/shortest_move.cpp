// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/shortest_move.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/vectors.h"

namespace otg {
namespace {

constexpr double kParallel = 1e-9;  // sine of the angle

/// Points x with direction . x >= depth.
struct Ahead {
  Vec3d direction;
  double depth;
};

/// The point of a line nearest to the origin that is ahead of all; `foot` is the line's own nearest one.
std::optional<Vec3d> onLine(const Vec3d& foot, const Vec3d& along, std::span<const Ahead> others, double slack) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (const Ahead& h : others) {
    const double slope = otgDot(h.direction, along), missing = h.depth - otgDot(h.direction, foot);
    if (std::fabs(slope) < kParallel) {
      if (missing > slack) return {};
    } else if (slope > 0) {
      low = std::max(low, missing / slope);
    } else {
      high = std::min(high, missing / slope);
    }
  }
  if (low > high + slack) return {};
  return foot + along * (low > 0 ? low : high < 0 ? high : 0.0);
}

/// The same of the plane at the end of what `first` asks for.
std::optional<Vec3d> onPlane(const Ahead& first, std::span<const Ahead> others, double slack) {
  Vec3d x = first.direction * first.depth;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const Ahead& h = others[i];
    if (otgDot(h.direction, x) >= h.depth - slack) continue;
    const double cosine = otgDot(first.direction, h.direction);
    const Vec3d across = otgCross(first.direction, h.direction);
    const double sine2 = otgDot(across, across);
    if (sine2 < kParallel * kParallel) return {};
    const Vec3d inPlane = (h.direction - first.direction * cosine) * (1 / sine2);
    const Vec3d foot = first.direction * first.depth + inPlane * (h.depth - cosine * first.depth);
    const std::optional<Vec3d> next = onLine(foot, across * (1 / std::sqrt(sine2)), others.first(i), slack);
    if (!next) return {};
    x = *next;
  }
  return x;
}

}  // namespace

std::optional<Vec3d> shortestMove(std::span<const Contact> contacts) {
  std::vector<Ahead> all;
  all.reserve(contacts.size());
  for (const Contact& c : contacts) all.push_back({c.normal * -1.0, c.depth});
  // The deepest first: what follows seldom changes the answer.
  std::stable_sort(all.begin(), all.end(), [](const Ahead& x, const Ahead& y) { return x.depth > y.depth; });
  Vec3d x{0, 0, 0};
  const double slack = all.empty() ? 0 : 1e-10 * all.front().depth;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (otgDot(all[i].direction, x) >= all[i].depth - slack) continue;
    const std::optional<Vec3d> next = onPlane(all[i], std::span(all).first(i), slack);
    if (!next) return {};
    x = *next;
  }
  return x;
}

}  // namespace otg
