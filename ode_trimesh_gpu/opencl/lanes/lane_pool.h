// SPDX-License-Identifier: BSD-3-Clause
// Lanes of one kind that wait for work.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "opencl/meshes/mesh_store.h"
#include "opencl/tuning.h"

namespace otg::opencl {

/// Lanes are kept when a query is done, so that a thread finds one with its lists made. They go when others need their
/// memory.
template <class Lane>
class LanePool : private MemoryBudget::Sharer {
 public:
  LanePool(Context& context, MeshStore& meshes, const Tuning& tuning)
      : context_(context), meshes_(meshes), tuning_(tuning) {
    context_.memory().join(*this);
  }
  ~LanePool() { context_.memory().leave(*this); }
  LanePool(const LanePool&) = delete;
  LanePool& operator=(const LanePool&) = delete;
  /// Makes a lane, so that the first query finds one. Throws ClError.
  void prepare() {
    with([](Lane&) {});
  }

  /// Calls use(lane) and keeps the lane for the next one, unless that throws: then its counters may hold anything.
  template <class Use>
  void with(Use&& use) {
    std::unique_ptr<Lane> lane = take();
    const std::uint64_t before = lane->repeats();
    use(*lane);
    keep(std::move(lane), before);
  }
  /// The same in two steps. A lane that is not kept is gone.
  std::unique_ptr<Lane> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Lane> lane = std::move(idle_.back());
        idle_.pop_back();
        return lane;
      }
    }
    return std::make_unique<Lane>(context_, meshes_, tuning_);
  }
  /// `before`: its repeats() when it was taken.
  void keep(std::unique_ptr<Lane> lane, std::uint64_t before) {
    repeats_ += lane->repeats() - before;
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(lane));
  }
  std::uint64_t repeats() const { return repeats_; }

 private:
  void letGo() noexcept override {
    std::vector<std::unique_ptr<Lane>> unused;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock) unused.swap(idle_);
  }

  Context& context_;
  MeshStore& meshes_;
  const Tuning tuning_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Lane>> idle_;
  std::atomic<std::uint64_t> repeats_{0};
};

}  // namespace otg::opencl
