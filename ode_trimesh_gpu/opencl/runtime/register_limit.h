// SPDX-License-Identifier: BSD-3-Clause
// A limit of registers for kernels whose compiler does not heed the option for it.
#pragma once

#include <optional>
#include <string>

#include "opencl/runtime/program_cache.h"

namespace otg::opencl {

/// The limit that the options of a program request (-cl-nv-maxrregcount=N), or 0.
unsigned registerLimitOf(const std::string& options);

/// A program binary in which every kernel has at most so many registers, where the binary is the text of PTX. NVIDIA's
/// compiler passes over the option where a kernel has a required size of work-groups, and heeds `.maxnreg` in the text.
/// None if it is no such text, or a kernel has a limit already.
std::optional<Bytes> withRegisterLimit(const Bytes& binary, unsigned registers);

}  // namespace otg::opencl
