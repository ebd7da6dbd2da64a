// SPDX-License-Identifier: BSD-3-Clause
// Finding OpenCL devices and choosing one.
#include "opencl/runtime/device.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string>
#include <string_view>

#include "base/environment.h"
#include "base/fork_gate.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"

namespace otg::opencl {
namespace {

constexpr cl_int kNoPlatform = -1001;  // CL_PLATFORM_NOT_FOUND_KHR, of the loader

template <class T>
T number(cl_device_id device, cl_device_info what) {
  T value{};
  clDo(OTG_CL(clGetDeviceInfo), device, what, sizeof value, static_cast<void*>(&value),
       static_cast<std::size_t*>(nullptr));
  return value;
}

/// Strings come with a terminating zero, and some drivers pad with blanks.
template <class Ask>
std::string text(Ask&& ask) {
  std::size_t size = 0;
  ask(std::size_t{0}, static_cast<void*>(nullptr), &size);
  std::string value(size, '\0');
  if (size > 0) ask(size, static_cast<void*>(value.data()), static_cast<std::size_t*>(nullptr));
  value.resize(std::min(value.find('\0'), value.size()));
  while (!value.empty() && value.back() == ' ') value.pop_back();
  return value;
}

std::string deviceText(cl_device_id device, cl_device_info what) {
  return text([&](std::size_t size, void* to, std::size_t* needed) {
    clDo(OTG_CL(clGetDeviceInfo), device, what, size, to, needed);
  });
}

std::string platformText(cl_platform_id platform, cl_platform_info what) {
  return text([&](std::size_t size, void* to, std::size_t* needed) {
    clDo(OTG_CL(clGetPlatformInfo), platform, what, size, to, needed);
  });
}

DeviceKind kindOf(cl_device_type type) {
  if (type & CL_DEVICE_TYPE_GPU) return DeviceKind::kGpu;
  if (type & CL_DEVICE_TYPE_ACCELERATOR) return DeviceKind::kAccelerator;
  if (type & CL_DEVICE_TYPE_CPU) return DeviceKind::kCpu;
  return DeviceKind::kOther;
}

DeviceInfo describe(cl_platform_id platform, cl_device_id device) {
  DeviceInfo info;
  info.platform = platformText(platform, CL_PLATFORM_NAME) + ", " + platformText(platform, CL_PLATFORM_VERSION);
  info.name = deviceText(device, CL_DEVICE_NAME);
  info.vendor = deviceText(device, CL_DEVICE_VENDOR);
  info.version = deviceText(device, CL_DEVICE_VERSION);
  info.driver = deviceText(device, CL_DRIVER_VERSION);
  info.kind = kindOf(number<cl_device_type>(device, CL_DEVICE_TYPE));
  info.available = number<cl_bool>(device, CL_DEVICE_AVAILABLE) &&
                   number<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE) &&
                   number<cl_bool>(device, CL_DEVICE_ENDIAN_LITTLE);
  constexpr cl_device_fp_config kIeee = CL_FP_FMA | CL_FP_ROUND_TO_NEAREST | CL_FP_INF_NAN | CL_FP_DENORM;
  const std::string extensions = deviceText(device, CL_DEVICE_EXTENSIONS);
  const auto has = [&](const char* extension) { return extensions.find(extension) != std::string::npos; };
  info.doubles =
      has("cl_khr_fp64") && (number<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG) & kIeee) == kIeee;
  info.longAtomics = has("cl_khr_int64_base_atomics") && has("cl_khr_int64_extended_atomics");
  constexpr cl_device_info kComputeCapabilityMajor = 0x4000;  // CL_DEVICE_COMPUTE_CAPABILITY_MAJOR_NV
  info.warps = has("cl_nv_device_attribute_query") && number<cl_uint>(device, kComputeCapabilityMajor) >= 8;
  info.hostBuffers = has("cl_nv_create_buffer");
  info.registerLimit = has("cl_nv_compiler_options");
  info.computeUnits = number<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
  info.globalMemory = number<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
  info.largestAllocation = number<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  info.localMemory = number<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE);
  info.largestWorkGroup = number<std::size_t>(device, CL_DEVICE_MAX_WORK_GROUP_SIZE);
  return info;
}

