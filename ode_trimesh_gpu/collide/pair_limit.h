// SPDX-License-Identifier: BSD-3-Clause
// How many candidate pairs a query may have.
#pragma once

#include <cstddef>
#include <new>
#include <string>
#include <vector>

#include "collide/traversal.h"

namespace otg {

/// Room for 128 MiB of candidates. Ordinary pairs have a thousandth of that.
inline constexpr int kMostCandidatePairs = 1 << 24;

/// A query has more candidate pairs than it may. A kind of want of memory, so that whoever expects that expects this.
class TooManyPairs : public std::bad_alloc {
 public:
  explicit TooManyPairs(std::size_t most)
      : text_("more than " + std::to_string(most) + " pairs of triangles have boxes that overlap") {}
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  std::string text_;
};

/// Candidates of a traversal, up to a limit.
class CandidateList {
 public:
  CandidateList(std::vector<TrianglePair>& pairs, std::size_t most) : pairs_(pairs), most_(most) {}
  void add(const TrianglePair& pair) {
    if (pairs_.size() == most_) throw TooManyPairs(most_);
    pairs_.push_back(pair);
  }

 private:
  std::vector<TrianglePair>& pairs_;
  std::size_t most_;
};

}  // namespace otg
