// SPDX-License-Identifier: BSD-3-Clause
// Elements of buffers that are plain words on a device. The host knows them as types of their own, so that one buffer
// is not taken for another.
#ifndef OTG_SHARED_ELEMENTS_H
#define OTG_SHARED_ELEMENTS_H
#include "shared/layout/device_layout.h"
#include "shared/layout/given.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// OTG_COUNT_*.
OTG_WORD_ELEMENT(otg_counter)
/// Chosen contacts behind a head, flags and places of pairs: see OTG_RESULT_CONTACTS.
OTG_WORD_ELEMENT(otg_chosen_word)
/// Records of hits behind a head.
OTG_BYTE_ELEMENT(otg_result_byte)
/// Two nodes, by number, A's and B's.
OTG_TWO_WORD_ELEMENT(otg_node_pair)
/// Two leaves: see otgPairOfLeaves.
OTG_TWO_WORD_ELEMENT(otg_leaf_pair)
/// Places of two triangles in their soups; OTG_HIT_UNDECIDED.
OTG_TWO_WORD_ELEMENT(otg_hit)

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_ELEMENTS_H
