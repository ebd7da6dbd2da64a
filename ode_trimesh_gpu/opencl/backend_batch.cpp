// SPDX-License-Identifier: BSD-3-Clause
// Many pairs in one submission.
#include <algorithm>
#include <functional>
#include <numeric>

#include "collide/stages.h"
#include "opencl/backend_state.h"
#include "opencl/take_records.h"

namespace otg::opencl {

/// One call for many queries: what is left to the device goes there in pieces, and each query is finished by one of
/// three functions, exactly once, or refused.
class Backend::Batch {
 public:
  /// Finishes a query from its records in an answer.
  using FromDevice =
      std::function<void(std::size_t query, const PairFrame&, const Answer&, std::span<const std::uint32_t> records)>;
  /// Finishes a query without the batch; false if the device was to help and failed.
  using Alone = std::function<bool(std::size_t query)>;

  Batch(State& state, std::span<const Query> queries, bool contacts, bool anyHit)
      : state_(state), queries_(queries), contacts_(contacts), anyHit_(anyHit) {}

  FromDevice fromDevice;
  Alone onHost, large;
  std::vector<std::size_t> refused;
  CollideStats counts;  ///< sums of what the device counted

  /// False if the device failed.
  bool run() {
    std::vector<std::size_t> order;
    frames_.reserve(queries_.size());
    for (std::size_t i = 0; i < queries_.size(); ++i) {
      frames_.push_back(makePairFrame(queries_[i]));
      if (isRefused(queries_[i])) {
        refused.push_back(i);
      } else if (isIdleQuery(queries_[i], frames_[i])) {
        onHost(i);
      } else if (work(i) > state_.tuning.batchTriangles) {
        good_ = large(i) && good_;
      } else {
        order.push_back(i);
      }
    }
    // The largest pairs first, so that none of them is what the rest of the device waits for in the end.
    std::stable_sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return work(x) > work(y); });
    const std::span<const std::size_t> all(order);
    for (std::size_t at = 0; at < all.size(); at += state_.tuning.batchPairs) {
      submit(all.subspan(at, std::min<std::size_t>(state_.tuning.batchPairs, all.size() - at)));
    }
    return good_;
  }

 private:
  std::uint64_t work(std::size_t i) const {
    return queries_[i].a->mesh().triangleCount() + queries_[i].b->mesh().triangleCount();
  }

  void submit(std::span<const std::size_t> which) {
    std::vector<const Query*> queries;
    std::vector<PairFrame> frames;
    for (const std::size_t i : which) {
      queries.push_back(&queries_[i]);
      frames.push_back(frames_[i]);
    }
    // Finishing calls no OpenCL, so that a failure means that none of these queries was finished.
    try {
      state_.batches.with([&](BatchLane& lane) {
        const Answer answer = lane.run(queries, frames, contacts_, anyHit_);
        finish(which, answer);
      });
      return;
    } catch (const ClError& error) {
      // Meshes that do not fit at once may fit in two halves.
      if (error.code() != CL_MEM_OBJECT_ALLOCATION_FAILURE || which.size() == 1) {
        logError(error);
        good_ = false;
        for (const std::size_t i : which) onHost(i);
        state_.onHost += which.size();
        return;
      }
    }
    submit(which.first(which.size() / 2));
    submit(which.subspan(which.size() / 2));
  }

  /// Deals the records out to their queries.
  void finish(std::span<const std::size_t> which, const Answer& answer) {
    std::vector<std::uint32_t> begin(which.size() + 1, 0), records(answer.count);
    for (std::uint32_t r = 0; r < answer.count; ++r) ++begin[pairOfRecord(answer, r) + 1];
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    for (std::uint32_t r = 0; r < answer.count; ++r) records[next[pairOfRecord(answer, r)]++] = r;
    for (std::size_t k = 0; k < which.size(); ++k) {
      fromDevice(which[k], frames_[which[k]], answer, std::span(records).subspan(begin[k], begin[k + 1] - begin[k]));
    }
    CollideStats device;
    takeCounts(answer, device);
    counts.boxTests += device.boxTests;
    counts.candidatePairs += device.candidatePairs;
    counts.decidedByDouble += device.decidedByDouble;
  }

  State& state_;
  std::span<const Query> queries_;
  const bool contacts_, anyHit_;
  bool good_ = true;
  std::vector<PairFrame> frames_;
};

