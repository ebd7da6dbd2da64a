// SPDX-License-Identifier: BSD-3-Clause
// Errors of the C API, of ODE and of the harness as exceptions of the Python package.
#pragma once

#include <nanobind/nanobind.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <atomic>
#include <stdexcept>
#include <string>

namespace otg::python {

namespace nb = nanobind;

/// A negative status of the C API with its sentence.
class StatusError : public std::runtime_error {
 public:
  StatusError(int status, const std::string& message) : std::runtime_error(message), status_(status) {}
  int status() const { return status_; }

 private:
  int status_;
};

/// Returns the status if it is no error; throws StatusError otherwise. `doing` goes in front of the library's sentence.
int check(int status, const std::string& doing = {});

/// Throws what dGpuTriMeshGetError() says; for functions that return null or 0.
[[noreturn]] void failWithLastError(const std::string& doing = {});

/// A value that a function of the module does not take.
class ArgumentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// ODE reached a point where it would end the program.
class OdeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Has an object used by one thread at a time. The second one gets an exception: waiting with the interpreter's lock
/// held could block both.
class OneAtATime {
 public:
  explicit OneAtATime(std::atomic<bool>& busy) : busy_(busy) {
    if (busy_.exchange(true)) throw StatusError(dGPUTRIMESH_ERROR_BUSY, "another thread is using this object");
  }
  ~OneAtATime() { busy_ = false; }
  OneAtATime(const OneAtATime&) = delete;
  OneAtATime& operator=(const OneAtATime&) = delete;

 private:
  std::atomic<bool>& busy_;
};

/// What ODE needs in each thread that calls it. Cheap after the first call of a thread.
void prepareThread();

/// Starts ODE and the geom class, and has ODE's fatal errors thrown as OdeError. Throws if that is not possible.
void startOde();

/// Defines how errors become exceptions, and the function that starts ODE.
void bindErrors(nb::module_& module);

}  // namespace otg::python
