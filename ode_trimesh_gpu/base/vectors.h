// SPDX-License-Identifier: BSD-3-Clause
// Small functions of vectors that only the host needs.
#pragma once

#include <algorithm>
#include <cmath>

#include "shared/contacts/solid_model.h"

namespace otg {

inline Vec3d minimum(const Vec3d& a, const Vec3d& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3d maximum(const Vec3d& a, const Vec3d& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline double norm(const Vec3d& v) {
  return otgNorm(v);
}
/// v at length 1, or zero.
inline Vec3d unit(const Vec3d& v) {
  return otgUnit(v);
}

}  // namespace otg
