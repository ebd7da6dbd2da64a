// SPDX-License-Identifier: BSD-3-Clause
// Counts many readers or one writer of an object, without anybody waiting.
#pragma once

#include <atomic>

namespace otg {

/// Held by queries while they read an object, and by who changes it. A program must not have both at once; where it
/// does, the one that comes second gets an error.
class UseCount {
 public:
  /// False while the object is being changed; then nothing is held.
  bool beginUse() noexcept {
    int uses = uses_.load(std::memory_order_relaxed);
    while (uses >= 0) {
      if (uses_.compare_exchange_weak(uses, uses + 1, std::memory_order_acquire, std::memory_order_relaxed))
        return true;
    }
    return false;
  }
  void endUse() noexcept { uses_.fetch_sub(1, std::memory_order_release); }
  /// False while the object is being read or changed; then nothing is held.
  bool beginChange() noexcept {
    int none = 0;
    return uses_.compare_exchange_strong(none, -1, std::memory_order_acquire, std::memory_order_relaxed);
  }
  void endChange() noexcept { uses_.store(0, std::memory_order_release); }

 private:
  std::atomic<int> uses_{0};  ///< those who read, or -1 while it is changed
};

/// The hold of who changes an object; null: of nothing, which succeeds.
class ChangeHold {
 public:
  explicit ChangeHold(UseCount* count) : held_(count), good_(count == nullptr || count->beginChange()) {}
  ~ChangeHold() {
    if (good_ && held_ != nullptr) held_->endChange();
  }
  ChangeHold(const ChangeHold&) = delete;
  ChangeHold& operator=(const ChangeHold&) = delete;
  bool good() const { return good_; }

 private:
  UseCount* held_;
  bool good_;
};

/// The hold of who reads an object; null: of nothing, which succeeds.
class UseHold {
 public:
  explicit UseHold(UseCount* count) : held_(count), good_(count == nullptr || count->beginUse()) {}
  ~UseHold() {
    if (good_ && held_ != nullptr) held_->endUse();
  }
  UseHold(const UseHold&) = delete;
  UseHold& operator=(const UseHold&) = delete;
  bool good() const { return good_; }

 private:
  UseCount* held_;
  bool good_;
};

}  // namespace otg
