// SPDX-License-Identifier: BSD-3-Clause
// Memory for what lives no longer than a step of a query: taken piece by piece, given back at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <vector>

namespace otg {

/// Keeps its blocks when it is reset, so that a step that takes no more than the last one takes nothing from the heap.
/// One thread at a time.
class ScratchMemory final : public std::pmr::memory_resource {
 public:
  ScratchMemory() = default;
  ScratchMemory(const ScratchMemory&) = delete;
  ScratchMemory& operator=(const ScratchMemory&) = delete;

  /// Ends the life of everything that was taken.
  void reset() {
    if (!blocks_.empty()) begin(0);
  }

 private:
  static constexpr std::size_t kFirstBlock = 16384;
  struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size;
  };

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (void* const place = take(bytes, alignment)) return place;
    return takeFromNext(bytes, alignment);
  }
  /// What was taken last makes room for the next.
  void do_deallocate(void* place, std::size_t bytes, std::size_t /*alignment*/) override {
    const auto first = reinterpret_cast<std::uintptr_t>(place);
    if (first + bytes == next_) next_ = first;
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  /// From the block in use; null where there is no room.
  void* take(std::size_t bytes, std::size_t alignment) {
    const std::uintptr_t first = (next_ + alignment - 1) & ~(alignment - 1);
    if (first > end_ || end_ - first < bytes) return nullptr;
    next_ = first + bytes;
    return reinterpret_cast<void*>(first);
  }
  [[gnu::noinline]] void* takeFromNext(std::size_t bytes, std::size_t alignment) {
    while (block_ + 1 < blocks_.size()) {
      begin(block_ + 1);
      if (void* const place = take(bytes, alignment)) return place;
    }
    const std::size_t twice = blocks_.empty() ? kFirstBlock : 2 * blocks_.back().size;
    const std::size_t size = std::max(twice, bytes + alignment);
    blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size});
    begin(blocks_.size() - 1);
    return take(bytes, alignment);
  }
  void begin(std::size_t block) {
    block_ = block;
    next_ = reinterpret_cast<std::uintptr_t>(blocks_[block].bytes.get());
    end_ = next_ + blocks_[block].size;
  }

  std::vector<Block> blocks_;
  std::size_t block_ = 0;              ///< in use, if there are blocks
  std::uintptr_t next_ = 1, end_ = 0;  ///< the bytes of it that are free; before the first block not even none
};

}  // namespace otg
