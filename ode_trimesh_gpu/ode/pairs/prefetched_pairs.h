// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a geom's pairs that were computed ahead of dCollide.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "dispatch/pair_job.h"
#include "ode/pairs/pair_query.h"

namespace otg {

struct PairTask;

/// Of the pairs in which the geom is the younger one. Any number of threads.
class PrefetchedPairs {
 public:
  bool empty() const { return count_.load(std::memory_order_acquire) == 0; }
  void clear();
  /// Takes over the result of `task`, which was computed for as many contacts as the geoms allow, and the history that
  /// it left. May throw std::bad_alloc.
  void add(const PairTask& task, PairResult&& result);

  /// Whether a query as `task` has it was computed ahead: same meshes, same relative pose and velocity to the last bit,
  /// same options, same history. If so, its contacts, `capacity` at most, and the history that it leaves, as if it
  /// were computed now. May throw std::bad_alloc.
  bool find(PairTask& task, int capacity, PairResult& result);
  /// After find(): what is remembered of the pair now has this stamp. A query that is requested again is still known.
  void seen(const PairTask& task, std::uint64_t stamp);

 private:
  struct Entry {
    PairQuery query;
    std::unique_ptr<const SolidHistory> history;  ///< what the query left; null if it had none
    PairResult result;
  };
  std::mutex mutex_;
  std::map<std::uint64_t, Entry> entries_;  ///< by the serial number of the older geom
  std::atomic<std::size_t> count_{0};
};

}  // namespace otg
