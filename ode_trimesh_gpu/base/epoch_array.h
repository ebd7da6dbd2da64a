// SPDX-License-Identifier: BSD-3-Clause
// Scratch values for the indices of a mesh's vertices or triangles: an array that is cleared without touching its
// memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace otg {

class EpochArray {
 public:
  static constexpr std::uint32_t kMissing = 0xffffffffu;

  /// Forgets every value; afterwards indices below `size` may be used.
  void reset(std::size_t size) {
    if (++epoch_ == 0) {  // wrapped: values of 2^32 resets ago would look alive
      slots_.assign(slots_.size(), 0);
      epoch_ = 1;
    }
    if (slots_.size() < size) slots_.resize(size, 0);
  }
  std::uint32_t find(std::size_t i) const {
    const std::uint64_t slot = slots_[i];
    return slot >> 32 == epoch_ ? static_cast<std::uint32_t>(slot) : kMissing;
  }
  void prefetch(std::size_t i) const { __builtin_prefetch(&slots_[i]); }
  bool has(std::size_t i) const { return slots_[i] >> 32 == epoch_; }
  void set(std::size_t i, std::uint32_t value) { slots_[i] = std::uint64_t{epoch_} << 32 | value; }

 private:
  std::vector<std::uint64_t> slots_;  ///< epoch, value
  std::uint32_t epoch_ = 0;
};

}  // namespace otg
