// SPDX-License-Identifier: BSD-3-Clause
// The C API of where collisions are computed.
#include "ode_trimesh_gpu/backend.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <vector>

#include "base/environment.h"
#include "dispatch/dispatcher.h"
#include "ode/base/status.h"
#include "ode/geom/geom_class.h"
#include "ode/geom/mesh_side.h"
#include "opencl/runtime/device_info.h"
#include "opencl/runtime/log.h"

static_assert(dGPUTRIMESH_DEVICE_FAILURES == otg::DeviceSlot::kMostFailures);

namespace otg {
namespace {

std::vector<int> defaultDevices() {
  const int index = opencl::defaultDevice(opencl::listDevices());
  return index < 0 ? std::vector<int>{} : std::vector<int>{index};
}

/// What auto uses.
std::vector<int> devicesForAuto() {
  const std::vector<opencl::DeviceInfo> devices = opencl::listDevices();
  const int index = opencl::defaultDevice(devices);
  for (const opencl::DeviceInfo& device : devices) {
    if (device.index == index && takesAuto(device)) return {index};
  }
  return {};
}

std::vector<int> allGpus() {
  std::vector<int> gpus;
  for (const opencl::DeviceInfo& device : opencl::listDevices()) {
    if (device.kind == opencl::DeviceKind::kGpu && device.available) gpus.push_back(device.index);
  }
  return gpus;
}

Place placeOf(int backend) {
  switch (backend) {
    case dGPUTRIMESH_BACKEND_CPU:
      return Place::kCpu;
    case dGPUTRIMESH_BACKEND_OPENCL:
      return Place::kOpencl;
    default:
      return Place::kAuto;
  }
}

/// Whether no device is being opened in the background, after so many milliseconds at most; less than 0: any number.
bool waitForOpening(int milliseconds) {
  constexpr std::chrono::hours kLong(24);
  bool done = dispatcher().waitForOpening(std::chrono::milliseconds(std::max(milliseconds, 0)));
  while (!done && milliseconds < 0) done = dispatcher().waitForOpening(kLong);
  return done;
}

}  // namespace

void chooseBackendOfEnvironment() noexcept {
  try {
    const Environment environment = readEnvironment();
    if (environment.deviceMemory) dGpuTriMeshSetDeviceMemory(*environment.deviceMemory);
    if (!environment.backend) return;
    switch (*environment.backend) {
      case Environment::Backend::kAuto:
        dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO);
        break;
      case Environment::Backend::kCpu:
        dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU);
        break;
      case Environment::Backend::kOpencl:
        if (dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_NO_DEVICE) {
          opencl::logLineOnce("OTG_BACKEND=opencl: there is no OpenCL device, so the CPU computes");
        }
        break;
    }
  } catch (const std::bad_alloc&) {
    return;  // as if nothing were set
  }
}

}  // namespace otg

int dGpuTriMeshSetBackend(int backend) {
  return otg::guarded([&] {
    if (backend < dGPUTRIMESH_BACKEND_AUTO || backend > dGPUTRIMESH_BACKEND_OPENCL) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    otg::Dispatcher& dispatcher = otg::dispatcher();
    const otg::Place place = otg::placeOf(backend);
    if (place == otg::Place::kAuto && !dispatcher.hasDevices()) dispatcher.openLater(otg::devicesForAuto);
    if (place == otg::Place::kOpencl) {
      otg::waitForOpening(-1);
      if (!dispatcher.hasDevices()) dispatcher.open(otg::defaultDevices());
    }
    dispatcher.setPlacement({place, place});
    const bool inVain = place == otg::Place::kOpencl && !dispatcher.hasDevices();
    return static_cast<int>(inVain ? dGPUTRIMESH_NO_DEVICE : dGPUTRIMESH_OK);
  });
}

int dGpuTriMeshGetBackend(void) {
  switch (otg::dispatcher().placement().middle) {
    case otg::Place::kCpu:
      return dGPUTRIMESH_BACKEND_CPU;
    case otg::Place::kOpencl:
      return dGPUTRIMESH_BACKEND_OPENCL;
    default:
      return dGPUTRIMESH_BACKEND_AUTO;
  }
}

