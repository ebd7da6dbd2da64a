// SPDX-License-Identifier: BSD-3-Clause
// What host and device hand each other for arrays of rays.
#ifndef OTG_SHARED_RAY_LAYOUT_H
#define OTG_SHARED_RAY_LAYOUT_H
#include "shared/layout/device_layout.h"

/// A ray is so many doubles: its origin, its direction (a unit vector), both in the mesh's frame, and its length.
#define OTG_RAY_DOUBLES 7

/// The result for one ray is a word: the number of the triangle that it hits first, or one of these two.
#define OTG_RAY_NOTHING 0x7fffffffu  ///< it hits none
#define OTG_RAY_OPEN 0x7ffffffeu     ///< the CPU has to compute it

/// Coordinates of origins that are larger are left to the CPU: products overflow.
#define OTG_RAY_FARTHEST 1e100

/// Nodes that a search may have left for later.
#define OTG_RAY_STACK 96

#endif  // OTG_SHARED_RAY_LAYOUT_H
