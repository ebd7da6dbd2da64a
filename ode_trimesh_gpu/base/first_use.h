// SPDX-License-Identifier: BSD-3-Clause
// What is computed on the first request, by any of several threads.
#pragma once

#include <atomic>
#include <mutex>
#include <utility>

namespace otg {

/// get() may be called by any number of threads at once; all else by the only one that holds the object.
template <class T>
class FirstUse {
 public:
  /// Throws what `make` throws; the next call makes it again.
  template <class Make>
  const T& get(Make&& make) const {
    if (!made_.load(std::memory_order_acquire)) {
      const std::lock_guard lock(mutex_);
      if (!made_.load(std::memory_order_relaxed)) {
        value_ = make();
        made_.store(true, std::memory_order_release);
      }
    }
    return value_;
  }
  void set(T value) {
    value_ = std::move(value);
    made_.store(true, std::memory_order_release);
  }
  /// To be made again.
  void reset() noexcept { made_.store(false, std::memory_order_release); }
  /// Null unless it was made.
  T* made() { return made_.load(std::memory_order_acquire) ? &value_ : nullptr; }

 private:
  mutable std::atomic<bool> made_{false};
  mutable std::mutex mutex_;
  mutable T value_{};
};

}  // namespace otg
