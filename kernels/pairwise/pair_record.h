// SPDX-License-Identifier: BSD-3-Clause
// From a hit to its record: decides in double what single precision could not, and makes the published contact.
//
// OTG_CONTACTS: 1 to make contacts (needs doubles), 0 for the pairs alone.
#ifndef OTG_PAIR_RECORD_H
#define OTG_PAIR_RECORD_H
#include "walk/pair_walk.h"
#include "walk/take_now.h"

#ifdef OTG_WITH_DOUBLE
#define OTG_REAL_DOUBLE
#include "shared/contacts/pairwise_contact.h"
#include "shared/tests/triangle_test.h"
#undef OTG_REAL_DOUBLE

/// Corners in A's frame. The expression for those of B defines where B is: see otgTransform.
inline static void otgCornersInDouble(__global const float4* meshes, uint placeA, uint placeB, otg_transform_d bInA,
                                      otg_vec3_d* a, otg_vec3_d* b) {
  for (int k = 0; k < 3; ++k) {
    const float4 p = meshes[placeA + k], q = meshes[placeB + k];
    a[k] = otgVec_d((double)p.x, (double)p.y, (double)p.z);
    b[k] = otgTransform_d(bInA, otgVec_d((double)q.x, (double)q.y, (double)q.z));
  }
}
#endif

#if OTG_CONTACTS
typedef otg_contact_record otg_record;
#else
typedef otg_pair_record otg_record;
#endif

#if OTG_CONTACTS && defined(OTG_WITH_DOUBLE)
inline static void otgStoreContact(otg_pair_contact_d contact, __global otg_record* record) {
  record->position[0] = contact.position.x;
  record->position[1] = contact.position.y;
  record->position[2] = contact.position.z;
  record->normal[0] = contact.normal.x;
  record->normal[1] = contact.normal.y;
  record->normal[2] = contact.normal.z;
  record->depth = contact.depth;
}
#endif

/// `placeA` and `placeB` are places in the buffer of meshes. Without doubles `bInA` is not used: only the CPU knows
/// where B is in double.
inline static void otgMakeRecord(__global const float4* meshes, uint placeA, uint placeB, int undecided,
                                 otg_task_pose bInA, uint pair, __global otg_record* record) {
  int kind = undecided ? OTG_RECORD_OPEN : OTG_RECORD_HIT;
#ifdef OTG_WITH_DOUBLE
  otg_vec3_d a[3], b[3];
  otgCornersInDouble(meshes, placeA, placeB, bInA, a, b);
  if (undecided) {
    // As makePairFrame sets them: no error of input, ten units of roundoff.
    otg_filter_error_d error;
    int answer;
    error.unit = 10 * 0x1p-53;
    error.delta = 0;
    error.tiny = 1e-280;
    answer = otgTrianglesFilter_d(error, a, b);
    kind = answer == OTG_DISJOINT ? OTG_RECORD_APART : answer == OTG_UNDECIDED ? OTG_RECORD_OPEN : OTG_RECORD_HIT;
  }
#if OTG_CONTACTS
  if (kind == OTG_RECORD_HIT) {
    const otg_pair_contact_d contact = otgPairwiseContact_d(a, b);
    kind = contact.kind;
    otgStoreContact(contact, record);
  }
#endif
#endif
  record->a = as_uint(meshes[placeA].w);
  record->b = as_uint(meshes[placeB].w);
  record->kind = kind;
  record->pair = pair;
}

/// What every results kernel ends with: the last work-group copies the counters to the head of the results and zeroes
/// them for the next query. All others have read them by then.
inline static void otgFinish(__global uint* counters, __global uchar* results, __local uint* last) {
  const uint lane = get_local_id(0);
  barrier(CLK_GLOBAL_MEM_FENCE);
  if (lane == 0) *last = atomic_inc(counters + OTG_COUNT_DONE) == get_num_groups(0) - 1;
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  if (!*last) return;
  for (uint i = lane; i < OTG_COUNTERS; i += get_local_size(0)) {
    const uint count = otgTakeNow(counters + i);
    if (i < OTG_RESULT_HEAD / sizeof(uint)) ((__global uint*)results)[i] = count;
  }
}

#endif  // OTG_PAIR_RECORD_H
