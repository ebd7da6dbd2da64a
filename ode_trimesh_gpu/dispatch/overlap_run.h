// SPDX-License-Identifier: BSD-3-Clause
// Whether meshes overlap, yes or no, for many pairs: by the CPU's threads or with devices.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dispatch/device_slot.h"
#include "dispatch/pair_job.h"
#include "dispatch/threads/thread_pool.h"

namespace otg {

/// Nothing is set at first: arrays of them are filled in by many threads.
struct OverlapJob {
  opencl::PosedMeshes pair;  ///< bInA is rigid; null, or a mesh without triangles, overlaps nothing
  Place place;
};

/// 1 or 0 for each job, as otg::overlap says. Devices find out whether triangles intersect; whether a part of one mesh
/// lies inside the other one, which matters where none do, is the CPU's. Jobs that are bound to devices go there, as
/// do open ones if that is expected to be sooner; each device gets a row of equal expected cost. What a device fails to
/// do, the CPU does. May throw std::bad_alloc.
void runOverlaps(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices,
                 std::span<const OverlapJob> jobs, std::span<std::uint8_t> answers);

/// Whether so much work in so many pairs is expected to be done sooner with `devices` devices of these costs, where
/// `threads` threads work.
bool areOverlapsSoonerOnDevice(double work, std::size_t pairs, const CostModel& costs, std::size_t devices,
                               unsigned threads);

}  // namespace otg
