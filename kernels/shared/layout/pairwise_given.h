// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of kernels/pairwise/ are given.
#ifndef OTG_SHARED_PAIRWISE_GIVEN_H
#define OTG_SHARED_PAIRWISE_GIVEN_H
#include "shared/layout/walk_given.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Words of OTG_LINKS arrays, each as long as the list of hits; of four hash tables.
OTG_WORD_ELEMENT(otg_link)
OTG_WORD_ELEMENT(otg_table_slot)
/// Hits: contacts that may stay, regions that have contacts.
OTG_WORD_ELEMENT(otg_kept_hit)
OTG_WORD_ELEMENT(otg_root_hit)
/// A hit that was chosen and its region's number.
OTG_TWO_WORD_ELEMENT(otg_chosen_hit)

// clang-format off

/// The hits of one pair, and their records.
#define OTG_GIVEN_PairHits(X, AND)    \
  X(value, otg_device_pair, pair) AND \
  X(value, otg_task_pose, bInA) AND   \
  X(read, otg_mesh_unit, meshes) AND  \
  X(write, otg_counter, counters) AND \
  X(read, otg_hit, hits) AND          \
  X(value, otg_uint, hitCapacity) AND \
  X(write, otg_result_byte, results)
OTG_PART(PairHits)

/// The hits of all pairs of a batch, and their records.
#define OTG_GIVEN_BatchHits(X, AND)      \
  X(read, otg_batch_pair, pairs) AND     \
  X(read, otg_device_mesh, places) AND   \
  X(read, otg_batch_task, tasks) AND     \
  X(read, otg_mesh_unit, meshes) AND     \
  X(write, otg_counter, counters) AND    \
  X(read, otg_batch_hit, hits) AND       \
  X(value, otg_uint, hitCapacity) AND    \
  X(write, otg_result_byte, results) AND \
  X(write, otg_chosen_word, chosen)
OTG_PART(BatchHits)

/// Where hits are entered: see otg_links. `tableSize`: slots of each table.
#define OTG_GIVEN_HitTables(X, AND)    \
  X(alias, otg_link, links) AND        \
  X(alias, otg_table_slot, tables) AND \
  X(value, otg_uint, tableSize)
OTG_PART(HitTables)

#define OTG_GIVEN_PairResults(X, AND) \
  X(part, PairHits, found) AND        \
  X(value, otg_uint, decides)
OTG_STRUCTURE(PairResults, "pairResults")

#define OTG_GIVEN_PairResultsEntered(X, AND) \
  X(part, PairHits, found) AND               \
  X(value, otg_uint, decides) AND            \
  X(part, HitTables, tables) AND             \
  X(write, otg_pair_state, state) AND        \
  X(write, otg_chosen_word, chosen)
OTG_STRUCTURE(PairResultsEntered, "pairResults")

#define OTG_GIVEN_PairDecide(X, AND) \
  X(part, PairHits, found)
OTG_STRUCTURE(PairDecide, "pairDecide")

#define OTG_GIVEN_PairDecideEntered(X, AND) \
  X(part, PairHits, found) AND              \
  X(part, HitTables, tables) AND            \
  X(write, otg_pair_state, state) AND       \
  X(write, otg_chosen_word, chosen)
OTG_STRUCTURE(PairDecideEntered, "pairDecide")

/// `answer` may be `chosen`.
#define OTG_GIVEN_PairReduce(X, AND)        \
  X(part, PairHits, found) AND              \
  X(read, otg_reduction, reductions) AND    \
  X(aliasRead, otg_chosen_word, chosen) AND \
  X(alias, otg_chosen_word, answer)
OTG_STRUCTURE(PairReduce, "pairReduce")

#define OTG_GIVEN_BatchResults(X, AND) \
  X(part, BatchHits, found) AND        \
  X(value, otg_uint, decides)
OTG_STRUCTURE(BatchResults, "batchResults")

#define OTG_GIVEN_BatchResultsEntered(X, AND) \
  X(part, BatchHits, found) AND               \
  X(value, otg_uint, decides) AND             \
  X(part, HitTables, tables) AND              \
  X(write, otg_pair_state, states)
OTG_STRUCTURE(BatchResultsEntered, "batchResults")

#define OTG_GIVEN_BatchDecide(X, AND) \
  X(part, BatchHits, found)
OTG_STRUCTURE(BatchDecide, "batchDecide")

#define OTG_GIVEN_BatchDecideEntered(X, AND) \
  X(part, BatchHits, found) AND              \
  X(part, HitTables, tables) AND             \
  X(write, otg_pair_state, states)
OTG_STRUCTURE(BatchDecideEntered, "batchDecide")

