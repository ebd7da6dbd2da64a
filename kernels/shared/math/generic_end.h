// SPDX-License-Identifier: BSD-3-Clause
// Closes a precision-generic header: see platform.h.
#ifdef __OPENCL_VERSION__
#undef REAL
#endif
#undef OTG_NAME
#undef OTG_VEC3
#undef OTG_TRANSFORM
#undef OTG_GENERIC
#undef OTG_ABS
#undef OTG_MAX
#undef OTG_MIN
#undef OTG_SQRT
#undef OTG_REAL
