// SPDX-License-Identifier: BSD-3-Clause
// Less of the same on a slow machine.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace otg::test {

/// So many of `count` rounds as the variable OTG_TEST_PART says, from 0 to 1, such as 0.1 on an emulated processor.
/// Without it all of them; never none.
inline int partOf(int count) {
  const char* const part = std::getenv("OTG_TEST_PART");
  if (part == nullptr) return count;
  return std::max(1, static_cast<int>(count * std::clamp(std::atof(part), 0.0, 1.0)));
}

}  // namespace otg::test
