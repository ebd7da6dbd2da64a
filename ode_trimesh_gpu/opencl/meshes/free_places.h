// SPDX-License-Identifier: BSD-3-Clause
// What is free of a buffer in which many things lie side by side.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace otg::opencl {

/// Gaps between what is taken, by place and by size. Every function but clear() takes O(log n) steps for n gaps.
/// Gaps that touch are one. One thread at a time.
class FreePlaces {
 public:
  /// Takes `count` places (1 or more) from the smallest gap that has them, the first of several: where they begin.
  /// Throws std::bad_alloc, and nothing is taken.
  std::optional<std::uint32_t> take(std::uint32_t count);
  /// The other way round. Throws std::bad_alloc, and the places stay taken.
  void giveBack(std::uint32_t begin, std::uint32_t count);
  /// So many places more, behind the last one. Throws std::bad_alloc.
  void grow(std::uint32_t count);
  /// None at all.
  void clear() noexcept;

  std::uint32_t capacity() const { return capacity_; }
  std::uint32_t free() const { return free_; }
  std::size_t gaps() const { return bySize_.size(); }

 private:
  using BySize = std::set<std::pair<std::uint32_t, std::uint32_t>>;  ///< size and begin
  void join(std::uint32_t begin, std::uint32_t end);

  BySize bySize_;
  std::map<std::uint32_t, std::uint32_t> byPlace_;  ///< begin to end
  std::uint32_t capacity_ = 0, free_ = 0;
};

}  // namespace otg::opencl
