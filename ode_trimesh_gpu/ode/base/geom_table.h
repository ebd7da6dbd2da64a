// SPDX-License-Identifier: BSD-3-Clause
// What is known of geoms by their addresses: a table that is searched for every geom of large arrays.
#pragma once

#include <ode/common.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/hash.h"

namespace otg {

struct GeomObject;

/// Open addressing with linear probing, so that an entry lies in one piece of memory, which can be prefetched.
/// Any number of threads may read at once, one changes.
class GeomTable {
 public:
  /// Null for what is not there.
  GeomObject* find(dGeomID geom) const noexcept {
    if (entries_.empty()) return nullptr;
    return entries_[placeOf(geom)].object;
  }
  /// Prefetches what find() reads.
  void fetch(dGeomID geom) const noexcept {
    if (!entries_.empty()) __builtin_prefetch(&entries_[firstPlaceOf(geom)]);
  }
  /// Neither is null. May throw std::bad_alloc.
  void insertOrAssign(dGeomID geom, GeomObject* object) {
    if (2 * (count_ + 1) > entries_.size()) grow();
    Entry& entry = entries_[placeOf(geom)];
    if (entry.geom == nullptr) ++count_;
    entry = {geom, object};
  }
  void erase(dGeomID geom) noexcept {
    if (entries_.empty()) return;
    std::size_t hole = placeOf(geom);
    if (entries_[hole].geom == nullptr) return;
    --count_;
    const std::size_t mask = entries_.size() - 1;
    // Those behind it that would not be found beyond a hole move up.
    for (std::size_t at = (hole + 1) & mask; entries_[at].geom != nullptr; at = (at + 1) & mask) {
      const std::size_t first = firstPlaceOf(entries_[at].geom);
      if (((at - first) & mask) < ((at - hole) & mask)) continue;
      entries_[hole] = entries_[at];
      hole = at;
    }
    entries_[hole] = {};
  }
  std::size_t size() const noexcept { return count_; }

 private:
  struct Entry {
    dGeomID geom = nullptr;
    GeomObject* object = nullptr;
  };
  std::size_t firstPlaceOf(dGeomID geom) const noexcept {
    const std::uint64_t bits = std::bit_cast<std::uintptr_t>(geom);
    return static_cast<std::size_t>(spreadBits(bits)) & (entries_.size() - 1);
  }
  /// Where it is, or else the free place where it would be put. There is one: at least half are free.
  std::size_t placeOf(dGeomID geom) const noexcept {
    std::size_t at = firstPlaceOf(geom);
    while (entries_[at].geom != nullptr && entries_[at].geom != geom) at = (at + 1) & (entries_.size() - 1);
    return at;
  }
  void grow() {
    std::vector<Entry> before(entries_.empty() ? 64 : 2 * entries_.size());
    before.swap(entries_);
    for (const Entry& entry : before) {
      if (entry.geom != nullptr) entries_[placeOf(entry.geom)] = entry;
    }
  }

  std::vector<Entry> entries_;  ///< as many as a power of two, or none
  std::size_t count_ = 0;
};

}  // namespace otg
