// SPDX-License-Identifier: BSD-3-Clause
// What a geom remembers of the pairs that it is in contact with, for the contact model `solid`.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "collide/solid_options.h"

namespace otg {

/// Bounded: of more than kMost pairs the one queried longest ago is forgotten. So is a pair without contacts, at its
/// next query, unless a sheet or a shell is in it. Any number of threads.
class PairMemory {
 public:
  static constexpr std::size_t kMost = 4096;
  /// Keys with this bit are no serial numbers: they are made of the address of a geom of ODE's own.
  static constexpr std::uint64_t kOfAddress = std::uint64_t{1} << 63;

  /// What is known of the pair with the geom of that serial number (serial numbers are never used again). Returns its
  /// stamp: a number that no other history that was ever stored in this process has, growing from one to the next; 0 if
  /// nothing is known.
  std::uint64_t recall(std::uint64_t other, SolidHistory& history, Vec3d* origin = nullptr) {
    if (empty()) return 0;
    const std::lock_guard lock(mutex_);
    const auto it = pairs_.find(other);
    if (it == pairs_.end()) return 0;
    history = it->second.history;
    if (origin != nullptr) *origin = it->second.origin;
    return it->second.stamp;
  }
  /// What recall() would return.
  std::uint64_t stampOf(std::uint64_t other) {
    if (empty()) return 0;
    const std::lock_guard lock(mutex_);
    const auto it = pairs_.find(other);
    return it == pairs_.end() ? 0 : it->second.stamp;
  }
  /// Whether the geom that holds this memory was mesh A of the pair; nothing if nothing newer than `clearedAt` is
  /// known.
  std::optional<bool> holderWasA(std::uint64_t other, std::uint64_t clearedAt) {
    if (empty()) return {};
    const std::lock_guard lock(mutex_);
    const auto it = pairs_.find(other);
    if (it == pairs_.end() || it->second.stamp <= clearedAt) return {};
    return it->second.holderIsA;
  }
  /// `origin`: of the frame that the history is given in, in the other geom's own. `holderIsA`: of two meshes. Returns
  /// the stamp.
  std::uint64_t store(std::uint64_t other, const SolidHistory& history, const Vec3d& origin = {0, 0, 0},
                      bool holderIsA = false) {
    const std::lock_guard lock(mutex_);
    Entry& entry = latest(other);
    entry.history = history;
    entry.origin = origin;
    entry.holderIsA = holderIsA;
    count_.store(pairs_.size(), std::memory_order_release);
    return entry.stamp = nextStamp();
  }
  /// As if what is known of the pair were stored again: its stamp, 0 if nothing is known.
  std::uint64_t renew(std::uint64_t other) {
    if (empty()) return 0;
    const std::lock_guard lock(mutex_);
    const auto it = pairs_.find(other);
    if (it == pairs_.end()) return 0;
    order_.splice(order_.end(), order_, it->second.place);
    return it->second.stamp = nextStamp();
  }
  /// The latest stamp of all.
  static std::uint64_t now() { return clock().load(std::memory_order_relaxed); }
  void forget(std::uint64_t other) {
    if (empty()) return;
    const std::lock_guard lock(mutex_);
    const auto it = pairs_.find(other);
    if (it == pairs_.end()) return;
    order_.erase(it->second.place);
    pairs_.erase(it);
    count_.store(pairs_.size(), std::memory_order_release);
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    pairs_.clear();
    order_.clear();
    count_.store(0, std::memory_order_release);
  }
  /// Whether nothing is known of any pair: most geoms of a batch are checked, and need no lock for that.
  bool empty() const { return count_.load(std::memory_order_acquire) == 0; }
  struct Remembered {
    std::uint64_t key;
    SolidHistory history;
    Vec3d origin{0, 0, 0};
    bool holderIsA = false;
  };
  /// Everything, the pair that was queried longest ago first: storing them in this order in an empty memory makes an
  /// equal one.
  std::vector<Remembered> all() {
    const std::lock_guard lock(mutex_);
    std::vector<Remembered> entries;
    for (const std::uint64_t other : order_) {
      const Entry& entry = pairs_.at(other);
      entries.push_back({other, entry.history, entry.origin, entry.holderIsA});
    }
    return entries;
  }
  /// Exchanges what two memories hold. Throws nothing; the other one must be the caller's own.
  void swap(PairMemory& other) {
    const std::lock_guard lock(mutex_);
    pairs_.swap(other.pairs_);
    order_.swap(other.order_);
    other.count_.store(other.pairs_.size(), std::memory_order_release);
    count_.store(pairs_.size(), std::memory_order_release);
  }

 private:
  static std::atomic<std::uint64_t>& clock() {
    static std::atomic<std::uint64_t> stamps{0};
    return stamps;
  }
  static std::uint64_t nextStamp() { return clock().fetch_add(1, std::memory_order_relaxed) + 1; }
  struct Entry {
    SolidHistory history;
    std::uint64_t stamp = 0;
    Vec3d origin{0, 0, 0};
    bool holderIsA = false;
    std::list<std::uint64_t>::iterator place;  ///< in order_
  };
  /// Of that pair, a new one if need be, as the last in the order.
  Entry& latest(std::uint64_t other) {
    if (const auto it = pairs_.find(other); it != pairs_.end()) {
      order_.splice(order_.end(), order_, it->second.place);
      return it->second;
    }
    if (pairs_.size() >= kMost) {  // in place of the first
      auto node = pairs_.extract(order_.front());
      order_.splice(order_.end(), order_, order_.begin());
      order_.back() = node.key() = other;
      return pairs_.insert(std::move(node)).position->second;
    }
    const auto place = order_.insert(order_.end(), other);
    try {
      Entry& entry = pairs_[other];
      entry.place = place;
      return entry;
    } catch (...) {
      order_.erase(place);
      throw;
    }
  }
  std::atomic<std::size_t> count_{0};  ///< of pairs_
  std::mutex mutex_;
  std::map<std::uint64_t, Entry> pairs_;
  std::list<std::uint64_t> order_;  ///< their keys, by stamp
};

}  // namespace otg
