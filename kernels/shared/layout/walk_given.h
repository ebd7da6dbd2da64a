// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of kernels/walk/ are given.
#ifndef OTG_SHARED_WALK_GIVEN_H
#define OTG_SHARED_WALK_GIVEN_H
#include "shared/layout/elements.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Numbers of pairs of a batch, in lists by their size; of the pairs with more hits than OTG_SMALL.
OTG_WORD_ELEMENT(otg_ordered_pair)
OTG_WORD_ELEMENT(otg_listed_pair)

// clang-format off

/// `method`: OTG_REDUCE_*, of the pair.
#define OTG_GIVEN_PairCut(X, AND)       \
  X(value, otg_device_pair, pair) AND   \
  X(read, otg_mesh_unit, meshes) AND    \
  X(write, otg_counter, counters) AND   \
  X(value, otg_uint, opens) AND         \
  X(write, otg_node_pair, out) AND      \
  X(value, otg_uint, outCapacity) AND   \
  X(write, otg_leaf_pair, leaves) AND   \
  X(value, otg_uint, leafCapacity) AND  \
  X(write, otg_pair_state, state) AND   \
  X(write, otg_chosen_word, chosen) AND \
  X(value, otg_uint, method)
OTG_STRUCTURE(PairCut, "pairCut")

#define OTG_GIVEN_PairLevel(X, AND)   \
  X(value, otg_device_pair, pair) AND \
  X(read, otg_mesh_unit, meshes) AND  \
  X(write, otg_counter, counters) AND \
  X(value, otg_uint, level) AND       \
  X(read, otg_node_pair, in) AND      \
  X(value, otg_uint, inCapacity) AND  \
  X(write, otg_node_pair, out) AND    \
  X(value, otg_uint, outCapacity) AND \
  X(write, otg_leaf_pair, leaves) AND \
  X(value, otg_uint, leafCapacity)
OTG_STRUCTURE(PairLevel, "pairLevel")

/// `stackSize`: places of `stack`.
#define OTG_GIVEN_PairTail(X, AND)     \
  X(value, otg_device_pair, pair) AND  \
  X(read, otg_mesh_unit, meshes) AND   \
  X(write, otg_counter, counters) AND  \
  X(value, otg_uint, level) AND        \
  X(read, otg_node_pair, seeds) AND    \
  X(value, otg_uint, seedCapacity) AND \
  X(read, otg_leaf_pair, leaves) AND   \
  X(value, otg_uint, leafCapacity) AND \
  X(write, otg_hit, hits) AND          \
  X(value, otg_uint, hitCapacity) AND  \
  X(value, otg_uint, mostHits) AND     \
  X(value, otg_uint, stackSize) AND    \
  X(local, otg_node_pair, stack)
OTG_STRUCTURE(PairTail, "pairTail")

/// `orderRoom`: places of each of the OTG_CLASSES lists in `order`.
#define OTG_GIVEN_BatchPrepare(X, AND)   \
  X(value, otg_uint, count) AND          \
  X(read, otg_batch_task, tasks) AND     \
  X(read, otg_device_mesh, places) AND   \
  X(read, otg_reduction, reductions) AND \
  X(write, otg_batch_pair, pairs) AND    \
  X(write, otg_pair_state, states) AND   \
  X(write, otg_chosen_word, chosen) AND  \
  X(write, otg_counter, counters) AND    \
  X(write, otg_ordered_pair, order) AND  \
  X(value, otg_uint, orderRoom)
OTG_STRUCTURE(BatchPrepare, "batchPrepare")

/// `precision`: of all pairs, but for delta. `stackSize`: places of `stack`.
#define OTG_GIVEN_BatchWalk(X, AND)       \
  X(read, otg_batch_pair, pairs) AND      \
  X(read, otg_device_mesh, places) AND    \
  X(value, otg_pair_error, precision) AND \
  X(read, otg_mesh_unit, meshes) AND      \
  X(write, otg_counter, counters) AND     \
  X(read, otg_ordered_pair, order) AND    \
  X(value, otg_uint, orderRoom) AND       \
  X(write, otg_chosen_word, chosen) AND   \
  X(write, otg_pair_state, states) AND    \
  X(write, otg_listed_pair, listed) AND   \
  X(write, otg_batch_hit, hits) AND       \
  X(value, otg_uint, hitCapacity) AND     \
  X(value, otg_uint, mostHits) AND        \
  X(value, otg_uint, anyHit) AND          \
  X(value, otg_uint, stackSize) AND       \
  X(local, otg_node_pair, stack)
OTG_STRUCTURE(BatchWalk, "batchWalk")

// clang-format on

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_WALK_GIVEN_H
