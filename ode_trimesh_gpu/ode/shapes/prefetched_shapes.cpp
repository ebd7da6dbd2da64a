// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/prefetched_shapes.h"

#include "collide/pairwise/reduction.h"

namespace otg {
bool isPrefetchedClass(int geomClass) noexcept {
  switch (geomClass) {
    case dSphereClass:
    case dBoxClass:
    case dCapsuleClass:
    case dCylinderClass:
    case dPlaneClass:
    case dConvexClass:
      return true;
    default:
      return false;
  }
}

bool canBeCut(int geomClass) noexcept {
  return geomClass == dSphereClass || geomClass == dPlaneClass;
}

bool PrefetchedShapes::find(std::uint64_t key, const ShapeQuery& query, int capacity, std::vector<Contact>& out,
                            DetachedHistory& left) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it == entries_.end()) return false;
  Entry& entry = it->second;
  entry.asked = capacity;
  if (!sameQuery(entry.query, query)) return false;
  const auto count = static_cast<int>(entry.contacts.size());
  if (capacity != entry.most) {
    if (count >= entry.most) return false;  // it may have been cut
    if (count > capacity && !canBeCut(query.geomClass)) return false;
  }
  if (count > capacity)
    out = limitContacts(entry.contacts, capacity);
  else
    out.assign(entry.contacts.begin(), entry.contacts.end());
  left = entry.left;
  return true;
}

void PrefetchedShapes::seen(std::uint64_t key, std::uint64_t before, std::uint64_t now) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it != entries_.end() && it->second.query.stamp == before) it->second.query.stamp = now;
}

int PrefetchedShapes::placesAskedFor(std::uint64_t key, int otherwise) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  return it != entries_.end() && it->second.asked > 0 ? it->second.asked : otherwise;
}

void PrefetchedShapes::beginRound() {
  const std::lock_guard lock(mutex_);
  ++round_;
}

bool PrefetchedShapes::keep(std::uint64_t key, const ShapeQuery& query, int most) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(key);
  if (it == entries_.end() || it->second.most != most || !sameQuery(it->second.query, query)) return false;
  it->second.round = round_;
  return true;
}

void PrefetchedShapes::add(std::uint64_t key, ShapeQuery&& query, int most, std::vector<Contact>&& contacts,
                           const DetachedHistory& left) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[key];
  entry = {std::move(query), std::move(contacts), left, most, entry.asked, round_};
  count_.store(entries_.size(), std::memory_order_release);
}

void PrefetchedShapes::endRound() {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [this](const auto& item) { return item.second.round != round_; });
  count_.store(entries_.size(), std::memory_order_release);
}

}  // namespace otg
