// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points against one mesh, by the CPU's threads or with a device.
#pragma once

#include <cstddef>

#include "dispatch/array_run.h"
#include "dispatch/pair_job.h"
#include "queries/closest_point.h"

namespace otg {

/// What is asked about each point.
struct PointJob {
  const CollisionMesh* mesh = nullptr;  ///< has triangles
  bool nearest = true;                  ///< the nearest point of the surface
  bool inside = true;                   ///< on which side the point lies (isInside)
  Place place = Place::kAuto;
};

struct PointAnswer {
  SurfacePoint nearest;  ///< only for PointJob::nearest
  bool inside = false;
};

using PointSource = ArraySource<Vec3d>;
using PointSink = ArraySink<Vec3d, PointAnswer>;

/// One point, on the calling thread.
PointAnswer answerPoint(const PointJob& job, const Vec3d& point);

/// All points on the CPU, by the pool's threads, from number `first` on.
void askOnHost(ThreadPool& pool, const PointJob& job, std::size_t first, std::size_t count, const PointSource& source,
               const PointSink& sink);

/// The same with the device: it finds triangles and sides, the CPU's threads make the answers of them. What the device
/// leaves undone, or all if it fails, the CPU does.
void askOnDevice(DeviceSlot& slot, ThreadPool& pool, const PointJob& job, std::size_t count, const PointSource& source,
                 const PointSink& sink);

/// Whether a device can do anything for the job.
bool pointsOnDevice(const PointJob& job, const DeviceSlot& slot);

/// Whether an array of so many points is expected to be done sooner with the device, where `threads` threads work.
bool arePointsSoonerOnDevice(const PointJob& job, std::size_t count, const CostModel& costs, unsigned threads);

}  // namespace otg
