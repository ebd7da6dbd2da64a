// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/device_slot.h"

#include <string>

#include "opencl/runtime/log.h"

namespace otg {
namespace {

std::atomic<bool> cpusTakeAuto{false};

}  // namespace

bool takesAuto(const opencl::DeviceInfo& device) {
  return device.kind != opencl::DeviceKind::kCpu || cpusTakeAuto.load(std::memory_order_relaxed);
}

bool letCpusTakeAuto(bool they) {
  return cpusTakeAuto.exchange(they);
}

void DeviceSlot::note(std::uint64_t pairs, bool good) {
  queries.fetch_add(pairs, std::memory_order_relaxed);
  calls.fetch_add(1, std::memory_order_relaxed);
  if (good) {
    failedInRow.store(0, std::memory_order_relaxed);
    return;
  }
  failedQueries.fetch_add(pairs, std::memory_order_relaxed);
  failedCalls.fetch_add(1, std::memory_order_relaxed);
  if (failedInRow.fetch_add(1) + 1 < kMostFailures || isOff.exchange(true)) return;
  const opencl::DeviceInfo& device = backend->device();
  opencl::logLine("OpenCL device " + std::to_string(device.index) + " (" + device.name + ") failed " +
                  std::to_string(kMostFailures) + " times in a row and is switched off; the CPU does its work");
}

}  // namespace otg
