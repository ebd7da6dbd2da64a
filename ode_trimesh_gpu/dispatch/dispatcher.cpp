// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/dispatcher.h"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <system_error>
#include <utility>

#include "base/fork_gate.h"
#include "base/system.h"
#include "dispatch/batch_run.h"
#include "dispatch/cost/calibration.h"
#include "dispatch/cost/rehearsal.h"
#include "dispatch/single_run.h"
#include "opencl/runtime/device_info.h"
#include "opencl/runtime/log.h"
#include "opencl/runtime/stop.h"

namespace otg {
namespace {

/// The one dispatcher is gone. Programs may let go of batches in the destructors of their own globals after that.
std::atomic<bool> hasEnded{false};

/// In the main thread, whose own objects are destroyed before all else when the process ends: before what drivers and
/// their compilers do at its end, some of which is only registered while they compile.
struct EndOfMainThread {
  EndOfMainThread() = default;
  ~EndOfMainThread() { dispatcher().stopOpening(); }
  EndOfMainThread(const EndOfMainThread&) = delete;
  EndOfMainThread& operator=(const EndOfMainThread&) = delete;
};

void unlessEnded(void (Dispatcher::*step)() noexcept) {
  if (!hasEnded.load(std::memory_order_acquire)) (dispatcher().*step)();
}

void logWrong(const opencl::DeviceInfo& device) {
  opencl::logLine("OpenCL device " + std::to_string(device.index) + " (" + device.name +
                  ") gives other answers than the CPU; it is not used");
}

}  // namespace

void watchEndOfProcess() {
  if (!isMainThread()) return;
  thread_local const EndOfMainThread end;
  static_cast<void>(end);
}

void Dispatcher::setThreadCount(unsigned threads) {
  std::shared_ptr<ThreadPool> before;  // its threads end outside of the lock
  const std::lock_guard lock(mutex_);
  threads_ = threads;
  before.swap(pool_);
}

void Dispatcher::setTaskRunner(const TaskRunner& runner) {
  std::shared_ptr<ThreadPool> before;
  const std::lock_guard lock(mutex_);
  runner_ = runner;
  before.swap(pool_);
}

unsigned Dispatcher::threadCount() const {
  const std::lock_guard lock(mutex_);
  if (threads_ != 0) return threads_;
  return pool_ ? pool_->threadCount() : defaultThreadCount(hasDevices());  // the default queries the system
}

std::shared_ptr<ThreadPool> Dispatcher::pool() {
  const std::lock_guard lock(mutex_);
  if (!pool_)
    pool_ = std::make_shared<ThreadPool>(threads_ != 0 ? threads_ : defaultThreadCount(hasDevices()), runner_);
  return pool_;
}

Dispatcher::Slots Dispatcher::openAll(std::span<const int> indices, const opencl::Tuning& tuning, Costs request,
                                      KeptCosts kept) const {
  Slots slots;
  const opencl::ProgramCache cache = opencl::ProgramCache::standard();
  for (const int index : indices) {
    auto slot = std::make_shared<DeviceSlot>();
    opencl::Tuning how = tuning;
    if (how.memoryBudget == 0) how.memoryBudget = deviceMemory_;
    slot->backend = opencl::Backend::open(index, how);
    if (!slot->backend) continue;
    slot->isForAuto = takesAuto(slot->backend->device());
    std::optional<CostModel> costs = storedCosts(slot->backend->device(), cache);
    if (request == Costs::kMeasured) {
      // All programs are built before something is measured, and also where that is known: no query is to wait for it.
      const Rehearsed rehearsed = rehearse(*slot->backend);
      if (rehearsed == Rehearsed::kDiffers) {
        logWrong(slot->backend->device());
        continue;
      }
      const bool good = rehearsed == Rehearsed::kGood;
      if (good && !costs) costs = costsOf(*slot->backend, cache, kept);
      if (!good || !costs) {
        opencl::logLine("OpenCL device " + std::to_string(index) +
                        " failed while it was tried and its costs were measured; it is not used");
        continue;
      }
    } else if (!agreesWithHost(*slot->backend)) {
      logWrong(slot->backend->device());
      continue;
    }
    if (costs) slot->costs = *costs;
    slot->knowsCosts = costs.has_value();
    slots.push_back(std::move(slot));
  }
  return slots;
}

std::size_t Dispatcher::open(std::span<const int> indices, const opencl::Tuning& tuning, Costs request) {
  Slots slots = openAll(indices, tuning, request, KeptCosts::kAll);
  const std::size_t count = slots.size();
  setDevices(std::move(slots));
  return count;
}

void Dispatcher::setOpeningHook(std::function<void()> hook) {
  const std::lock_guard lock(mutex_);
  openingHook_ = std::move(hook);
}

void Dispatcher::openLater(const std::function<std::vector<int>()>& which) {
  if (opencl::areDevicesLost()) return;
  watchEndOfProcess();
  const auto dropped = std::make_shared<std::atomic<bool>>(false);
  {
    const std::lock_guard lock(mutex_);
    if (opening_ && !opener_.wait(std::chrono::milliseconds(0))) return;
    opening_ = dropped;
  }
  try {
    opener_.run([this, dropped, which] { openNow(dropped, which); });
  } catch (const std::system_error&) {  // no thread to be had
    openNow(dropped, which);
  }
}

void Dispatcher::openNow(const Flag& dropped, const std::function<std::vector<int>()>& which) {
  Slots slots;
  try {
    std::function<void()> hook;
    {
      const std::lock_guard lock(mutex_);
      hook = openingHook_;
    }
    if (hook) hook();
    // Where the process is ended by another thread than the main one, this does what watchEndOfProcess() does, but for
    // what compilers register later.
    const opencl::StopScope scope(*dropped, [this] {
      if (this == &dispatcher()) static_cast<void>(std::atexit([] { dispatcher().stopOpening(); }));
    });
    opencl::checkStop();
    slots = openAll(which(), {}, Costs::kMeasured, KeptCosts::kUndisturbed);
  } catch (const opencl::Stopped&) {
    slots.clear();
  } catch (const std::exception& error) {
    slots.clear();
    opencl::logLine(std::string("no device was opened: ") + error.what());
  }
  std::shared_ptr<ThreadPool> before;
  const std::lock_guard lock(mutex_);
  if (*dropped || opening_ != dropped) return;  // closed outside of the lock
  opening_.reset();
  before = exchangeDevices(slots);
}

bool Dispatcher::stopOpening() noexcept {
  bool wasOpening = false;
  {
    const std::lock_guard lock(mutex_);
    wasOpening = opening_ != nullptr;
    if (opening_) *opening_ = true;
    opening_.reset();
  }
  opener_.join();
  return wasOpening;
}

void Dispatcher::setDevices(Slots devices) {
  std::shared_ptr<ThreadPool> before;
  const std::lock_guard lock(mutex_);
  if (opening_) *opening_ = true;
  opening_.reset();
  before = exchangeDevices(devices);
}

/// Under the mutex. Returns threads that nobody is to take any more; they end outside of it.
std::shared_ptr<ThreadPool> Dispatcher::exchangeDevices(Slots& devices) {
  devices_.swap(devices);
  hasDevices_.store(!devices_.empty(), std::memory_order_release);
  return threads_ == 0 ? std::exchange(pool_, nullptr) : nullptr;  // the default is another one beside devices
}

void Dispatcher::abandon() noexcept {
  const std::lock_guard lock(mutex_);
  hasDevices_.store(false, std::memory_order_release);
  // The shares are never given back.
  // NOLINTNEXTLINE(clang-analyzer-cplusplus.NewDeleteLeaks)
  for (std::shared_ptr<DeviceSlot>& slot : devices_) {
    auto* const kept = new (std::nothrow) std::shared_ptr<DeviceSlot>;
    if (kept == nullptr) return;
    kept->swap(slot);
  }
  devices_.clear();
}

void Dispatcher::inChild() noexcept {
  mutex_.unlock();
  abandon();
  const std::lock_guard lock(mutex_);
  opening_.reset();
  // The pool's threads are not there to be joined: it is never destroyed.
  auto* const kept = new (std::nothrow) std::shared_ptr<ThreadPool>;
  if (kept == nullptr) return;
  kept->swap(pool_);
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): see above

Dispatcher::Slots Dispatcher::devices() const {
  const std::lock_guard lock(mutex_);
  return devices_;
}

Dispatcher::Slots Dispatcher::usableDevices() const {
  if (!hasDevices()) return {};
  Slots slots = devices();
  std::erase_if(slots, [](const auto& slot) { return slot->isOff.load(); });
  return slots;
}

/// Where some work may be done anywhere, those that take such work. If there are none, those for the rest.
Dispatcher::Slots Dispatcher::devicesFor(const Places& places) const {
  Slots slots = usableDevices();
  if (!places.anyAuto || slots.empty()) return slots;
  Slots some = slots;
  std::erase_if(some, [](const auto& slot) { return !slot->isForAuto; });
  return some.empty() && places.anyBound ? slots : some;
}

const std::shared_ptr<DeviceSlot>& Dispatcher::leastBusy(const Slots& slots) {
  return *std::min_element(slots.begin(), slots.end(), [](const auto& x, const auto& y) {
    return x->underWay.load(std::memory_order_relaxed) < y->underWay.load(std::memory_order_relaxed);
  });
}

std::span<const Contact> Dispatcher::collide(const PairJob& job, Workspace& workspace, Ran& ran) {
  if (!hasDevices() || job.place == Placement{Place::kCpu, Place::kCpu} || isConvexJob(job)) {
    return collideOnHost(job, workspace);
  }
  const Slots slots = devicesFor({isOpenToAll(job.place), !isOpenToAll(job.place)});
  if (slots.empty()) return collideOnHost(job, workspace);
  return collideOn(*leastBusy(slots), job, workspace, ran.onDevice, ran.deviceFailed);
}

void Dispatcher::run(std::size_t count, std::size_t grain, const ThreadPool::Work& work) {
  if (count <= grain || hasEnded.load(std::memory_order_acquire)) {  // no need of threads, or none any more
    if (count > 0) work(0, count);
    return;
  }
  pool()->run(count, grain, work);
}

void Dispatcher::runShort(std::size_t count, std::size_t grain, const ThreadPool::Work& work) {
  if (count <= grain || hasEnded.load(std::memory_order_acquire)) {
    run(count, grain, work);
  } else {
    pool()->runShort(count, grain, work);
  }
}

template <class Job>
std::shared_ptr<DeviceSlot> Dispatcher::slotForArray(const Job& job, std::size_t count, unsigned threads) const {
  if (!hasDevices() || job.place == Place::kCpu) return nullptr;
  Slots slots = devicesFor({job.place == Place::kAuto, false});
  std::erase_if(slots, [&](const auto& slot) { return !canAnswer(*slot, job); });
  if (slots.empty()) return nullptr;
  const std::shared_ptr<DeviceSlot>& slot = leastBusy(slots);
  return job.place == Place::kOpencl || isArraySoonerOnDevice(job, count, slot->costs, threads) ? slot : nullptr;
}

template <class Job>
void Dispatcher::answerArray(const Job& job, std::size_t count, const ArraySource<Job>& source,
                             const ArraySink<Job>& sink) {
  if (count == 0) return;
  const std::shared_ptr<ThreadPool> threads = pool();
  if (const auto slot = slotForArray(job, count, threads->threadCount())) {
    answerOnDevice(*slot, *threads, job, count, source, sink);
  } else {
    answerOnHost(*threads, job, 0, count, source, sink);
  }
}

void Dispatcher::askPoints(const PointJob& job, std::size_t count, const PointSource& source, const PointSink& sink) {
  answerArray(job, count, source, sink);
}

void Dispatcher::castRays(const RayJob& job, std::size_t count, const RaySource& source, const RaySink& sink) {
  answerArray(job, count, source, sink);
}

void Dispatcher::askOverlaps(std::span<const OverlapJob> jobs, std::span<std::uint8_t> answers) {
  runOverlaps(*pool(), devicesFor(placesOf(jobs, hasDevices())), jobs, answers);
}

void Dispatcher::askDistances(std::span<const OverlapJob> jobs, double limit, std::span<MeshDistance> answers) {
  Slots slots = devicesFor(placesOf(jobs, hasDevices()));
  std::erase_if(slots, [](const auto& slot) { return !slot->backend->answersDistances(); });
  DeviceSlot* const slot = slots.empty() ? nullptr : leastBusy(slots).get();
  runDistances(*pool(), slot, jobs, limit, answers);
}

BatchEnd Dispatcher::collideBatch(std::span<const PairWork> work) {
  return runBatch(*pool(), devicesFor(placesOf(work, hasDevices())), work, takesOver_);
}

BatchEnd Dispatcher::collideBatch(std::span<const PairJob* const> jobs, std::span<PairResult> results) {
  std::vector<PairWork> work;
  work.reserve(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) work.push_back({jobs[i], &results[i]});
  return collideBatch(work);
}

Dispatcher& dispatcher() {
  struct Instance : Dispatcher {
    Instance() {
      addForkHooks({[] { unlessEnded(&Dispatcher::beforeFork); }, [] { unlessEnded(&Dispatcher::inParent); },
                    [] { unlessEnded(&Dispatcher::inChild); }});
    }
    ~Instance() {
      stopOpening();
      abandon();
      hasEnded.store(true, std::memory_order_release);
    }
  };
  static Instance instance;
  return instance;
}

}  // namespace otg
