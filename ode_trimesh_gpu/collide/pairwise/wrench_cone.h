// SPDX-License-Identifier: BSD-3-Clause
// The convex cone of a set of wrenches and the projection on it (non-negative least squares).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "collide/query.h"

namespace otg {

using Wrench = Eigen::Matrix<double, 6, 1>;

/// Scaling of wrenches: torques about the mean position, in units of the largest distance from it. So forces and
/// torques count alike, whatever the size and place of the contacts.
class WrenchFrame {
 public:
  explicit WrenchFrame(std::span<const Contact> contacts);
  /// [n, (p - c) x n / r]; the torque is zero when all positions are one point.
  Wrench wrench(const Contact& contact) const;

 private:
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double inverseRadius_ = 0;
};

/// Where on the cone a wrench is projected to: coefficients >= 0 on at most six rays.
struct ConeProjection {
  Wrench residual = Wrench::Zero();  ///< wrench minus the combination of rays, recomputed from the coefficients
  std::array<std::uint32_t, 6> rays{};
  std::array<double, 6> coefficients{};
  int count = 0;

  double distance() const { return residual.norm(); }
};

/// { sum x_i ray_i : x_i >= 0 }.
class WrenchCone {
 public:
  /// Numbered 0, 1, ... in the order of adding.
  void add(const Wrench& ray);
  /// A disabled ray keeps its number and is not part of the cone.
  void disable(std::uint32_t ray) { enabled_[ray] = 0; }
  void enable(std::uint32_t ray) { enabled_[ray] = 1; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(rays_.size()); }
  const Wrench& ray(std::uint32_t i) const { return rays_[i]; }

  /// Nearest point of the cone, by Lawson and Hanson's active-set method ("Solving Least Squares Problems", 1974,
  /// chapter 23). Ends early once the distance is at most `enough`. `start` is an earlier projection of the same
  /// wrench, all of whose rays must be enabled. The answer's distance is never below the true one by more than
  /// rounding: the coefficients are feasible even if the iteration stalls.
  ConeProjection project(const Wrench& wrench, double enough = 0, const ConeProjection& start = {}) const;

 private:
  std::vector<Wrench> rays_;
  std::vector<std::uint8_t> enabled_;
};

}  // namespace otg
