// SPDX-License-Identifier: BSD-3-Clause
// When a lane has its device decide in exact arithmetic.
#pragma once

#include <algorithm>
#include <cstdint>

namespace otg::opencl {

/// Whether a lane's next query is to decide on the device, in exact arithmetic, what double arithmetic leaves open: for
/// a while after one that left something open. As a rule nothing is, and the kernels for it cost a launch.
class ExactNeed {
 public:
  bool isExpected() const { return queries_ > 0; }
  /// After each query: whether it left something open.
  void take(bool any) { queries_ = any ? kQueries : queries_ - std::min(queries_, 1u); }

 private:
  static constexpr std::uint32_t kQueries = 64;
  std::uint32_t queries_ = 0;
};

}  // namespace otg::opencl
