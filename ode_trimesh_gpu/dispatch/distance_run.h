// SPDX-License-Identifier: BSD-3-Clause
// How far meshes are apart, for many pairs: by the CPU's threads or with a device.
#pragma once

#include <span>

#include "dispatch/device_slot.h"
#include "dispatch/overlap_run.h"
#include "dispatch/threads/thread_pool.h"
#include "queries/mesh_distance.h"

namespace otg {

/// What the time of a pair that is apart follows: how many triangles there are.
double distanceWork(const Query& query);

/// meshDistance for each of these jobs, by the CPU's threads. A mesh without triangles is near nothing.
void measureOnHost(ThreadPool& pool, std::span<const OverlapJob> jobs, std::span<const std::size_t> which, double limit,
                   std::span<MeshDistance> answers);

/// The same with the device: it finds which meshes intersect, and the nearest triangles of those that do not; the
/// CPU's threads find whether one lies inside the other, a point that both have, and where nearest triangles are
/// nearest. What the device leaves undone, or all if it fails, the CPU does. Jobs have triangles.
void measureOnDevice(DeviceSlot& slot, ThreadPool& pool, std::span<const OverlapJob> jobs,
                     std::span<const std::size_t> which, double limit, std::span<MeshDistance> answers);

/// Whether so much work in so many pairs is expected to be done sooner with the device, where `threads` threads work.
bool areDistancesSoonerOnDevice(double work, std::size_t pairs, const CostModel& costs, unsigned threads);

/// All jobs: those bound to a device, and open ones if that is expected to be sooner, with this one, which may be null.
void runDistances(ThreadPool& pool, DeviceSlot* slot, std::span<const OverlapJob> jobs, double limit,
                  std::span<MeshDistance> answers);

}  // namespace otg
