// SPDX-License-Identifier: BSD-3-Clause
// Something that is made when it is needed first, by who needs it.
#pragma once

#include <atomic>
#include <memory>

namespace otg {

/// The owner needs not know what T is: only make() does. Any number of threads.
template <class T>
class OwnedLater {
 public:
  OwnedLater() = default;
  ~OwnedLater() {
    if (T* const made = get(); made != nullptr) destroy_(made);
  }
  OwnedLater(const OwnedLater&) = delete;
  OwnedLater& operator=(const OwnedLater&) = delete;

  /// Null unless it was made.
  T* get() const noexcept { return made_.load(std::memory_order_acquire); }

  /// Throws what making one throws.
  T& make() {
    if (T* const made = get(); made != nullptr) return *made;
    auto made = std::make_unique<T>();
    T* other = nullptr;
    if (!made_.compare_exchange_strong(other, made.get(), std::memory_order_acq_rel)) return *other;
    destroy_ = [](T* it) { delete it; };
    return *made.release();
  }

 private:
  std::atomic<T*> made_{nullptr};
  void (*destroy_)(T*) = nullptr;
};

}  // namespace otg
