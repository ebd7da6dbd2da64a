// SPDX-License-Identifier: BSD-3-Clause
// The SIMD stages for AVX2.
#define OTG_SIMD_NAMESPACE simd_avx2
#include "collide/simd/surface_kernels_impl.h"
#include "collide/simd/wide_kernels_impl.h"
