// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a mesh with geoms of ODE's own that were computed ahead of dCollide.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "collide/query.h"
#include "ode/shapes/primitive_task.h"
#include "ode/shapes/shape_query.h"

namespace otg {

/// Whether pairs with geoms of this class are computed ahead: not rays, which are as quick as the look-up, and not
/// heightfields, whose heights a program may change without a word.
bool isPrefetchedClass(int geomClass) noexcept;

/// Whether a list of all contacts can be cut afterwards: the contacts of other classes break ties by triangles that
/// they no longer name.
bool canBeCut(int geomClass) noexcept;

/// Of one mesh's geom. Any number of threads.
class PrefetchedShapes {
 public:
  bool empty() const { return count_.load(std::memory_order_acquire) == 0; }

  /// Whether this was computed ahead. If so its contacts in the mesh's own numbers, `capacity` at most and as if they
  /// were computed now, and what it leaves. May throw std::bad_alloc.
  bool find(std::uint64_t key, const ShapeQuery& query, int capacity, std::vector<Contact>& out, DetachedHistory& left);
  /// After find(): what is remembered of the pair now has this stamp. A query that is requested again is still known.
  void seen(std::uint64_t key, std::uint64_t before, std::uint64_t now);

  /// How many contacts were requested last of that pair; `otherwise` if none were. What is computed ahead for as
  /// many needs no cutting, which would not give the same for every class.
  int placesAskedFor(std::uint64_t key, int otherwise);
  /// A prefetch begins: what it does not take over or add goes in endRound().
  void beginRound();
  /// Takes over what is there for the same query; false if it has to be computed.
  bool keep(std::uint64_t key, const ShapeQuery& query, int most);
  /// `most`: for how many contacts it was computed. May throw std::bad_alloc.
  void add(std::uint64_t key, ShapeQuery&& query, int most, std::vector<Contact>&& contacts,
           const DetachedHistory& left);
  void endRound();

 private:
  struct Entry {
    ShapeQuery query;
    std::vector<Contact> contacts;
    DetachedHistory left;
    int most = 0, asked = 0;  ///< 0: not requested
    std::uint64_t round = 0;
  };
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, Entry> entries_;  ///< by the key of memory
  std::uint64_t round_ = 0;
  std::atomic<std::size_t> count_{0};
};

}  // namespace otg
