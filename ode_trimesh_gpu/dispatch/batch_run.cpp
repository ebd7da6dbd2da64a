// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/batch_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <memory>
#include <numeric>
#include <system_error>
#include <thread>

#include "dispatch/cost/plan.h"
#include "dispatch/single_run.h"

namespace otg {
namespace {

/// One batch.
class BatchRun {
 public:
  BatchRun(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices, std::span<const PairWork> pairs,
           bool takesOver)
      : pool_(pool), devices_(devices), pairs_(pairs), takesOver_(takesOver) {}

  BatchEnd run() {
    deal();
    std::vector<std::thread> threads;
    threads.reserve(blocks_.size());  // else what runs out of memory would leave threads behind
    start_ = Clock::now();
    for (std::size_t d = 0; d < blocks_.size(); ++d) {
      devices_[d]->blockPairs = blocks_[d].size();
      devices_[d]->blockMs = 0;
      if (blocks_[d].empty()) continue;
      if (blocks_[d].size() == pairs_.size()) {  // no other device has anything to do
        devices_[d]->blockExpectedMs = 1e-3 * expectedOfAll_;
        runDevice(*devices_[d], blocks_[d]);
        continue;
      }
      try {
        threads.emplace_back([this, d] { runDevice(*devices_[d], blocks_[d]); });
      } catch (const std::system_error&) {  // no thread to be had: this one does it before its own work
        runBlock(*devices_[d], blocks_[d]);
      }
    }
    noteExpected();
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
    return std::move(end_);
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

  /// Who may do a job.
  enum class Kind : std::uint8_t {
    kHost,
    kWithDevice,  ///< the CPU, one by one, with a device's help
    kBound,       ///< devices
    kOpen         ///< devices or the CPU
  };

  /// What every job costs, whether a batch has it as a pair of solids, and who may do it: by all threads, because pairs
  /// are many and lie far apart.
  void measure() {
    works_.resize(pairs_.size());
    solids_.resize(pairs_.size());
    kinds_.resize(pairs_.size());
    struct Part {  // their sums are added up in one order
      double hostBusy = 0, onDevice = 0;
      bool any[2] = {false, false};  ///< of either model
    };
    std::vector<Part> parts((pairs_.size() + kReadAtOnce - 1) / kReadAtOnce);
    const CostModel& costs = devices_[0]->costs;
    const bool knowSolids =
        std::all_of(devices_.begin(), devices_.end(), [](const auto& d) { return d->costs.knowsSolids(); });
    pool_.run(pairs_.size(), kReadAtOnce, [&](std::size_t begin, std::size_t end) {
      Part part;
      for (std::size_t i = begin; i < end; ++i) {
        const PairJob& job = *pairs_[i].job;
        if (isConvexJob(job)) {  // next to nothing
          kinds_[i] = Kind::kHost;
          continue;
        }
        works_[i] = expectedWork(job.query);
        solids_[i] = solidInBatch(job) ? 1 : 0;
        const bool isHosts = isSurfaceJob(job) || (isOpenToAll(job.place) && !devices_[0]->isForAuto);
        kinds_[i] = isHosts ? Kind::kHost : kindOf(job, works_[i], solids_[i] != 0, costs, knowSolids);
        part.any[solids_[i]] = true;
        part.onDevice += deviceCost(i, costs);
        if (kinds_[i] == Kind::kHost || kinds_[i] == Kind::kWithDevice) {
          part.hostBusy += hostCost(job, costs, works_[i]);
        }
      }
      parts[begin / kReadAtOnce] = part;
    });
    Part all;
    for (const Part& part : parts) {
      all.hostBusy += part.hostBusy;
      all.onDevice += part.onDevice;
      for (const int model : {0, 1}) all.any[model] = all.any[model] || part.any[model];
    }
    hostBusy_ = all.hostBusy;
    expectedOfAll_ = costs.launchCost(all.any[0], all.any[1]) + all.onDevice;
  }
  static Kind kindOf(const PairJob& job, double work, bool solid, const CostModel& costs, bool knowSolids) {
    const Placement place = settled(job.place);
    const bool isOpen = place.middle == Place::kAuto, isTogether = place.middle == place.near;
    const bool inBatch = isTogether && !job.byLevels && (contactsOnDevice(job) || (solid && (!isOpen || knowSolids)));
    if (!isOpen && place.middle != Place::kOpencl && place.near != Place::kOpencl) return Kind::kHost;
    if (inBatch) return isOpen ? Kind::kOpen : Kind::kBound;
    return !isOpen || isSoonerOnDevice(job, costs, work) ? Kind::kWithDevice : Kind::kHost;
  }

  static std::vector<CostModel> modelsOf(const std::vector<std::shared_ptr<DeviceSlot>>& devices) {
    std::vector<CostModel> models;
    models.reserve(devices.size());
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
    if (devices_.empty()) {
      singles_.resize(pairs_.size());
      std::iota(singles_.begin(), singles_.end(), std::size_t{0});
      return;
    }
    measure();
    Indices bound, open, withDevice;
    bound.reserve(pairs_.size());
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      switch (kinds_[i]) {
        case Kind::kBound:
          bound.push_back(i);
          break;
        case Kind::kOpen:
          open.push_back(i);
          break;
        case Kind::kWithDevice:
          withDevice.push_back(i);
          [[fallthrough]];
        case Kind::kHost:
          singles_.push_back(i);
      }
    }
    const std::vector<CostModel> models = modelsOf(devices_);
    bindLarge(models, open, bound);
    if (!withDevice.empty()) slotOf_.resize(pairs_.size(), nullptr);
    for (std::size_t k = 0; k < withDevice.size(); ++k) {
      slotOf_[withDevice[k]] = devices_[k * devices_.size() / withDevice.size()].get();
    }
    if (open.empty() && devices_.size() == 1) {
      blocks_.push_back(std::move(bound));
      return;
    }
    Division division;
    division.bound = bound.size();
    division.hostBusy = hostBusy_;
    division.threads = pool_.threadCount();
    bound.insert(bound.end(), open.begin(), open.end());
    std::vector<double> work;
    work.reserve(bound.size());
    for (const std::size_t i : bound) work.push_back(works_[i]);
    std::vector<std::uint8_t> solid;
    solid.reserve(bound.size());
    for (const std::size_t i : bound) solid.push_back(solids_[i]);
    division.work = work;
    division.solid = solid;
    std::size_t begin = 0;
    for (const std::size_t end : divide(division, models)) {
      blocks_.emplace_back(bound.begin() + static_cast<std::ptrdiff_t>(begin),
                           bound.begin() + static_cast<std::ptrdiff_t>(end));
      begin = end;
    }
    open_.assign(bound.begin() + static_cast<std::ptrdiff_t>(begin), bound.end());
    singles_.insert(singles_.end(), open_.begin(), open_.end());
    if (takesOver_ && !open_.empty()) claimed_ = std::vector<std::atomic<bool>>(pairs_.size());
  }

