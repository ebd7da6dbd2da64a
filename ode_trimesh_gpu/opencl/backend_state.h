// SPDX-License-Identifier: BSD-3-Clause
// What a backend holds.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>

#include "collide/rotation_tolerance.h"
#include "opencl/lanes/batch_lane.h"
#include "opencl/lanes/distance_lane.h"
#include "opencl/lanes/lane_pool.h"
#include "opencl/lanes/overlap_lane.h"
#include "opencl/lanes/pair_lane.h"
#include "opencl/lanes/point_lane.h"
#include "opencl/lanes/ray_lane.h"
#include "opencl/published/levels_lane.h"
#include "opencl/published/phase_lane.h"
#include "opencl/runtime/log.h"
#include "opencl/runtime/stop.h"

namespace otg::opencl {

/// Any number of threads.
struct BackendState {
  Context context;
  const Tuning tuning;
  MeshStore meshes;
  LanePool<PairLane> pairs, profiled;
  LanePool<BatchLane> batches, profiledBatches;
  LanePool<OverlapLane> overlaps, profiledOverlaps;
  LanePool<PhaseLane> phases;
  LanePool<PointLane> points;
  LanePool<RayLane> rays;
  LanePool<DistanceLane> distances;
  SoupPlaces soupPlaces;
  MeshStore binaryMeshes;  ///< of the traversal `levels`, which is for comparing: beside the others
  LanePool<LevelsLane> levels, profiledLevels;
  std::atomic<std::uint64_t> queries{0}, onHost{0}, leftToHost{0}, decidedOnHost{0}, described{0}, describedInVain{0},
      contactsMade{0}, contactsLeft{0};
  std::atomic<std::uint64_t> pointsAsked{0}, pointsOnHost{0}, raysCast{0}, raysOnHost{0}, distancesAsked{0},
      distancesOnHost{0};

  BackendState(const FoundDevice& device, const Tuning& how)
      : context(device, ProgramCache::standard(), how.doubles),
        tuning(how),
        meshes(context, how.memoryBudget != 0 ? how.memoryBudget : device.info.globalMemory / 2, how.leafTriangles,
               MeshLayout::kEightWide, how.cutOrder),
        pairs(context, meshes, tuning),
        profiled(context, meshes, withProfile(how)),
        batches(context, meshes, tuning),
        profiledBatches(context, meshes, withProfile(how)),
        overlaps(context, meshes, tuning),
        profiledOverlaps(context, meshes, withProfile(how)),
        phases(context, meshes, tuning),
        points(context, meshes, tuning),
        rays(context, meshes, tuning),
        distances(context, meshes, tuning),
        soupPlaces(how.leafTriangles),
        binaryMeshes(context, how.memoryBudget != 0 ? how.memoryBudget : device.info.globalMemory / 4, 1,
                     MeshLayout::kBinary),
        levels(context, binaryMeshes, tuning),
        profiledLevels(context, binaryMeshes, withProfile(how)) {
    if (isStoppable()) {
      context.programs().loadCompiler();
      tellLoaded();
    }
    if (!how.warmUp) return;
    meshes.prepare();
    pairs.prepare();
    batches.prepare();
    if (!context.info().doubles) return;
    points.prepare();
    rays.prepare();
  }
  /// Whether contacts are reduced on the device.
  bool reduces() const { return context.info().doubles && tuning.reduce; }
  static Tuning withProfile(Tuning how) {
    how.profile = true;
    return how;
  }
};

inline void logError(const ClError& error) {
  logFailure(error.call(), error.code(), error.what());
}

/// Whether the query is one that otg::collide refuses by an exception.
inline bool isRefused(const Query& query) {
  const Vec3d& t = query.bInA.t;
  return !std::isfinite(t.x) || !std::isfinite(t.y) || !std::isfinite(t.z) ||
         !(rotationDefect(query.bInA) <= kRelativeRotationTolerance);
}

/// Whether there is nothing that a device could do: the host knows what to answer.
inline bool isIdleQuery(const Query& query, const PairFrame& frame) {
  return query.a->tree().nodes.empty() || query.b->tree().nodes.empty() || !frame.finite;
}

}  // namespace otg::opencl
