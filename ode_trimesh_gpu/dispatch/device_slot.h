// SPDX-License-Identifier: BSD-3-Clause
// An open device and what became of the work it was given.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "dispatch/cost/cost_model.h"
#include "opencl/backend.h"

namespace otg {

/// Whether work that may be done anywhere (Place::kAuto) may go to a device. Not to one of type CPU: it has the cores
/// that the library's own threads have, and is slower on them. Work that must go to a device does go there.
bool takesAuto(const opencl::DeviceInfo& device);
/// Tests: such devices take it, too, if they are opened from now on. Returns what held before.
bool letCpusTakeAuto(bool they);

/// Any number of threads.
struct DeviceSlot {
  /// A device that fails so often in a row is not used any more.
  static constexpr int kMostFailures = 3;

  std::shared_ptr<opencl::Backend> backend;
  CostModel costs = assumedCosts();
  bool knowsCosts = false;          ///< whether they were measured
  bool isForAuto = true;            ///< see takesAuto()
  std::atomic<int> underWay{0};     ///< single queries at the moment
  std::atomic<int> failedInRow{0};  ///< calls
  std::atomic<bool> isOff{false};
  std::atomic<std::uint64_t> queries{0};        ///< pairs that it was given
  std::atomic<std::uint64_t> failedQueries{0};  ///< of these, in calls that failed: the CPU did what it left
  std::atomic<std::uint64_t> calls{0}, failedCalls{0};
  /// Of the last batch: pairs in the device's block, what the block was expected to take, and what it took.
  std::atomic<std::uint64_t> blockPairs{0};
  std::atomic<double> blockExpectedMs{0}, blockMs{0};

  /// Counts a call for so many pairs. The device is switched off when it has failed too often; that is logged, once.
  void note(std::uint64_t pairs, bool good);
};

}  // namespace otg
