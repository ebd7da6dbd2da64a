// SPDX-License-Identifier: BSD-3-Clause
// The text of the kernels.
#pragma once

#include <string>

namespace otg::opencl {

/// One file of the folder kernels/, as it was when the library was built.
struct KernelFile {
  const char* name;  ///< below kernels/, for example "shared/math/vec3.h"
  const char* text;
};
extern const KernelFile kKernelFiles[];
extern const unsigned kKernelFileCount;

/// The file `name` with the files that it includes put in, and #line directives so that messages of a compiler name the
/// place. If the environment variable OTG_KERNEL_DIR is set, files are read from that folder instead of those that were
/// built in. Throws std::runtime_error naming a file that is not there.
std::string kernelSource(const std::string& name);

}  // namespace otg::opencl
