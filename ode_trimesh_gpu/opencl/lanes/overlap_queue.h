// SPDX-License-Identifier: BSD-3-Clause
// The pairs of a batch whose overlaps are described, some at a time. The CPU makes contacts from some descriptions
// while the device makes the next.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "opencl/lanes/lane_pool.h"
#include "opencl/lanes/overlap_lane.h"

namespace otg::opencl {

/// Some pairs of one batch, in one submission.
struct OverlapSubmission {
  std::size_t holder = 0;                    ///< whose batch it is: the caller's number
  const BatchLane* batch = nullptr;          ///< let go after the job is done
  std::vector<std::size_t> which;            ///< the caller's numbers of the pairs
  std::vector<otg_listed_overlap> pairs;     ///< of each: number in the batch, and hits
  std::vector<const CollisionMesh*> bodies;  ///< of each: A and B
  std::vector<otg_overlap_task> tasks{};     ///< of each, if its contacts are to be made, too
  std::unique_ptr<OverlapLane> lane{};       ///< once it is begun
  std::uint64_t repeats = 0;                 ///< of the lane until then
  std::optional<ClError> error{};            ///< why it was not, or why it did not end

  void add(std::size_t i, const otg_listed_overlap& pair, const CollisionMesh* a, const CollisionMesh* b) {
    which.push_back(i);
    pairs.push_back(pair);
    bodies.insert(bodies.end(), {a, b});
  }
  /// The pairs from `begin` on, as a job of its own that is not begun.
  OverlapSubmission part(std::size_t begin, std::size_t count) const {
    OverlapSubmission some{holder, batch, {}, {}, {}};
    for (std::size_t k = begin; k < std::min(begin + count, which.size()); ++k) {
      some.add(which[k], pairs[k], bodies[2 * k], bodies[2 * k + 1]);
      if (!tasks.empty()) some.tasks.push_back(tasks[k]);
    }
    return some;
  }
};

/// One thread.
class OverlapQueue {
 public:
  /// `most` pairs at a time.
  OverlapQueue(LanePool<OverlapLane>& lanes, std::uint32_t most) : lanes_(lanes), most_(std::max(1u, most)) {}

  /// Begins with the job as soon as there are few enough under way.
  void add(const OverlapSubmission& job) {
    for (std::size_t at = 0; at < job.which.size(); at += most_) jobs_.push_back(job.part(at, most_));
    beginSome();
  }
  bool isEmpty() const { return jobs_.empty(); }

  /// Waits for all, and calls done(job) for one after the other: with `error`, or with a lane that holds what was
  /// found.
  template <class Done>
  void finish(Done&& done) {
    for (done_ = 0; done_ < jobs_.size(); ++done_) {
      beginSome();
      end(jobs_[done_], done);
    }
    jobs_.clear();
    done_ = begun_ = 0;
  }

 private:
  static constexpr std::size_t kAtOnce = 2;

  void beginSome() {
    while (begun_ < std::min(jobs_.size(), done_ + kAtOnce)) begin(jobs_[begun_++]);
  }

  void begin(OverlapSubmission& job) {
    try {
      job.lane = lanes_.take();
      job.repeats = job.lane->repeats();
      job.lane->begin(*job.batch, job.pairs, job.bodies, job.tasks);
    } catch (const ClError& error) {
      job.lane = nullptr;
      job.error = error;
    }
  }

  template <class Done>
  void end(OverlapSubmission& job, Done& done) {
    try {
      if (!job.error) job.lane->end();
    } catch (const ClError& error) {
      job.lane = nullptr;
      job.error = error;
    }
    // Tables that do not fit at once may fit in two halves.
    if (job.error && job.error->code() == CL_MEM_OBJECT_ALLOCATION_FAILURE && job.which.size() > 1) {
      const std::size_t half = (job.which.size() + 1) / 2;
      for (const std::size_t at : {std::size_t{0}, half}) {
        OverlapSubmission some = job.part(at, half);
        begin(some);
        end(some, done);
      }
      return;
    }
    done(job);
    if (job.lane) lanes_.keep(std::move(job.lane), job.repeats);
  }

  LanePool<OverlapLane>& lanes_;
  const std::size_t most_;
  std::vector<OverlapSubmission> jobs_;
  std::size_t begun_ = 0, done_ = 0;
};

}  // namespace otg::opencl
