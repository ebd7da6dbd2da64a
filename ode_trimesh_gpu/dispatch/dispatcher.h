// SPDX-License-Identifier: BSD-3-Clause
// Who computes what.
#pragma once

#include <memory>
#include <mutex>
#include <span>

#include "dispatch/pair_job.h"
#include "dispatch/thread_pool.h"

namespace otg {

/// Any number of threads, except where a function says otherwise.
class Dispatcher {
 public:
  Dispatcher() = default;
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  /// Threads that work on one batch, the caller among them; 0: defaultThreadCount(), which is what it is at first.
  /// Batches under way go on with theirs.
  void setThreadCount(unsigned threads);
  unsigned threadCount() const;

  /// Every job, each with the result that it has by itself. `results` has as many elements. Throws std::bad_alloc,
  /// after which the results are of no use; want of memory for a single pair is an outcome of that pair.
  void collideBatch(std::span<const PairJob* const> jobs, std::span<PairResult> results);

 private:
  std::shared_ptr<ThreadPool> pool();

  mutable std::mutex mutex_;
  unsigned threads_ = 0;
  std::shared_ptr<ThreadPool> pool_;  ///< made when first needed
};

/// The one of the process.
Dispatcher& dispatcher();

}  // namespace otg
