// SPDX-License-Identifier: BSD-3-Clause
// From the poses of a batch to what the traversal needs, and to the order in which pairs are walked. OTG_GROUP is the
// size of work-groups.
#include "walk/pair_walk.h"
//
#include "shared/layout/walk_given.h"
#include "walk/pair_state.h"

#ifdef OTG_WITH_DOUBLE
#define OTG_REAL_DOUBLE
#include "shared/tests/pair_bounds.h"
#undef OTG_REAL_DOUBLE

inline static otg_vec3_d otgInDouble(otg_vec3_f v) {
  return otgVec_d((double)v.x, (double)v.y, (double)v.z);
}

/// Sets the pair's frame and bounds; flags of a pose that cannot be worked with.
inline static uint otgMakeFrame(otg_transform_d pose, const otg_device_mesh* a, const otg_device_mesh* b,
                                __global otg_batch_pair* pair) {
  const double squared = otgRotationDefectSquared_d(pose), defect = sqrt(squared);
  if (!isfinite(pose.t.x) || !isfinite(pose.t.y) || !isfinite(pose.t.z)) return OTG_PAIR_REFUSED;
  if (!(squared >= 0) || !(defect <= OTG_RELATIVE_ROTATION_TOLERANCE)) return OTG_PAIR_REFUSED;
  const otg_pair_bounds_d bounds = otgPairBounds_d(pose, defect, otgInDouble(a->center), (double)a->radius,
                                                   otgInDouble(b->center), (double)b->radius);
  if (!(bounds.scale < OTG_LARGEST_SCALE)) return OTG_PAIR_NO_FRAME | OTG_PAIR_TO_HOST;
  for (int k = 0; k < 9; ++k) pair->r[k] = (float)pose.r[k];
  pair->t = otgVec_f((float)bounds.t.x, (float)bounds.t.y, (float)bounds.t.z);
  // As deviceBoxes on the CPU: devices may take the smallest floats for zero.
  pair->eps = convert_float_rtp(bounds.eps) + 1e-36f;
  pair->delta = convert_float_rtp(bounds.delta);
  return 0;
}
#endif

/// One lane for each pair. `order` gets the numbers of the pairs that are to be walked, in OTG_CLASSES lists by size,
/// each with room for all. Without doubles the CPU makes frames, and `pairs` is complete.
__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void batchPrepare(
    OTG_GIVEN(BatchPrepare)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  __global const otg_batch_task* task = tasks + i;
  const otg_device_mesh a = places[task->meshA], b = places[task->meshB];
  uint flag = otgFirstFlags(&a, &b, reductions[task->reduction].method);
  otgResetState(states + i, task->reduction, &a, &b);
#ifdef OTG_WITH_DOUBLE
  pairs[i].meshA = task->meshA;
  pairs[i].meshB = task->meshB;
  const uint unfit = otgMakeFrame(task->bInA, &a, &b, pairs + i);
  if (unfit) flag = unfit;
#else
  const uint unfit = 0;
#endif
  if (task->skip) flag = OTG_PAIR_SKIPPED;
  chosen[OTG_FLAGS + i] = flag;
  chosen[OTG_PLACE(count, i)] = 0;
  chosen[OTG_PLACE(count, i) + 1] = 0;
  if (unfit || task->skip) atomic_inc(counters + OTG_COUNT_FLAGGED);
  if (unfit || task->skip || a.triangles == 0 || b.triangles == 0) return;
  const uint class = clz(a.triangles + b.triangles);
  order[(size_t) class * orderRoom + atomic_inc(counters + OTG_COUNT_CLASS + class)] = i;
}
