// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/prefetched_pairs.h"

#include "collide/stages.h"
#include "ode/pairs/pair_task.h"

namespace otg {
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
  entry.query = pairQuery(task, task.stamp);
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
  if (!sameQuery(entry.query, pairQuery(task, task.stamp))) return false;
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
  if (it != entries_.end() && it->second.query.stamp == task.stamp) it->second.query.stamp = stamp;
}

}  // namespace otg
