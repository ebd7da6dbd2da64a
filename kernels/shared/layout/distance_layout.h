// SPDX-License-Identifier: BSD-3-Clause
// What host and device hand each other for distances of pairs of meshes.
#ifndef OTG_SHARED_DISTANCE_LAYOUT_H
#define OTG_SHARED_DISTANCE_LAYOUT_H
#include "shared/layout/device_layout.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// One pair of a batch. Kernels that read it need doubles.
typedef struct {
#if !defined(__OPENCL_VERSION__) || defined(OTG_WITH_DOUBLE)
  double r[9], t[3];  ///< B's frame to A's
  double limit;       ///< nothing farther apart is looked for
#endif
  /// eps: by how much the distance of boxes may be off in single precision, and more than that of triangles may.
  otg_pair_boxes boxes;
  otg_uint meshA, meshB;  ///< places in the batch's table of otg_device_mesh
} otg_distance_task;

/// The result for a pair is two words: the numbers of the nearest triangles, or this twice.
#define OTG_DISTANCE_NOTHING 0xffffffffu

/// Sums of sizes and distances of which squares neither overflow nor vanish in single precision.
#define OTG_DISTANCE_LEAST 1e-12
#define OTG_DISTANCE_MOST 1e15

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_distance_task) == 200);
}  // namespace otg
#endif
#endif  // OTG_SHARED_DISTANCE_LAYOUT_H
