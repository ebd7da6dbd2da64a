// SPDX-License-Identifier: BSD-3-Clause
// Meshes resident on a device: uploaded once, evicted least recently used first; where vertices move, followed.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "bvh/collision_mesh.h"
#include "collide/pair_frame.h"
#include "opencl/meshes/free_places.h"
#include "opencl/meshes/packed_mesh.h"
#include "opencl/meshes/packed_motion.h"
#include "opencl/run_parts.h"
#include "opencl/runtime/context.h"
#include "opencl/runtime/given.h"
#include "opencl/runtime/memory_budget.h"
#include "shared/layout/meshes_given.h"

namespace otg::opencl {

/// The box frame for a device. Devices may take numbers smaller than the smallest normal float for zero: some forty
/// roundings of 1.2e-38 at most.
inline BoxFrame<float> deviceBoxes(const PairFrame& frame) {
  BoxFrame<float> boxes = frame.boxes;
  boxes.eps += 1e-36f;
  return boxes;
}

/// All meshes of one context lie in one buffer, so that a kernel that works on many pairs reaches all of them. Any
/// thread.
class MeshStore : private MemoryBudget::Sharer {
 public:
  /// `budget`: of what the buffer takes; `leafTriangles`: most triangles of a leaf of the trees; `cutOrder`: as in
  /// Tuning.
  MeshStore(Context& context, std::shared_ptr<MemoryBudget> budget, std::uint32_t leafTriangles,
            MeshLayout layout = MeshLayout::kEightWide, std::uint32_t cutOrder = 0);
  ~MeshStore();
  MeshStore(const MeshStore&) = delete;
  MeshStore& operator=(const MeshStore&) = delete;

  /// Makes the kernel that updates need, which the first of them would do. Throws ClError.
  void prepare();

  struct Resident {
    otg_device_mesh place{};
    std::uint32_t begin = 0, units = 0;  ///< of 16 bytes
    std::atomic<int> pins{0};
    const void* key = nullptr;                   ///< CollisionMesh::structureKey()
    std::weak_ptr<const void> structure;         ///< of that mesh
    std::uint64_t moves = 0;                     ///< CollisionMesh::moves() of what lies there
    std::shared_ptr<const PackedPlaces> places;  ///< of a mesh that has moved
  };

  /// Meshes that stay where they are as long as this lives. The store lives longer.
  class Pinned {
   public:
    Pinned() = default;
    Pinned(Pinned&&) noexcept = default;
    Pinned& operator=(Pinned&& other) noexcept {
      std::swap(buffer_, other.buffer_);
      std::swap(meshes_, other.meshes_);
      return *this;
    }
    ~Pinned() {
      for (Resident* const mesh : meshes_) {
        if (mesh != nullptr) --mesh->pins;
      }
    }
    cl_mem buffer() const { return buffer_->get(); }
    BufferOf<const otg_mesh_unit> units() const { return BufferOf<const otg_mesh_unit>(buffer_->get()); }
    const otg_device_mesh& operator[](std::size_t i) const { return meshes_[i]->place; }
    /// Null for a mesh that had not moved when it was packed: it lies there as packMesh() would put it.
    const PackedPlaces* places(std::size_t i) const { return meshes_[i]->places.get(); }

   private:
    friend class MeshStore;
    std::shared_ptr<const BufferHandle> buffer_;  ///< a later one may be larger; this one keeps what it holds
    std::vector<Resident*> meshes_;               ///< null: not there yet
  };

  /// Uploads what is not there, and what has changed of what is. No mesh is empty. Meshes are packed by `threads`, if
  /// there are any, while other queries go on. Throws ClError, with CL_MEM_OBJECT_ALLOCATION_FAILURE when the budget
  /// cannot hold these meshes beside the ones that are pinned; nothing is pinned then.
  Pinned acquire(std::span<const CollisionMesh* const> meshes, const RunParts* threads = nullptr);

  struct Counts {
    /// Whole meshes that were sent, changes of resident ones, meshes that made room; bytes of the first two.
    std::uint64_t uploads = 0, updates = 0, evictions = 0, bytesUploaded = 0;
    std::uint64_t bytesUsed = 0, bytesHeld = 0;  ///< by meshes now; by the buffer
    /// Writes of whole meshes, which may be several to a write; meshes that were looked at to make room.
    std::uint64_t writes = 0, steps = 0;
  };
  Counts counts() const;
  std::uint32_t leafTriangles() const { return leafTriangles_; }
  const std::shared_ptr<MemoryBudget>& budget() const { return budget_; }

 private:
  using Residents = std::list<Resident>;
  /// A mesh on its way to the device.
  struct Parcel {
    const CollisionMesh* mesh;
    PackedMesh packed;
    Residents::iterator resident;
  };
  Pinned tryAcquire(std::span<const CollisionMesh* const> meshes, const RunParts* threads);
  bool startAnew();
  bool isAnyInUse() const;
  void forgetAll() noexcept;
  bool pin(const CollisionMesh& mesh, Resident*& pinned);
  void pack(std::span<Parcel> parcels, Residents& residents, const RunParts* threads) const;
  void upload(std::span<Parcel> parcels, Residents& residents, std::uint64_t later);
  void write(std::span<Parcel> parcels);
  bool update(const CollisionMesh& mesh, Resident& resident);
  void send(const PackedChanges& changes, std::uint32_t begin);
  Residents::iterator drop(Residents::iterator it);
  void free(const Resident& resident);
  void makeRoom(std::uint64_t units);
  std::uint32_t allocate(std::uint32_t units);
  bool grow(std::uint64_t units);
  bool evictOne();
  /// All meshes and the buffer, if no query has any of them.
  void letGo() noexcept override;
  void forgetDead();
  void forgetOutdated();

  Context& context_;
  const std::shared_ptr<MemoryBudget> budget_;
  const std::uint64_t mostUnits_;
  const std::uint32_t leafTriangles_, cutOrder_;
  const MeshLayout layout_;
  /// Holds the mutex. What is made meanwhile may request this store to let go, by its own thread.
  class Lock {
   public:
    explicit Lock(const MeshStore& store) : lock_(store.mutex_), isBusy_(store.isBusy_) { isBusy_ = true; }
    ~Lock() { isBusy_ = false; }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

   private:
    const std::lock_guard<std::mutex> lock_;
    std::atomic<bool>& isBusy_;
  };
  mutable std::mutex mutex_;
  mutable std::atomic<bool> isBusy_{false};
  QueueHandle queue_;
  std::shared_ptr<const BufferHandle> buffer_;
  FreePlaces places_;                       ///< units of the buffer
  KernelFor<given::ScatterUnits> scatter_;  ///< made by prepare() or the first update
  ListOf<MeshUnit> sent_;                   ///< changes on their way
  std::vector<MeshUnit> sending_;
  Residents residents_;  ///< the least recently used first
  Residents outdated_;   ///< of meshes that have moved while these were pinned
  std::unordered_map<const void*, Residents::iterator> byMesh_;
  std::uint64_t sinceSweep_ = 0;  ///< meshes that were placed since forgetDead()
  Counts counts_;
};

}  // namespace otg::opencl
