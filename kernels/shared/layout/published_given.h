// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of kernels/published/ are given.
#ifndef OTG_SHARED_PUBLISHED_GIVEN_H
#define OTG_SHARED_PUBLISHED_GIVEN_H
#include "shared/layout/pairwise_given.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Nodes that a traversal begins with.
OTG_WORD_ELEMENT(otg_start_node)
/// Numbers that are summed up, and sums: one, or two at once.
OTG_WORD_ELEMENT(otg_one_sum)
OTG_TWO_WORD_ELEMENT(otg_two_sums)
/// Places of two triangles in their soups; two triangles by number.
OTG_TWO_WORD_ELEMENT(otg_place_pair)
OTG_TWO_WORD_ELEMENT(otg_number_pair)
/// Of one step of the middle phase alone.
OTG_WORD_ELEMENT(otg_step_counter)
/// What work-groups of scanOnce report to each other; OTG_SCAN_WORDS for each. The number of groups that have begun.
OTG_WORD_ELEMENT(otg_scan_status)
OTG_WORD_ELEMENT(otg_scan_ticket)
#define OTG_SCAN_WORDS 8

// clang-format off

/// `starts`: `countA` nodes of A, then `countB` of B.
#define OTG_GIVEN_LevelsBegin(X, AND) \
  X(read, otg_start_node, starts) AND \
  X(value, otg_uint, countA) AND      \
  X(value, otg_uint, countB) AND      \
  X(write, otg_node_pair, pairs)
OTG_STRUCTURE(LevelsBegin, "levelsBegin")

#define OTG_GIVEN_LevelsTest(X, AND)  \
  X(value, otg_device_pair, pair) AND \
  X(read, otg_mesh_unit, meshes) AND  \
  X(read, otg_node_pair, pairs) AND   \
  X(value, otg_uint, count) AND       \
  X(write, otg_one_sum, overlaps)
OTG_STRUCTURE(LevelsTest, "levelsTest")

/// `nodesA`, `nodesB`: as otg_device_mesh, here and below.
#define OTG_GIVEN_LevelsCompact(X, AND) \
  X(read, otg_mesh_unit, meshes) AND    \
  X(value, otg_uint, nodesA) AND        \
  X(value, otg_uint, nodesB) AND        \
  X(read, otg_node_pair, pairs) AND     \
  X(value, otg_uint, count) AND         \
  X(read, otg_one_sum, overlaps) AND    \
  X(read, otg_one_sum, places) AND      \
  X(read, otg_one_sum, total) AND       \
  X(write, otg_node_pair, kept) AND     \
  X(write, otg_two_sums, weights)
OTG_STRUCTURE(LevelsCompact, "levelsCompact")

/// The pairs of one level, and where what comes of them goes.
#define OTG_GIVEN_LevelsKept(X, AND) \
  X(read, otg_mesh_unit, meshes) AND \
  X(value, otg_uint, nodesA) AND     \
  X(value, otg_uint, nodesB) AND     \
  X(read, otg_node_pair, kept) AND   \
  X(read, otg_two_sums, weights) AND \
  X(read, otg_two_sums, places) AND  \
  X(value, otg_uint, count)
OTG_PART(LevelsKept)

#define OTG_GIVEN_LevelsSplit(X, AND)  \
  X(part, LevelsKept, level) AND       \
  X(value, otg_uint, begin) AND        \
  X(write, otg_place_pair, leaves) AND \
  X(value, otg_uint, leafCapacity)
OTG_STRUCTURE(LevelsSplit, "levelsSplit")

#define OTG_GIVEN_LevelsSpawn(X, AND) \
  X(part, LevelsKept, level) AND      \
  X(write, otg_node_pair, next) AND   \
  X(value, otg_uint, nextCapacity)
OTG_STRUCTURE(LevelsSpawn, "levelsSpawn")

/// `method`: OTG_REDUCE_*, of the pair.
#define OTG_GIVEN_LevelsReset(X, AND)   \
  X(value, otg_device_pair, pair) AND   \
  X(write, otg_pair_state, state) AND   \
  X(write, otg_chosen_word, chosen) AND \
  X(value, otg_uint, method)
OTG_STRUCTURE(LevelsReset, "levelsReset")

/// `leaves`: pairs of leaves of one triangle each.
#define OTG_GIVEN_LevelsNear(X, AND)  \
  X(value, otg_device_pair, pair) AND \
  X(read, otg_mesh_unit, meshes) AND  \
  X(write, otg_counter, counters) AND \
  X(read, otg_place_pair, leaves) AND \
  X(value, otg_uint, count) AND       \
  X(write, otg_hit, hits) AND         \
  X(value, otg_uint, hitCapacity)
OTG_STRUCTURE(LevelsNear, "levelsNear")

#define OTG_GIVEN_LevelsNearFused(X, AND) \
  X(value, otg_device_pair, pair) AND     \
  X(value, otg_task_pose, bInA) AND       \
  X(read, otg_mesh_unit, meshes) AND      \
  X(write, otg_counter, counters) AND     \
  X(read, otg_place_pair, leaves) AND     \
  X(value, otg_uint, count) AND           \
  X(value, otg_uint, hitCapacity) AND     \
  X(write, otg_result_byte, results)
