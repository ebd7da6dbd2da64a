// SPDX-License-Identifier: BSD-3-Clause
// Eight floats as the REAL of the shared formulas, by the compiler's vector extension: the same source as the scalar
// and the OpenCL form, compiled once per instruction set in a namespace of its own (OTG_SIMD_NAMESPACE; see
// wide_kernels.h).
#pragma once

#include <cstdint>
#include <cstring>

namespace otg::OTG_SIMD_NAMESPACE {

struct SimdReal {
  typedef float Floats __attribute__((vector_size(32)));
  typedef std::int32_t Ints __attribute__((vector_size(32)));
  Floats v;
  SimdReal() = default;
  SimdReal(Floats x) : v(x) {}            // NOLINT(google-explicit-constructor): reads as a number
  SimdReal(float x) : v(x - Floats{}) {}  // NOLINT(google-explicit-constructor)
  static SimdReal load(const float* p) {
    Floats x;
    std::memcpy(&x, p, sizeof x);
    return x;
  }
};

inline SimdReal operator+(SimdReal a, SimdReal b) {
  return a.v + b.v;
}
inline SimdReal operator-(SimdReal a, SimdReal b) {
  return a.v - b.v;
}
inline SimdReal operator*(SimdReal a, SimdReal b) {
  return a.v * b.v;
}
inline SimdReal otgMax(SimdReal a, SimdReal b) {
  return a.v > b.v ? a.v : b.v;
}
inline SimdReal otgMin(SimdReal a, SimdReal b) {
  return a.v < b.v ? a.v : b.v;
}
inline SimdReal otgAbs(SimdReal a) {
  SimdReal::Ints bits;
  std::memcpy(&bits, &a.v, sizeof bits);
  bits &= 0x7fffffff;
  SimdReal out;
  std::memcpy(&out.v, &bits, sizeof bits);
  return out;
}

/// Bit k set where lane k of a comparison is true.
inline unsigned bitsOf(const SimdReal::Ints& m) {
#if defined(__AVX__)
  SimdReal::Floats signs;
  std::memcpy(&signs, &m, sizeof signs);
  return static_cast<unsigned>(__builtin_ia32_movmskps256(signs));
#elif defined(__SSE__)
  typedef float Half __attribute__((vector_size(16)));
  Half lo, hi;
  std::memcpy(&lo, &m, sizeof lo);
  std::memcpy(&hi, reinterpret_cast<const char*>(&m) + sizeof lo, sizeof hi);
  return static_cast<unsigned>(__builtin_ia32_movmskps(lo) | __builtin_ia32_movmskps(hi) << 4);
#else
  unsigned bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<unsigned>(m[k] != 0) << k;
  return bits;
#endif
}

/// Bit k set where a > b in lane k.
inline unsigned greaterBits(SimdReal a, SimdReal b) {
  return bitsOf(a.v > b.v);
}

}  // namespace otg::OTG_SIMD_NAMESPACE
