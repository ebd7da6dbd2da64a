// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums on a device (kernels/published/levels_scan.cl), of any length.
#pragma once

#include <cstdint>
#include <type_traits>

#include "opencl/runtime/given.h"
#include "shared/layout/published_given.h"

namespace otg::opencl {

/// Part of one lane. `Sum`: otg_one_sum or otg_two_sums. Functions throw ClError.
template <class Sum>
class PrefixSum {
 public:
  /// `group`: how many numbers a work-group scans, 2 at least.
  PrefixSum(Context& context, std::uint32_t group);

  /// places[i] becomes the sum of values[0] to values[i - 1], and total[totalAt] the sum of all `count`. 32-bit
  /// arithmetic, which wraps. `places` may be `values`.
  void enqueue(cl_command_queue queue, BufferOf<const Sum> values, BufferOf<Sum> places, std::uint32_t count,
               BufferOf<Sum> total, std::uint32_t totalAt, Profile& profile);

 private:
  std::uint32_t blocks(std::uint32_t count) const { return count / group_ + (count % group_ || count == 0 ? 1 : 0); }

  static constexpr bool kTwo = std::is_same_v<Sum, otg_two_sums>;
  Context& context_;
  const std::uint32_t group_;
  KernelFor<std::conditional_t<kTwo, given::ScanTwos, given::ScanOnes>> scan_;
  KernelFor<std::conditional_t<kTwo, given::AddTwos, given::AddOnes>> add_;
  ListOf<Sum> sums_;  ///< of work-groups, of groups of these, and so on, one after the other
};

}  // namespace otg::opencl
