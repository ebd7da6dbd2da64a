// SPDX-License-Identifier: BSD-3-Clause
// The programs of one context: built when first requested, from the cache on disk where that has them.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "opencl/runtime/device.h"
#include "opencl/runtime/handle.h"
#include "opencl/runtime/program_cache.h"

namespace otg::opencl {

class Programs {
 public:
  Programs(cl_context context, const FoundDevice& device, ProgramCache cache);

  /// The kernel file `name` built with `options` ("-D..." words; the standard and what the device has are added).
  /// Throws ClError with the build log when it does not build, Stopped on a thread that has to stop (stop.h). Any
  /// thread; lives as long as this object.
  cl_program get(const std::string& name, const std::string& options);

  /// Says that what the device gives does not suffice for a program: get() throws this from now on.
  void giveUp(const std::string& name, const std::string& options, const ClError& why);
  /// Whether some program whose name begins with this could not be built, or was given up. What it is for runs on the
  /// CPU then.
  bool hasFailed(const std::string& beginning) const;
  /// How many could not.
  std::size_t failedCount() const;

  /// Builds a program of nothing, for which a driver loads its compiler. Throws ClError.
  void loadCompiler();

  /// How the programs so far came about.
  struct Counts {
    int fromSource = 0, fromCache = 0;
  };
  Counts counts() const;

 private:
  ProgramHandle fromBinary(const Bytes& binary, const std::string& options);
  ProgramHandle fromSource(const std::string& source, const std::string& options);
  void build(cl_program program, const std::string& options);
  Bytes binaryOf(cl_program program);

  cl_context context_;
  cl_device_id device_;
  ProgramCache cache_;
  std::string deviceKey_;
  bool doubles_;
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, std::string>, ProgramHandle> built_;
  mutable std::mutex failedMutex_;  // building takes its time
  std::map<std::pair<std::string, std::string>, ClError> failed_;
  Counts counts_;
};

}  // namespace otg::opencl
