// SPDX-License-Identifier: BSD-3-Clause
// The OpenCL functions that the library calls, found in the loader at run time: nothing is linked, so that the library
// works where no OpenCL is installed.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace otg::opencl {

#define OTG_CL_FUNCTIONS(F)    \
  F(clGetPlatformIDs)          \
  F(clGetPlatformInfo)         \
  F(clGetDeviceIDs)            \
  F(clGetDeviceInfo)           \
  F(clCreateContext)           \
  F(clReleaseContext)          \
  F(clCreateCommandQueue)      \
  F(clReleaseCommandQueue)     \
  F(clCreateProgramWithSource) \
  F(clCreateProgramWithBinary) \
  F(clBuildProgram)            \
  F(clGetProgramInfo)          \
  F(clGetProgramBuildInfo)     \
  F(clReleaseProgram)          \
  F(clCreateKernel)            \
  F(clGetKernelWorkGroupInfo)  \
  F(clSetKernelArg)            \
  F(clReleaseKernel)           \
  F(clCreateBuffer)            \
  F(clReleaseMemObject)        \
  F(clEnqueueReadBuffer)       \
  F(clEnqueueWriteBuffer)      \
  F(clEnqueueCopyBuffer)       \
  F(clEnqueueFillBuffer)       \
  F(clEnqueueMapBuffer)        \
  F(clEnqueueUnmapMemObject)   \
  F(clEnqueueNDRangeKernel)    \
  F(clWaitForEvents)           \
  F(clGetEventInfo)            \
  F(clGetEventProfilingInfo)   \
  F(clReleaseEvent)            \
  F(clFlush)                   \
  F(clFinish)                  \
  F(clGetExtensionFunctionAddressForPlatform)

struct Api {
#define OTG_CL_MEMBER(name) decltype(&::name) name;
  OTG_CL_FUNCTIONS(OTG_CL_MEMBER)
#undef OTG_CL_MEMBER
};

/// Null when there is no loader or it lacks a function. The loader stays loaded until the process ends.
const Api* api();

/// In a child of fork() whose parent has loaded OpenCL: the driver's threads are not there, so that nothing of it may
/// be called any more, not even to release what the parent had.
bool isOpenclForeign() noexcept;

}  // namespace otg::opencl
