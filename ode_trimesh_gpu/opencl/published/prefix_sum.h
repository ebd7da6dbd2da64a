// SPDX-License-Identifier: BSD-3-Clause
// Exclusive prefix sums on a device (kernels/published/levels_scan*.cl), of any length.
#pragma once

#include <cstdint>
#include <type_traits>

#include "opencl/published/levels.h"
#include "opencl/runtime/given.h"
#include "shared/layout/published_given.h"

namespace otg::opencl {

/// Part of one lane. `Sum`: otg_one_sum or otg_two_sums. Functions throw ClError.
template <class Sum>
class PrefixSum {
 public:
  /// `group`: work-items of a work-group, 2 at least.
  PrefixSum(Context& context, std::uint32_t group);

  /// places[i] becomes the sum of values[0] to values[i - 1], and total[totalAt] the sum of all `count`. 32-bit
  /// arithmetic, which wraps. `places` may be `values`. Kernels of a way are built when it is first used.
  void enqueue(cl_command_queue queue, BufferOf<const Sum> values, BufferOf<Sum> places, std::uint32_t count,
               BufferOf<Sum> total, std::uint32_t totalAt, Profile& profile, PrefixSums way = PrefixSums::kPublished);

 private:
  static constexpr bool kTwo = std::is_same_v<Sum, otg_two_sums>;
  using ScanKernel = KernelFor<std::conditional_t<kTwo, given::ScanTwos, given::ScanOnes>>;
  using AddKernel = KernelFor<std::conditional_t<kTwo, given::AddTwos, given::AddOnes>>;
  using OnceKernel = KernelFor<std::conditional_t<kTwo, given::OnceTwos, given::OnceOnes>>;
  /// The sums of blocks of numbers, of blocks of these, and so on.
  struct Blocks {
    std::uint32_t numbers = 0;  ///< of a block
    ScanKernel scan;
    AddKernel add;
    std::uint32_t of(std::uint32_t count) const { return count / numbers + (count % numbers || count == 0 ? 1 : 0); }
  };
  Blocks& blocks(PrefixSums way);
  void enqueueOnce(cl_command_queue queue, BufferOf<const Sum> values, BufferOf<Sum> places, std::uint32_t count,
                   BufferOf<Sum> total, std::uint32_t totalAt, Profile& profile);

  Context& context_;
  const std::uint32_t group_;
  Blocks published_, efficient_;
  OnceKernel once_;
  ListOf<Sum> sums_;  ///< of work-groups, of groups of these, and so on, one after the other
  ListOf<otg_scan_status> status_{OTG_SCAN_WORDS};
  ListOf<otg_scan_ticket> ticket_;
  std::uint32_t turn_ = 0;
};

}  // namespace otg::opencl
