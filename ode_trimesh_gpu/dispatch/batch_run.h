// SPDX-License-Identifier: BSD-3-Clause
// Many pairs, by all threads and devices at once.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "dispatch/device_slot.h"
#include "dispatch/pair_job.h"
#include "dispatch/threads/thread_pool.h"

namespace otg {

/// Deals the jobs out and runs them: one host thread for each device, the pool's for the rest. With `takesOver` a
/// device that is done before the CPU takes over a part of what the CPU has not begun. Results are empty before. Throws
/// std::bad_alloc.
[[nodiscard]] BatchEnd runBatch(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices,
                                std::span<const PairWork> work, bool takesOver = true);

}  // namespace otg
