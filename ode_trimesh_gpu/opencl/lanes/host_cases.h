// SPDX-License-Identifier: BSD-3-Clause
// Queries that no device gets.
#pragma once

#include <cmath>

#include "collide/pair_frame.h"
#include "collide/query.h"
#include "collide/rotation_tolerance.h"

namespace otg::opencl {

/// Whether the query is one that otg::collide refuses by an exception.
inline bool isRefused(const Query& query) {
  const Vec3d& t = query.bInA.t;
  return !std::isfinite(t.x) || !std::isfinite(t.y) || !std::isfinite(t.z) ||
         !(rotationDefect(query.bInA) <= kRelativeRotationTolerance);
}

/// Whether there is nothing that a device could do: the CPU knows the result.
inline bool isIdleQuery(const Query& query, const PairFrame& frame) {
  return query.a->tree().nodes.empty() || query.b->tree().nodes.empty() || !frame.finite;
}

}  // namespace otg::opencl
