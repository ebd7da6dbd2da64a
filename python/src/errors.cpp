// SPDX-License-Identifier: BSD-3-Clause
#include "errors.h"

#include <ode/ode.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <new>

#include "mesh_io/mesh_file.h"
#include "scenes/scene_description.h"

namespace otg::python {
namespace {

/// The exception classes, which live as long as the process: those of errors.py once it has given them.
PyObject *base_error = PyExc_RuntimeError, *mesh_error = PyExc_RuntimeError, *pose_error = PyExc_RuntimeError,
         *scene_error = PyExc_RuntimeError, *argument_error = PyExc_RuntimeError, *busy_error = PyExc_RuntimeError,
         *ode_error = PyExc_RuntimeError;

PyObject* classOf(int status) {
  switch (status) {
    case dGPUTRIMESH_ERROR_MESH:
    case dGPUTRIMESH_ERROR_MASS:
    case dGPUTRIMESH_ERROR_COOKED:
      return mesh_error;
    case dGPUTRIMESH_ERROR_POSE:
      return pose_error;
    case dGPUTRIMESH_ERROR_ARGUMENT:
      return argument_error;
    case dGPUTRIMESH_ERROR_BUSY:
      return busy_error;
    case dGPUTRIMESH_ERROR_MEMORY:
      return PyExc_MemoryError;
    case dGPUTRIMESH_ERROR_FILE:
      return PyExc_OSError;
    default:
      return base_error;
  }
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const StatusError& error) {
    PyErr_SetString(classOf(error.status()), error.what());
  } catch (const ArgumentError& error) {
    PyErr_SetString(argument_error, error.what());
  } catch (const OdeError& error) {
    PyErr_SetString(ode_error, error.what());
  } catch (const mesh_io::LoadError& error) {
    PyErr_SetString(mesh_error, error.what());
  } catch (const scenes::SceneError& error) {
    PyErr_SetString(scene_error, error.what());
  }
}

[[noreturn]] void throwOdeError(int, const char* message, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, message, arguments);
  throw OdeError(std::string("ODE cannot go on: ") + text);
}

struct OdeThread {
  OdeThread() { dAllocateODEDataForThread(dAllocateMaskAll); }
  ~OdeThread() { dCleanupODEAllDataForThread(); }
};

}  // namespace

int check(int status, const std::string& doing) {
  if (status >= 0) return status;
  const std::string why = dGpuTriMeshErrorString(status);
  throw StatusError(status, doing.empty() ? why : doing + ": " + why);
}

void failWithLastError(const std::string& doing) {
  const int status = dGpuTriMeshGetError();
  check(status < 0 ? status : dGPUTRIMESH_ERROR_MEMORY, doing);
  throw std::bad_alloc();  // not reached: the status is an error
}

void prepareThread() {
  static thread_local const OdeThread data;
  static_cast<void>(data);
}

void startOde() {
  dInitODE2(0);
  dSetErrorHandler(&throwOdeError);
  dSetDebugHandler(&throwOdeError);
  prepareThread();
  if (dGpuTriMeshInit() == 0) failWithLastError("the library cannot start");
}

void bindErrors(nb::module_& module) {
  nb::register_exception_translator(&translate, nullptr);
  module.def(
      "start",
      [](const nb::handle& base, const nb::handle& mesh, const nb::handle& pose, const nb::handle& scene,
         const nb::handle& argument, const nb::handle& busy, const nb::handle& ode) {
        base_error = base.inc_ref().ptr();
        mesh_error = mesh.inc_ref().ptr();
        pose_error = pose.inc_ref().ptr();
        scene_error = scene.inc_ref().ptr();
        argument_error = argument.inc_ref().ptr();
        busy_error = busy.inc_ref().ptr();
        ode_error = ode.inc_ref().ptr();
        startOde();
      },
      nb::arg("base"), nb::arg("mesh"), nb::arg("pose"), nb::arg("scene"), nb::arg("argument"), nb::arg("busy"),
      nb::arg("ode"), "Starts ODE. The classes are those that errors become.");
}

}  // namespace otg::python
