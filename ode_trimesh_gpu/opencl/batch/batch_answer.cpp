// SPDX-License-Identifier: BSD-3-Clause
// Where the contacts of a batch lie: BatchAnswer of backend.h.
#include "opencl/backend.h"

namespace otg::opencl {

void BatchAnswer::clear() {
  size_ = 0;
  parts_.clear();
  apart_.clear();
  refused.clear();
  leftToHost = madeAgain = 0;
  byHost.clear();
  stats = {};
}

void BatchAnswer::addPart(std::size_t begin, std::size_t count, const std::uint32_t* places, const Contact* contacts,
                          std::shared_ptr<const void> memory) {
  parts_.push_back({begin, count, places, contacts, std::move(memory)});
}

std::span<const Contact> BatchAnswer::of(std::size_t i) const {
  if (!apart_.empty()) {
    if (const auto own = apart_.find(i); own != apart_.end()) return own->second;
  }
  for (const Part& part : parts_) {
    if (i - part.begin >= part.count) continue;
    const std::uint32_t *place = part.places + 2 * (i - part.begin), count = place[1];
    if (count > 0) return {part.contacts + place[0], count};
  }
  return {};
}

std::size_t BatchAnswer::contactCount() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < size_; ++i) count += of(i).size();
  return count;
}

}  // namespace otg::opencl
