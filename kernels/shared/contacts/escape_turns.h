// SPDX-License-Identifier: BSD-3-Clause
// The directions that are compared for the way out of a region in which surfaces contradict each other:
// collide/solid/escape.cpp, and on devices kernels/solid/large/ways.cl. In OpenCL C only with doubles.
#ifndef OTG_SHARED_ESCAPE_TURNS_H
#define OTG_SHARED_ESCAPE_TURNS_H
#include "shared/math/platform.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// The 26 of a cube's faces, edges and corners, the push, the way back, and B's axes in both senses. Then so many times
/// so many around the best so far.
#define OTG_ESCAPE_DIRECTIONS 34
#define OTG_ESCAPE_TURNS 3
#define OTG_ESCAPE_SIDES 6
/// Lines along which a way is measured: from the region's middle, and from up to 16 of its points, each moved by a part
/// of the way to the middle: the points themselves lie on the surfaces.
#define OTG_ESCAPE_ORIGINS 17
#define OTG_ESCAPE_INWARDS 0.02

#if !defined(__OPENCL_VERSION__) || defined(OTG_WITH_DOUBLE)
/// How far to the side, and where around: the cosine and sine of a sixth of a turn each. As numbers, because two
/// libraries need not agree on the last bit of a sine.
OTG_CONSTANT double kEscapeSteps[OTG_ESCAPE_TURNS] = {0.3, 0.15, 0.075};
OTG_CONSTANT double kEscapeCosines[OTG_ESCAPE_SIDES] = {1,  0.50000000000000011,  -0.49999999999999978,
                                                        -1, -0.50000000000000044, 0.50000000000000011};
OTG_CONSTANT double kEscapeSines[OTG_ESCAPE_SIDES] = {
    0, 0.8660254037844386, 0.86602540378443871, 1.2246467991473532e-16, -0.86602540378443837, -0.8660254037844386};
#endif

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_ESCAPE_TURNS_H
