// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/context.h"

#include <bit>

#include "base/fork_gate.h"

namespace otg::opencl {

Context::Context(const FoundDevice& device, ProgramCache cache, bool doubles, std::uint64_t memory)
    : device_(device), memory_(std::make_shared<MemoryBudget>(memory)) {
  const LibraryCall noFork;  // drivers are loaded, see stop.h
  device_.info.doubles = device_.info.doubles && doubles;
  const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM,
                                              reinterpret_cast<cl_context_properties>(device.platform), 0};
  context_ = ContextHandle(
      clMake(OTG_CL(clCreateContext), properties, cl_uint{1}, &device_.device, nullptr, static_cast<void*>(nullptr)));
  if (device_.info.hostBuffers) {
    createHostBuffer_ = std::bit_cast<decltype(createHostBuffer_)>(
        api()->clGetExtensionFunctionAddressForPlatform(device.platform, "clCreateBufferNV"));
  }
  programs_ = std::make_unique<Programs>(context_.get(), device_, std::move(cache));
}

QueueHandle Context::makeQueue(bool profiling) const {
  const cl_command_queue_properties properties = profiling ? CL_QUEUE_PROFILING_ENABLE : 0;
  return QueueHandle(clMake(OTG_CL(clCreateCommandQueue), context_.get(), device_.device, properties));
}

MemoryShare Context::takeMemory(std::size_t bytes, const MemoryBudget::Sharer* asker) const {
  if (!memory_->take(bytes)) {
    if (asker != nullptr) {
      memory_->askOthers(*asker);
    } else {
      memory_->askAll();
    }
    if (!memory_->take(bytes)) {
      throw ClError("clCreateBuffer", CL_MEM_OBJECT_ALLOCATION_FAILURE, "the memory budget is used up");
    }
  }
  return {memory_, bytes};
}

BufferHandle Context::makeBuffer(cl_mem_flags flags, std::size_t bytes, const MemoryBudget::Sharer* asker) const {
  MemoryShare share = takeMemory(bytes, asker);
  ++buffersMade_;
  return {MemObjectHandle(clMake(OTG_CL(clCreateBuffer), context_.get(), flags, bytes, static_cast<void*>(nullptr))),
          std::move(share)};
}

BufferHandle Context::makeHostBuffer(std::size_t bytes) const {
  constexpr cl_bitfield kInHostMemory = 1;  // CL_MEM_LOCATION_HOST_NV
  MemoryShare share = takeMemory(bytes, nullptr);
  ++buffersMade_;
  return {MemObjectHandle(clMake("clCreateBufferNV", createHostBuffer_, context_.get(), cl_mem_flags{CL_MEM_READ_WRITE},
                                 kInHostMemory, bytes, static_cast<void*>(nullptr))),
          std::move(share)};
}

Kernel Context::makeKernel(const std::string& program, const std::string& options, const char* kernel) {
  KernelHandle made(clMake(OTG_CL(clCreateKernel), programs_->get(program, options), kernel));
  try {
    checkLimits(made.get(), program);
  } catch (const ClError& error) {
    if (error.code() == CL_INVALID_WORK_GROUP_SIZE) programs_->giveUp(program, options, error);
    throw;
  }
  return Kernel(std::move(made), &buffersMade_);
}

/// Throws ClError for a kernel whose work-groups need more local memory than there is: to launch it would fail each
/// time. CL_KERNEL_WORK_GROUP_SIZE is not queried: Rusticl 22.3 says 32 of kernels that it runs with 128.
void Context::checkLimits(cl_kernel kernel, const std::string& program) const {
  cl_ulong local = 0;
  clDo(OTG_CL(clGetKernelWorkGroupInfo), kernel, device_.device, cl_kernel_work_group_info{CL_KERNEL_LOCAL_MEM_SIZE},
       sizeof local, static_cast<void*>(&local), static_cast<std::size_t*>(nullptr));
  if (local <= device_.info.localMemory) return;
  throw ClError("clCreateKernel", CL_INVALID_WORK_GROUP_SIZE, program + " needs more local memory than the device has");
}

}  // namespace otg::opencl
