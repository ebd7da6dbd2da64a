// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/kept_pairs.h"

namespace otg {
namespace {

/// The limit of contacts goes beside it.
PairQuery queryWithoutLimit(const PairTask& task, std::uint64_t stamp) {
  PairQuery query = pairQuery(task, stamp);
  query.options.maxContacts = 0;
  return query;
}

bool isKept(const PairTask& task) {
  const Query& query = task.job.query;
  if (!task.remembers || task.job.any || task.job.filter != nullptr) return false;
  const Placement& place = task.job.place;
  if (place.middle == Place::kOpencl || place.near == Place::kOpencl) return false;
  return query.options.contacts != ContactModel::kSolid || query.a->convex() == nullptr || query.b->convex() == nullptr;
}

}  // namespace

bool findKept(const PairTask& task, std::vector<Contact>& contacts, PairCounts& counts) {
  KeptPairs* const kept = task.younger().keptPairs.get();
  if (kept == nullptr || !isKept(task)) return false;
  const Query& query = task.job.query;
  return kept->find(
      task.older().serial, query.bInA, [&] { return queryWithoutLimit(task, task.stamp); }, query.options.maxContacts,
      contacts, &counts);
}

void foundKept(const PairTask& task, std::uint64_t before, std::uint64_t stamp) {
  KeptPairs* const kept = task.younger().keptPairs.get();
  if (kept != nullptr) kept->seen(task.older().serial, before, stamp);
}

void noteComputed(const PairTask& task, std::uint64_t stamp, std::span<const Contact> contacts,
                  const PairCounts& counts) {
  if (!isKept(task)) return;
  const Query& query = task.job.query;
  task.younger().keptPairs.make().note(
      task.older().serial, query.bInA, [&] { return queryWithoutLimit(task, stamp); }, query.options.maxContacts,
      contacts, counts);
}

}  // namespace otg
