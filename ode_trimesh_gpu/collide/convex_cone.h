// SPDX-License-Identifier: BSD-3-Clause
// The convex cone of a set of vectors and the projection on it (non-negative least squares).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

namespace otg {

/// Where on the cone a vector is projected to: coefficients >= 0 on at most as many rays as there are dimensions.
template <int kDimension>
struct ConeProjection {
  using Vector = Eigen::Matrix<double, kDimension, 1>;
  Vector residual = Vector::Zero();  ///< the vector minus the combination of rays, recomputed from the coefficients
  std::array<std::uint32_t, kDimension> rays{};
  std::array<double, kDimension> coefficients{};
  int count = 0;

  double distance() const { return residual.norm(); }
};

/// { sum x_i ray_i : x_i >= 0 }.
template <int kDimension>
class ConvexCone {
 public:
  using Projection = ConeProjection<kDimension>;
  using Vector = typename Projection::Vector;

  explicit ConvexCone(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : rays_(memory), enabled_(memory) {}

  void reserve(std::size_t rays) {
    rays_.reserve(rays);
    enabled_.reserve(rays);
  }
  /// Numbered 0, 1, ... in the order of adding.
  void add(const Vector& ray);
  void replace(std::uint32_t ray, const Vector& by) { rays_[ray] = by; }
  /// A disabled ray keeps its number and is not part of the cone.
  void disable(std::uint32_t ray) { enabled_[ray] = 0; }
  void enable(std::uint32_t ray) { enabled_[ray] = 1; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(rays_.size()); }
  const Vector& ray(std::uint32_t i) const { return rays_[i]; }

  /// Nearest point of the cone, by Lawson and Hanson's active-set method ("Solving Least Squares Problems", 1974,
  /// chapter 23). Ends early once the distance is at most `enough`. `start` is an earlier projection of the same
  /// vector, all of whose rays must be enabled. The result's distance is never below the true one by more than
  /// rounding: the coefficients are feasible even if the iteration stalls.
  Projection project(const Vector& vector, double enough = 0, const Projection& start = {}) const;

 private:
  std::pmr::vector<Vector> rays_;
  std::pmr::vector<std::uint8_t> enabled_;
};

}  // namespace otg
