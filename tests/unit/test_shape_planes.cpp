// SPDX-License-Identifier: BSD-3-Clause
// How deep boxes and cylinders reach below points and edges, against lines through the shape and many samples.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "base/vectors.h"
#include "collide/surface/shape_planes.h"
#include "primitives/convex_shape.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Vec3d kHalf{0.7, 0.5, 0.4};  ///< of the box
constexpr double kRadius = 0.5, kHalfHeight = 0.8;

/// Where a line p + t d is within two bounds of one coordinate.
void clip(double p, double d, double bound, double& from, double& to) {
  if (d == 0) {
    if (std::fabs(p) > bound) from = kInfinity;
    return;
  }
  from = std::max(from, std::min((-bound - p) / d, (bound - p) / d));
  to = std::min(to, std::max((-bound - p) / d, (bound - p) / d));
}

/// How far the shape reaches against `out` from a point in it or above it; none elsewhere.
std::optional<double> depthOf(bool isRound, const Vec3d& p, const Vec3d& out) {
  const Vec3d d = out * -1.0;
  double from = 0, to = kInfinity;
  clip(p.z, d.z, isRound ? kHalfHeight : kHalf.z, from, to);
  if (isRound) {
    const double a = d.x * d.x + d.y * d.y, b = p.x * d.x + p.y * d.y, c = p.x * p.x + p.y * p.y - kRadius * kRadius;
    if (b * b < a * c) return std::nullopt;
    from = std::max(from, (-b - std::sqrt(b * b - a * c)) / a);
    to = std::min(to, (-b + std::sqrt(b * b - a * c)) / a);
  } else {
    clip(p.x, d.x, kHalf.x, from, to);
    clip(p.y, d.y, kHalf.y, from, to);
  }
  return from <= to ? std::optional(to) : std::nullopt;
}

template <class Check>
void forEachStretch(bool isRound, std::uint32_t seed, const Check& check) {
  Draw draw(seed);
  const auto shape = isRound ? cylinderShape(kRadius, kHalfHeight) : boxShape(kHalf);
  ShapePlanes planes(*shape);
  int seen = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3d from = draw.inBox(1), to = draw.inBox(1);
    // Often nearly along the axis, or across it.
    Vec3d out = draw.direction();
    if (i % 3 == 1) out = unit({0.01 * out.x, 0.01 * out.y, 1});
    if (i % 3 == 2) out = unit({out.x, out.y, 0.01 * out.z});
    planes.lookAt({-2, -2, -2}, {2, 2, 2});
    planes.lookAlong(out, {-2, -2, -2}, {2, 2, 2});
    ShapePlanes::Stretch stretch{from, to - from, 0, 1};
    if (!planes.cut(stretch)) continue;
    check(planes, stretch, out);
    ++seen;
  }
  REQUIRE(seen > 500);
}

}  // namespace

TEST_CASE("a shape is as deep below a point as the line from there through it") {
  for (const bool isRound : {false, true}) {
    forEachStretch(isRound, 1, [&](ShapePlanes& planes, const ShapePlanes::Stretch& stretch, const Vec3d& out) {
      for (const double t : {0.0, 0.5 * (stretch.low + stretch.high), 1.0}) {
        const std::optional<double> depth = depthOf(isRound, stretch.at(t), out);
        const double found = planes.depthBelow(stretch.at(t));
        REQUIRE((found >= 0) == depth.has_value());
        if (depth) REQUIRE(found == Approx(*depth).margin(1e-12));
      }
    });
  }
}

TEST_CASE("no sample of an edge is deeper than its deepest place") {
  constexpr int kSamples = 2000;
  for (const bool isRound : {false, true}) {
    forEachStretch(isRound, 2, [&](ShapePlanes& planes, const ShapePlanes::Stretch& stretch, const Vec3d& out) {
      double most = 0;
      for (int i = 0; i <= kSamples; ++i) {
        const double t = static_cast<double>(i) / kSamples;
        most = std::max(most, depthOf(isRound, stretch.at(t), out).value_or(0));
      }
      const double t = planes.deepest(stretch, 0);
      REQUIRE(t >= 0);
      REQUIRE(t <= 1);
      // The line from there may graze the shape, and miss it by rounding.
      const double within = t + 1e-7 * (0.5 * (stretch.low + stretch.high) - t);
      REQUIRE(depthOf(isRound, stretch.at(within), out).value_or(0) >= most - 1e-5);
    });
  }
}

TEST_CASE("a place deeper than enough is found exactly, and another one is in the shape or above it") {
  forEachStretch(true, 3, [&](ShapePlanes& planes, const ShapePlanes::Stretch& stretch, const Vec3d&) {
    const double most = planes.depthBelow(stretch.at(planes.deepest(stretch, 0)));
    const double above = planes.depthBelow(stretch.at(planes.deepest(stretch, 0.999 * most)));
    REQUIRE(above >= most - 1e-9);
    REQUIRE(planes.depthBelow(stretch.at(planes.deepest(stretch, 1.001 * most))) >= 0);
  });
}
