// SPDX-License-Identifier: BSD-3-Clause
// What host and device hand each other for arrays of points.
#ifndef OTG_SHARED_POINT_LAYOUT_H
#define OTG_SHARED_POINT_LAYOUT_H
#include "shared/layout/device_layout.h"

/// The result for one point is a word: the number of the nearest triangle, or one of the two that follow, and the flag.
#define OTG_POINT_INSIDE 0x80000000u    ///< the flag
#define OTG_POINT_TRIANGLE 0x7fffffffu  ///< mask
#define OTG_POINT_NOTHING 0x7fffffffu   ///< there is no triangle, or none was requested
#define OTG_POINT_OPEN 0x7ffffffeu      ///< the CPU has to compute all of it

/// Coordinates of points that are larger are left to the CPU: squares overflow.
#define OTG_POINT_FARTHEST 1e100

/// Nodes that a search may have left for later.
#define OTG_POINT_STACK 96

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

#if !defined(__OPENCL_VERSION__) || defined(OTG_WITH_DOUBLE)
/// Of a mesh, in its own frame.
typedef struct {
  double lo[3], hi[3];
} otg_point_bounds;
#endif

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_point_bounds) == 48);
}  // namespace otg
#endif

#endif  // OTG_SHARED_POINT_LAYOUT_H
