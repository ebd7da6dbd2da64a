// SPDX-License-Identifier: BSD-3-Clause
// Eight floats or doubles as the REAL of the shared formulas, by the compiler's vector extension: the same source as
// the scalar and the OpenCL form, compiled once per instruction set in a namespace of its own (OTG_SIMD_NAMESPACE; see
// wide_kernels.h).
#pragma once

#include <cstdint>
#include <cstring>

namespace otg::OTG_SIMD_NAMESPACE {

struct FloatLanes {
  using Value = float;
  using Int = std::int32_t;
  static constexpr Int kMagnitude = INT32_MAX;  ///< all bits but the sign's
  typedef Value Values __attribute__((vector_size(32)));
  typedef Int Ints __attribute__((vector_size(32)));
};
struct DoubleLanes {
  using Value = double;
  using Int = std::int64_t;
  static constexpr Int kMagnitude = INT64_MAX;
  typedef Value Values __attribute__((vector_size(64)));
  typedef Int Ints __attribute__((vector_size(64)));
};

template <class Lanes>
struct Simd {
  using T = typename Lanes::Value;
  using Int = typename Lanes::Int;
  using Values = typename Lanes::Values;
  using Ints = typename Lanes::Ints;
  Values v;
  Simd() = default;
  [[gnu::always_inline]] Simd(Values x) : v(x) {}        // NOLINT(google-explicit-constructor): reads as a number
  [[gnu::always_inline]] Simd(T x) : v(x - Values{}) {}  // NOLINT(google-explicit-constructor)
  [[gnu::always_inline]] static Simd load(const T* p) {
    Values x;
    std::memcpy(&x, p, sizeof x);
    return x;
  }
  [[gnu::always_inline]] friend Simd operator+(Simd a, Simd b) { return a.v + b.v; }
  [[gnu::always_inline]] friend Simd operator-(Simd a, Simd b) { return a.v - b.v; }
  [[gnu::always_inline]] friend Simd operator*(Simd a, Simd b) { return a.v * b.v; }
  [[gnu::always_inline]] friend Simd otgMax(Simd a, Simd b) { return a.v > b.v ? a.v : b.v; }
  [[gnu::always_inline]] friend Simd otgMin(Simd a, Simd b) { return a.v < b.v ? a.v : b.v; }
  [[gnu::always_inline]] friend Simd otgAbs(Simd a) {
    Ints bits;
    std::memcpy(&bits, &a.v, sizeof bits);
    bits &= Lanes::kMagnitude;
    Simd out;
    std::memcpy(&out.v, &bits, sizeof bits);
    return out;
  }
};
using SimdReal = Simd<FloatLanes>;
using SimdDouble = Simd<DoubleLanes>;

/// Bit k set where lane k of a comparison is true.
[[gnu::always_inline]] inline unsigned bitsOf(const SimdReal::Ints& m) {
#if defined(__AVX__)
  SimdReal::Values signs;
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

[[gnu::always_inline]] inline unsigned bitsOf(const SimdDouble::Ints& m) {
  return bitsOf(__builtin_convertvector(m, SimdReal::Ints));
}

/// Bit k set where a > b in lane k.
[[gnu::always_inline]] inline unsigned greaterBits(SimdReal a, SimdReal b) {
  return bitsOf(a.v > b.v);
}

}  // namespace otg::OTG_SIMD_NAMESPACE
