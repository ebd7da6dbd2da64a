// SPDX-License-Identifier: BSD-3-Clause
// Three-vectors of REAL. Plain structs without padding, so that arrays of them look the same on host and device.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_VEC3_D) : !defined(OTG_SHARED_VEC3_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_VEC3_D
#else
#define OTG_SHARED_VEC3_F
#endif
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {

/// A point or vector. The frame is said where it is used; units are the mesh's own (metres in an ODE world).
template <class REAL>
struct Vec3 {
  REAL x, y, z;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
static_assert(sizeof(Vec3f) == 12 && sizeof(Vec3d) == 24);

/// A rotation and a translation that take points of frame B to frame A: a = R b + t.
/// `r` is row-major and is applied as given (nothing here assumes that it is exactly orthonormal).
template <class REAL>
struct Transform {
  REAL r[9];
  Vec3<REAL> t;
};
using Transformf = Transform<float>;
using Transformd = Transform<double>;
static_assert(sizeof(Transformf) == 48 && sizeof(Transformd) == 96);

#else
inline static REAL OTG_NAME(otgMax)(REAL a, REAL b) {
  return a > b ? a : b;
}
inline static REAL OTG_NAME(otgMin)(REAL a, REAL b) {
  return a < b ? a : b;
}

typedef struct {
  REAL x, y, z;
} OTG_VEC3;
typedef struct {
  REAL r[9];
  OTG_VEC3 t;
} OTG_TRANSFORM;
#endif

OTG_GENERIC OTG_VEC3 OTG_NAME(otgVec)(REAL x, REAL y, REAL z) {
  OTG_VEC3 v;
  v.x = x;
  v.y = y;
  v.z = z;
  return v;
}

OTG_GENERIC OTG_VEC3 OTG_NAME(otgAdd)(OTG_VEC3 a, OTG_VEC3 b) {
  return OTG_NAME(otgVec)(a.x + b.x, a.y + b.y, a.z + b.z);
}

OTG_GENERIC OTG_VEC3 OTG_NAME(otgSub)(OTG_VEC3 a, OTG_VEC3 b) {
  return OTG_NAME(otgVec)(a.x - b.x, a.y - b.y, a.z - b.z);
}

OTG_GENERIC OTG_VEC3 OTG_NAME(otgScale)(OTG_VEC3 a, REAL s) {
  return OTG_NAME(otgVec)(a.x * s, a.y * s, a.z * s);
}

OTG_GENERIC REAL OTG_NAME(otgDot)(OTG_VEC3 a, OTG_VEC3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

OTG_GENERIC OTG_VEC3 OTG_NAME(otgCross)(OTG_VEC3 a, OTG_VEC3 b) {
  return OTG_NAME(otgVec)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/// R v: the rotation alone.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgRotate)(OTG_TRANSFORM m, OTG_VEC3 v) {
  return OTG_NAME(otgVec)(m.r[0] * v.x + m.r[1] * v.y + m.r[2] * v.z, m.r[3] * v.x + m.r[4] * v.y + m.r[5] * v.z,
                          m.r[6] * v.x + m.r[7] * v.y + m.r[8] * v.z);
}

/// Transposed R v: the inverse of otgRotate for an orthonormal R.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgRotateBack)(OTG_TRANSFORM m, OTG_VEC3 v) {
  return OTG_NAME(otgVec)(m.r[0] * v.x + m.r[3] * v.y + m.r[6] * v.z, m.r[1] * v.x + m.r[4] * v.y + m.r[7] * v.z,
                          m.r[2] * v.x + m.r[5] * v.y + m.r[8] * v.z);
}

/// R v + t, summed left to right, one rounding per operation. In double this very expression *defines* where the
/// vertices of mesh B are: exact decisions, the oracle tests and every backend start from its result.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgTransform)(OTG_TRANSFORM m, OTG_VEC3 v) {
  return OTG_NAME(otgVec)(m.r[0] * v.x + m.r[1] * v.y + m.r[2] * v.z + m.t.x,
                          m.r[3] * v.x + m.r[4] * v.y + m.r[5] * v.z + m.t.y,
                          m.r[6] * v.x + m.r[7] * v.y + m.r[8] * v.z + m.t.z);
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
