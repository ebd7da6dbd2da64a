// SPDX-License-Identifier: BSD-3-Clause
// Many pairs of geoms, read at one moment, computed at once, and told of later.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "dispatch/thread_pool.h"
#include "ode/pair_task.h"
#include "ode_trimesh_gpu/batch.h"

namespace otg {

/// Geoms may move and be destroyed, and their meshes be rebuilt, while run() is at work. The dispatcher's threads help
/// with all of it.
class PairBatch {
 public:
  /// Reads the geoms, which are of our class or dTriMeshes. With `capacity` 0 each pair has as many contacts as its
  /// geoms allow. Throws std::bad_alloc.
  PairBatch(std::span<const dGpuTriMeshPair> pairs, int capacity, bool unimportant);
  ~PairBatch();
  PairBatch(const PairBatch&) = delete;
  PairBatch& operator=(const PairBatch&) = delete;

  /// Computes. Any thread, once. Throws std::bad_alloc.
  void run();

  std::size_t pairCount() const { return count_; }
  const PairTask& task(std::size_t i) const { return blocks_[i / kBlock]->tasks[i % kBlock]; }
  /// After run(); empty for a pair with nothing to do.
  PairResult& result(std::size_t i) { return blocks_[i / kBlock]->results[i % kBlock]; }
  const PairResult& result(std::size_t i) const { return blocks_[i / kBlock]->results[i % kBlock]; }
  /// After run().
  std::size_t contactCount() const { return contactCount_; }

  /// What the collision of each pair leaves with its geoms, as if they had collided in the order of the pairs. Once.
  /// Throws std::bad_alloc.
  void remember();

  /// Calls work(begin, end) for parts of the pairs, by the dispatcher's threads.
  void forParts(const ThreadPool::Work& work) const;

 private:
  static constexpr std::size_t kBlock = 64;
  /// Pairs that one thread reads; memory that it makes and that another may free.
  struct Block {
    PairTask tasks[kBlock];
    PairResult results[kBlock];
    std::shared_ptr<const GeomObject> objects[2 * kBlock];  ///< what the tasks point to
    /// Each once: counting shares of a few meshes in thousands of pairs keeps threads waiting for each other.
    std::vector<std::shared_ptr<const CollisionMesh>> meshes;
    void hold(const MeshSide& side);
  };
  enum class Kind : std::uint8_t { kNone, kJob, kAsks, kLater };

  Kind read(std::size_t i, const dGpuTriMeshPair& pair, int capacity, bool unimportant, bool mayAsk);

  std::size_t count_, contactCount_ = 0;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<Kind> kinds_;
  std::vector<std::uint8_t> owners_;  ///< pairs of one memory have one number here
};

/// Whether ODE would ask about them: not one geom, not two of one body.
bool isPairInOde(dGeomID o1, dGeomID o2);

}  // namespace otg
