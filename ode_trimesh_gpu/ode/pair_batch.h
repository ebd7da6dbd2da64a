// SPDX-License-Identifier: BSD-3-Clause
// Many pairs of geoms, read at one moment, computed at once, and told of later.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "ode/pair_task.h"
#include "ode_trimesh_gpu/batch.h"

namespace otg {

/// Geoms may move and be destroyed, and their meshes be rebuilt, while run() is at work.
class PairBatch {
 public:
  /// Reads the geoms, which are of our class or dTriMeshes. With `capacity` 0 each pair has as many contacts as its
  /// geoms allow. Throws std::bad_alloc.
  PairBatch(std::span<const dGpuTriMeshPair> pairs, int capacity, bool unimportant);
  /// Computes. Any thread, once. Throws std::bad_alloc.
  void run();

  std::size_t pairCount() const { return tasks_.size(); }
  const PairTask& task(std::size_t i) const { return tasks_[i]; }
  /// After run(); empty for a pair with nothing to do.
  PairResult& result(std::size_t i) { return results_[i]; }
  std::size_t contactCount() const;

  /// What the collision of each pair leaves with its geoms, in the order of the pairs. Once. Throws std::bad_alloc.
  void remember();

 private:
  std::vector<PairTask> tasks_;
  std::vector<PairResult> results_;
  std::vector<std::shared_ptr<const void>> alive_;  ///< what the tasks point to
};

/// Whether ODE would ask about them: not one geom, not two of one body.
bool isPairInOde(dGeomID o1, dGeomID o2);

}  // namespace otg