  /// What a device's block is expected to take, in microseconds.
  double expectedOf(const DeviceSlot& slot, const Indices& block) const {
    double expected = launchCost(slot.costs, block);
    for (const std::size_t i : block) expected += deviceCost(i, slot.costs);
    return expected;
  }

  /// For who queries devices, while they are at work.
  void noteExpected() const {
    for (std::size_t d = 0; d < blocks_.size(); ++d) {
      if (blocks_[d].size() < pairs_.size()) {
        devices_[d]->blockExpectedMs = 1e-3 * expectedOf(*devices_[d], blocks_[d]);
      }
    }
  }

  /// Whether the caller is the one to do job `i`: the first that calls is.
  bool claim(std::size_t i) { return claimed_.empty() || !claimed_[i].exchange(true, std::memory_order_relaxed); }

  /// By the pool's threads, one pair at a time.
  void runSingles() {
    runByPool(pool_, pairs_, singles_, [this](std::size_t i, Workspace& workspace) {
      if (!claim(i)) return;
      const PairJob& job = *pairs_[i].job;
      PairResult& result = *pairs_[i].result;
      keepOutcome(result, workspace, [&] {
        if (slotOf_.empty() || slotOf_[i] == nullptr) return collideOfMany(job, workspace);
        if (job.place == Placement{}) {  // it was found to be sooner there
          PairJob placed = job;
          placed.place = {Place::kOpencl, Place::kOpencl};
          return collideOn(*slotOf_[i], placed, workspace, result.onDevice, result.deviceFailed);
        }
        return collideOn(*slotOf_[i], job, workspace, result.onDevice, result.deviceFailed);
      });
    });
    PairCounts sums;
    for (const std::size_t i : singles_) sums += pairs_[i].result->counts;
    const std::lock_guard lock(mutex_);
    end_.counts += sums;
  }

