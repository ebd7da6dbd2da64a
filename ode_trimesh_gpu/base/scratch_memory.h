// SPDX-License-Identifier: BSD-3-Clause
// Memory for what lives no longer than a step of a query: taken piece by piece, given back at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <vector>

namespace otg {

/// Keeps its blocks when it is reset, so that a step that takes no more than the last one asks the heap for nothing.
/// One thread at a time.
class ScratchMemory final : public std::pmr::memory_resource {
 public:
  ScratchMemory() = default;
  ScratchMemory(const ScratchMemory&) = delete;
  ScratchMemory& operator=(const ScratchMemory&) = delete;

  /// Ends the life of everything that was taken.
  void reset() {
    block_ = 0;
    used_ = 0;
  }

 private:
  static constexpr std::size_t kFirstBlock = 16384;
  struct Block {
    std::unique_ptr<std::byte[]> bytes;
    std::size_t size;
  };

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    for (; block_ < blocks_.size(); ++block_, used_ = 0) {
      if (void* const place = takeFrom(blocks_[block_], bytes, alignment)) return place;
    }
    const std::size_t twice = blocks_.empty() ? kFirstBlock : 2 * blocks_.back().size;
    const std::size_t size = twice > bytes + alignment ? twice : bytes + alignment;
    blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size});
    return takeFrom(blocks_.back(), bytes, alignment);
  }
  /// What was taken last makes room for the next.
  void do_deallocate(void* place, std::size_t bytes, std::size_t /*alignment*/) override {
    std::byte* const begin = blocks_[block_].bytes.get();
    if (static_cast<std::byte*>(place) + bytes == begin + used_) {
      used_ = static_cast<std::size_t>(static_cast<std::byte*>(place) - begin);
    }
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  void* takeFrom(const Block& block, std::size_t bytes, std::size_t alignment) {
    const auto begin = reinterpret_cast<std::uintptr_t>(block.bytes.get());
    const std::size_t first = ((begin + used_ + alignment - 1) & ~(alignment - 1)) - begin;
    if (first > block.size || block.size - first < bytes) return nullptr;
    used_ = first + bytes;
    return block.bytes.get() + first;
  }

  std::vector<Block> blocks_;
  std::size_t block_ = 0, used_ = 0;  ///< where the next piece is looked for
};

}  // namespace otg
