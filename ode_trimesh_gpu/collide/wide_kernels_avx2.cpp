// SPDX-License-Identifier: BSD-3-Clause
// The SIMD stages for AVX2.
#define OTG_SIMD_NAMESPACE simd_avx2
#include "collide/solid/surface_kernels_impl.h"
#include "collide/wide_kernels_impl.h"
