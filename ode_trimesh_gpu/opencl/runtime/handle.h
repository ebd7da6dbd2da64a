// SPDX-License-Identifier: BSD-3-Clause
// Ownership of OpenCL objects.
#pragma once

#include <utility>

#include "opencl/runtime/call.h"
#include "opencl/runtime/memory_budget.h"

namespace otg::opencl {

/// Owns one reference. `Release` has a static function release(T).
template <class T, class Release>
class Handle {
 public:
  Handle() = default;
  explicit Handle(T object) : object_(object) {}
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Handle() {
    if (object_ != nullptr) Release::release(object_);
  }
  T get() const { return object_; }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  T object_ = nullptr;
};

#define OTG_CL_HANDLE(Name, type, function)                                            \
  struct Name##Release {                                                               \
    static void release(type object) noexcept { clRelease(OTG_CL(function), object); } \
  };                                                                                   \
  using Name = Handle<type, Name##Release>;
OTG_CL_HANDLE(ContextHandle, cl_context, clReleaseContext)
OTG_CL_HANDLE(QueueHandle, cl_command_queue, clReleaseCommandQueue)
OTG_CL_HANDLE(ProgramHandle, cl_program, clReleaseProgram)
OTG_CL_HANDLE(KernelHandle, cl_kernel, clReleaseKernel)
OTG_CL_HANDLE(MemObjectHandle, cl_mem, clReleaseMemObject)
OTG_CL_HANDLE(EventHandle, cl_event, clReleaseEvent)
#undef OTG_CL_HANDLE

/// A buffer and its share of the budget, which is given back when the buffer is released.
class BufferHandle {
 public:
  BufferHandle() = default;
  BufferHandle(MemObjectHandle object, MemoryShare share) : share_(std::move(share)), object_(std::move(object)) {}
  cl_mem get() const { return object_.get(); }
  explicit operator bool() const { return static_cast<bool>(object_); }

 private:
  MemoryShare share_;  // goes last
  MemObjectHandle object_;
};

}  // namespace otg::opencl
