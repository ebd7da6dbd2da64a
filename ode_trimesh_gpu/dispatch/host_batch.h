// SPDX-License-Identifier: BSD-3-Clause
// Pairs on the CPU: one, or many by all threads.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "dispatch/pair_job.h"
#include "dispatch/threads/thread_pool.h"

namespace otg {

/// The contacts of one pair, best first and no more than query.options.maxContacts, in the workspace. Throws what
/// otg::collide throws.
std::span<const Contact> collideOnHost(const PairJob& job, Workspace& workspace);

/// The same for a job of a batch, whose pairs were not looked at before: those that cannot meet end at once. (A
/// single dCollide() finds them out before it makes a job.)
std::span<const Contact> collideOfMany(const PairJob& job, Workspace& workspace);

/// Whether a job runs on the CPU alone, and needs no triangles: isConvexPair(), with all contacts requested.
bool isConvexJob(const PairJob& job);

/// Whether it is isSurfacePair(), with all contacts requested: most are done by a look at few triangles.
bool isSurfaceJob(const PairJob& job);

/// As collideOnHost from workspace.intersecting: for pairs whose first two phases were done elsewhere.
std::span<const Contact> contactsOnHost(const PairJob& job, Workspace& workspace);

/// Calls one(i, workspace) for the pairs i of `which`, by the pool's threads, each thread with a workspace of its own.
/// The results do not depend on the number of threads. The jobs of `work` show which are large.
void runByPool(ThreadPool& pool, std::span<const PairWork> work, std::span<const std::size_t> which,
               const std::function<void(std::size_t i, Workspace& workspace)>& one);

/// Runs `finish`, which gives the contacts of one job, and keeps them or what it throws in the result.
template <class Finish>
void keepOutcome(PairResult& result, const Workspace& workspace, Finish&& finish) {
  try {
    keepContacts(result, finish());
    result.counts = PairCounts(workspace.stats);
    result.outcome = PairResult::Outcome::kDone;
  } catch (const std::invalid_argument&) {
    result.outcome = PairResult::Outcome::kRefused;
  } catch (...) {  // of want of memory
    result.outcome = PairResult::Outcome::kNoMemory;
  }
}

/// How much there may be to do for a pair, in triangles.
inline std::size_t workOf(const Query& query) {
  return query.a->mesh().triangleCount() + query.b->mesh().triangleCount();
}

}  // namespace otg
