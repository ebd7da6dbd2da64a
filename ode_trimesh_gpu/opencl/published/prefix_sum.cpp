// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/prefix_sum.h"

#include <bit>
#include <string>
#include <vector>

namespace otg::opencl {
namespace {

/// Numbers of a work-item in one pass.
constexpr std::uint32_t kEach = 4;
/// Turns go up by this, and begin anew when they have come to the end.
constexpr std::uint32_t kTurn = 4, kLastTurn = 0xfffffff0;

}  // namespace

template <class Sum>
PrefixSum<Sum>::PrefixSum(Context& context, std::uint32_t group) : context_(context), group_(group) {}

template <class Sum>
auto PrefixSum<Sum>::blocks(PrefixSums way) -> Blocks& {
  const bool isTree = way == PrefixSums::kWorkEfficient;
  Blocks& blocks = isTree ? efficient_ : published_;
  if (blocks.scan) return blocks;
  // A tree has two numbers for each work-item, and a power of two of them. Blocks of scanAdd are those of the scan.
  blocks.numbers = isTree ? 2 * std::bit_floor(group_) : group_;
  const std::string two = std::string(" -DOTG_TWO_SUMS=") + (kTwo ? "1" : "0");
  const std::string numbers = " -DOTG_BLOCK=" + std::to_string(blocks.numbers);
  const std::string options = "-DOTG_GROUP=" + std::to_string(group_) + numbers + two;
  blocks.add.make(context_, "published/levels_scan.cl", options);
  blocks.scan.make(context_, isTree ? "published/levels_scan_efficient.cl" : "published/levels_scan.cl", options);
  return blocks;
}

template <class Sum>
void PrefixSum<Sum>::enqueueOnce(cl_command_queue queue, BufferOf<const Sum> values, BufferOf<Sum> places,
                                 std::uint32_t count, BufferOf<Sum> total, std::uint32_t totalAt, Profile& profile) {
  if (!once_) {
    once_.make(context_, "published/levels_scan_single.cl",
               "-DOTG_GROUP=" + std::to_string(group_) + " -DOTG_EACH=" + std::to_string(kEach) +
                   " -DOTG_TWO_SUMS=" + (kTwo ? "1" : "0"));
    ticket_.reserve(context_, 1);
    fillZero(queue, ticket_.get(), sizeof(otg_uint));
  }
  const std::uint32_t block = group_ * kEach, groups = count / block + (count % block || count == 0 ? 1 : 0);
  if (groups > status_.places() || turn_ >= kLastTurn) {
    status_.reserve(context_, std::bit_ceil(groups));
    fillZero(queue, status_.get(), std::size_t{status_.places()} * OTG_SCAN_WORDS * sizeof(otg_uint));
    turn_ = 0;
  }
  turn_ += kTurn;
  once_.give({.values = values,
              .places = places,
              .count = count,
              .total = total,
              .totalAt = totalAt,
              .status = status_.buffer(),
              .ticket = ticket_.buffer(),
              .turn = turn_});
  launch(queue, once_, group_, groups, 1, profile.next(Profile::kScan));
}

template <class Sum>
void PrefixSum<Sum>::enqueue(cl_command_queue queue, BufferOf<const Sum> values, BufferOf<Sum> places,
                             std::uint32_t count, BufferOf<Sum> total, std::uint32_t totalAt, Profile& profile,
                             PrefixSums way) {
  if (way == PrefixSums::kSinglePass) {
    enqueueOnce(queue, values, places, count, total, totalAt, profile);
    return;
  }
  Blocks& of = blocks(way);
  // One pass for each power of a block's size: what is scanned, where it begins, how much of it there is.
  struct Pass {
    cl_uint begin, count;
  };
  std::vector<Pass> passes{{0, count}};
  std::uint64_t sums = 0;
  for (std::uint32_t n = count; of.of(n) > 1; n = passes.back().count) {
    passes.push_back({static_cast<cl_uint>(sums), of.of(n)});
    sums += of.of(n);
  }
  sums_.reserve(context_, std::bit_ceil(std::max<std::uint64_t>(1, sums)));
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const bool last = i + 1 == passes.size();
    of.scan.give({.values = i == 0 ? values : sums_.buffer(),
                  .valuesBegin = passes[i].begin,
                  .places = i == 0 ? places : sums_.buffer(),
                  .placesBegin = passes[i].begin,
                  .count = passes[i].count,
                  .sums = last ? total : sums_.buffer(),
                  .sumsBegin = last ? totalAt : passes[i + 1].begin});
    launch(queue, of.scan, group_, of.of(passes[i].count), 1, profile.next(Profile::kScan));
  }
  for (std::size_t i = passes.size() - 1; i-- > 0;) {
    of.add.give({.places = i == 0 ? places : sums_.buffer(),
                 .placesBegin = passes[i].begin,
                 .count = passes[i].count,
                 .sums = sums_.buffer(),
                 .sumsBegin = passes[i + 1].begin});
    const std::uint32_t groups = passes[i].count / group_ + (passes[i].count % group_ ? 1 : 0);
    launch(queue, of.add, group_, groups, 1, profile.next(Profile::kScan));
  }
}

template class PrefixSum<otg_one_sum>;
template class PrefixSum<otg_two_sums>;

}  // namespace otg::opencl
