// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/batch_run.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <thread>

#include "dispatch/plan.h"
#include "dispatch/single_run.h"

namespace otg {
namespace {

/// One batch.
class BatchRun {
 public:
  BatchRun(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices,
           std::span<const PairJob* const> jobs, std::span<PairResult> results)
      : pool_(pool), devices_(devices), jobs_(jobs), results_(results), slotOf_(jobs.size(), nullptr) {}

  PairCounts run() {
    deal();
    std::vector<std::thread> threads;
    for (std::size_t d = 0; d < blocks_.size(); ++d) {
      if (blocks_[d].empty()) continue;
      try {
        threads.emplace_back([this, d] { runBlock(*devices_[d], blocks_[d]); });
      } catch (const std::system_error&) {  // no thread to be had: this one does it before its own work
        runBlock(*devices_[d], blocks_[d]);
      }
    }
    try {
      runSingles();
    } catch (...) {
      for (std::thread& thread : threads) thread.join();
      throw;
    }
    for (std::thread& thread : threads) thread.join();
    if (!leftOver_.empty()) {  // what a device that was switched off meanwhile had not begun
      singles_ = std::move(leftOver_);
      runSingles();
    }
    PairCounts sums = blockCounts_;
    for (const PairResult& result : results_) sums += result.counts;
    return sums;
  }

 private:
  using Indices = std::vector<std::size_t>;

  static double hostCost(const PairJob& job, const CostModel& costs, double work) {
    return (contactsOnDevice(job) ? costs.hostPairwise : costs.hostSolid).of(work);
  }

  void deal() {
    Indices bound, open;  // to devices; to devices or the CPU
    double hostBusy = 0;
    if (devices_.empty()) {
      for (std::size_t i = 0; i < jobs_.size(); ++i) singles_.push_back(i);
      return;
    }
    const CostModel& costs = devices_[0]->costs;
    Indices withDevice;  // one by one, with a device's help
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      const PairJob& job = *jobs_[i];
      const Placement place = settled(job.place);
      const bool isOpen = place.middle == Place::kAuto;
      if (!isOpen && place.middle != Place::kOpencl && place.near != Place::kOpencl) {
        hostBusy += hostCost(job, costs, expectedWork(job.query));
        singles_.push_back(i);
      } else if (!contactsOnDevice(job) || place.middle != place.near) {
        const double work = expectedWork(job.query);
        hostBusy += hostCost(job, costs, work);
        if (!isOpen || isSoonerOnDevice(job, costs, work)) withDevice.push_back(i);
        singles_.push_back(i);
      } else {
        (isOpen ? open : bound).push_back(i);
      }
    }
    for (std::size_t k = 0; k < withDevice.size(); ++k) {
      slotOf_[withDevice[k]] = devices_[k * devices_.size() / withDevice.size()].get();
    }
    Division division;
    division.bound = bound.size();
    division.hostBusy = hostBusy;
    division.threads = pool_.threadCount();
    bound.insert(bound.end(), open.begin(), open.end());
    std::vector<double> work;
    work.reserve(bound.size());
    for (const std::size_t i : bound) work.push_back(expectedWork(jobs_[i]->query));
    division.work = work;
    std::vector<CostModel> models;
    for (const auto& device : devices_) models.push_back(device->costs);
    std::size_t begin = 0;
    for (const std::size_t end : divide(division, models)) {
      DeviceSlot& slot = *devices_[blocks_.size()];
      double expected = begin < end ? slot.costs.batchLaunch : 0;
      for (std::size_t i = begin; i < end; ++i) expected += slot.costs.batchPair.of(work[i]);
      slot.blockPairs = end - begin;
      slot.blockExpectedMs = 1e-3 * expected;
      slot.blockMs = 0;
      blocks_.emplace_back(bound.begin() + static_cast<std::ptrdiff_t>(begin),
                           bound.begin() + static_cast<std::ptrdiff_t>(end));
      begin = end;
    }
    singles_.insert(singles_.end(), bound.begin() + static_cast<std::ptrdiff_t>(begin), bound.end());
  }

  /// By the pool's threads, one pair at a time.
  void runSingles() {
    runByPool(pool_, jobs_, singles_, [this](std::size_t i, Workspace& workspace) {
      const PairJob& job = *jobs_[i];
      PairResult& result = results_[i];
      keepOutcome(result, workspace, [&] {
        if (slotOf_[i] == nullptr) return collideOnHost(job, workspace);
        if (job.place == Placement{}) {  // it was found to be sooner there
          PairJob placed = job;
          placed.place = {Place::kOpencl, Place::kOpencl};
          return collideOn(*slotOf_[i], placed, workspace, result.onDevice, result.deviceFailed);
        }
        return collideOn(*slotOf_[i], job, workspace, result.onDevice, result.deviceFailed);
      });
    });
  }

  /// A device's block, in one call.
  void runBlock(DeviceSlot& slot, const Indices& block) noexcept {
    try {
      if (slot.isOff) {
        const std::lock_guard lock(mutex_);
        leftOver_.insert(leftOver_.end(), block.begin(), block.end());
        return;
      }
      std::vector<Query> queries;
      queries.reserve(block.size());
      for (const std::size_t i : block) queries.push_back(jobs_[i]->query);
      opencl::BatchAnswer answer;
      const auto start = std::chrono::steady_clock::now();
      const bool good = slot.backend->collideBatch(queries, answer);
      slot.blockMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      slot.note(block.size(), good);
      for (std::size_t k = 0; k < block.size(); ++k) {
        PairResult& result = results_[block[k]];
        const std::span<const Contact> contacts = answer.of(k);
        result.contacts.assign(contacts.begin(), contacts.end());
        result.onDevice = good;
        result.deviceFailed = !good;
      }
      {
        const std::lock_guard lock(mutex_);
        blockCounts_ += PairCounts(answer.stats);
      }
      for (const std::size_t k : answer.refused) results_[block[k]].outcome = PairResult::Outcome::kRefused;
    } catch (...) {
      for (const std::size_t i : block) results_[i].outcome = PairResult::Outcome::kNoMemory;
    }
  }

  ThreadPool& pool_;
  const std::vector<std::shared_ptr<DeviceSlot>>& devices_;
  const std::span<const PairJob* const> jobs_;
  const std::span<PairResult> results_;
  Indices singles_;
  std::vector<Indices> blocks_;      ///< one for each device
  std::vector<DeviceSlot*> slotOf_;  ///< of singles that a device helps with
  std::mutex mutex_;
  Indices leftOver_;
  PairCounts blockCounts_;
};

}  // namespace

PairCounts runBatch(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices,
                    std::span<const PairJob* const> jobs, std::span<PairResult> results) {
  return BatchRun(pool, devices, jobs, results).run();
}

}  // namespace otg
