// SPDX-License-Identifier: BSD-3-Clause
// Having a device build all programs that queries may need, before there are queries.
#pragma once

#include "opencl/backend.h"

namespace otg {

/// Whether `auto` gives this device pairs of solids. Not CPUs: their own threads do these sooner, and PoCL takes
/// minutes for the kernels.
bool mayDoSolids(const opencl::Backend& backend);

/// Why a device that was tried is of use, or of none.
enum class Rehearsed {
  kGood,
  kFailed,  ///< some call did
  kDiffers  ///< a result differs from the CPU's
};

/// Runs a small query of each kind that `auto` gives to devices, so that none of them builds programs later. Compares
/// contacts and pairs with the CPU's. Throws std::bad_alloc, and opencl::Stopped on a thread that has to stop.
Rehearsed rehearse(opencl::Backend& backend);

/// The same of a single pair and a batch of a few, whose programs are built with every device. A call that fails is no
/// difference.
bool agreesWithHost(opencl::Backend& backend);

}  // namespace otg
