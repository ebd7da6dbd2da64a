// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/prefix_sum.h"

#include <bit>
#include <string>
#include <vector>

namespace otg::opencl {

template <class Sum>
PrefixSum<Sum>::PrefixSum(Context& context, std::uint32_t group) : context_(context), group_(group) {
  const std::string options = "-DOTG_GROUP=" + std::to_string(group) + " -DOTG_TWO_SUMS=" + (kTwo ? "1" : "0");
  scan_.make(context, "published/levels_scan.cl", options);
  add_.make(context, "published/levels_scan.cl", options);
}

template <class Sum>
void PrefixSum<Sum>::enqueue(cl_command_queue queue, BufferOf<const Sum> values, BufferOf<Sum> places,
                             std::uint32_t count, BufferOf<Sum> total, std::uint32_t totalAt, Profile& profile) {
  // One pass for each power of the group's size: what is scanned, where it begins, how much of it there is.
  struct Pass {
    cl_uint begin, count;
  };
  std::vector<Pass> passes{{0, count}};
  std::uint64_t sums = 0;
  for (std::uint32_t n = count; blocks(n) > 1; n = passes.back().count) {
    passes.push_back({static_cast<cl_uint>(sums), blocks(n)});
    sums += blocks(n);
  }
  sums_.reserve(context_, std::bit_ceil(std::max<std::uint64_t>(1, sums)));
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const bool last = i + 1 == passes.size();
    scan_.give({.values = i == 0 ? values : sums_.buffer(),
                .valuesBegin = passes[i].begin,
                .places = i == 0 ? places : sums_.buffer(),
                .placesBegin = passes[i].begin,
                .count = passes[i].count,
                .sums = last ? total : sums_.buffer(),
                .sumsBegin = last ? totalAt : passes[i + 1].begin});
    launch(queue, scan_, group_, blocks(passes[i].count), 1, profile.next(Profile::kScan));
  }
  for (std::size_t i = passes.size() - 1; i-- > 0;) {
    add_.give({.places = i == 0 ? places : sums_.buffer(),
               .placesBegin = passes[i].begin,
               .count = passes[i].count,
               .sums = sums_.buffer(),
               .sumsBegin = passes[i + 1].begin});
    launch(queue, add_, group_, blocks(passes[i].count), 1, profile.next(Profile::kScan));
  }
}

template class PrefixSum<otg_one_sum>;
template class PrefixSum<otg_two_sums>;

}  // namespace otg::opencl
