// SPDX-License-Identifier: BSD-3-Clause
// The contacts of the large regions of a described pair of solids: kernels/overlap_arena.cl and what follows it.
#pragma once

#include <cstdint>

#include "collide/solid/found_overlap.h"
#include "opencl/launch.h"
#include "opencl/pinned_buffer.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// Part of one lane. Functions throw ClError.
class OverlapContacts {
 public:
  OverlapContacts(Context& context, const Tuning& tuning);
  /// Whether contacts of a query with these options can be made on the device.
  bool works(const Query& query) const {
    return works_ && query.options.solid.contactsPerRegion <= static_cast<int>(kMostOfRegion);
  }

  /// The pair, and its description on the device.
  struct Pair {
    const Query& query;
    cl_mem meshes, pairs, description;  ///< as OverlapStage has them
    std::uint32_t unitRoom, tableRoom;
  };
  /// Everything after the kernels that describe the pair.
  void enqueue(cl_command_queue queue, const Pair& pair, Profile& profile);
  /// Waits for the queue: what the device found, good until the next reading.
  FoundContacts read(cl_command_queue queue, Profile& profile);
  /// After that: whether enqueue() has to be called again, with more room or with kernels that were left out.
  bool isIncomplete();

 private:
  static constexpr std::uint32_t kMostOfRegion = 64;
  void build();
  void reserve(cl_command_queue queue);
  Context& context_;
  const bool isCpu_, works_;
  const std::uint32_t lanes_, registers_;
  std::uint32_t arenaWanted_, most_ = 0;
  bool turns_ = false;  ///< whether regions are expected whose ways out are looked for around the best
  struct Made {
    Kernel kernel;
    std::uint32_t group = 0;
  };
  Made arena_, weigh_, ways_, turn_, candidates_, choose_;
  BufferHandle progress_, task_;
  DeviceList space_{OTG_ARENA_UNIT}, results_{1};
  PinnedBuffer host_;
};

}  // namespace otg::opencl
