// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums on a device (kernels/published/levels_scan.cl), of any length.
#pragma once

#include <cstdint>

#include "opencl/runtime/launch.h"

namespace otg::opencl {

/// Part of one lane. Functions throw ClError.
class PrefixSum {
 public:
  enum class Of { kUint, kUint2 };
  /// `group`: how many numbers a work-group scans, 2 at least.
  PrefixSum(Context& context, std::uint32_t group, Of what);

  /// places[i] becomes the sum of values[0] to values[i - 1], and total[totalAt] the sum of all `count`. 32-bit
  /// arithmetic, which wraps. `places` may be `values`.
  void enqueue(cl_command_queue queue, cl_mem values, cl_mem places, std::uint32_t count, cl_mem total,
               std::uint32_t totalAt, Profile& profile);

 private:
  std::uint32_t blocks(std::uint32_t count) const { return count / group_ + (count % group_ || count == 0 ? 1 : 0); }

  Context& context_;
  const std::uint32_t group_;
  Kernel scan_, add_;
  DeviceList sums_;  ///< of work-groups, of groups of these, and so on, one after the other
};

}  // namespace otg::opencl
