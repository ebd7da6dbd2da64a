// SPDX-License-Identifier: BSD-3-Clause
// The published design on one device: its traversal by levels, its narrow phase, and queries of which
// one phase runs there. Beside the
// rooms of the backend, which reaches it in one place: opencl/backend_published.cpp.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>

#include "collide/query.h"
#include "opencl/lanes/lane_pool.h"
#include "opencl/published/levels.h"
#include "opencl/published/levels_lane.h"
#include "opencl/published/middle_lane.h"
#include "opencl/published/near_lane.h"

namespace otg::opencl {

/// Any number of threads. Nothing of it is on the device before the first query, and it throws no ClError. Every
/// function gives what the CPU gives, byte for byte, and returns false when the device failed and the CPU did the
/// work.
class PublishedDesign {
 public:
  struct Counters {
    std::atomic<std::uint64_t>&queries, &onHost;
  };
  /// `meshes`: the backend's, whose trees one phase alone goes through.
  PublishedDesign(Context& context, MeshStore& meshes, const Tuning& tuning, Counters counters);
  PublishedDesign(const PublishedDesign&) = delete;
  PublishedDesign& operator=(const PublishedDesign&) = delete;

  /// As otg::collide and otg::findIntersectingPairs, by levels; the exceptions, too. `report`, which may be null, says
  /// what happened, with times if `profile`.
  bool collideByLevels(const Query& query, Workspace& workspace, const LevelsOptions& how = {},
                       LevelsReport* report = nullptr, bool profile = false);
  bool findPairsByLevels(const Query& query, Workspace& workspace, const LevelsOptions& how = {},
                         LevelsReport* report = nullptr);

  /// One phase on the device, the other one is the caller's: as otg::middlePhase, with pairs of triangles of the
  /// device's leaves, in any order;
  bool findCandidates(const Query& query, Workspace& workspace);
  /// the same by levels;
  bool findCandidatesByLevels(const Query& query, Workspace& workspace, const LevelsOptions& how = {},
                              LevelsReport* report = nullptr, bool profile = false);
  /// as otg::nearPhase, for candidates from anywhere;
  bool decideCandidates(const Query& query, Workspace& workspace, NearOrder order = NearOrder::kFilterFirst);
  /// and all that follows a mid phase: workspace.candidates -> workspace.reduced, as otg::collide leaves it. The
  /// device makes contacts of the model `pairwise` where it has doubles.
  bool collideCandidates(const Query& query, Workspace& workspace, NearOrder order = NearOrder::kFilterFirst,
                         NearReport* report = nullptr, bool profile = false);

  /// Runs that were repeated because a list was too short.
  std::uint64_t repeats() const;
  /// Of the meshes for levels.
  MeshStore::Counts meshCounts() const;

 private:
  /// Meshes with binary trees, in a store that shares the budget of the other one.
  struct Levels {
    MeshStore meshes;
    LanePool<LevelsLane> lanes, profiled;
    Levels(Context& context, const std::shared_ptr<MemoryBudget>& budget, const Tuning& tuning);
  };
  /// Lanes for candidates from anywhere.
  struct Near {
    LanePool<NearLane> lanes, profiled;
    Near(Context& context, MeshStore& meshes, const Tuning& tuning);
  };
  /// Decides workspace.candidates, with contacts and their regions if `contacts`; whether these are there. Throws
  /// ClError.
  bool decide(const Query& query, Workspace& workspace, NearOrder order, bool contacts, bool profile,
              NearReport& report);
  /// Made when first requested. Throws ClError.
  Levels& levels();
  const Levels* levelsIfMade() const;

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  const Counters counters_;
  LanePool<MiddleLane> middle_;
  Near near_;
  mutable std::mutex mutex_;
  std::unique_ptr<Levels> levels_;
};

}  // namespace otg::opencl
