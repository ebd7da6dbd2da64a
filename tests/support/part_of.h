// SPDX-License-Identifier: BSD-3-Clause
// Less of the same on a slow machine, or where there is little time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace otg::test {

/// So many of `count` rounds as the variable OTG_TEST_PART says, from 0 to 1, such as 0.1 on an emulated processor.
/// Without it all of them; never none.
inline int partOf(int count) {
  const char* const part = std::getenv("OTG_TEST_PART");
  if (part == nullptr) return count;
  return std::max(1, static_cast<int>(count * std::clamp(std::atof(part), 0.0, 1.0)));
}

/// Whether round `n` of a long list is one of such a part: each k-th round is, beginning with k - 1.
inline bool isInPart(std::uint64_t n) {
  const auto k = static_cast<std::uint64_t>(1000 / partOf(1000));
  return n % k == k - 1;
}

}  // namespace otg::test
