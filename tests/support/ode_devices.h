// SPDX-License-Identifier: BSD-3-Clause
// What tests of the C API ask of the first device.
#pragma once

#include <cstdint>

#include "ode_trimesh_gpu/ode_trimesh_gpu.h"
#include "support/catch.h"

namespace otg::test {

/// Calls that the device has answered so far; none of them failed.
inline std::uint64_t deviceCalls() {
  dGpuTriMeshDevice device;
  dGpuTriMeshDeviceInit(&device);
  CHECK(dGpuTriMeshGetDevice(0, &device) == dGPUTRIMESH_OK);
  CHECK(device.failed_calls == 0);
  return device.calls;
}

}  // namespace otg::test
