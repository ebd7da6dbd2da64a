// SPDX-License-Identifier: BSD-3-Clause
// Operators and small functions of vectors that only the CPU needs.
#pragma once

#include <algorithm>
#include <cmath>

#include "shared/math/vec3.h"

namespace otg {

template <class T>
constexpr Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
constexpr Vec3<T> operator*(const Vec3<T>& a, T s) {
  return {a.x * s, a.y * s, a.z * s};
}

inline Vec3d asDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
inline Vec3d minimum(const Vec3d& a, const Vec3d& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3d maximum(const Vec3d& a, const Vec3d& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}
/// v at length 1, or zero.
inline Vec3d unit(const Vec3d& v) {
  const double length = norm(v);
  return length > 0 ? v * (1 / length) : Vec3d{0, 0, 0};
}

/// Of a rotation and translation.
inline Transformd inverseOf(const Transformd& m) {
  Transformd out{{m.r[0], m.r[3], m.r[6], m.r[1], m.r[4], m.r[7], m.r[2], m.r[5], m.r[8]}, {0, 0, 0}};
  out.t = otgRotateBack(m, m.t) * -1.0;
  return out;
}

/// First the inner one, then the outer one.
inline Transformd composed(const Transformd& outer, const Transformd& inner) {
  Transformd out{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out.r[3 * i + j] =
          outer.r[3 * i] * inner.r[j] + outer.r[3 * i + 1] * inner.r[3 + j] + outer.r[3 * i + 2] * inner.r[6 + j];
    }
  }
  out.t = otgTransform(outer, inner.t);
  return out;
}

}  // namespace otg
