// SPDX-License-Identifier: BSD-3-Clause
// How the last kernel of a query of one pair ends, in its one work-group.
#ifndef OTG_CONTACT_FINISH_H
#define OTG_CONTACT_FINISH_H
#include "pairwise/pair_record.h"

/// Copies the counters to the head of the results, and with `clear` zeroes them for the next query.
inline static void otgFinishPair(__global uint* counters, __global uint* results, int clear) {
  barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  for (uint i = get_local_id(0); i < OTG_COUNTERS; i += get_local_size(0)) {
    const uint count = clear ? otgTakeNow(counters + i) : otgReadNow(counters + i);
    if (i < OTG_COUNTERS_READ) results[i] = count;
  }
}

#endif  // OTG_CONTACT_FINISH_H
