// SPDX-License-Identifier: BSD-3-Clause
// Many pairs of geoms, read at one moment, computed at once, and reported later.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "dispatch/threads/thread_pool.h"
#include "ode/pairs/pair_task.h"
#include "ode_trimesh_gpu/batch.h"

namespace otg {

/// What is requested of all pairs of a batch.
struct PairBatchRequest {
  int capacity = 0;          ///< contacts of a pair at most; 0: as many as its geoms allow
  bool unimportant = false;  ///< ODE's CONTACTS_UNIMPORTANT
  /// Whether the geoms are known to be alive and meshes, of our class or dTriMeshes; else that is found out.
  bool known = false;
};

/// Geoms may move and be destroyed, and their meshes be rebuilt, while run() is at work. The dispatcher's threads help
/// with all of it.
class PairBatch {
 public:
  /// Reads the geoms. Throws std::bad_alloc.
  PairBatch(std::span<const dGpuTriMeshPair> pairs, const PairBatchRequest& request);
  ~PairBatch();
  PairBatch(const PairBatch&) = delete;
  PairBatch& operator=(const PairBatch&) = delete;

  /// False if one of the geoms is no mesh. Then nothing was changed, and nothing else is to be called.
  bool areMeshes() const { return areMeshes_; }

  /// Computes. Any thread, once. Throws std::bad_alloc.
  void run();

  std::size_t pairCount() const { return count_; }
  const PairTask& task(std::size_t i) const { return blocks_[i / kBlock]->tasks[i % kBlock]; }
  /// After run(); empty for a pair with nothing to do.
  PairResult& result(std::size_t i) { return blocks_[i / kBlock]->results[i % kBlock]; }
  const PairResult& result(std::size_t i) const { return blocks_[i / kBlock]->results[i % kBlock]; }
  /// Whether there is nothing to compute, because the pair's contacts were kept.
  bool isKept(std::size_t i) const { return kinds_[i] == Kind::kKept; }
  /// After run(). Stays when pairs are let go.
  std::size_t contactCount() const { return firsts_.back(); }
  /// After run(): how many contacts the pairs have that come before those of the part that pair `i` is the first of, as
  /// forParts() gives it.
  std::size_t contactsBefore(std::size_t i) const { return firsts_[i / kBlock]; }

  /// What the collision of each pair leaves with its geoms, as if they had collided in the order of the pairs. Once.
  /// Throws std::bad_alloc.
  void remember() {
    rememberHistories();
    count({});
  }
  /// The same; and each part of the pairs is given to `write`, as forParts() does. Then it is released, and has no
  /// results any more.
  void remember(const ThreadPool::Work& write) {
    rememberHistories();
    count(write);
  }

  /// Calls work(begin, end) for parts of the pairs, by the dispatcher's threads.
  void forParts(const ThreadPool::Work& work) const;

 private:
  static constexpr std::size_t kBlock = 64;
  /// Pairs that one thread reads; memory that it makes and that another may free.
  struct Block {
    PairTask tasks[kBlock];
    PairResult results[kBlock];
    std::shared_ptr<const GeomObject> objects[2 * kBlock];  ///< what the tasks point to
    /// Few of them twice: counting shares of a few meshes in thousands of pairs keeps threads waiting for each other.
    std::vector<std::shared_ptr<const CollisionMesh>> meshes;
    std::vector<SolidHistory> histories;  ///< of tasks, which point to them: room for all is made at once
  };
  enum class Kind : std::uint8_t { kNone, kJob, kKept, kAsks, kLater };
  static constexpr std::uint8_t kNobody = 255;
  struct Found {
    bool areMeshes = true, areAllJobs = true, anyLater = false;
  };

  /// Any thread.
  Found readPart(std::size_t begin, std::span<const dGpuTriMeshPair> pairs);
  static void takeBusy(MeshGeom&& side1, MeshGeom&& side2, PairTask& task);
  /// What a task gets once its geoms were read. Whether there is anything to compute: its contacts may be kept.
  bool finishReading(std::size_t i);
  /// The caller's thread, which calls the program's callbacks.
  Kind readLater(std::size_t i, const dGpuTriMeshPair& pair);
  /// Takes out of a result what belongs to other geoms than the pair's.
  void keepOwnOf(std::size_t i);
  /// By whose memory, if the collision of pair `i` changes anything there: pairs of one memory have one number.
  std::uint8_t ownerOf(std::size_t i) const;
  void rememberHistories();
  /// For the next query of that pair, if it is where it is now: after rememberHistories(), which gives tasks the stamps
  /// of what is remembered now.
  void keepResult(std::size_t i) const;
  void count(const ThreadPool::Work& write);

  std::size_t count_;
  PairBatchRequest request_;
  bool areMeshes_ = true;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<Kind> kinds_;
  std::vector<PairWork> work_;        ///< of those that are jobs
  std::vector<std::uint8_t> owners_;  ///< ownerOf()
  bool anyOwner_ = false;             ///< other than kNobody
  std::vector<std::size_t> firsts_;   ///< number of the first contact of each block, and of all contacts
  BatchEnd end_;
};

/// Where the contacts of an array go: those of pair i from place i * `places` on, and how many they are.
struct PairArrays {
  int places = 0;  ///< of each pair, no fewer than its contacts
  dContactGeom* contact = nullptr;
  int skip = 0;  ///< bytes from one place to the next
  int* counts = nullptr;
};

/// PairBatch::remember(), which lets go of all pairs, and their contacts as ODE's.
void rememberInto(PairBatch& batch, const PairArrays& to);

/// A number of contacts as the C API has it: no more than fit.
int toInt(std::size_t count);

/// Whether ODE would report them: not one geom, not two of one body.
bool isPairInOde(dGeomID o1, dGeomID o2);

}  // namespace otg
