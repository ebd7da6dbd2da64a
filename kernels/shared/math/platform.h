// SPDX-License-Identifier: BSD-3-Clause
// What lets one header be read as C++ and as OpenCL C 1.2.
//
// A shared header writes each formula once, for a number type that it calls REAL:
//
//     OTG_GENERIC REAL OTG_NAME(otgDot)(OTG_VEC3 a, OTG_VEC3 b) { ... }
//
// As C++ that is a function template (called as otgDot(a, b)); REAL may be float, double or a SIMD vector class with
// the usual operators. OpenCL C includes the header once with OTG_REAL_FLOAT (names end in _f). Where the device has
// doubles it does so again with OTG_REAL_DOUBLE (names end in _d). Such headers therefore have one include guard per
// precision, so that several of them may include the same third one; C++, where OTG_REAL_DOUBLE is not defined, uses
// the first. See generic_begin.h and generic_end.h, and vec3.h for an example.
#ifndef OTG_SHARED_PLATFORM_H
#define OTG_SHARED_PLATFORM_H

#ifdef __OPENCL_VERSION__

#pragma OPENCL FP_CONTRACT OFF
#define OTG_INLINE inline static
#define OTG_CONSTANT __constant
#define OTG_UINT(x) ((uint)(x))
#define OTG_INT(x) ((int)(x))  ///< of a floating-point number that fits: rounded towards zero
typedef int otg_int;
typedef uint otg_uint;
typedef ulong otg_ulong;

#else  // C++

#include <cmath>
#include <cstdint>

#define OTG_INLINE inline
#define OTG_CONSTANT static constexpr
#define OTG_UINT(x) static_cast<std::uint32_t>(x)
#define OTG_INT(x) static_cast<std::int32_t>(x)
namespace otg {
using otg_int = std::int32_t;
using otg_uint = std::uint32_t;
using otg_ulong = std::uint64_t;
}  // namespace otg

#endif

#endif  // OTG_SHARED_PLATFORM_H