  /// A device's block, and then what it takes over from the CPU.
  void runDevice(DeviceSlot& slot, const Indices& block) noexcept {
    const auto begin = Clock::now();
    runBlock(slot, block);
    if (claimed_.empty()) return;
    try {
      // How much slower than expected the device was, and the CPU until now; not more than a little quicker.
      const double slower = std::max(0.5, microseconds(begin) / std::max(expectedOf(slot, block), 1.0));
      while (!slot.isOff) {
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
      const double cost = hostCost(*pairs_[open_[k]].job, slot.costs, works_[open_[k]]);
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
      cost += hostCost(*pairs_[open_[k]].job, slot.costs, works_[open_[k]]);
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
    const auto start = Clock::now();
    const bool first = slot.blockMs == 0;  // not what it takes over
    const auto solids = std::count_if(block.begin(), block.end(), [&](std::size_t i) { return solids_[i] != 0; });
    if (solids == 0 || static_cast<std::size_t>(solids) == block.size()) {
      runModel(slot, block);
    } else {
      Indices models[2];
      try {
        for (const std::size_t i : block) models[solids_[i]].push_back(i);
      } catch (...) {
        for (const std::size_t i : block) pairs_[i].result->outcome = PairResult::Outcome::kNoMemory;
        return;
      }
      for (const Indices& some : models) runModel(slot, some);
    }
    if (first) slot.blockMs = 1e-3 * microseconds(start);
  }

  void runModel(DeviceSlot& slot, const Indices& block) noexcept {
    try {
      if (slot.isOff) {
        leave(block);
        return;
      }
      std::vector<const Query*> queries;
      queries.reserve(block.size());
      for (const std::size_t i : block) queries.push_back(&pairs_[i].job->query);
      const auto shared = std::make_shared<opencl::BatchAnswer>();
      opencl::BatchAnswer& answer = *shared;
      const opencl::RunParts onHost = [&](std::size_t count, const ThreadPool::Work& work) {
        pool_.run(count, 1, work, true);  // the device waits for it, and nothing waits for pairs of the CPU
      };
      const bool good = slot.backend->collideBatch(queries, answer, nullptr, onHost);
      slot.note(block.size(), good);
      {
        const std::lock_guard lock(mutex_);
        end_.memory.push_back(shared);
        end_.counts += PairCounts(answer.stats);
      }
      pool_.run(block.size(), kReadAtOnce, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          PairResult& result = *pairs_[block[k]].result;
          result.contacts = answer.of(k);
          result.onDevice = good;
          result.deviceFailed = !good;
        }
      });
      for (const std::size_t k : answer.byHost) pairs_[block[k]].result->onDevice = false;
      for (const std::size_t k : answer.refused) pairs_[block[k]].result->outcome = PairResult::Outcome::kRefused;
    } catch (...) {  // of want of memory, which may be one pair's: each by itself
      try {
        leave(block);
      } catch (...) {
        for (const std::size_t i : block) pairs_[i].result->outcome = PairResult::Outcome::kNoMemory;
      }
    }
  }

  /// To the CPU's threads, when the devices are done.
  void leave(const Indices& jobs) {
    const std::lock_guard lock(mutex_);
    leftOver_.insert(leftOver_.end(), jobs.begin(), jobs.end());
  }

  ThreadPool& pool_;
  const std::vector<std::shared_ptr<DeviceSlot>>& devices_;
  const std::span<const PairWork> pairs_;
  const bool takesOver_;
  Indices singles_;
  std::vector<Indices> blocks_;             ///< one for each device
  Indices open_;                            ///< of the singles: those that a device may take over
  std::vector<double> works_;               ///< expectedWork of every job
  std::vector<std::uint8_t> solids_;        ///< solidInBatch of every job
  std::vector<Kind> kinds_;                 ///< of every job, if there are devices
  std::vector<std::atomic<bool>> claimed_;  ///< by job; empty if there is no taking over
  std::mutex takeOver_;
  double hostBusy_ = 0, takenCost_ = 0;
  double expectedOfAll_ = 0;  ///< microseconds on the first device by itself
  Clock::time_point start_;
  std::vector<DeviceSlot*> slotOf_;  ///< by job, of singles that a device helps with; empty if it helps with none
  std::mutex mutex_;
  Indices leftOver_;
  BatchEnd end_;
};

}  // namespace

BatchEnd runBatch(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices,
                  std::span<const PairWork> work, bool takesOver) {
  return BatchRun(pool, devices, work, takesOver).run();
}

}  // namespace otg
