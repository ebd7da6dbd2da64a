// SPDX-License-Identifier: BSD-3-Clause
// The lists and kernels by which a lane turns contacts into the few that were requested.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "collide/query.h"
#include "opencl/results/result_buffer.h"
#include "opencl/tuning.h"
#include "shared/layout/pairwise_given.h"

namespace otg::opencl {

/// Defines OTG_WARP of contact_choose.h where the device has what it takes.
std::string warpOption(const Context& context);

/// Defines OTG_STAYS: whether work-groups with nothing to do have to go through all barriers all the same. On CPUs
/// barriers below a condition are not compiled as they should be, and cost nothing.
std::string staysOption(const Context& context);

/// Hits that one work-group keeps in local memory (contact_group.h): a power of two, `wanted` if the device can.
std::uint32_t hitsOfGroup(const Context& context, std::uint32_t wanted);
/// Options of a program for work-groups that do.
std::string groupReduction(const Context& context, std::uint32_t group, std::uint32_t hits);

/// How the device chooses contacts that are requested in this way.
otg_reduction deviceReduction(const CollideOptions& options, bool byHost);
/// The same for the model `solid`. `remembers`: the pair has a history, which holds what only the CPU knows of deep
/// regions. `pairwise`: one more than the place of deviceReduction() in the table, or 0 where the pair is of two
/// solids.
otg_reduction solidReduction(const CollideOptions& options, bool byHost, std::uint32_t pairwise);

/// Part of one lane. Functions throw ClError.
class Reducer {
 public:
  /// `single`: for one pair of meshes at a time; otherwise for batches.
  Reducer(Context& context, const Tuning& tuning, bool single);
  /// Whether this device reduces; if not, only reserveStates() and send() are of use.
  bool works() const { return static_cast<bool>(unite_); }

  void reserveStates(std::uint32_t pairs);
  /// Room for so many pairs of meshes, hits, and contacts of each pair (`places` at most).
  void reserve(cl_command_queue queue, std::uint32_t pairs, std::uint32_t hits, std::uint32_t places);
  /// Contacts that one pair can have at most.
  std::uint32_t contactsOfPair() const { return room_; }
  /// Sends the table unless it is the one that is there.
  void send(cl_command_queue queue, std::span<const otg_reduction> reductions);

  given::HitTables tables() const {
    return {.links = links_.buffer(), .tables = tables_.buffer(), .tableSize = tableSize_};
  }
  BufferOf<otg_pair_state> states() const { return states_.buffer(); }
  BufferOf<otg_reduction> reductions() const { return reductions_.buffer(); }

  /// What there is to be reduced: places in the list of hits, and pairs of meshes.
  struct Hits {
    BufferOf<const otg_mesh_unit> meshes;
    BufferOf<otg_counter> counters;
    BufferOf<otg_result_byte> records;
    std::uint32_t capacity, pairs;
  };
  /// Everything after the records are there and the hits are in their tables. `chosen` gets the results, those of a
  /// single pair `answer` (ChosenBuffer::beginAnswer).
  void enqueue(cl_command_queue queue, const Hits& hits, const ChosenBuffer& chosen, BufferOf<otg_chosen_word> answer,
               std::size_t groups, Profile& profile);

  /// Of a batch: turns the counts of contacts that follow the flags in `chosen` into places.
  void enqueuePlaces(cl_command_queue queue, std::uint32_t pairs, const ChosenBuffer& chosen, Profile& profile);

 private:
  static constexpr std::size_t kTables = 4;  ///< as in otg_links
  Context& context_;
  const std::uint32_t recordGroup_, chooseGroup_, keptPlaces_;
  const bool single_;
  std::uint32_t placeGroup_ = 0;
  KernelFor<given::UniteContacts> unite_;
  KernelFor<given::SelectContacts> select_;
  KernelFor<given::ChooseContacts> choose_;
  KernelFor<given::PlaceContacts> place_;
  KernelFor<given::WriteContacts> write_;
  ListOf<otg_link> links_{OTG_LINKS};
  ListOf<otg_table_slot> tables_{kTables};
  ListOf<otg_pair_state> states_;
  ListOf<otg_reduction> reductions_;
  ListOf<otg_kept_hit> kept_;
  ListOf<otg_root_hit> roots_;
  ListOf<otg_chosen_hit> lists_;
  std::uint32_t tableSize_ = 0, room_ = 0;
  std::vector<otg_reduction> sent_;
};

}  // namespace otg::opencl
