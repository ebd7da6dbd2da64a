// SPDX-License-Identifier: BSD-3-Clause
// How functions and loops of large kernels are compiled.
#ifndef OTG_INLINED_H
#define OTG_INLINED_H

/// The compiler of PoCL 3.1 crashes when it is to weigh whether inlining these is worth it. OTG_NOT_INLINED: for a
/// simulator that does not know what its compiler leaves behind where it has inlined.
#ifdef OTG_NOT_INLINED
#define OTG_INLINED inline static
#else
#define OTG_INLINED inline static __attribute__((always_inline))
#endif

/// Before loops of large bodies: what is unrolled into a kernel of this size does not fit the caches of instructions.
#define OTG_ROLLED _Pragma("unroll 1")

#endif  // OTG_INLINED_H
