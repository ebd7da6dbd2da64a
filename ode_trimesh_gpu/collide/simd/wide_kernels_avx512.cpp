// SPDX-License-Identifier: BSD-3-Clause
// The SIMD stages for AVX-512 with 256-bit vectors.
#define OTG_SIMD_NAMESPACE simd_avx512
#include "collide/simd/surface_kernels_impl.h"
#include "collide/simd/wide_kernels_impl.h"
