// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/prefix_sum.h"

#include <bit>
#include <string>
#include <vector>

namespace otg::opencl {

PrefixSum::PrefixSum(Context& context, std::uint32_t group, Of what)
    : context_(context), group_(group), sums_(what == Of::kUint ? sizeof(cl_uint) : sizeof(cl_uint2)) {
  const std::string options =
      "-DOTG_GROUP=" + std::to_string(group) + " -DOTG_SUM=" + (what == Of::kUint ? "uint" : "uint2");
  scan_ = context.makeKernel("published/levels_scan.cl", options, "scanBlocks");
  add_ = context.makeKernel("published/levels_scan.cl", options, "scanAdd");
}

void PrefixSum::enqueue(cl_command_queue queue, cl_mem values, cl_mem places, std::uint32_t count, cl_mem total,
                        std::uint32_t totalAt, Profile& profile) {
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
    const cl_mem from = i == 0 ? values : sums_.get(), to = i == 0 ? places : sums_.get();
    Arguments(scan_) << from << passes[i].begin << to << passes[i].begin << passes[i].count
                     << (last ? total : sums_.get()) << (last ? totalAt : passes[i + 1].begin);
    launch(queue, scan_, group_, blocks(passes[i].count), 1, profile.next(Profile::kScan));
  }
  for (std::size_t i = passes.size() - 1; i-- > 0;) {
    const cl_mem to = i == 0 ? places : sums_.get();
    Arguments(add_) << to << passes[i].begin << passes[i].count << sums_.get() << passes[i + 1].begin;
    launch(queue, add_, group_, blocks(passes[i].count), 1, profile.next(Profile::kScan));
  }
}

}  // namespace otg::opencl
