// SPDX-License-Identifier: BSD-3-Clause
// Random numbers, directions and poses that are the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "shared/math/vec3.h"

namespace otg::test {

/// Draws without the standard distributions, whose values differ between standard libraries. Two draws that are
/// arguments of one call differ between compilers: braces keep their order.
class Draw {
 public:
  explicit Draw(std::uint32_t seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((std::uint64_t{engine_()} * n) >> 32); }
  Vec3d inBox(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Vec3d direction() {
    for (;;) {
      const Vec3d v = inBox(1);
      const double squared = otgDot(v, v);
      if (squared > 0.01 && squared < 1) return otgScale(v, 1 / std::sqrt(squared));
    }
  }

 private:
  std::mt19937 engine_;
};

/// Turn by `angle` about the unit vector `axis`, then a move.
inline Transformd makePose(const Vec3d& axis, double angle, const Vec3d& move) {
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  const Vec3d u = axis;
  return {
      {c + k * u.x * u.x, k * u.x * u.y - s * u.z, k * u.x * u.z + s * u.y, k * u.x * u.y + s * u.z, c + k * u.y * u.y,
       k * u.y * u.z - s * u.x, k * u.x * u.z - s * u.y, k * u.y * u.z + s * u.x, c + k * u.z * u.z},
      move};
}

/// A move alone: an exact identity matrix.
inline Transformd makeMove(const Vec3d& move) {
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, move};
}

/// One of the 24 rotations of the cube, exact in every arithmetic.
inline Transformd makeQuarterTurn(unsigned which, const Vec3d& move) {
  const unsigned permutation = which % 6, signs = which / 6 % 4;
  constexpr int kOrder[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const double parity = permutation < 3 ? 1 : -1;
  const double sign[3] = {signs & 1 ? -1.0 : 1.0, signs & 2 ? -1.0 : 1.0, 0};
  Transformd pose{{}, move};
  for (int row = 0; row < 3; ++row) {
    pose.r[3 * row + kOrder[permutation][row]] = row < 2 ? sign[row] : parity * sign[0] * sign[1];
  }
  return pose;
}

}  // namespace otg::test
