// SPDX-License-Identifier: BSD-3-Clause
// Scratch values for the indices of a mesh's vertices or triangles: an array that is cleared without touching its
// memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace otg {

class EpochArray {
 public:
  static constexpr std::uint32_t kMissing = 0xffffffffu;

  /// Forgets every value; afterwards indices below `size` may be used. Throws std::bad_alloc.
  void reset(std::size_t size) {
    // Wrapped: values of 2^32 resets ago would look alive.
    if (++epoch_ != 0 && size <= size_) return;
    size = std::max(size, size_);
    size_ = 0;
    // Zeros that the system has ready: a first query of a large mesh touches few of them.
    slots_.reset(static_cast<std::uint64_t*>(std::calloc(std::max<std::size_t>(size, 1), sizeof(std::uint64_t))));
    if (slots_ == nullptr) throw std::bad_alloc();
    size_ = size;
    epoch_ = 1;
  }
  std::uint32_t find(std::size_t i) const {
    const std::uint64_t slot = slots_[i];
    return slot >> 32 == epoch_ ? static_cast<std::uint32_t>(slot) : kMissing;
  }
  void prefetch(std::size_t i) const { __builtin_prefetch(&slots_[i]); }
  bool has(std::size_t i) const { return slots_[i] >> 32 == epoch_; }
  void set(std::size_t i, std::uint32_t value) { slots_[i] = std::uint64_t{epoch_} << 32 | value; }

 private:
  struct Free {
    void operator()(std::uint64_t* slots) const { std::free(slots); }
  };
  std::unique_ptr<std::uint64_t[], Free> slots_;  ///< epoch, value
  std::size_t size_ = 0;
  std::uint32_t epoch_ = 0;
};

}  // namespace otg