int dGeomGpuTriMeshSetBackend(dGeomID g, int backend) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    if (backend < dGPUTRIMESH_BACKEND_DEFAULT || backend > dGPUTRIMESH_BACKEND_OPENCL) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    object->params.backend = backend;
    object->params.middle_phase = object->params.near_phase = dGPUTRIMESH_BACKEND_DEFAULT;
    const bool inVain = backend == dGPUTRIMESH_BACKEND_OPENCL && !otg::dispatcher().hasDevices();
    return static_cast<int>(inVain ? dGPUTRIMESH_NO_DEVICE : dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshGetBackend(dGeomID g) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    return object == nullptr ? static_cast<int>(dGPUTRIMESH_ERROR_CLASS) : object->params.backend;
  });
}

int dGpuTriMeshOpenDevices(const int* indices, int count) {
  return otg::guarded([&] {
    std::vector<int> which;
    if (indices != nullptr && count >= 0) {
      which.assign(indices, indices + count);
    } else if (indices == nullptr && (count == 0 || count == -1)) {
      which = count == 0 ? otg::defaultDevices() : otg::allGpus();
    } else {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    return static_cast<int>(otg::dispatcher().open(which));
  });
}

int dGpuTriMeshWaitForDevices(int milliseconds) {
  return otg::guarded([&] {
    const bool done = otg::waitForOpening(milliseconds);
    if (otg::dispatcher().hasDevices()) return static_cast<int>(dGPUTRIMESH_OK);
    return static_cast<int>(done ? dGPUTRIMESH_NO_DEVICE : dGPUTRIMESH_OPENING);
  });
}

void dGpuTriMeshSetDeviceMemory(duint64 bytes) {
  otg::dispatcher().setDeviceMemory(bytes);
}

duint64 dGpuTriMeshGetDeviceMemory(void) {
  return otg::dispatcher().deviceMemory();
}

duint64 dGpuTriMeshReleaseDeviceMemory(void) {
  std::uint64_t bytes = 0;
  otg::guarded([&] {
    for (const auto& slot : otg::dispatcher().devices()) bytes += slot->backend->releaseMemory();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return bytes;
}

void dGpuTriMeshCloseDevices(void) {
  otg::dispatcher().close();
}

void dGpuTriMeshDeviceInit(dGpuTriMeshDevice* device) {
  if (device == nullptr) return;
  *device = dGpuTriMeshDevice{};
  device->size = sizeof(dGpuTriMeshDevice);
}

int dGpuTriMeshGetDeviceCount(void) {
  int count = 0;
  otg::guarded([&] {
    count = static_cast<int>(otg::dispatcher().devices().size());
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return count;
}

int dGpuTriMeshGetDevice(int Index, dGpuTriMeshDevice* device) {
  return otg::guarded([&] {
    const auto slots = otg::dispatcher().devices();
    if (!otg::isCurrentSize(device) || Index < 0 || static_cast<std::size_t>(Index) >= slots.size()) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const otg::DeviceSlot& slot = *slots[static_cast<std::size_t>(Index)];
    const otg::opencl::DeviceInfo& info = slot.backend->device();
    const otg::opencl::BackendCounts counts = slot.backend->counts();
    dGpuTriMeshDeviceInit(device);
    device->index = info.index;
    device->switched_off = slot.isOff ? 1 : 0;
    const std::size_t length = std::min(info.name.size(), sizeof device->name - 1);
    std::memcpy(device->name, info.name.data(), length);
    device->queries = slot.queries;
    device->failed_queries = slot.failedQueries;
    device->calls = slot.calls;
    device->failed_calls = slot.failedCalls;
    device->mesh_uploads = counts.meshUploads;
    device->mesh_updates = counts.meshUpdates;
    device->mesh_bytes_sent = counts.meshBytesSent;
    device->mesh_evictions = counts.meshEvictions;
    device->mesh_bytes = counts.meshBytes;
    device->memory_bytes = counts.memory;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
