// SPDX-License-Identifier: BSD-3-Clause
// The lists and kernels by which the overlap of one pair of solids is described, by many work-groups.
#pragma once

#include <cstdint>

#include "collide/solid/found_overlap.h"
#include "opencl/launch.h"
#include "opencl/pinned_buffer.h"
#include "opencl/tuning.h"
#include "shared/overlap_layout.h"

namespace otg::opencl {

/// Part of one lane. Functions throw ClError.
class OverlapStage {
 public:
  OverlapStage(Context& context, const Tuning& tuning);
  /// Whether the device can.
  bool works() const { return works_; }
  /// Whether it is worth it for a pair that is expected to have so many hits, or of which only the number of triangles
  /// is known.
  bool pays(std::uint32_t hits) const { return works_ && hits >= leastHits_; }
  bool paysForTriangles(std::uint64_t triangles) const { return works_ && triangles / 100 >= leastHits_; }

  /// What a lane has of its pair when the trees were walked.
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
  /// Waits for the queue: the head of the results, good until the next reading.
  const otg_overlap_state* readHead(cl_command_queue queue, Profile& profile);
  const otg_overlap_state* head() const { return reinterpret_cast<const otg_overlap_state*>(host_.data()); }
  /// After readHead: whether there was room for the results; if not, there will be for the next run.
  bool fits();
  /// After that: all of the results, good until the next query.
  FoundOverlap readRest(cl_command_queue queue, Profile& profile);

 private:
  void build();
  void read(cl_command_queue queue, std::size_t bytes, Profile& profile);
  Context& context_;
  const std::uint32_t group_, registers_;
  const std::size_t mostGroups_;
  std::uint32_t leastHits_;
  bool works_;
  Kernel contour_, edges_, unite_, regions_, surface_, depths_, results_;
  otg_overlap_sizes sizes_{};
  BufferHandle state_;
  DeviceList crossings_{sizeof(otg_crossing)}, slots_{sizeof(otg_uint)}, hits_{sizeof(otg_overlap_hit)},
      parents_{sizeof(otg_uint)}, marks_{sizeof(otg_uint)}, vertices_{sizeof(otg_found_inside)},
      clusters_{sizeof(otg_found_inside)}, cells_{sizeof(otg_surface_cell)}, cellList_{sizeof(otg_uint)},
      small_{sizeof(otg_found_inside)}, depthTable_{sizeof(otg_ulong)}, out_{16};
  PinnedBuffer host_;
  std::uint32_t outWanted_, expected_ = 1u << 12;  ///< units behind the head
  std::size_t have_ = 0;                           ///< bytes read
};

}  // namespace otg::opencl
