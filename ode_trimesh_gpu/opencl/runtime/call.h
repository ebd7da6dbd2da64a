// SPDX-License-Identifier: BSD-3-Clause
// The one way in which OpenCL is called: every call is counted, may be made to fail by a test, and reports failure as a
// ClError.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "opencl/runtime/api.h"

namespace otg::opencl {

/// A call that failed. Stays inside the layer: the backend catches it and the CPU finishes the query.
class ClError : public std::runtime_error {
 public:
  ClError(const char* call, cl_int code, const std::string& detail = {});
  /// Name of the function, a string literal.
  const char* call() const { return call_; }
  cl_int code() const { return code_; }

 private:
  const char* call_;
  cl_int code_;
};

/// Reports it as logFailure() does.
void logError(const ClError& error);

/// There is no room for meshes, because queries of others use those that take it.
struct MemoryInUse : ClError {
  using ClError::ClError;
};

/// Test hook: what makes calls fail. Process-wide.
struct FaultInjection {
  /// The `nth` call from now on (1 is the next) and `more` after it fail with `code`; 0 turns it off. Calls that
  /// release are made all the same, and then reported as failed.
  static void failAt(std::uint64_t nth, cl_int code = CL_OUT_OF_RESOURCES, std::uint64_t more = 0);
  /// Calls so far.
  static std::uint64_t callCount();
};

namespace detail {
/// Counts a call; CL_SUCCESS, or the code with which this call is to fail.
cl_int beginCall();
void reportRelease(const char* call, cl_int code) noexcept;
}  // namespace detail

/// Name and function for the templates below: clDo(OTG_CL(clFlush), queue).
#define OTG_CL(name) #name, ::otg::opencl::api()->name

/// A function that returns a status. Throws ClError.
template <class... P, class... A>
void clDo(const char* name, cl_int (*function)(P...), A... arguments) {
  cl_int code = detail::beginCall();
  if (code == CL_SUCCESS) code = function(arguments...);
  if (code != CL_SUCCESS) throw ClError(name, code);
}

/// A function that returns an object and takes the place for a status as its last argument. Throws ClError.
template <class T, class... P, class... A>
T clMake(const char* name, T (*function)(P...), A... arguments) {
  cl_int code = detail::beginCall();
  T object{};
  if (code == CL_SUCCESS) object = function(arguments..., &code);
  if (code != CL_SUCCESS) throw ClError(name, code);
  return object;
}

/// A function that releases or gives back. Never throws: a failure is logged.
template <class... P, class... A>
void clRelease(const char* name, cl_int (*function)(P...), A... arguments) noexcept {
  if (isOpenclForeign()) return;
  const cl_int injected = detail::beginCall();
  const cl_int code = function(arguments...);
  if (injected != CL_SUCCESS || code != CL_SUCCESS) detail::reportRelease(name, code != CL_SUCCESS ? code : injected);
}

}  // namespace otg::opencl
