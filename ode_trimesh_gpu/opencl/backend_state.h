// SPDX-License-Identifier: BSD-3-Clause
// What a backend holds.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>

#include "opencl/batch/workspace_pool.h"
#include "opencl/lanes/array_lane.h"
#include "opencl/lanes/batch_lane.h"
#include "opencl/lanes/distance_lane.h"
#include "opencl/lanes/lane_pool.h"
#include "opencl/lanes/overlap_lane.h"
#include "opencl/lanes/pair_lane.h"
#include "opencl/runtime/stop.h"

namespace otg::opencl {

class PublishedDesign;

/// Any number of threads.
struct BackendState {
  Context context;
  const Tuning tuning;
  MeshStore meshes;
  LanePool<PairLane> pairs, profiled;
  LanePool<BatchLane> batches, profiledBatches;
  LanePool<OverlapLane> overlaps, profiledOverlaps;
  LanePool<PointLane> points;
  LanePool<RayLane> rays;
  LanePool<DistanceLane> distances;
  WorkspacePool workspaces;
  std::mutex publishedMutex;
  std::shared_ptr<PublishedDesign> published;  ///< null until it is used; made by backend_published.cpp alone
  std::atomic<std::uint64_t> queries{0}, onHost{0}, leftToHost{0}, decidedOnHost{0}, described{0}, describedInVain{0},
      contactsMade{0}, contactsLeft{0};
  std::atomic<std::uint64_t> pointsAsked{0}, pointsOnHost{0}, raysCast{0}, raysOnHost{0}, distancesAsked{0},
      distancesOnHost{0};

  BackendState(const FoundDevice& device, const Tuning& how)
      : context(device, ProgramCache::standard(), how.doubles,
                how.memoryBudget != 0 ? how.memoryBudget : device.info.globalMemory / 2),
        tuning(how),
        meshes(context,
               std::make_shared<MemoryBudget>(how.meshBudget != 0 ? how.meshBudget : context.memory().bytes() / 2),
               how.leafTriangles, MeshLayout::kEightWide, how.cutOrder),
        pairs(context, meshes, tuning),
        profiled(context, meshes, withProfile(how)),
        batches(context, meshes, tuning),
        profiledBatches(context, meshes, withProfile(how)),
        overlaps(context, meshes, tuning),
        profiledOverlaps(context, meshes, withProfile(how)),
        points(context, meshes, tuning),
        rays(context, meshes, tuning),
        distances(context, meshes, tuning) {
    if (isStoppable()) {
      context.programs().loadCompiler();
      tellLoaded();
    }
    if (!how.warmUp) return;
    meshes.prepare();
    pairs.prepare();
    batches.prepare();
    if (!context.info().doubles) return;
    prepareIfItBuilds(points);
    prepareIfItBuilds(rays);
  }
  /// A feature whose program does not build is not there; the device is.
  template <class Lane>
  void prepareIfItBuilds(LanePool<Lane>& pool) {
    const std::size_t before = context.programs().failedCount();
    try {
      pool.prepare();
    } catch (const ClError& error) {
      if (context.programs().failedCount() == before) throw;
      logError(error);
    }
  }
  /// Whether the device has what this takes.
  bool makesSolids() { return tuning.solid && !context.programs().hasFailed("solid/small/"); }
  bool answersArrays(const char* program) { return context.info().doubles && !context.programs().hasFailed(program); }
  /// Whether contacts are reduced on the device.
  bool reduces() const { return context.info().doubles && tuning.reduce; }
  static Tuning withProfile(Tuning how) {
    how.profile = true;
    return how;
  }
};

}  // namespace otg::opencl
