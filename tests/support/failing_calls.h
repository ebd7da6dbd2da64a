// SPDX-License-Identifier: BSD-3-Clause
// What arrays of points, rays and distances promise when calls of OpenCL fail.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dispatch/device_slot.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "support/opencl.h"

namespace otg::test {

inline std::shared_ptr<DeviceSlot> openSlot(const opencl::Tuning& tuning = {}) {
  auto slot = std::make_shared<DeviceSlot>();
  slot->backend = openBackend(tuning);
  REQUIRE(slot->backend);
  return slot;
}

struct FailedCalls {
  std::uint64_t failed = 0, onHost = 0;
};

/// Has each call of OpenCL fail in turn, alone and with all after it. `differ(slot, times)`: asks so many times, with
/// meshes that the device has not seen, and returns how many answers are wrong. `onHost(slot)`: how many items the CPU
/// took over. At least `leastCalls` calls are looked for. What is logged is looked at.
template <class Differ, class OnHost>
FailedCalls checkFailingCalls(const opencl::Tuning& tuning, std::uint64_t leastCalls, const Differ& differ,
                              const OnHost& onHost) {
  std::uint64_t calls = 0;
  {
    const auto slot = openSlot(tuning);
    const std::uint64_t before = opencl::FaultInjection::callCount();
    CHECK(differ(*slot, 2) == 0);
    calls = opencl::FaultInjection::callCount() - before;
  }
  CHECK(calls > leastCalls);
  std::vector<std::string> lines;
  opencl::forgetFailures();
  opencl::setLogSink([&](const std::string& line) { lines.push_back(line); });
  FailedCalls sums;
  int notCounted = 0;  // failures that the slot does not know of
  for (const cl_int code : {CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE}) {
    for (const std::uint64_t more : {std::uint64_t{0}, std::uint64_t{1000000}}) {  // one call, or all from there on
      const auto slot = openSlot(tuning);
      for (std::uint64_t n = 1; n <= calls; ++n) {
        INFO("call " << n << " fails with " << code << (more > 0 ? " and all after it" : ""));
        const std::uint64_t failed = slot->failedCalls, taken = onHost(*slot);
        opencl::FaultInjection::failAt(n, code, more);
        REQUIRE(differ(*slot, 2) == 0);
        opencl::FaultInjection::failAt(0);
        notCounted += onHost(*slot) > taken && slot->failedCalls == failed;
        slot->isOff = false;
        REQUIRE(differ(*slot, 1) == 0);  // the backend is as good as new
        REQUIRE(slot->failedInRow == 0);
      }
      sums.failed += slot->failedCalls;
      sums.onHost += onHost(*slot);
    }
  }
  opencl::setLogSink({});
  CHECK(notCounted == 0);
  CHECK(sums.failed > 100);
  CHECK(lines.size() > 3);
  for (const std::string& line : lines) CHECK(line.find("ode_trimesh_gpu: ") == 0);
  return sums;
}

}  // namespace otg::test
