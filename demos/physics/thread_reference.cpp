// SPDX-License-Identifier: BSD-3-Clause
// The plastic-impact reference of a nut on a bolt.
#include "physics/thread_reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace otg::physics {
namespace {

using Vec = Eigen::Vector3d;
using Vec2 = Eigen::Vector2d;

struct Flank {
  std::array<Vec, 3> corners;  ///< counter-clockwise seen from above
  Eigen::AlignedBox2d bounds;
  Vec slope;  ///< height = slope.x x + slope.y y + slope.z
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
    Flank flank{p, {}, {}};
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

/// The least height above the start at which the nut, turned by `angle`, is clear.
double leastHeight(const ThreadSetup& setup, const std::vector<Flank>& boltUp, double angle) {
  double height = -std::numeric_limits<double>::infinity();
  // On the helix the nut has climbed this much when it is clear again. Pairs that would need much more do not face each
  // other: there is a tooth between them. Those that need much less are a turn apart.
  const double climb = setup.pitch * angle / (2 * std::numbers::pi);
  for (const Flank& nut : flanks(setup.nut, -1, angle)) {
    for (const Flank& bolt : boltUp) {
      if (!nut.bounds.intersects(bolt.bounds)) continue;
      for (const Vec2& p : commonPart(nut, bolt)) {
        const Vec at(p.x(), p.y(), 1);
        const double needed = bolt.slope.dot(at) - nut.slope.dot(at);
        if (std::abs(needed - climb + 0.2 * setup.pitch) < 0.25 * setup.pitch) height = std::max(height, needed);
      }
    }
  }
  return height;
}

}  // namespace

std::vector<double> threadHeights(const ThreadSetup& setup, int samples) {
  const std::vector<Flank> boltUp = flanks(setup.bolt, 1, 0);
  std::vector<double> heights;
  for (int i = 0; i < samples; ++i)
    heights.push_back(leastHeight(setup, boltUp, 2 * std::numbers::pi / setup.segments * i / samples));
  return heights;
}

ThreadMotion plasticThreadReference(const ThreadSetup& setup, double seconds) {
  constexpr int kSamples = 64;
  constexpr double kStep = 1e-5;
  const double column = 2 * std::numbers::pi / setup.segments, rise = setup.pitch / setup.segments;
  const std::vector<double> heights = threadHeights(setup, kSamples);
  // Height and slope at any angle; between samples linear, from column to column one step of the helix.
  const auto contactAt = [&](double angle, double& slope) {
    const double columns = std::floor(angle / column), part = (angle / column - columns) * kSamples;
    const int i = std::min(kSamples - 1, static_cast<int>(part));
    const double low = heights[static_cast<std::size_t>(i)];
    const double high = i + 1 < kSamples ? heights[static_cast<std::size_t>(i) + 1] : heights[0] + rise;
    slope = (high - low) * kSamples / column;
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
