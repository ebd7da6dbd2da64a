// SPDX-License-Identifier: BSD-3-Clause
// Solids that touch themselves: some of their vertices lie at the same place, and their indices tell them apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/vectors.h"
#include "scenes/generated_meshes.h"
#include "support/flush_pairs.h"

namespace otg::test {

struct SelfTouching {
  std::string what;
  scenes::MeshArrays touching, apart;  ///< the same body, and with a gap of about 1e-6
};

/// Two cubes of side 1; the second is `gap` farther off in the direction of its place.
inline scenes::MeshArrays twoCubes(const Vec3d& place, double gap) {
  return scenes::merge({scenes::makeBox({1, 1, 1}), moved(scenes::makeBox({1, 1, 1}), otgScale(place, 1 + gap))});
}

/// A torus whose inner sides meet in an edge, but for a gap.
inline scenes::MeshArrays pinchedTorus(double gap) {
  constexpr double kHole = 0.25;
  scenes::MeshArrays torus = scenes::makeTorus(1, 1 - kHole, 24, 24);
  const double step = 2 * M_PI / 24;
  const auto move = [&](double angle, const Vec3d& to) {
    const Vec3d from{kHole * std::cos(angle), kHole * std::sin(angle), 0};
    const auto far = [&](const Vec3f& v) { return norm(Vec3d{v.x - from.x, v.y - from.y, v.z - from.z}); };
    Vec3f& nearest = *std::min_element(torus.vertices.begin(), torus.vertices.end(),
                                       [&](const Vec3f& a, const Vec3f& b) { return far(a) < far(b); });
    nearest = {static_cast<float>(to.x), static_cast<float>(to.y), static_cast<float>(to.z)};
  };
  move(0, {gap, 0, 0});
  move(step, {gap, 0.0625, 0});
  move(M_PI, {-gap, 0, 0});
  move(M_PI - step, {-gap, 0.0625, 0});
  return torus;
}

inline std::vector<SelfTouching> selfTouching() {
  std::vector<SelfTouching> bodies;
  bodies.push_back({"two cubes at an edge", twoCubes({1, 1, 0}, 0), twoCubes({1, 1, 0}, 1e-6)});
  bodies.push_back({"two cubes at a corner", twoCubes({1, 1, 1}, 0), twoCubes({1, 1, 1}, 1e-6)});
  bodies.push_back({"a pinched torus", pinchedTorus(0), pinchedTorus(5e-7)});
  return bodies;
}

}  // namespace otg::test
