// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/batch_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <memory>
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
           std::span<const PairJob* const> jobs, std::span<PairResult> results, bool takesOver)
      : pool_(pool),
        devices_(devices),
        jobs_(jobs),
        results_(results),
        takesOver_(takesOver),
        slotOf_(jobs.size(), nullptr) {}

  PairCounts run() {
    deal();
    std::vector<std::thread> threads;
    start_ = Clock::now();
    for (std::size_t d = 0; d < blocks_.size(); ++d) {
      if (blocks_[d].empty()) continue;
      try {
        threads.emplace_back([this, d] { runDevice(*devices_[d], blocks_[d]); });
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
    if (!leftOver_.empty()) {  // of a device that was switched off meanwhile
      singles_ = std::move(leftOver_);
      claimed_.clear();
      runSingles();
    }
    PairCounts sums = blockCounts_;
    for (const PairResult& result : results_) sums += result.counts;
    return sums;
  }

 private:
  static constexpr std::size_t kReadAtOnce = 128;
  using Indices = std::vector<std::size_t>;
  using Clock = std::chrono::steady_clock;

  static double hostCost(const PairJob& job, const CostModel& costs, double work) {
    return costs.hostCost(!contactsOnDevice(job), work);
  }
  double deviceCost(std::size_t i, const CostModel& costs) const {
    return costs.deviceCost(solids_[i] != 0, works_[i]);
  }
  double launchCost(const CostModel& costs, const Indices& block) const {
    const auto solids = std::count_if(block.begin(), block.end(), [&](std::size_t i) { return solids_[i] != 0; });
    return costs.launchCost(static_cast<std::size_t>(solids) < block.size(), solids > 0);
  }

  /// What every job costs, and whether a batch has it as a pair of solids.
  void measure() {
    works_.resize(jobs_.size());
    solids_.resize(jobs_.size());
    pool_.run(jobs_.size(), kReadAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        works_[i] = expectedWork(jobs_[i]->query);
        solids_[i] = solidInBatch(*jobs_[i]) ? 1 : 0;
      }
    });
  }

  static std::vector<CostModel> modelsOf(const std::vector<std::shared_ptr<DeviceSlot>>& devices) {
    std::vector<CostModel> models;
    for (const auto& device : devices) models.push_back(device->costs);
    return models;
  }

  /// Moves open pairs of solids with large overlaps to those that are bound to devices, if all of them are best there.
  void bindLarge(const std::vector<CostModel>& models, Indices& open, Indices& bound) const {
    const auto isLarge = [&](std::size_t i) { return solids_[i] != 0 && models[0].isLarge(works_[i]); };
    std::vector<double> large;
    for (const std::size_t i : open) {
      if (isLarge(i)) large.push_back(works_[i]);
    }
    if (!largeOnDevices(large, models, pool_.threadCount())) return;
    std::copy_if(open.begin(), open.end(), std::back_inserter(bound), isLarge);
    std::erase_if(open, isLarge);
  }

  void deal() {
    Indices bound, open;  // to devices; to devices or the CPU
    double hostBusy = 0;
    if (devices_.empty()) {
      for (std::size_t i = 0; i < jobs_.size(); ++i) singles_.push_back(i);
      return;
    }
    measure();
    const CostModel& costs = devices_[0]->costs;
    const bool knowSolids =
        std::all_of(devices_.begin(), devices_.end(), [](const auto& d) { return d->costs.knowsSolids(); });
    Indices withDevice;  // one by one, with a device's help
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      const PairJob& job = *jobs_[i];
      const Placement place = settled(job.place);
      const bool isOpen = place.middle == Place::kAuto, isTogether = place.middle == place.near;
      const bool inBatch = isTogether && (contactsOnDevice(job) || (solids_[i] != 0 && (!isOpen || knowSolids)));
      if (!isOpen && place.middle != Place::kOpencl && place.near != Place::kOpencl) {
        hostBusy += hostCost(job, costs, works_[i]);
        singles_.push_back(i);
      } else if (inBatch) {
        (isOpen ? open : bound).push_back(i);
      } else {
        const double work = works_[i];
        hostBusy += hostCost(job, costs, work);
        if (!isOpen || isSoonerOnDevice(job, costs, work)) withDevice.push_back(i);
        singles_.push_back(i);
      }
    }
    const std::vector<CostModel> models = modelsOf(devices_);
    bindLarge(models, open, bound);
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
    for (const std::size_t i : bound) work.push_back(works_[i]);
    std::vector<std::uint8_t> solid;
    for (const std::size_t i : bound) solid.push_back(solids_[i]);
    division.work = work;
    division.solid = solid;
    std::size_t begin = 0;
    for (const std::size_t end : divide(division, models)) {
      DeviceSlot& slot = *devices_[blocks_.size()];
      blocks_.emplace_back(bound.begin() + static_cast<std::ptrdiff_t>(begin),
                           bound.begin() + static_cast<std::ptrdiff_t>(end));
      double expected = launchCost(slot.costs, blocks_.back());
      for (std::size_t i = begin; i < end; ++i) expected += deviceCost(bound[i], slot.costs);
      slot.blockPairs = end - begin;
      slot.blockExpectedMs = 1e-3 * expected;
      slot.blockMs = 0;
      begin = end;
    }
    open_.assign(bound.begin() + static_cast<std::ptrdiff_t>(begin), bound.end());
    singles_.insert(singles_.end(), open_.begin(), open_.end());
    if (takesOver_ && !open_.empty()) claimed_ = std::vector<std::atomic<bool>>(jobs_.size());
    hostBusy_ = hostBusy;
  }

  /// Whether the caller is the one to do job `i`: the first that asks is.
  bool claim(std::size_t i) { return claimed_.empty() || !claimed_[i].exchange(true, std::memory_order_relaxed); }

  /// By the pool's threads, one pair at a time.
  void runSingles() {
    runByPool(pool_, jobs_, singles_, [this](std::size_t i, Workspace& workspace) {
      if (!claim(i)) return;
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

  /// A device's block, and then what it takes over from the CPU.
  void runDevice(DeviceSlot& slot, const Indices& block) noexcept {
    const auto begin = Clock::now();
    runBlock(slot, block);
    try {
      // How much slower than expected the device was, and the CPU until now; not more than a little quicker.
      double expected = launchCost(slot.costs, block);
      for (const std::size_t i : block) expected += deviceCost(i, slot.costs);
      const double slower = std::max(0.5, microseconds(begin) / std::max(expected, 1.0));
      while (!claimed_.empty() && !slot.isOff) {
        const Indices more = takeOver(slot, slower);
        if (more.empty()) return;
        runBlock(slot, more);
      }
    } catch (...) {  // no memory: the CPU does the rest
    }
  }

  /// A part of the open pairs that the CPU has not begun, from the end on: see shareToTake.
  Indices takeOver(const DeviceSlot& slot, double slower) {
    const std::lock_guard lock(takeOver_);
    double all = 0, left = 0, forDevice = 0;
    for (std::size_t k = 0; k < open_.size(); ++k) {
      const double cost = hostCost(*jobs_[open_[k]], slot.costs, works_[open_[k]]);
      all += cost;
      if (claimed_[open_[k]].load(std::memory_order_relaxed)) continue;
      left += cost;
      forDevice += slower * deviceCost(open_[k], slot.costs);
    }
    const double done = all - left - takenCost_, elapsed = microseconds(start_);
    double host = (left + hostBusy_) / slot.costs.speedup(pool_.threadCount());
    // By the CPU's own pace, if it has had nothing else to do.
    if (hostBusy_ == 0 && done > 0) host = left * elapsed / done;
    const double share = shareToTake({host, forDevice, slower * launchCost(slot.costs, open_)});
    Indices taken;
    double cost = 0;
    for (std::size_t k = open_.size(); k-- > 0 && cost < share * left;) {
      if (!claim(open_[k])) continue;
      cost += hostCost(*jobs_[open_[k]], slot.costs, works_[open_[k]]);
      taken.push_back(open_[k]);
    }
    takenCost_ += cost;
    return taken;
  }

  static double microseconds(Clock::time_point since) {
    return std::chrono::duration<double, std::micro>(Clock::now() - since).count();
  }

  /// Pairs that a device does, in one call for each model.
  void runBlock(DeviceSlot& slot, const Indices& block) noexcept {
    Indices models[2];
    try {
      for (const std::size_t i : block) models[solids_[i]].push_back(i);
    } catch (...) {
      for (const std::size_t i : block) results_[i].outcome = PairResult::Outcome::kNoMemory;
      return;
    }
    const auto start = Clock::now();
    const bool first = slot.blockMs == 0;  // not what it takes over
    for (const Indices& some : models) {
      if (!some.empty()) runModel(slot, some);
    }
    if (first) slot.blockMs = 1e-3 * microseconds(start);
  }

  void runModel(DeviceSlot& slot, const Indices& block) noexcept {
    try {
      if (slot.isOff) {
        leave(block);
        return;
      }
      std::vector<Query> queries(block.size());
      pool_.run(block.size(), kReadAtOnce, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) queries[k] = jobs_[block[k]]->query;
      });
      const auto shared = std::make_shared<opencl::BatchAnswer>();
      opencl::BatchAnswer& answer = *shared;
      const opencl::RunParts onHost = [&](std::size_t count, const ThreadPool::Work& work) {
        pool_.run(count, 1, work, true);  // the device waits for it, and for pairs of the CPU nobody does
      };
      const bool good = slot.backend->collideBatch(queries, answer, nullptr, onHost);
      slot.note(block.size(), good);
      for (std::size_t k = 0; k < block.size(); ++k) {
        PairResult& result = results_[block[k]];
        result.contacts = answer.of(k);
        result.memory = shared;
        result.onDevice = good;
        result.deviceFailed = !good;
      }
      for (const std::size_t k : answer.byHost) results_[block[k]].onDevice = false;
      {
        const std::lock_guard lock(mutex_);
        blockCounts_ += PairCounts(answer.stats);
      }
      for (const std::size_t k : answer.refused) results_[block[k]].outcome = PairResult::Outcome::kRefused;
    } catch (...) {
      for (const std::size_t i : block) results_[i].outcome = PairResult::Outcome::kNoMemory;
    }
  }

  /// To the CPU's threads, when the devices are done.
  void leave(const Indices& jobs) {
    const std::lock_guard lock(mutex_);
    leftOver_.insert(leftOver_.end(), jobs.begin(), jobs.end());
  }

  ThreadPool& pool_;
  const std::vector<std::shared_ptr<DeviceSlot>>& devices_;
  const std::span<const PairJob* const> jobs_;
  const std::span<PairResult> results_;
  const bool takesOver_;
  Indices singles_;
  std::vector<Indices> blocks_;             ///< one for each device
  Indices open_;                            ///< of the singles: those that a device may take over
  std::vector<double> works_;               ///< expectedWork of every job
  std::vector<std::uint8_t> solids_;        ///< solidInBatch of every job
  std::vector<std::atomic<bool>> claimed_;  ///< by job; empty if nobody takes over
  std::mutex takeOver_;
  double hostBusy_ = 0, takenCost_ = 0;
  Clock::time_point start_;
  std::vector<DeviceSlot*> slotOf_;  ///< of singles that a device helps with
  std::mutex mutex_;
  Indices leftOver_;
  PairCounts blockCounts_;
};

}  // namespace

PairCounts runBatch(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices,
                    std::span<const PairJob* const> jobs, std::span<PairResult> results, bool takesOver) {
  return BatchRun(pool, devices, jobs, results, takesOver).run();
}

}  // namespace otg
