// SPDX-License-Identifier: BSD-3-Clause
// Sums of which a few terms can change, at a cost that follows their number. They equal a sum over everything to the
// last bit.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace otg {

/// A sum in a fixed order: of each kBlock neighbours first, then of each kGroup of these, then of all.
class BlockSum {
 public:
  static constexpr std::size_t kBlock = 16, kGroup = 64;
  void add(double x) {
    block_ += x;
    if (++count_ % kBlock != 0) return;
    group_ += block_;
    block_ = 0;
    if (count_ % (kBlock * kGroup) != 0) return;
    total_ += group_;
    group_ = 0;
  }
  double total() const { return total_ + (group_ + block_); }

 private:
  double block_ = 0, group_ = 0, total_ = 0;
  std::size_t count_ = 0;
};

/// The same sum with its parts kept. A term is requested by its number: `term(i)`.
class KeptBlockSum {
 public:
  template <class Term>
  void build(std::size_t count, Term&& term) {
    count_ = count;
    blocks_.assign((count + BlockSum::kBlock - 1) / BlockSum::kBlock, 0);
    groups_.assign((blocks_.size() + BlockSum::kGroup - 1) / BlockSum::kGroup, 0);
    for (std::size_t b = 0; b < blocks_.size(); ++b) sumBlock(b, term);
    for (std::size_t g = 0; g < groups_.size(); ++g) sumGroup(g);
  }
  /// After the terms in `changed` (their numbers) have changed. Overwrites the list.
  template <class Term>
  void update(std::vector<std::uint32_t>& changed, Term&& term) {
    reduce(changed, BlockSum::kBlock);
    for (const std::uint32_t b : changed) sumBlock(b, term);
    reduce(changed, BlockSum::kGroup);
    for (const std::uint32_t g : changed) sumGroup(g);
  }
  double total() const {
    // Whole groups go to the total by themselves; the last one, if it is not whole, as the sum of its parts.
    double total = 0;
    for (const double g : groups_) total += g;
    return total;
  }

 private:
  static void reduce(std::vector<std::uint32_t>& numbers, std::size_t by) {
    for (std::uint32_t& n : numbers) n /= static_cast<std::uint32_t>(by);
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }
  template <class Term>
  void sumBlock(std::size_t b, Term& term) {
    double sum = 0;
    const std::size_t end = std::min(count_, (b + 1) * BlockSum::kBlock);
    for (std::size_t i = b * BlockSum::kBlock; i < end; ++i) sum += term(i);
    blocks_[b] = sum;
  }
  void sumGroup(std::size_t g) {
    double sum = 0;
    const std::size_t end = std::min(blocks_.size(), (g + 1) * BlockSum::kGroup);
    for (std::size_t b = g * BlockSum::kGroup; b < end; ++b) sum += blocks_[b];
    groups_[g] = sum;
  }

  std::size_t count_ = 0;
  std::vector<double> blocks_, groups_;
};

}  // namespace otg
