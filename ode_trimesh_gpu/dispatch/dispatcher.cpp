// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/dispatcher.h"

#include <numeric>

#include "dispatch/host_batch.h"

namespace otg {

void Dispatcher::setThreadCount(unsigned threads) {
  std::shared_ptr<ThreadPool> before;  // its threads end outside of the lock
  const std::lock_guard lock(mutex_);
  threads_ = threads;
  before.swap(pool_);
}

unsigned Dispatcher::threadCount() const {
  const std::lock_guard lock(mutex_);
  return threads_ != 0 ? threads_ : defaultThreadCount();
}

std::shared_ptr<ThreadPool> Dispatcher::pool() {
  const std::lock_guard lock(mutex_);
  if (!pool_) pool_ = std::make_shared<ThreadPool>(threads_ != 0 ? threads_ : defaultThreadCount());
  return pool_;
}

void Dispatcher::collideBatch(std::span<const PairJob* const> jobs, std::span<PairResult> results) {
  std::vector<std::size_t> all(jobs.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  collideOnHost(*pool(), jobs, all, results);
}

Dispatcher& dispatcher() {
  static Dispatcher instance;
  return instance;
}

}  // namespace otg
