// SPDX-License-Identifier: BSD-3-Clause
// Finding OpenCL devices.
#pragma once

#include <vector>

#include "opencl/runtime/api.h"
#include "opencl/runtime/device_info.h"

namespace otg::opencl {

struct FoundDevice {
  cl_platform_id platform = nullptr;
  cl_device_id device = nullptr;
  DeviceInfo info;
};

/// As listDevices(), with the identifiers to make contexts from.
std::vector<FoundDevice> findDevices();

}  // namespace otg::opencl
