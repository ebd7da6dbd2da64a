// SPDX-License-Identifier: BSD-3-Clause
// What a set of contacts requests: the shortest translation that leaves all of them.
#pragma once

#include <optional>
#include <span>

#include "shared/math/vec3.h"

namespace otg::truth {

/// Translations t with normal . t >= depth. The normal has length 1.
struct HalfSpace {
  Vec3d normal;
  double depth;
};

/// The shortest t in all of the half-spaces; none where they have no point in common.
///
/// Source of method: Seidel, Small-dimensional linear programming and convex hulls made easy, 1991. A half-space that
/// the optimum so far violates has the next optimum on its boundary, a problem of one dimension less.
std::optional<Vec3d> shortestTranslation(std::span<const HalfSpace> halfSpaces);

}  // namespace otg::truth
