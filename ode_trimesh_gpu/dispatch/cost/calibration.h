// SPDX-License-Identifier: BSD-3-Clause
// Measuring what the cost model says of a device, once, and keeping it.
#pragma once

#include "dispatch/cost/cost_model.h"
#include "opencl/backend.h"
#include "opencl/runtime/program_cache.h"

namespace otg {

/// Times generated pairs of meshes on the calling thread and on the device; takes some tenths of a second. Nothing if
/// the device fails meanwhile. `isDisturbed`: whether other threads took the processors from it, so that what it says
/// of the CPU is too much. Throws std::bad_alloc, and opencl::Stopped on a thread that has to stop.
std::optional<CostModel> measureCosts(opencl::Backend& backend, bool* isDisturbed = nullptr);

/// What a model of this device beside this CPU is stored under.
std::string costKey(const opencl::DeviceInfo& device);

/// The stored model of the device. Nothing if there is none, or if it is damaged.
std::optional<CostModel> storedCosts(const opencl::DeviceInfo& device, const opencl::ProgramCache& cache);

/// Which costs that were measured are stored. What is measured while the program computes goes for it alone.
enum class KeptCosts { kAll, kUndisturbed };

/// The stored model of the device, or one that is measured now and stored. A damaged file counts as none and is
/// replaced. Nothing if the device fails.
std::optional<CostModel> costsOf(opencl::Backend& backend, const opencl::ProgramCache& cache,
                                 KeptCosts kept = KeptCosts::kAll);

}  // namespace otg
