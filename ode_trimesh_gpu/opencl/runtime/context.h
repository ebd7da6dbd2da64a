// SPDX-License-Identifier: BSD-3-Clause
// One OpenCL context on one device, with what is shared by all queries on it.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>

#include "opencl/runtime/device.h"
#include "opencl/runtime/handle.h"
#include "opencl/runtime/kernel.h"
#include "opencl/runtime/programs.h"

namespace otg::opencl {

/// Any thread. Everything made from it must go before it does.
class Context {
 public:
  /// Without `doubles` the device is used as if it had none. `memory`: most bytes of all buffers. Throws ClError.
  Context(const FoundDevice& device, ProgramCache cache, bool doubles = true,
          std::uint64_t memory = std::numeric_limits<std::uint64_t>::max());

  const DeviceInfo& info() const { return device_.info; }
  cl_context get() const { return context_.get(); }
  Programs& programs() { return *programs_; }

  /// In-order. Throws ClError.
  QueueHandle makeQueue(bool profiling) const;
  /// How many buffers were made so far: as long as that stays the same, a buffer's handle means the same buffer.
  std::uint64_t buffersMade() const { return buffersMade_; }
  /// What all buffers take together. Where it is used up, sharers are requested to let go of what they do not
  /// use.
  MemoryBudget& memory() const { return *memory_; }
  /// Throws ClError, with CL_MEM_OBJECT_ALLOCATION_FAILURE where the budget has no room. `asker` is left out.
  BufferHandle makeBuffer(cl_mem_flags flags, std::size_t bytes, const MemoryBudget::Sharer* asker = nullptr) const;
  /// In host memory, to be mapped once and for all: kernels write to it over the bus, and the host sees that when
  /// the queue has been waited for. Only with hostBuffers().
  BufferHandle makeHostBuffer(std::size_t bytes) const;
  bool hostBuffers() const { return createHostBuffer_ != nullptr; }
  Kernel makeKernel(const std::string& program, const std::string& options, const char* kernel);

 private:
  void checkLimits(cl_kernel kernel, const std::string& program) const;
  MemoryShare takeMemory(std::size_t bytes, const MemoryBudget::Sharer* asker) const;
  FoundDevice device_;
  std::shared_ptr<MemoryBudget> memory_;
  ContextHandle context_;
  /// clCreateBufferNV: as clCreateBuffer, with flags of its own behind the usual ones.
  cl_mem (*createHostBuffer_)(cl_context, cl_mem_flags, cl_bitfield, std::size_t, void*, cl_int*) = nullptr;
  std::unique_ptr<Programs> programs_;
  mutable std::atomic<std::uint64_t> buffersMade_{0};
};

}  // namespace otg::opencl