OTG_STRUCTURE(LevelsNearFused, "levelsNear")

/// `candidates`: places of two triangles each, in their soups.
#define OTG_GIVEN_ContactsFirst(X, AND)   \
  X(value, otg_device_pair, pair) AND     \
  X(value, otg_task_pose, bInA) AND       \
  X(read, otg_mesh_unit, meshes) AND      \
  X(write, otg_counter, counters) AND     \
  X(read, otg_place_pair, candidates) AND \
  X(value, otg_uint, count) AND           \
  X(value, otg_uint, hitCapacity) AND     \
  X(write, otg_result_byte, results)
OTG_STRUCTURE(ContactsFirst, "contactsFirst")

#define OTG_GIVEN_LevelsEnd(X, AND)   \
  X(write, otg_counter, counters) AND \
  X(write, otg_result_byte, results)
OTG_STRUCTURE(LevelsEnd, "levelsEnter")

#define OTG_GIVEN_LevelsEnter(X, AND)    \
  X(write, otg_counter, counters) AND    \
  X(write, otg_result_byte, results) AND \
  X(value, otg_uint, hitCapacity) AND    \
  X(part, HitTables, tables) AND         \
  X(write, otg_pair_state, state) AND    \
  X(write, otg_chosen_word, chosen)
OTG_STRUCTURE(LevelsEnter, "levelsEnter")

/// `places` may be `values`. `sums` gets a number for each work-group, from `sumsBegin` on. Two programs have it.
#define OTG_GIVEN_ScanOnes(X, AND)      \
  X(aliasRead, otg_one_sum, values) AND \
  X(value, otg_uint, valuesBegin) AND   \
  X(alias, otg_one_sum, places) AND     \
  X(value, otg_uint, placesBegin) AND   \
  X(value, otg_uint, count) AND         \
  X(alias, otg_one_sum, sums) AND       \
  X(value, otg_uint, sumsBegin)
OTG_STRUCTURE(ScanOnes, "scanBlocks")
#define OTG_GIVEN_ScanTwos(X, AND)       \
  X(aliasRead, otg_two_sums, values) AND \
  X(value, otg_uint, valuesBegin) AND    \
  X(alias, otg_two_sums, places) AND     \
  X(value, otg_uint, placesBegin) AND    \
  X(value, otg_uint, count) AND          \
  X(alias, otg_two_sums, sums) AND       \
  X(value, otg_uint, sumsBegin)
OTG_STRUCTURE(ScanTwos, "scanBlocks")

/// `places` may be `values`. `turn`: a multiple of 4 that no scan before had for this `status`. `total[totalAt]` gets the
/// sum of all.
#define OTG_GIVEN_OnceOnes(X, AND)      \
  X(aliasRead, otg_one_sum, values) AND \
  X(alias, otg_one_sum, places) AND     \
  X(value, otg_uint, count) AND         \
  X(alias, otg_one_sum, total) AND      \
  X(value, otg_uint, totalAt) AND       \
  X(write, otg_scan_status, status) AND \
  X(write, otg_scan_ticket, ticket) AND \
  X(value, otg_uint, turn)
OTG_STRUCTURE(OnceOnes, "scanOnce")
#define OTG_GIVEN_OnceTwos(X, AND)       \
  X(aliasRead, otg_two_sums, values) AND \
  X(alias, otg_two_sums, places) AND     \
  X(value, otg_uint, count) AND          \
  X(alias, otg_two_sums, total) AND      \
  X(value, otg_uint, totalAt) AND        \
  X(write, otg_scan_status, status) AND \
  X(write, otg_scan_ticket, ticket) AND  \
  X(value, otg_uint, turn)
OTG_STRUCTURE(OnceTwos, "scanOnce")

/// `sums` has been scanned.
#define OTG_GIVEN_AddOnes(X, AND)     \
  X(write, otg_one_sum, places) AND   \
  X(value, otg_uint, placesBegin) AND \
  X(value, otg_uint, count) AND       \
  X(aliasRead, otg_one_sum, sums) AND \
  X(value, otg_uint, sumsBegin)
OTG_STRUCTURE(AddOnes, "scanAdd")
#define OTG_GIVEN_AddTwos(X, AND)      \
  X(write, otg_two_sums, places) AND   \
  X(value, otg_uint, placesBegin) AND  \
  X(value, otg_uint, count) AND        \
  X(aliasRead, otg_two_sums, sums) AND \
  X(value, otg_uint, sumsBegin)
OTG_STRUCTURE(AddTwos, "scanAdd")

#define OTG_GIVEN_MiddleStep(X, AND)       \
  X(value, otg_device_pair, pair) AND      \
  X(read, otg_mesh_unit, meshes) AND       \
  X(write, otg_step_counter, counters) AND \
  X(read, otg_node_pair, in) AND           \
  X(value, otg_uint, count) AND            \
  X(write, otg_node_pair, out) AND         \
  X(value, otg_uint, outCapacity) AND      \
  X(write, otg_number_pair, found) AND     \
  X(value, otg_uint, foundCapacity)
OTG_STRUCTURE(MiddleStep, "middleStep")

// clang-format on

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_PUBLISHED_GIVEN_H
