// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/context.h"

#include <bit>

namespace otg::opencl {

Context::Context(const FoundDevice& device, ProgramCache cache, bool doubles) : device_(device) {
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

BufferHandle Context::makeBuffer(cl_mem_flags flags, std::size_t bytes) const {
  ++buffersMade_;
  return BufferHandle(clMake(OTG_CL(clCreateBuffer), context_.get(), flags, bytes, static_cast<void*>(nullptr)));
}

BufferHandle Context::makeHostBuffer(std::size_t bytes) const {
  constexpr cl_bitfield kInHostMemory = 1;  // CL_MEM_LOCATION_HOST_NV
  ++buffersMade_;
  return BufferHandle(clMake("clCreateBufferNV", createHostBuffer_, context_.get(), cl_mem_flags{CL_MEM_READ_WRITE},
                             kInHostMemory, bytes, static_cast<void*>(nullptr)));
}

Kernel Context::makeKernel(const std::string& program, const std::string& options, const char* kernel) {
  return Kernel(KernelHandle(clMake(OTG_CL(clCreateKernel), programs_->get(program, options), kernel)), &buffersMade_);
}

}  // namespace otg::opencl
