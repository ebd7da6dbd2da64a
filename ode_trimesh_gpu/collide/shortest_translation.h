// SPDX-License-Identifier: BSD-3-Clause
// The shortest translation that gets a body out of half-spaces.
#pragma once

#include <cstddef>
#include <limits>
#include <memory_resource>
#include <vector>

#include "shared/contacts/shortest_translation.h"

namespace otg {

/// The shortest translation t with normal . t >= depth for half-spaces that come one by one.
class ShortestTranslation {
 public:
  explicit ShortestTranslation(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : all_(memory) {}
  const Vec3d& value() const { return t_; }
  bool satisfies(const Vec3d& normal, double depth) const { return otgIsOut(normal, depth, t_) != 0; }

  /// `normal` is a unit vector. False where no translation of at most that length satisfies all, as between two walls:
  /// then nothing changes.
  bool add(const Vec3d& normal, double depth, double longest = std::numeric_limits<double>::infinity());

 private:
  std::pmr::vector<HalfSpace<double>> all_;
  Vec3d t_{0, 0, 0};
};

}  // namespace otg
