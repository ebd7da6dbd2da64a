// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/programs.h"

#include <stdexcept>

#include "base/fork_gate.h"
#include "opencl/runtime/kernel_source.h"
#include "opencl/runtime/register_limit.h"
#include "opencl/runtime/stop.h"

namespace otg::opencl {
namespace {

/// What the formulas of the shared headers take for granted, on every device: no option here may let a compiler change
/// a rounding.
constexpr char kStandard[] = "-cl-std=CL1.2";

}  // namespace

Programs::Programs(cl_context context, const FoundDevice& device, ProgramCache cache)
    : context_(context),
      device_(device.device),
      cache_(std::move(cache)),
      deviceKey_(device.info.platform + "\n" + device.info.name + "\n" + device.info.version + "\n" +
                 device.info.driver),
      doubles_(device.info.doubles) {}

void Programs::loadCompiler() {
  const LibraryCall noFork;  // see stop.h
  fromSource("__kernel void nothing(__global uint* word) { *word = 0; }\n", kStandard);
}

cl_program Programs::get(const std::string& name, const std::string& options) {
  const std::lock_guard lock(mutex_);
  ProgramHandle& program = built_[{name, options}];
  if (program) return program.get();
  {
    const std::lock_guard lockFailed(failedMutex_);
    const auto found = failed_.find({name, options});
    if (found != failed_.end()) throw ClError(found->second);
  }
  checkStop();
  std::string source;
  try {
    source = kernelSource(name);
  } catch (const std::runtime_error& error) {
    throw ClError("clCreateProgramWithSource", CL_INVALID_PROGRAM, error.what());
  }
  const std::string all = std::string(kStandard) + (doubles_ ? " -DOTG_WITH_DOUBLE" : "") + " " + options;
  // The text itself is part of the key: two sources never share a file.
  const std::string key = deviceKey_ + "\n" + all + "\n" + source;
  if (const std::optional<Bytes> binary = cache_.load(key)) {
    try {
      program = fromBinary(*binary, all);
      ++counts_.fromCache;
      return program.get();
    } catch (const ClError&) {  // the driver does not take it (any more): build it
    }
  }
  ProgramHandle made;
  try {
    made = fromSource(source, all);
  } catch (const ClError& error) {
    if (error.code() == CL_BUILD_PROGRAM_FAILURE) giveUp(name, options, error);
    throw;
  }
  try {
    Bytes binary = binaryOf(made.get());
    if (std::optional<Bytes> limited = withRegisterLimit(binary, registerLimitOf(all))) {
      try {
        made = fromBinary(*limited, all);
        binary = *std::move(limited);
      } catch (const ClError&) {  // the program without the limit does the same
      }
    }
    cache_.store(key, binary);
  } catch (const ClError&) {  // a driver that gives no binary: it is built anew every time
  }
  ++counts_.fromSource;
  program = std::move(made);
  return program.get();
}

void Programs::giveUp(const std::string& name, const std::string& options, const ClError& why) {
  const std::lock_guard lock(failedMutex_);
  failed_.insert({{name, options}, why});
}

bool Programs::hasFailed(const std::string& beginning) const {
  const std::lock_guard lock(failedMutex_);
  const auto first = failed_.lower_bound({beginning, ""});
  return first != failed_.end() && first->first.first.starts_with(beginning);
}

std::size_t Programs::failedCount() const {
  const std::lock_guard lock(failedMutex_);
  return failed_.size();
}

Programs::Counts Programs::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

ProgramHandle Programs::fromBinary(const Bytes& binary, const std::string& options) {
  const std::size_t size = binary.size();
  const unsigned char* data = binary.data();
  cl_int status = CL_SUCCESS;
  ProgramHandle program(
      clMake(OTG_CL(clCreateProgramWithBinary), context_, cl_uint{1}, &device_, &size, &data, &status));
  if (status != CL_SUCCESS) throw ClError("clCreateProgramWithBinary", status);
  build(program.get(), options);
  return program;
}

ProgramHandle Programs::fromSource(const std::string& source, const std::string& options) {
  const std::size_t size = source.size();
  const char* text = source.c_str();
  ProgramHandle program(clMake(OTG_CL(clCreateProgramWithSource), context_, cl_uint{1}, &text, &size));
  build(program.get(), options);
  return program;
}

void Programs::build(cl_program program, const std::string& options) {
  try {
    clDo(OTG_CL(clBuildProgram), program, cl_uint{1}, &device_, options.c_str(), nullptr, nullptr);
  } catch (const ClError& error) {
    std::string log;
    try {
      std::size_t size = 0;
      clDo(OTG_CL(clGetProgramBuildInfo), program, device_, cl_program_build_info{CL_PROGRAM_BUILD_LOG}, std::size_t{0},
           static_cast<void*>(nullptr), &size);
      log.resize(size);
      clDo(OTG_CL(clGetProgramBuildInfo), program, device_, cl_program_build_info{CL_PROGRAM_BUILD_LOG}, size,
           static_cast<void*>(log.data()), static_cast<std::size_t*>(nullptr));
    } catch (const ClError&) {  // no log to be had; the code says enough
    }
    throw ClError(error.call(), error.code(), log);
  }
}

Bytes Programs::binaryOf(cl_program program) {
  std::size_t size = 0;
  clDo(OTG_CL(clGetProgramInfo), program, cl_program_info{CL_PROGRAM_BINARY_SIZES}, sizeof size,
       static_cast<void*>(&size), static_cast<std::size_t*>(nullptr));
  Bytes binary(size);
  unsigned char* data = binary.data();
  clDo(OTG_CL(clGetProgramInfo), program, cl_program_info{CL_PROGRAM_BINARIES}, sizeof data, static_cast<void*>(&data),
       static_cast<std::size_t*>(nullptr));
  return binary;
}

}  // namespace otg::opencl
