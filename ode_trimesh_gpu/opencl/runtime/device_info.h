// SPDX-License-Identifier: BSD-3-Clause
// What is known of an OpenCL device. Free of OpenCL's types, for layers above.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace otg::opencl {

enum class DeviceKind { kGpu, kAccelerator, kCpu, kOther };

struct DeviceInfo {
  int index = 0;  ///< place in the list of all devices: platforms in the loader's order, devices in the platform's
  std::string platform, name, vendor, version, driver;
  DeviceKind kind = DeviceKind::kOther;
  bool available = false;    ///< can be used now, has a compiler, is little-endian
  bool doubles = false;      ///< double arithmetic that rounds as IEEE 754 says, fma and denormals included
  bool longAtomics = false;  ///< 64-bit atomics: add, exchange, minimum and maximum
  bool warps =
      false;  ///< 32 work-items run in step and can compute their maximum: NVIDIA's compute capability 8 and up
  bool hostBuffers = false;    ///< kernels can write to host memory (cl_nv_create_buffer)
  bool registerLimit = false;  ///< the compiler takes a limit of registers (cl_nv_compiler_options)
  std::uint32_t computeUnits = 0;
  std::uint64_t globalMemory = 0, largestAllocation = 0, localMemory = 0;  ///< bytes
  std::uint64_t largestWorkGroup = 0;
};

const char* nameOf(DeviceKind kind);

/// All devices of all platforms; empty where there is no OpenCL. A platform or device that gives no reply is left out,
/// and that is logged.
std::vector<DeviceInfo> listDevices();

/// In a child of fork() whose parent has loaded OpenCL: there are no devices any more.
bool areDevicesLost() noexcept;

/// Number of the device that is used when none is requested, or -1 when none is usable. The environment variable
/// OTG_OPENCL_DEVICE chooses: a number as listed, a part of the name (case does not matter), or "none". Without it: the
/// first GPU, else the first accelerator, else the first CPU.
int defaultDevice(const std::vector<DeviceInfo>& devices);

}  // namespace otg::opencl
