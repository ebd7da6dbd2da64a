// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/pair_query.h"

#include "base/same_bits.h"
#include "ode/pairs/pair_task.h"

namespace otg {

bool isSameMesh(const std::weak_ptr<const void>& x, const std::weak_ptr<const void>& y) {
  return !x.owner_before(y) && !y.owner_before(x);
}

PairQuery pairQuery(const PairTask& task, std::uint64_t stamp) {
  const Query& query = task.job.query;
  return {query.a->lifetime(), query.b->lifetime(), query.bInA, query.relativeVelocity, query.options, stamp,
          task.remembers};
}

bool sameQuery(const PairQuery& x, const PairQuery& y) {
  return x.stamp == y.stamp && x.remembers == y.remembers && sameBits(x.pose, y.pose) &&
         sameBits(x.velocity, y.velocity) && isSameMesh(x.a, y.a) && isSameMesh(x.b, y.b) && x.options == y.options;
}

}  // namespace otg