/// `pairCount`, `contactRoom`: pairs and contacts that `chosen` has places for.
#define OTG_GIVEN_BatchReduce(X, AND)    \
  X(read, otg_mesh_unit, meshes) AND     \
  X(write, otg_counter, counters) AND    \
  X(value, otg_uint, hitCapacity) AND    \
  X(read, otg_result_byte, results) AND  \
  X(read, otg_pair_state, states) AND    \
  X(read, otg_reduction, reductions) AND \
  X(read, otg_listed_pair, list) AND     \
  X(value, otg_uint, listed) AND         \
  X(value, otg_uint, least) AND          \
  X(write, otg_chosen_word, chosen) AND  \
  X(value, otg_uint, pairCount) AND      \
  X(value, otg_uint, contactRoom) AND    \
  X(value, otg_uint, only) AND           \
  X(value, otg_uint, last)
OTG_STRUCTURE(BatchReduce, "batchReduce")

/// `decided`: records that solidRecords made.
#define OTG_GIVEN_SolidPairwise(X, AND)   \
  X(read, otg_batch_pair, pairs) AND      \
  X(read, otg_device_mesh, places) AND    \
  X(read, otg_batch_task, tasks) AND      \
  X(read, otg_mesh_unit, meshes) AND      \
  X(read, otg_counter, counters) AND      \
  X(read, otg_batch_hit, hits) AND        \
  X(value, otg_uint, hitCapacity) AND     \
  X(read, otg_result_byte, decided) AND   \
  X(write, otg_result_byte, contacts) AND \
  X(read, otg_chosen_word, chosen)
OTG_STRUCTURE(SolidPairwise, "solidPairwise")

/// Hits in their tables, with their records. `capacity`: places in the list of hits.
#define OTG_GIVEN_EnteredHits(X, AND)    \
  X(write, otg_result_byte, records) AND \
  X(alias, otg_link, links) AND          \
  X(alias, otg_table_slot, tables) AND   \
  X(value, otg_uint, tableSize) AND      \
  X(value, otg_uint, capacity)
OTG_PART(EnteredHits)

#define OTG_GIVEN_UniteContacts(X, AND)  \
  X(read, otg_mesh_unit, meshes) AND     \
  X(read, otg_counter, counters) AND     \
  X(part, EnteredHits, hits) AND         \
  X(read, otg_pair_state, states) AND    \
  X(read, otg_reduction, reductions) AND \
  X(read, otg_chosen_word, results)
OTG_STRUCTURE(UniteContacts, "uniteContacts")

#define OTG_GIVEN_SelectContacts(X, AND) \
  X(read, otg_counter, counters) AND     \
  X(part, EnteredHits, hits) AND         \
  X(write, otg_pair_state, states) AND   \
  X(read, otg_reduction, reductions) AND \
  X(read, otg_chosen_word, results) AND  \
  X(write, otg_kept_hit, kept) AND       \
  X(write, otg_root_hit, roots)
OTG_STRUCTURE(SelectContacts, "selectContacts")

/// `chosenRoom`: places of each pair in `chosen`. `answer` may be `results`.
#define OTG_GIVEN_ChooseContacts(X, AND) \
  X(read, otg_mesh_unit, meshes) AND     \
  X(write, otg_counter, counters) AND    \
  X(part, EnteredHits, hits) AND         \
  X(alias, otg_pair_state, states) AND   \
  X(read, otg_reduction, reductions) AND \
  X(alias, otg_kept_hit, kept) AND       \
  X(alias, otg_root_hit, roots) AND      \
  X(write, otg_chosen_hit, chosen) AND   \
  X(value, otg_uint, chosenRoom) AND     \
  X(alias, otg_chosen_word, results) AND \
  X(alias, otg_chosen_word, answer)
OTG_STRUCTURE(ChooseContacts, "chooseContacts")

#define OTG_GIVEN_PlaceContacts(X, AND) \
  X(value, otg_uint, pairs) AND         \
  X(write, otg_chosen_word, results)
OTG_STRUCTURE(PlaceContacts, "placeContacts")

/// `chosenRoom` as above; `contactRoom`: contacts that `results` has places for.
#define OTG_GIVEN_WriteContacts(X, AND)  \
  X(read, otg_mesh_unit, meshes) AND     \
  X(write, otg_counter, counters) AND    \
  X(part, EnteredHits, hits) AND         \
  X(read, otg_pair_state, states) AND    \
  X(read, otg_chosen_hit, chosen) AND    \
  X(value, otg_uint, chosenRoom) AND     \
  X(value, otg_uint, pairs) AND          \
  X(write, otg_chosen_word, results) AND \
  X(value, otg_uint, contactRoom)
OTG_STRUCTURE(WriteContacts, "writeContacts")

// clang-format on

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_PAIRWISE_GIVEN_H