std::vector<cl_platform_id> platforms() {
  cl_uint count = 0;
  try {
    clDo(OTG_CL(clGetPlatformIDs), cl_uint{0}, static_cast<cl_platform_id*>(nullptr), &count);
  } catch (const ClError& error) {
    if (error.code() == kNoPlatform) return {};  // a loader without drivers is no failure
    throw;
  }
  std::vector<cl_platform_id> ids(count);
  if (count > 0) clDo(OTG_CL(clGetPlatformIDs), count, ids.data(), static_cast<cl_uint*>(nullptr));
  return ids;
}

std::vector<cl_device_id> devicesOf(cl_platform_id platform) {
  cl_uint count = 0;
  try {
    clDo(OTG_CL(clGetDeviceIDs), platform, cl_device_type{CL_DEVICE_TYPE_ALL}, cl_uint{0},
         static_cast<cl_device_id*>(nullptr), &count);
  } catch (const ClError& error) {
    if (error.code() == CL_DEVICE_NOT_FOUND) return {};
    throw;
  }
  std::vector<cl_device_id> ids(count);
  if (count > 0) {
    clDo(OTG_CL(clGetDeviceIDs), platform, cl_device_type{CL_DEVICE_TYPE_ALL}, count, ids.data(),
         static_cast<cl_uint*>(nullptr));
  }
  return ids;
}

/// Runs a step of the search; what it fails with is logged.
template <class Step>
void tolerate(Step&& step) {
  try {
    step();
  } catch (const ClError& error) {
    logFailure(error.call(), error.code(), "while devices were looked for");
  }
}

std::string lower(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

/// Once for each value.
void sayNoDevice(const std::string& requested, const std::vector<DeviceInfo>& devices) {
  std::string allowed = "none";
  for (const DeviceInfo& device : devices) {
    if (device.available) allowed += ", " + std::to_string(device.index) + " or part of '" + device.name + "'";
  }
  logLineOnce(environmentFault("OTG_OPENCL_DEVICE", requested, allowed) + ". No device is used");
}

}  // namespace

const char* nameOf(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::kGpu:
      return "gpu";
    case DeviceKind::kAccelerator:
      return "accelerator";
    case DeviceKind::kCpu:
      return "cpu";
    case DeviceKind::kOther:
      break;
  }
  return "other";
}

std::vector<FoundDevice> findDevices() {
  const LibraryCall noFork;  // drivers are loaded, see stop.h
  std::vector<FoundDevice> found;
  if (isOpenclForeign() || api() == nullptr) return found;
  tolerate([&] {
    for (const cl_platform_id platform : platforms()) {
      tolerate([&] {
        for (const cl_device_id device : devicesOf(platform)) {
          tolerate([&] { found.push_back({platform, device, describe(platform, device)}); });
        }
      });
    }
  });
  for (std::size_t i = 0; i < found.size(); ++i) found[i].info.index = static_cast<int>(i);
  return found;
}

bool areDevicesLost() noexcept {
  return isOpenclForeign();
}

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> out;
  for (FoundDevice& device : findDevices()) out.push_back(std::move(device.info));
  return out;
}

int defaultDevice(const std::vector<DeviceInfo>& devices) {
  if (const std::string requested = readEnvironment().openclDevice; !requested.empty()) {
    const std::string_view word(requested);
    int index = -1;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
    const bool isNumber = error == std::errc() && end == word.data() + word.size();
    for (const DeviceInfo& device : devices) {
      const bool meant = isNumber ? device.index == index : lower(device.name).find(lower(word)) != std::string::npos;
      if (meant && device.available) return device.index;
    }
    if (word != "none") sayNoDevice(requested, devices);
    return -1;
  }
  for (const DeviceKind kind : {DeviceKind::kGpu, DeviceKind::kAccelerator, DeviceKind::kCpu}) {
    for (const DeviceInfo& device : devices) {
      if (device.kind == kind && device.available) return device.index;
    }
  }
  return -1;
}

}  // namespace otg::opencl
