// SPDX-License-Identifier: BSD-3-Clause
// dGpuTriMeshInit and dGpuTriMeshClose, sentences for status codes, and what the library was built as.
#include "ode_trimesh_gpu/library.h"

#include <atomic>
#include <string_view>

#include "dispatch/dispatcher.h"
#include "dispatch/threads/workspace_lease.h"
#include "ode/base/status.h"
#include "ode/geom/class_number.h"
#include "ode/library/class_registration.h"
#include "ode_trimesh_gpu/backend.h"
#include "ode_trimesh_gpu/version.h"

namespace otg {
namespace {

std::atomic<bool> openingDropped{false};  ///< of a device for `auto`, by dGpuTriMeshClose()

#if defined(dDOUBLE)
constexpr char kConfiguration[] = "ode_trimesh_gpu double_precision";
#else
constexpr char kConfiguration[] = "ode_trimesh_gpu single_precision";
#endif

}  // namespace
}  // namespace otg

int dGpuTriMeshInit(void) {
  if (otg::ensureRegistered() != dGPUTRIMESH_OK) return 0;
  // What Close has dropped is begun again, unless something else was requested meanwhile.
  if (otg::openingDropped.exchange(false) && dGpuTriMeshGetBackend() == dGPUTRIMESH_BACKEND_AUTO) {
    dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO);
  }
  return 1;
}

void dGpuTriMeshClose(void) {
  otg::freeThreadWorkspaces();
  if (otg::dispatcher().stopOpening()) otg::openingDropped = true;
}

int dGpuTriMeshGetClass(void) {
  return otg::registeredClass();
}

int dGpuTriMeshGetError(void) {
  return otg::takeStatus();
}

#define OTG_TEXT_OF(number) #number
#define OTG_VERSION_TEXT(major, minor, patch) OTG_TEXT_OF(major) "." OTG_TEXT_OF(minor) "." OTG_TEXT_OF(patch)

const char* dGpuTriMeshGetVersion(void) {
  return OTG_VERSION_TEXT(dGPUTRIMESH_VERSION_MAJOR, dGPUTRIMESH_VERSION_MINOR, dGPUTRIMESH_VERSION_PATCH);
}

const char* dGpuTriMeshErrorString(int status) {
  switch (status) {
    case dGPUTRIMESH_OK:
      return "no error";
    case dGPUTRIMESH_NOT_SOLID:
      return "done, but the mesh is open or wound inconsistently and has no proper inside";
    case dGPUTRIMESH_NO_DEVICE:
      return "done, but no OpenCL device can be used, so that the CPU computes";
    case dGPUTRIMESH_OPENING:
      return "done, but a device is still being opened, so that the CPU computes";
    case dGPUTRIMESH_ERROR_ARGUMENT:
      return "an argument is null, negative or out of range";
    case dGPUTRIMESH_ERROR_MESH:
      return "the mesh can't be worked with; its report says why";
    case dGPUTRIMESH_ERROR_MEMORY:
      return "out of memory";
    case dGPUTRIMESH_ERROR_UNSUPPORTED:
      return "this version of the library can't do that";
    case dGPUTRIMESH_ERROR_ODE:
      return "ODE is not initialised; call dInitODE2() first";
    case dGPUTRIMESH_ERROR_PRECISION:
      return "ODE was built with another precision (dReal) than this library";
    case dGPUTRIMESH_ERROR_CLASS:
      return "the geom is not of the class of this library";
    case dGPUTRIMESH_ERROR_MASS:
      return "the mesh has no positive volume, so that it has no mass";
    case dGPUTRIMESH_ERROR_CLASS_COUNT:
      return "all of ODE's user classes are taken";
    case dGPUTRIMESH_ERROR_POSE:
      return "the pose of a geom is not finite, or its rotation matrix scales, shears or mirrors";
    case dGPUTRIMESH_ERROR_FILE:
      return "a file can't be read or written";
    case dGPUTRIMESH_ERROR_BUSY:
      return "mesh data are changed while a collision uses them";
    case dGPUTRIMESH_ERROR_COOKED:
      return "the bytes are no cooked mesh of this version, or are damaged";
    default:
      return "unknown status";
  }
}

const char* dGpuTriMeshGetConfiguration(void) {
  return otg::kConfiguration;
}

int dGpuTriMeshCheckConfiguration(const char* token) {
  if (token == nullptr || *token == '\0') return 0;
  const std::string_view wanted(token);
  std::string_view rest(otg::kConfiguration);
  while (!rest.empty()) {
    const std::size_t end = rest.find(' ');
    if (rest.substr(0, end) == wanted) return 1;
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  return 0;
}
