// SPDX-License-Identifier: BSD-3-Clause
// The SIMD stages for what every processor of the target architecture has.
#define OTG_SIMD_NAMESPACE simd_baseline
#include "collide/simd/surface_kernels_impl.h"
#include "collide/simd/wide_kernels_impl.h"
