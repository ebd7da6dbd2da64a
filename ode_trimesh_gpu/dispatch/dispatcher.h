// SPDX-License-Identifier: BSD-3-Clause
// Who computes what: the CPU's threads, devices, or both at once. What is computed does not depend on it.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "dispatch/array_run.h"
#include "dispatch/cost/calibration.h"
#include "dispatch/device_slot.h"
#include "dispatch/distance_run.h"
#include "dispatch/overlap_run.h"
#include "dispatch/pair_job.h"
#include "dispatch/threads/background_thread.h"
#include "dispatch/threads/thread_pool.h"

namespace otg {

/// Whether opening a device measures its costs if they are not known. Without costs, pairs that may be computed
/// anywhere are the CPU's, and devices of different kinds get equal blocks of a batch.
enum class Costs { kMeasured, kIfStored };

/// Any number of threads.
class Dispatcher {
 public:
  Dispatcher() = default;
  ~Dispatcher() { stopOpening(); }
  Dispatcher(const Dispatcher&) = delete;
  Dispatcher& operator=(const Dispatcher&) = delete;

  /// Threads that work on one batch, the caller among them; 0: defaultThreadCount(), which is what it is at first.
  /// Batches under way go on with theirs.
  void setThreadCount(unsigned threads);
  unsigned threadCount() const;
  /// Who runs the CPU's share of batches, in place of threads of the library's own; one without function: these again.
  void setTaskRunner(const TaskRunner& runner);

  /// Where pairs run that say nothing else: a setting that this class keeps for the layer above.
  void setPlacement(Placement place) { place_ = place; }
  Placement placement() const { return place_; }

  /// Whether devices that are done before the CPU take over what it has not begun (they do); without that a batch is
  /// divided as planned.
  void setTakeOver(bool takesOver) { takesOver_ = takesOver; }

  /// Bytes that all buffers may take on each device that is opened from now on; 0: what Tuning::memoryBudget says of 0.
  void setDeviceMemory(std::uint64_t bytes) { deviceMemory_ = bytes; }
  std::uint64_t deviceMemory() const { return deviceMemory_; }

  /// Opens these devices (numbers of opencl::listDevices(); one may be there several times, each with a context of its
  /// own). They replace those that were open. Measures their costs if they are not known. Devices that cannot be
  /// opened, or that fail meanwhile, are left out, which is logged. Returns how many are open. Throws std::bad_alloc.
  std::size_t open(std::span<const int> indices, const opencl::Tuning& tuning = {}, Costs costs = Costs::kMeasured);
  /// The same for the devices that `which` names, on a thread of its own: all is built and measured there, and until
  /// then this dispatcher has the devices that it has. Nothing if devices are being opened already. What is opened is
  /// dropped if devices are opened, set or closed meanwhile.
  void openLater(const std::function<std::vector<int>()>& which);
  /// Waits until no devices are being opened on that thread, for so long at most; whether that is so.
  bool waitForOpening(std::chrono::milliseconds most) { return opener_.wait(most); }
  /// Has that thread stop, and waits for that: until the program that it builds is built. Whether there was something
  /// to stop.
  bool stopOpening() noexcept;
  /// Tests: called by that thread before anything else.
  void setOpeningHook(std::function<void()> hook);
  void close() { setDevices({}); }
  /// Lets go of the devices without closing them: for the end of the process, when a driver may be gone already.
  void abandon() noexcept;
  /// Around a fork(), when no call is under way. The child has neither threads nor devices of its parent, and opens no
  /// devices: the CPU computes there, with threads of its own.
  void beforeFork() noexcept { mutex_.lock(); }
  void inParent() noexcept { mutex_.unlock(); }
  void inChild() noexcept;
  bool hasDevices() const { return hasDevices_.load(std::memory_order_acquire); }
  /// The open ones, switched off or not. None that are being opened.
  std::vector<std::shared_ptr<DeviceSlot>> devices() const;
  /// Takes over devices that were opened elsewhere.
  void setDevices(std::vector<std::shared_ptr<DeviceSlot>> devices);

