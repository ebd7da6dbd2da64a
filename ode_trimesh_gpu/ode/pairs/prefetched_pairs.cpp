// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/prefetched_pairs.h"

#include <array>
#include <bit>

#include "collide/stages.h"
#include "ode/pairs/pair_task.h"

namespace otg {
namespace {

/// By their bits: the same bytes are promised for the same bytes, and 0 is not -0.
bool sameBits(const Transformd& x, const Transformd& y) {
  using Bits = std::array<std::uint64_t, 12>;
  static_assert(sizeof(Bits) == sizeof(Transformd));
  return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(y);
}
bool sameBits(const Vec3d& x, const Vec3d& y) {
  using Bits = std::array<std::uint64_t, 3>;
  return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(y);
}

bool sameQuery(const Query& x, const Query& y) {
  return x.a == y.a && x.b == y.b && x.options == y.options && sameBits(x.bInA, y.bInA) &&
         sameBits(x.relativeVelocity, y.relativeVelocity);
}

/// Whether the mesh is the very one, with its vertices where they were. Addresses alone would not show it: another mesh
/// may lie at the same one by now.
bool isStill(const std::weak_ptr<const void>& then, const CollisionMesh& now) {
  const std::weak_ptr<const void> lifetime = now.lifetime();
  return !then.owner_before(lifetime) && !lifetime.owner_before(then);
}

}  // namespace

void PrefetchedPairs::clear() {
  if (empty()) return;
  const std::lock_guard lock(mutex_);
  entries_.clear();
  count_.store(0, std::memory_order_release);
}

void PrefetchedPairs::add(const PairTask& task, PairResult&& result) {
  // All that may throw comes before the first change. A copy of the contacts: they may lie in a whole batch's memory,
  // which goes away or is not to stay for long.
  keepContacts(result, result.contacts);
  const SolidHistory* const history = task.job.query.history;
  auto left = history == nullptr ? nullptr : std::make_unique<const SolidHistory>(*history);
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[task.older().serial];
  entry.a = task.job.query.a->lifetime();
  entry.b = task.job.query.b->lifetime();
  entry.query = task.job.query;
  entry.query.history = nullptr;
  entry.remembers = task.remembers;
  entry.stamp = task.stamp;
  entry.history = std::move(left);
  entry.result = std::move(result);
  count_.store(entries_.size(), std::memory_order_release);
}

bool PrefetchedPairs::find(PairTask& task, int capacity, PairResult& result) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(task.older().serial);
  if (it == entries_.end()) return false;
  const Entry& entry = it->second;
  const Query& query = task.job.query;
  if (entry.remembers != task.remembers || entry.stamp != task.stamp || !isStill(entry.a, *query.a) ||
      !isStill(entry.b, *query.b) || !sameQuery(entry.query, query)) {
    return false;
  }
  const auto most = static_cast<std::size_t>(entry.query.options.maxContacts);
  if (entry.result.contacts.size() > static_cast<std::size_t>(capacity)) {
    // A list that may have been cut already says nothing of a shorter one.
    if (entry.result.contacts.size() >= most) return false;
    result = entry.result;
    keepContacts(result, limitContactsOfCaller(query, entry.result.contacts, capacity));
  } else {
    result = entry.result;
  }
  if (query.history != nullptr) *query.history = entry.history != nullptr ? *entry.history : SolidHistory{};
  return true;
}

void PrefetchedPairs::seen(const PairTask& task, std::uint64_t stamp) {
  const std::lock_guard lock(mutex_);
  const auto it = entries_.find(task.older().serial);
  if (it != entries_.end() && it->second.stamp == task.stamp) it->second.stamp = stamp;
}

}  // namespace otg
