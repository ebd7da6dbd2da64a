// SPDX-License-Identifier: BSD-3-Clause
// The shortest translation that gets a body out of half-spaces.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <vector>

#include "shared/math/vec3.h"

namespace otg {

/// The shortest translation t with normal . t >= depth for half-spaces that come one by one.
///
/// Seidel's incremental method for linear programs of low dimension, with the length in place of a linear objective:
/// the shortest one touches the half-space that it does not satisfy yet, and at most two of those before.
class ShortestTranslation {
 public:
  explicit ShortestTranslation(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : all_(memory) {}
  const Vec3d& value() const { return t_; }
  bool satisfies(const Vec3d& normal, double depth) const;

  /// `normal` is a unit vector. False where no translation satisfies all, as between two walls: then nothing changes.
  bool add(const Vec3d& normal, double depth);

 private:
  struct HalfSpace {
    Vec3d normal;
    double depth;
  };
  bool onBoundary(const HalfSpace& touched, Vec3d& t) const;
  bool onLine(const Vec3d& foot, const Vec3d& along, std::size_t others, Vec3d& t) const;

  std::pmr::vector<HalfSpace> all_;
  Vec3d t_{0, 0, 0};
};

}  // namespace otg
