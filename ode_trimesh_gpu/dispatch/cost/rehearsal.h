// SPDX-License-Identifier: BSD-3-Clause
// Having a device build all programs that queries may need, before there are queries.
#pragma once

#include "opencl/backend.h"

namespace otg {

/// Whether `auto` gives this device pairs of solids. Not CPUs: their own threads do these sooner, and PoCL takes
/// minutes for the kernels.
bool mayDoSolids(const opencl::Backend& backend);

/// Runs a small query of each kind that `auto` gives to devices, so that none of them builds programs later. False if
/// the device fails. Throws std::bad_alloc, and opencl::Stopped on a thread that is told to stop.
bool rehearse(opencl::Backend& backend);

}  // namespace otg