  /// What a device had to do with a result.
  struct Ran {
    bool onDevice = false, deviceFailed = false;
  };
  /// One job on the calling thread: its contacts, in the workspace. Throws what otg::collide throws.
  std::span<const Contact> collide(const PairJob& job, Workspace& workspace, Ran& ran);

  /// ThreadPool::run on the threads of batches.
  void run(std::size_t count, std::size_t grain, const ThreadPool::Work& work);
  /// ThreadPool::runShort on these.
  void runShort(std::size_t count, std::size_t grain, const ThreadPool::Work& work);

  /// Every point of an array, each with the result that it has by itself. Runs on the CPU or, where the job and the
  /// costs say so, with the device that has the least to do.
  void askPoints(const PointJob& job, std::size_t count, const PointSource& source, const PointSink& sink);
  /// The same for rays.
  void castRays(const RayJob& job, std::size_t count, const RaySource& source, const RaySink& sink);

  /// Whether the meshes of each pair overlap: see runOverlaps.
  void askOverlaps(std::span<const OverlapJob> jobs, std::span<std::uint8_t> answers);

  /// How far the meshes of each pair are apart: see runDistances; with the device that has the least to do.
  void askDistances(std::span<const OverlapJob> jobs, double limit, std::span<MeshDistance> answers);

  /// Every job, each with the result that it has by itself, in place of one that is empty. The counts have those that a
  /// device has for a batch only among them. Throws std::bad_alloc, after which the results are of no use; want of
  /// memory for a single pair is an outcome of that pair.
  [[nodiscard]] BatchEnd collideBatch(std::span<const PairWork> work);
  /// The same; as many jobs as results.
  [[nodiscard]] BatchEnd collideBatch(std::span<const PairJob* const> jobs, std::span<PairResult> results);

 private:
  using Slots = std::vector<std::shared_ptr<DeviceSlot>>;
  std::shared_ptr<ThreadPool> pool();
  Slots usableDevices() const;
  /// What the work of one call may be: for either side, or for devices alone.
  struct Places {
    bool anyAuto = false, anyBound = false;
    void add(const Placement& place) {
      if (isOpenToAll(place)) anyAuto = true;
      if (place.middle == Place::kOpencl || place.near == Place::kOpencl) anyBound = true;
    }
    void add(const PairWork& work) { add(work.job->place); }
    void add(const OverlapJob& job) { add(Placement{job.place, job.place}); }
  };
  template <class Work>
  static Places placesOf(std::span<const Work> work, bool isNeeded) {
    Places places;
    for (std::size_t i = 0; isNeeded && i < work.size(); ++i) places.add(work[i]);
    return places;
  }
  Slots devicesFor(const Places& places) const;
  static const std::shared_ptr<DeviceSlot>& leastBusy(const Slots& slots);
  Slots openAll(std::span<const int> indices, const opencl::Tuning& tuning, Costs costs, KeptCosts kept) const;
  using Flag = std::shared_ptr<std::atomic<bool>>;
  std::shared_ptr<ThreadPool> exchangeDevices(Slots& devices);
  void openNow(const Flag& dropped, const std::function<std::vector<int>()>& which);
  /// The device that has the least to do, where the place of an array and the costs say so; else null.
  template <class Job>
  std::shared_ptr<DeviceSlot> slotForArray(const Job& job, std::size_t count, unsigned threads) const;
  template <class Job>
  void answerArray(const Job& job, std::size_t count, const ArraySource<Job>& source, const ArraySink<Job>& sink);

  mutable std::mutex mutex_;
  std::atomic<Placement> place_{Placement{}};
  unsigned threads_ = 0;
  TaskRunner runner_;
  std::shared_ptr<ThreadPool> pool_;  ///< made when first needed
  Slots devices_;
  std::atomic<bool> hasDevices_{false}, takesOver_{true};
  std::atomic<std::uint64_t> deviceMemory_{0};
  Flag opening_;  ///< of what is being opened; set when it is dropped
  std::function<void()> openingHook_;
  BackgroundThread opener_;
};

/// The one of the process.
Dispatcher& dispatcher();

/// Called by the main thread at some time, it has the end of the process wait for what dispatcher() opens in the
/// background. By other threads: nothing.
void watchEndOfProcess();

}  // namespace otg
