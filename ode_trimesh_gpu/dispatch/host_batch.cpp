// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/host_batch.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "collide/boxes_apart.h"
#include "collide/convex/convex_pair_contacts.h"
#include "collide/pair_history.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "collide/surface/surface_contacts.h"
#include "dispatch/threads/workspace_lease.h"

namespace otg {
namespace {

/// Items that a thread takes at once: one, unless there are so many that taking them costs.
constexpr std::size_t kManyPairs = 4096, kPairsAtOnce = 8, kReadAtOnce = 128;
/// A pair that has this many times the mean begins before the others, so that not all wait for it in the end.
constexpr std::size_t kLarge = 8;
/// Pairs of no more triangles together may be over before another thread is awake.
constexpr std::size_t kFewTriangles = 1 << 14;

}  // namespace

namespace {

bool isPlain(const PairJob& job) {
  return !job.any && job.filter == nullptr;
}

void makeContacts(const PairJob& job, Workspace& workspace) {
  const Query& query = job.query;
  if (job.any) {
    pairwiseContacts(query, workspace);
    // A solid model finds a mesh that lies inside the other one, where no triangles intersect.
    if (!workspace.contacts.empty() || query.options.contacts != ContactModel::kSolid) {
      const std::size_t count =
          std::min(workspace.contacts.size(), static_cast<std::size_t>(query.options.maxContacts));
      workspace.reduced.assign(workspace.contacts.begin(),
                               workspace.contacts.begin() + static_cast<std::ptrdiff_t>(count));
      return;
    }
  }
  collideIntersecting(query, workspace);
}

}  // namespace

std::span<const Contact> contactsOnHost(const PairJob& job, Workspace& workspace) {
  const Query& query = job.query;
  if (job.filter != nullptr && job.filter->dropPairs(query, workspace)) {
    // What is left bounds no solid: each pair speaks for itself.
    pairwiseContacts(query, workspace);
    reduceContacts(query, workspace);
  } else {
    makeContacts(job, workspace);
  }
  numberAsCaller(query, workspace);
  if (job.filter != nullptr) job.filter->finish(query, workspace);
  return workspace.reduced;
}

bool isConvexJob(const PairJob& job) {
  return isPlain(job) && isConvexPair(job.query);
}

bool isSurfaceJob(const PairJob& job) {
  return isPlain(job) && isSurfacePair(job.query);
}

std::span<const Contact> collideOnHost(const PairJob& job, Workspace& workspace) {
  if (isPlain(job)) {
    collide(job.query, workspace);
    return workspace.reduced;
  }
  findIntersectingPairs(job.query, workspace);
  return contactsOnHost(job, workspace);
}

std::span<const Contact> collideOfMany(const PairJob& job, Workspace& workspace) {
  if (!meetsNothing(job.query)) return collideOnHost(job, workspace);
  workspace.clear();
  rememberPlain(job.query, stateBefore(job.query), false, {0, 0, 0});
  return {};
}

void runByPool(ThreadPool& pool, std::span<const PairWork> work, std::span<const std::size_t> which,
               const std::function<void(std::size_t i, Workspace& workspace)>& one) {
  if (which.empty()) return;
  std::vector<std::size_t> sizes(which.size());  // by all threads: pairs lie far apart
  pool.run(which.size(), kReadAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) sizes[k] = workOf(work[which[k]].job->query);
  });
  const std::size_t all = std::accumulate(sizes.begin(), sizes.end(), std::size_t{0});
  std::vector<std::size_t> order, others;
  for (std::size_t k = 0; k < which.size(); ++k) {
    (sizes[k] * which.size() > kLarge * all ? order : others).push_back(which[k]);
  }
  order.insert(order.end(), others.begin(), others.end());
  const auto collide = [&](std::size_t begin, std::size_t end) {
    const WorkspaceLease lease;
    for (std::size_t k = begin; k < end; ++k) one(order[k], *lease);
  };
  if (all <= kFewTriangles) {
    pool.runShort(order.size(), 1, collide);
  } else {
    pool.run(order.size(), order.size() < kManyPairs ? 1 : kPairsAtOnce, collide);
  }
}

}  // namespace otg
