// SPDX-License-Identifier: BSD-3-Clause
// Contacts as wrenches: forces along their normals, and what these turn.
#pragma once

#include <Eigen/Core>
#include <memory_resource>
#include <span>

#include "collide/query.h"

namespace otg {

using Wrench = Eigen::Matrix<double, 6, 1>;

/// Scaling of wrenches: torques about the mean position, in units of the largest distance from it. So forces and
/// torques count alike, whatever the size and place of the contacts.
class WrenchFrame {
 public:
  explicit WrenchFrame(std::span<const Contact> contacts,
                       std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  /// [n, (p - c) x n / r]; the torque is zero when all positions are one point.
  Wrench wrench(const Contact& contact) const;
  /// r, or 0 when all positions are one point.
  double radius() const { return inverseRadius_ > 0 ? 1 / inverseRadius_ : 0; }

 private:
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double inverseRadius_ = 0;
};

}  // namespace otg
