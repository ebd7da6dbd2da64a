// SPDX-License-Identifier: BSD-3-Clause
// Bytes of one device's memory that lists, results and stores of meshes share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace otg::opencl {

/// Any thread.
class MemoryBudget {
 public:
  /// One of those who share it.
  class Sharer {
   public:
    /// Gives back what it holds, unless that is in use at the moment. Does not wait.
    virtual void letGo() noexcept = 0;

   protected:
    virtual ~Sharer() = default;
  };

  explicit MemoryBudget(std::uint64_t bytes) : bytes_(bytes) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t left() const {
    const std::lock_guard lock(mutex_);
    return bytes_ - held_;
  }
  std::uint64_t held() const {
    const std::lock_guard lock(mutex_);
    return held_;
  }
  /// False if so much is not left; nothing is taken then.
  bool take(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    if (bytes > bytes_ - held_) return false;
    held_ += bytes;
    return true;
  }
  void giveBack(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    held_ -= bytes;
  }

  /// Between join() and leave() others may have it let go.
  void join(Sharer& sharer) {
    const std::lock_guard lock(sharersMutex_);
    sharers_.push_back(&sharer);
  }
  void leave(Sharer& sharer) {
    const std::lock_guard lock(sharersMutex_);
    std::erase(sharers_, &sharer);
  }
  /// Has all others let go. Whether there are others.
  bool askOthers(const Sharer& asker) {
    const std::lock_guard lock(sharersMutex_);
    for (Sharer* sharer : sharers_) {
      if (sharer != &asker) sharer->letGo();
    }
    return sharers_.size() > 1;
  }
  /// Has all of them let go.
  void askAll() {
    const std::lock_guard lock(sharersMutex_);
    for (Sharer* sharer : sharers_) sharer->letGo();
  }

 private:
  const std::uint64_t bytes_;
  mutable std::mutex mutex_;
  std::uint64_t held_ = 0;
  std::mutex sharersMutex_;
  std::vector<Sharer*> sharers_;
};

/// Bytes of a budget that a sharer has taken; given back when this goes.
class MemoryShare {
 public:
  MemoryShare() = default;
  MemoryShare(std::shared_ptr<MemoryBudget> budget, std::uint64_t bytes) : budget_(std::move(budget)), bytes_(bytes) {}
  MemoryShare(MemoryShare&&) noexcept = default;
  MemoryShare& operator=(MemoryShare&& other) noexcept {
    std::swap(budget_, other.budget_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~MemoryShare() {
    if (budget_) budget_->giveBack(bytes_);
  }

 private:
  std::shared_ptr<MemoryBudget> budget_;
  std::uint64_t bytes_ = 0;
};

}  // namespace otg::opencl