bool Backend::collideBatch(std::span<const Query> queries, BatchAnswer& answer) {
  Workspace workspace;
  std::vector<Contact> made;  // in the order in which queries are finished
  std::vector<std::size_t> from(queries.size(), 0), count(queries.size(), 0);
  CollideStats sums;
  const auto keep = [&](std::size_t i) {
    from[i] = made.size();
    count[i] = workspace.reduced.size();
    made.insert(made.end(), workspace.reduced.begin(), workspace.reduced.end());
    const CollideStats& s = workspace.stats;
    sums.boxTests += s.boxTests;
    sums.candidatePairs += s.candidatePairs;
    sums.decidedByDouble += s.decidedByDouble;
    sums.intersectingPairs += s.intersectingPairs;
    sums.decidedExactly += s.decidedExactly;
    sums.contactsBeforeReduction += s.contactsBeforeReduction;
  };
  const bool contacts = std::any_of(queries.begin(), queries.end(), [](const Query& q) { return !mayBeSolid(q); });
  state_->queries += queries.size();
  Batch batch(*state_, queries, contacts, false);
  batch.fromDevice = [&](std::size_t i, const PairFrame& frame, const Answer& found,
                         std::span<const std::uint32_t> records) {
    const bool pairwise = !mayBeSolid(queries[i]);
    workspace.stats = {};
    takeRecords(queries[i], frame, found, records, pairwise, workspace);
    if (pairwise && found.hasContacts()) {
      reduceContacts(queries[i], workspace);
    } else {
      collideIntersecting(queries[i], workspace);
    }
    numberAsCaller(queries[i], workspace);
    keep(i);
  };
  batch.onHost = [&](std::size_t i) {
    otg::collide(queries[i], workspace);
    keep(i);
    return true;
  };
  batch.large = [&](std::size_t i) {
    --state_->queries;  // counted again there
    const bool good = collide(queries[i], workspace);
    keep(i);
    return good;
  };
  const bool good = batch.run();
  answer.contacts.clear();
  answer.contacts.reserve(made.size());
  answer.first.assign(1, 0);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto begin = made.begin() + static_cast<std::ptrdiff_t>(from[i]);
    answer.contacts.insert(answer.contacts.end(), begin, begin + static_cast<std::ptrdiff_t>(count[i]));
    answer.first.push_back(answer.contacts.size());
  }
  sums.boxTests += batch.counts.boxTests;
  sums.candidatePairs += batch.counts.candidatePairs;
  sums.decidedByDouble += batch.counts.decidedByDouble;
  answer.stats = sums;
  answer.refused = std::move(batch.refused);
  return good;
}

bool Backend::intersectBatch(std::span<const Query> queries, std::vector<std::uint8_t>& answer) {
  Workspace workspace;
  answer.assign(queries.size(), 0);
  state_->queries += queries.size();
  Batch batch(*state_, queries, false, true);
  batch.fromDevice = [&](std::size_t i, const PairFrame& frame, const Answer& from,
                         std::span<const std::uint32_t> records) {
    answer[i] = std::any_of(records.begin(), records.end(),
                            [&](std::uint32_t r) { return recordIntersects(queries[i], frame, from, r); });
  };
  batch.onHost = [&](std::size_t i) {
    otg::findIntersectingPairs(queries[i], workspace);
    answer[i] = !workspace.intersecting.empty();
    return true;
  };
  batch.large = [&](std::size_t i) {
    --state_->queries;  // counted again there
    const bool good = findIntersectingPairs(queries[i], workspace);
    answer[i] = !workspace.intersecting.empty();
    return good;
  };
  return batch.run();
}

}  // namespace otg::opencl
