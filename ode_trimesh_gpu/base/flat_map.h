// SPDX-License-Identifier: BSD-3-Clause
// A map from 64-bit keys to 32-bit values for scratch use: open addressing, cleared without touching its memory.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "base/hash.h"

namespace otg {

class FlatMap {
 public:
  static constexpr std::uint32_t kMissing = 0xffffffffu;

  explicit FlatMap(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : slots_(memory) {}

  void clear() {
    size_ = 0;
    if (++epoch_ == 0) {  // wrapped: entries of 2^32 clears ago would look alive
      slots_.assign(slots_.size(), {});
      epoch_ = 1;
    }
  }
  std::uint32_t find(std::uint64_t key) const {
    if (slots_.empty()) return kMissing;
    for (std::size_t i = spreadBits(key) & mask();; i = (i + 1) & mask()) {
      if (slots_[i].epoch != epoch_) return kMissing;
      if (slots_[i].key == key) return slots_[i].value;
    }
  }
  /// The value of the key, set to `value` first if the key is new. The reference holds until the next insertion.
  std::uint32_t& insert(std::uint64_t key, std::uint32_t value, bool* inserted = nullptr) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    for (std::size_t i = spreadBits(key) & mask();; i = (i + 1) & mask()) {
      Slot& slot = slots_[i];
      if (slot.epoch != epoch_) {
        slot = {key, value, epoch_};
        ++size_;
        if (inserted) *inserted = true;
        return slot.value;
      }
      if (slot.key == key) {
        if (inserted) *inserted = false;
        return slot.value;
      }
    }
  }
  std::size_t size() const { return size_; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t value = 0;
    std::uint32_t epoch = 0;
  };
  std::size_t mask() const { return slots_.size() - 1; }
  void grow() {
    std::pmr::vector<Slot> old(slots_.empty() ? 64 : 2 * slots_.size(), slots_.get_allocator());
    old.swap(slots_);
    const std::uint32_t live = epoch_;
    epoch_ = 1;
    size_ = 0;
    for (const Slot& slot : old) {
      if (slot.epoch == live && live != 0) insert(slot.key, slot.value);
    }
  }
  std::pmr::vector<Slot> slots_;
  std::size_t size_ = 0;
  std::uint32_t epoch_ = 1;
};

}  // namespace otg
