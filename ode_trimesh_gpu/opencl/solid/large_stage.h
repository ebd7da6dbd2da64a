// SPDX-License-Identifier: BSD-3-Clause
// The lists and kernels by which the overlaps of pairs of solids are described: of one pair by many work-groups, or of
// many pairs.
#pragma once

#include <cstdint>
#include <span>

#include "collide/solid/found_overlap.h"
#include "opencl/runtime/launch.h"
#include "opencl/runtime/pinned_buffer.h"
#include "opencl/tuning.h"
#include "shared/contacts/region_grid.h"
#include "shared/layout/overlap_layout.h"

namespace otg::opencl {

/// Part of one lane. Functions throw ClError.
class LargeStage {
 public:
  LargeStage(Context& context, const Tuning& tuning);
  /// Whether the device can, and is to.
  static bool works(Context& context, const Tuning& tuning);
  /// Whether it is worth it for a pair alone that is expected to have so many hits. Of others only the number of
  /// triangles is known.
  bool pays(std::uint32_t hits) const { return works_ && hits >= leastHits_; }
  bool paysForTriangles(std::uint64_t triangles) const { return works_ && triangles / 100 >= leastHits_; }

  /// What a lane has of its one pair when the trees were walked.
  struct Pair {
    const otg_device_pair& pair;
    const Transformd& bInA;
    const CollisionMesh &a, &b;
    cl_mem meshes, counters, hits;
    std::uint32_t hitPlaces;
    cl_mem records;  ///< get a record for each hit
    std::uint32_t hitsExpected;
  };
  /// Room for a pair of these meshes and so many hits.
  void reserve(cl_command_queue queue, const Pair& pair);
  /// Everything from the hits on. The last kernel ends the query.
  void enqueue(cl_command_queue queue, const Pair& pair, Profile& profile);

  /// What a lane has of its batch of solids when solidScatter has gathered the hits of each pair; and which pairs are
  /// to be described, with how many hits each. Meshes by pair: A, B.
  struct Batch {
    cl_mem meshes, tasks, places, states, hits;
    std::uint32_t hitPlaces;
    std::span<const otg_listed_overlap> pairs;  ///< `number` and `hits` are set
    std::span<const CollisionMesh* const> bodies;
  };
  void reserve(cl_command_queue queue, const Batch& batch);
  void enqueue(cl_command_queue queue, const Batch& batch, Profile& profile);

  /// Begins to read the results, as far as can be foreseen, behind what is in the queue.
  void beginHead(cl_command_queue queue, Profile& profile);
  /// Waits for the queue. Whether there was room for everything; if not, there will be for the next run.
  bool endHead(cl_command_queue queue);
  /// After that, until the next reading: the state of one of the pairs, as its kernels left it.
  const otg_overlap_state& head(std::uint32_t pair = 0) const;
  /// On the device: the table of pairs, and the results with room for so many units behind the heads and so many tables
  /// of large regions.
  cl_mem pairs() const { return pairs_.get(); }
  cl_mem results() const { return out_.get(); }
  std::uint32_t unitRoom() const { return static_cast<std::uint32_t>(out_.places() - headBytes() / 16); }
  std::uint32_t tableRoom() const { return cells_.places(); }
  /// As endHead says, where another caller has read the totals.
  bool fits(const otg_overlap_totals& totals);
  /// After endHead: reads what was not read yet.
  void readRest(cl_command_queue queue, Profile& profile);
  /// After that: what was found of a pair, good until the next reading.
  FoundOverlap found(std::uint32_t pair = 0) const;

 private:
  struct Sizes {
    std::uint64_t slots, inside, marks, hits;  ///< of all pairs
    std::uint32_t pairs, tables;
  };
  void build();
  void reserve(cl_command_queue queue, const Sizes& sizes);
  void enqueueRest(cl_command_queue queue, cl_mem meshes, cl_mem counters, std::size_t groups, Profile& profile);
  std::size_t headBytes() const { return OTG_OVERLAP_HEAD(std::size_t{count_}); }
  Context& context_;
  const std::uint32_t group_;
  const std::size_t mostGroups_;
  std::uint32_t leastHits_;
  bool works_;
  bool anyParts_ = false;  ///< a mesh is no solid of one component
  Kernel contour_, take_, enter_, edges_, contained_, unite_, votes_, join_, regions_, surface_, depths_, unitPlaces_,
      results_;
  std::uint32_t count_ = 1;  ///< pairs
  BufferHandle totals_;
  DeviceList tasks_{sizeof(otg_listed_overlap)}, pairs_{sizeof(otg_overlap_pair)}, states_{sizeof(otg_overlap_state)},
      crossings_{sizeof(otg_crossing)}, slots_{sizeof(otg_uint)}, hits_{sizeof(otg_overlap_hit)},
      parents_{sizeof(otg_uint)}, marks_{sizeof(otg_uint)}, balances_{sizeof(otg_int)},
      inside_{sizeof(otg_found_inside)}, cells_{OTG_GRID_KEYS * sizeof(otg_surface_cell)},
      cellList_{OTG_GRID_KEYS * sizeof(otg_uint)}, small_{sizeof(otg_found_inside)},
      depthTable_{OTG_GRID_KEYS * sizeof(otg_ulong)}, out_{16};
  PinnedBuffer staged_, host_;
  std::uint32_t outWanted_, tablesWanted_ = OTG_OVERLAP_REGIONS;
  std::uint32_t expected_ = 1u << 12;  ///< units behind the head
  std::size_t have_ = 0;               ///< bytes read
};

}  // namespace otg::opencl
