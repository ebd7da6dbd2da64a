// SPDX-License-Identifier: BSD-3-Clause
// Arrays of rays against one mesh, by the CPU's threads or with a device.
#pragma once

#include <cstddef>

#include "dispatch/array_run.h"
#include "dispatch/pair_job.h"
#include "queries/ray_cast.h"

namespace otg {

/// What is asked about each ray: its closest hit.
struct RayJob {
  const CollisionMesh* mesh = nullptr;  ///< has triangles
  bool cullBack = false;                ///< hits from behind do not count
  Place place = Place::kAuto;
};

using RaySource = ArraySource<LongRay>;
/// A ray without a hit has one with the triangle kNone.
using RaySink = ArraySink<LongRay, RayHit>;

/// One ray, on the calling thread.
RayHit answerRay(const RayJob& job, const LongRay& ray);

/// All rays on the CPU, by the pool's threads, from number `first` on.
void castOnHost(ThreadPool& pool, const RayJob& job, std::size_t first, std::size_t count, const RaySource& source,
                const RaySink& sink);

/// The same with the device: it finds triangles, the CPU's threads say where they are hit. What the device leaves
/// undone, or all if it fails, the CPU does.
void castOnDevice(DeviceSlot& slot, ThreadPool& pool, const RayJob& job, std::size_t count, const RaySource& source,
                  const RaySink& sink);

/// Whether a device can do anything for arrays of rays.
bool raysOnDevice(const DeviceSlot& slot);

/// Whether an array of so many rays is expected to be done sooner with the device, where `threads` threads work.
bool areRaysSoonerOnDevice(const RayJob& job, std::size_t count, const CostModel& costs, unsigned threads);

}  // namespace otg
