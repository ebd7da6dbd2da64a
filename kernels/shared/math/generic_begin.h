// SPDX-License-Identifier: BSD-3-Clause
// Opens a precision-generic header: see platform.h. No include guard: read once per header and precision.
#include "shared/math/platform.h"

#ifdef __OPENCL_VERSION__
#if defined(OTG_REAL_DOUBLE)
#define REAL double
#define OTG_NAME(name) name##_d
#define OTG_VEC3 otg_vec3_d
#define OTG_TRANSFORM otg_transform_d
#elif defined(OTG_REAL_FLOAT)
#define REAL float
#define OTG_NAME(name) name##_f
#define OTG_VEC3 otg_vec3_f
#define OTG_TRANSFORM otg_transform_f
#else
#error "define OTG_REAL_FLOAT or OTG_REAL_DOUBLE before including a generic shared header"
#endif
#define OTG_GENERIC OTG_INLINE
#define OTG_ABS(x) fabs(x)
// Not fmax and fmin: which zero those give for +0 and -0 is up to the device, and results are compared byte by byte.
#define OTG_MAX(a, b) OTG_NAME(otgMax)(a, b)
#define OTG_MIN(a, b) OTG_NAME(otgMin)(a, b)
#define OTG_SQRT(x) sqrt(x)
#define OTG_REAL(x) ((REAL)(x))
#else
#define OTG_NAME(name) name
#define OTG_VEC3 Vec3<REAL>
#define OTG_TRANSFORM Transform<REAL>
// Always inlined, so that a caller compiled for a wider instruction set gets the formula in that instruction set. No
// copy compiled for it is left for the linker to choose.
#define OTG_GENERIC     \
  template <class REAL> \
  [[gnu::always_inline]] inline
#define OTG_ABS(x) otgAbs(x)
#define OTG_MAX(a, b) otgMax(a, b)
#define OTG_MIN(a, b) otgMin(a, b)
#define OTG_SQRT(x) otgSqrt(x)
#define OTG_REAL(x) static_cast<REAL>(x)

#ifndef OTG_SHARED_SCALAR_OPS
#define OTG_SHARED_SCALAR_OPS
// The operations that have no operator. SIMD vector classes overload these beside their definition.
namespace otg {
[[gnu::always_inline]] inline float otgAbs(float x) {
  return std::fabs(x);
}
[[gnu::always_inline]] inline double otgAbs(double x) {
  return std::fabs(x);
}
[[gnu::always_inline]] inline float otgMax(float a, float b) {
  return a > b ? a : b;
}
[[gnu::always_inline]] inline double otgMax(double a, double b) {
  return a > b ? a : b;
}
[[gnu::always_inline]] inline float otgMin(float a, float b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline double otgMin(double a, double b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline float otgSqrt(float x) {
  return std::sqrt(x);
}
[[gnu::always_inline]] inline double otgSqrt(double x) {
  return std::sqrt(x);
}
}  // namespace otg
#endif
#endif
