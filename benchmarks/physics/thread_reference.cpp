// SPDX-License-Identifier: BSD-3-Clause
// The plastic-impact reference of a nut on a bolt.
#include "physics/thread_reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace otg::physics {
namespace {

using Vec = Eigen::Vector3d;
using Vec2 = Eigen::Vector2d;

struct Flank {
  std::array<Vec, 3> corners;  ///< counter-clockwise seen from above
  Eigen::AlignedBox2d bounds;
  double low, high;  ///< least and largest z
  Vec slope;         ///< height = slope.x x + slope.y y + slope.z
};

/// Triangles that face up (sign 1) or down (sign -1), turned about z.
std::vector<Flank> flanks(const scenes::MeshArrays& mesh, double sign, double angle) {
  const Eigen::AngleAxisd turn(angle, Vec::UnitZ());
  std::vector<Flank> result;
  for (const Triangle& t : mesh.triangles) {
    std::array<Vec, 3> p;
    for (int k = 0; k < 3; ++k) {
      const Vec3f& v = mesh.vertices[t.v[k]];
      p[static_cast<std::size_t>(k)] = turn * Vec(v.x, v.y, v.z);
    }
    const Vec normal = (p[1] - p[0]).cross(p[2] - p[0]);
    // Vertical walls have no height; what is steeper than this is a wall with rounded coordinates.
    if (sign * normal.z() < 1e-3 * normal.norm()) continue;
    if (sign < 0) std::swap(p[1], p[2]);
    Flank flank{p, {}, std::min({p[0].z(), p[1].z(), p[2].z()}), std::max({p[0].z(), p[1].z(), p[2].z()}), {}};
    for (const Vec& corner : p) flank.bounds.extend(corner.head<2>());
    flank.slope = Vec(-normal.x() / normal.z(), -normal.y() / normal.z(), 0);
    flank.slope.z() = p[0].z() - flank.slope.head<2>().dot(p[0].head<2>());
    result.push_back(flank);
  }
  return result;
}

/// The corners of the common part of both projections, by clipping one triangle at the other's edges.
std::vector<Vec2> commonPart(const Flank& a, const Flank& b) {
  std::vector<Vec2> polygon;
  for (const Vec& p : a.corners) polygon.push_back(p.head<2>());
  for (std::size_t k = 0; k < 3 && !polygon.empty(); ++k) {
    const Vec2 from = b.corners[k].head<2>(), edge = Vec2(b.corners[(k + 1) % 3].head<2>()) - from;
    const auto side = [&](const Vec2& p) { return edge.x() * (p.y() - from.y()) - edge.y() * (p.x() - from.x()); };
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const double sp = side(p), sq = side(q);
      if (sp >= 0) kept.push_back(p);
      if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) kept.push_back(p + (q - p) * (sp / (sp - sq)));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

/// Flanks by the sector about the axis that they touch, to find neighbours by.
class Sectors {
 public:
  explicit Sectors(const std::vector<Flank>& flanks) : sectors_(kCount) {
    for (const Flank& flank : flanks) {
      const auto [first, count] = rangeOf(flank);
      for (int i = 0; i < count; ++i) sectors_[static_cast<std::size_t>((first + i) % kCount)].push_back(&flank);
    }
  }
  /// Calls fn with every flank that shares a sector with this one, some of them repeatedly.
  template <class Fn>
  void forEachNear(const Flank& flank, const Fn& fn) const {
    const auto [first, count] = rangeOf(flank);
    for (int i = 0; i < count; ++i)
      for (const Flank* other : sectors_[static_cast<std::size_t>((first + i) % kCount)]) fn(*other);
  }

 private:
  static constexpr int kCount = 180;
  /// First sector and how many; all of them for what reaches near the axis or far around it.
  static std::pair<int, int> rangeOf(const Flank& flank) {
    const Vec2 middle = flank.bounds.center();
    const double reach = 0.5 * flank.bounds.diagonal().norm(), distance = middle.norm();
    if (reach > 0.7 * distance) return {0, kCount};
    const double half = std::asin(reach / distance), angle = std::atan2(middle.y(), middle.x()) + std::numbers::pi;
    const double width = 2 * std::numbers::pi / kCount;
    const int first = static_cast<int>(std::floor((angle - half) / width));
    const int last = static_cast<int>(std::floor((angle + half) / width));
    return {(first + kCount) % kCount, std::min(kCount, last - first + 1)};
  }
  std::vector<std::vector<const Flank*>> sectors_;
};

/// The least height above the start at which the nut, turned by `angle`, is clear.
double leastHeight(const ThreadSetup& setup, const Sectors& boltUp, double angle) {
  double height = -std::numeric_limits<double>::infinity();
  // On the helix the nut has climbed this much when it is clear again. Pairs that would need much more do not face each
  // other: there is a tooth between them. Those that need much less are a turn apart.
  const double climb = setup.pitch * angle / (2 * std::numbers::pi);
  const double least = climb - 0.45 * setup.pitch, most = climb + 0.05 * setup.pitch;
  for (const Flank& nut : flanks(setup.nut, -1, angle)) {
    boltUp.forEachNear(nut, [&](const Flank& bolt) {
      if (bolt.high - nut.low < least || bolt.low - nut.high > most || !nut.bounds.intersects(bolt.bounds)) return;
      for (const Vec2& p : commonPart(nut, bolt)) {
        const Vec at(p.x(), p.y(), 1);
        const double needed = bolt.slope.dot(at) - nut.slope.dot(at);
        if (needed > least && needed < most) height = std::max(height, needed);
      }
    });
  }
  return height;
}

}  // namespace

std::vector<double> threadHeights(const ThreadSetup& setup, int samples) {
  const std::vector<Flank> up = flanks(setup.bolt, 1, 0);
  const Sectors boltUp(up);
  std::vector<double> heights;
  heights.reserve(static_cast<std::size_t>(samples));
  for (int i = 0; i < samples; ++i)
    heights.push_back(leastHeight(setup, boltUp, 2 * std::numbers::pi / setup.segments * i / samples));
  return heights;
}

ThreadMotion plasticThreadReference(const ThreadSetup& setup, double seconds) {
  const int samples = setup.samples;
  constexpr double kStep = 1e-5;
  const double column = 2 * std::numbers::pi / setup.segments, rise = setup.pitch / setup.segments;
  const std::vector<double> heights = threadHeights(setup, samples);
  // Height and slope at any angle; between samples linear, from column to column one step of the helix.
  const auto contactAt = [&](double angle, double& slope) {
    const double columns = std::floor(angle / column), part = (angle / column - columns) * samples;
    const int i = std::min(samples - 1, static_cast<int>(part));
    const double low = heights[static_cast<std::size_t>(i)];
    const double high = i + 1 < samples ? heights[static_cast<std::size_t>(i) + 1] : heights[0] + rise;
    slope = (high - low) * samples / column;
    return low + (high - low) * (part - i) + columns * rise;
  };
  double z = 0, angle = 0, zSpeed = 0, angleSpeed = 0;
  for (long step = 0; step < std::lround(seconds / kStep); ++step) {
    zSpeed -= setup.gravity * kStep;
    double slope = 0;
    const double height = contactAt(angle, slope);
    const double approach = slope * angleSpeed - zSpeed;
    if (z <= height && approach > 0) {
      const double impulse = approach / (1 + slope * slope / setup.inertia);
      zSpeed += impulse;
      angleSpeed -= impulse * slope / setup.inertia;
    }
    z = std::max(z + zSpeed * kStep, height + std::min(0.0, zSpeed) * kStep);
    angle += angleSpeed * kStep;
    // What little the step has left below the contact is lifted out; it is of second order in the step.
    z = std::max(z, contactAt(angle, slope));
  }
  return {z, angle};
}

}  // namespace otg::physics
