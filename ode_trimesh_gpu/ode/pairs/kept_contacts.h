// SPDX-License-Identifier: BSD-3-Clause
// The contacts of pairs that stay where they are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <mutex>
#include <new>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/same_bits.h"
#include "dispatch/pair_job.h"

namespace otg {

/// Of one geom: for each of its pairs the pose of the last query, and, once a pose has come twice, what was found
/// there. No result depends on it: a query at the very pose of the last one leaves what is remembered as it was.
/// `Query` is all that contacts depend on, but for how many there may be. It has a `pose` and a `stamp` of what is
/// remembered, and there is a sameQuery(). `kIsWhole`: contacts that were not cut are the same whatever their limit.
/// Any number of threads.
template <class Query>
class KeptContacts {
 public:
  /// Whether the pair is where it was, and nothing else has changed. If so its contacts, for `most` of them, and what
  /// they took. `query` makes the query, if need be. May throw std::bad_alloc.
  template <class MakeQuery>
  bool find(std::uint64_t key, const Transformd& pose, const MakeQuery& query, int most, std::vector<Contact>& contacts,
            PairCounts* counts = nullptr) {
    const std::lock_guard lock(mutex_);
    const auto it = entries_.find(key);
    if (it == entries_.end()) return false;
    Entry& entry = it->second;
    if (!entry.hasAnswer || !sameBits(entry.query.pose, pose)) return false;
    const bool isWhole = Query::kIsWhole && std::ssize(entry.contacts) < std::min(entry.most, most);
    entry.hasAnswer = (entry.most == most || isWhole) && sameQuery(entry.query, query());
    if (!entry.hasAnswer) return false;
    contacts.assign(entry.contacts.begin(), entry.contacts.end());
    if (counts != nullptr) *counts = entry.counts;
    return true;
  }
  /// After find(): what is remembered of the pair had the stamp `before`, and has another one now. Something else may
  /// have been kept since then.
  void seen(std::uint64_t key, std::uint64_t before, std::uint64_t stamp) {
    const std::lock_guard lock(mutex_);
    const auto it = entries_.find(key);
    if (it != entries_.end() && it->second.query.stamp == before) it->second.query.stamp = stamp;
  }
  /// What was computed. `query` as in find(), but with the stamp of what is remembered now. Nothing is kept where
  /// memory is short.
  template <class MakeQuery>
  void note(std::uint64_t key, const Transformd& pose, const MakeQuery& query, int most,
            std::span<const Contact> contacts, const PairCounts& counts = {}) noexcept {
    const std::lock_guard lock(mutex_);
    try {
      if (entries_.size() >= kMost && !entries_.contains(key)) entries_.clear();
      Entry& entry = entries_[key];
      entry.hasAnswer = false;
      if (!sameBits(entry.query.pose, pose)) {
        entry.query.pose = pose;
        entry.contacts.reserve(contacts.size());  // so that what comes next takes no memory
        return;
      }
      entry.query = query();
      entry.contacts.assign(contacts.begin(), contacts.end());
      entry.counts = counts;
      entry.most = most;
      entry.hasAnswer = true;
    } catch (const std::bad_alloc&) {
      entries_.erase(key);
    }
  }

  void clear() {
    const std::lock_guard lock(mutex_);
    entries_.clear();
  }

 private:
  struct Entry {
    Query query;  ///< of its pose alone, as long as there is no result
    std::vector<Contact> contacts;
    PairCounts counts;
    int most = 0;
    bool hasAnswer = false;
  };
  static constexpr std::size_t kMost = 1024;
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, Entry> entries_;
};

}  // namespace otg
