// SPDX-License-Identifier: BSD-3-Clause
// The contacts of the large regions of described pairs of solids: kernels/solid/large/arena.cl and what follows it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/solid/found_overlap.h"
#include "opencl/runtime/launch.h"
#include "opencl/runtime/pinned_buffer.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// What is requested of the pair of a query.
otg_overlap_task overlapTask(const Query& query);

/// Part of one lane. Functions throw ClError.
class LargeContacts {
 public:
  /// `many`: for pairs of batches.
  LargeContacts(Context& context, const Tuning& tuning, bool many);
  /// Whether contacts of a query with these options can be made on the device.
  static bool works(const Query& query, const Tuning& tuning) {
    return tuning.overlapContacts != 0 && query.refiner == nullptr &&
           query.options.solid.contactsPerRegion <= static_cast<int>(kMostOfRegion);
  }

  /// Pairs, and their descriptions on the device.
  struct Pairs {
    std::span<const otg_overlap_task> tasks;    ///< of each
    cl_mem meshes, pairs, description;          ///< as LargeStage has them
    std::uint32_t unitRoom = 0, tableRoom = 0;  ///< of the description
  };
  /// Everything after the kernels that describe the pairs.
  void enqueue(cl_command_queue queue, const Pairs& pairs, Profile& profile);
  /// Begins to read what comes of it, as much as can be foreseen, behind what is in the queue.
  void beginHead(cl_command_queue queue, Profile& profile);
  /// Waits for the queue. After that: how much the descriptions needed;
  void endHead(cl_command_queue queue);
  const otg_overlap_totals& totals() const { return sums().totals; }
  /// and whether enqueue() has to be called again, with more room or with kernels that were left out.
  bool isIncomplete();
  /// Then reads the rest.
  void readRest(cl_command_queue queue, Profile& profile);
  /// After that, until the next reading: what was found of a pair. The head is there after endHead.
  FoundContacts found(std::uint32_t pair = 0) const;
  const otg_contacts_head& head(std::uint32_t pair = 0) const {
    return reinterpret_cast<const otg_contacts_head*>(host_.data() + sizeof(otg_contacts_sums))[pair];
  }

 private:
  static constexpr std::uint32_t kMostOfRegion = 64;
  void build();
  void reserve(cl_command_queue queue);
  void read(cl_command_queue queue, std::size_t from, std::size_t bytes, Profile& profile);
  const otg_contacts_sums& sums() const { return *reinterpret_cast<const otg_contacts_sums*>(host_.data()); }
  std::size_t headBytes() const { return OTG_CONTACTS_HEADS(std::size_t{count_}); }
  std::size_t smallAt() const { return headBytes() + std::size_t{slots_} * stride_ * sizeof(otg_chosen_contact); }
  Context& context_;
  const bool isCpu_, forMany_;
  const std::uint32_t lanes_, weighGroups_;
  std::uint32_t arenaWanted_, slotsWanted_ = 0, smallWanted_;
  // Of the last run: pairs, regions in the arena, places for the contacts of one, and for hits of small regions.
  std::uint32_t count_ = 1, slots_ = 0, stride_ = 1, small_ = 0;
  std::size_t have_ = 0;  ///< bytes read
  bool turns_ = false;    ///< whether regions are expected whose ways out are looked for around the best
  struct Made {
    Kernel kernel;
    std::uint32_t group = 0;
  };
  Made list_, arena_, weigh_, ways_, turn_, candidates_, choose_;
  BufferHandle progress_;
  DeviceList tasks_{sizeof(otg_overlap_task)}, places_{sizeof(otg_uint)}, space_{OTG_ARENA_UNIT}, results_{1};
  PinnedBuffer staged_, host_;
};

}  // namespace otg::opencl
