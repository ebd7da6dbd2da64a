// SPDX-License-Identifier: BSD-3-Clause
#include "truth/profile_bodies.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "truth/certificate_bodies.h"

namespace otg::truth {
namespace {

constexpr double kPi = std::numbers::pi;

Point2 polar(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

ProfileBody star(Random& random) {
  const int points = 3 + random.below(7);
  const double outer = random.uniform(0.3, 0.7), inner = outer * random.uniform(0.3, 0.7);
  std::vector<Point2> outline;
  outline.reserve(2 * static_cast<std::size_t>(points));
  for (int i = 0; i < 2 * points; ++i) outline.push_back(polar(i % 2 == 0 ? outer : inner, kPi * i / points));
  return {extruded(outline, random.uniform(0.1, 0.5)), fmt::format("star of {}", points)};
}

ProfileBody comb(Random& random) {
  const int teeth = 3 + random.below(5);
  const double pitch = random.uniform(0.1, 0.25), tooth = pitch * random.uniform(0.35, 0.65),
               length = random.uniform(0.1, 0.5), back = random.uniform(0.08, 0.2);
  std::vector<Point2> outline{{0, -back}, {pitch * (teeth - 1) + tooth, -back}};
  for (int i = teeth - 1; i >= 0; --i) {
    const double left = pitch * i, right = left + tooth;
    if (i < teeth - 1) outline.push_back({right, 0});
    outline.push_back({right, length});
    outline.push_back({left, length});
    if (i > 0) outline.push_back({left, 0});
  }
  return {extruded(outline, random.uniform(0.1, 0.5)), fmt::format("comb of {}", teeth)};
}

/// A band along a curve that is given by angle, of the given thickness.
template <class Radius>
std::vector<Point2> band(const Radius& radius, double turns, int segments, double thickness) {
  std::vector<Point2> outline;
  for (int i = 0; i <= segments; ++i) {
    const double angle = 2 * kPi * turns * i / segments;
    outline.push_back(polar(radius(angle) + thickness, angle));
  }
  for (int i = segments; i >= 0; --i) {
    const double angle = 2 * kPi * turns * i / segments;
    outline.push_back(polar(radius(angle), angle));
  }
  return outline;
}

ProfileBody hook(Random& random) {
  const int segments = 6 + random.below(20);
  const double inner = random.uniform(0.2, 0.4), thickness = random.uniform(0.08, 0.2),
               turns = random.uniform(0.5, 0.9);
  const auto radius = [&](double) { return inner; };
  return {extruded(band(radius, turns, segments, thickness), random.uniform(0.1, 0.3)),
          fmt::format("hook of {} segments", segments)};
}

ProfileBody spiral(Random& random) {
  const int segments = 20 + random.below(30);
  const double thickness = random.uniform(0.04, 0.08), gap = random.uniform(0.05, 0.12),
               turns = random.uniform(1.2, 2.5);
  const auto radius = [&](double angle) { return 0.08 + (thickness + gap) * angle / (2 * kPi); };
  return {extruded(band(radius, turns, segments, thickness), random.uniform(0.1, 0.3)),
          fmt::format("spiral of {} segments", segments)};
}

}  // namespace

ProfileBody randomProfile(Random& random) {
  constexpr ProfileBody (*kKinds[])(Random&) = {star, comb, hook, spiral};
  return kKinds[random.below(4)](random);
}

}  // namespace otg::truth
