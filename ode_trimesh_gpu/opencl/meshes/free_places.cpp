// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/meshes/free_places.h"

#include <iterator>

namespace otg::opencl {

std::optional<std::uint32_t> FreePlaces::take(std::uint32_t count) {
  const auto gap = bySize_.lower_bound({count, 0});
  if (gap == bySize_.end()) return std::nullopt;
  const auto [size, begin] = *gap;
  if (size > count) {
    // The rest of the gap keeps its end, so nothing new is needed but its other key.
    auto sized = bySize_.extract(gap);
    sized.value() = {size - count, begin + count};
    bySize_.insert(std::move(sized));
    auto placed = byPlace_.extract(begin);
    placed.key() = begin + count;
    byPlace_.insert(std::move(placed));
  } else {
    bySize_.erase(gap);
    byPlace_.erase(begin);
  }
  free_ -= count;
  return begin;
}

void FreePlaces::giveBack(std::uint32_t begin, std::uint32_t count) {
  join(begin, begin + count);
  free_ += count;
}

void FreePlaces::grow(std::uint32_t count) {
  if (count == 0) return;
  join(capacity_, capacity_ + count);
  capacity_ += count;
  free_ += count;
}

void FreePlaces::clear() noexcept {
  bySize_.clear();
  byPlace_.clear();
  capacity_ = free_ = 0;
}

/// A new gap, one with those that it touches.
void FreePlaces::join(std::uint32_t begin, std::uint32_t end) {
  const auto next = byPlace_.find(end);
  auto before = byPlace_.lower_bound(begin);
  before = before != byPlace_.begin() && std::prev(before)->second == begin ? std::prev(before) : byPlace_.end();
  const std::uint32_t from = before != byPlace_.end() ? before->first : begin;
  const std::uint32_t to = next != byPlace_.end() ? next->second : end;
  const auto sized = bySize_.insert({to - from, from}).first;
  if (before != byPlace_.end()) {
    bySize_.erase({begin - from, from});
    before->second = to;
  } else {
    try {
      byPlace_.emplace(from, to);
    } catch (...) {
      bySize_.erase(sized);
      throw;
    }
  }
  if (next != byPlace_.end()) {
    bySize_.erase({to - end, end});
    byPlace_.erase(next);
  }
}

}  // namespace otg::opencl
