// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points or of rays against one mesh, queried one by one, by the CPU's threads or with a device.
#pragma once

#include <cstddef>
#include <functional>

#include "dispatch/device_slot.h"
#include "dispatch/pair_job.h"
#include "dispatch/threads/thread_pool.h"
#include "queries/closest_point.h"
#include "queries/ray_cast.h"

namespace otg {

struct PointAnswer {
  SurfacePoint nearest;  ///< only for PointJob::nearest
  bool inside = false;
};

/// What is queried of each point.
struct PointJob {
  using Item = Vec3d;
  using Answer = PointAnswer;
  const CollisionMesh* mesh = nullptr;  ///< has triangles
  bool nearest = true;                  ///< the nearest point of the surface
  bool inside = true;                   ///< on which side the point lies (isInside)
  Place place = Place::kAuto;
};

/// What is queried of each ray: its closest hit. A ray without a hit has one with the triangle kNone.
struct RayJob {
  using Item = LongRay;
  using Answer = RayHit;
  const CollisionMesh* mesh = nullptr;  ///< has triangles
  bool cullBack = false;                ///< hits from behind do not count
  Place place = Place::kAuto;
};

/// Items begin to end - 1, in the frame of the mesh -> to[0] and up. Called by any thread.
template <class Job>
using ArraySource = std::function<void(std::size_t begin, std::size_t end, typename Job::Item* to)>;
/// The same items with their results. Called by any thread, once for each item.
template <class Job>
using ArraySink = std::function<void(std::size_t begin, std::size_t end, const typename Job::Item* items,
                                     const typename Job::Answer* answers)>;

using PointSource = ArraySource<PointJob>;
using PointSink = ArraySink<PointJob>;
using RaySource = ArraySource<RayJob>;
using RaySink = ArraySink<RayJob>;

/// One item, on the calling thread.
PointAnswer answerOne(const PointJob& job, const Vec3d& point);
RayHit answerOne(const RayJob& job, const LongRay& ray);

/// All items on the CPU, by the pool's threads, from number `first` on. For both jobs.
template <class Job>
void answerOnHost(ThreadPool& pool, const Job& job, std::size_t first, std::size_t count,
                  const ArraySource<Job>& source, const ArraySink<Job>& sink);

/// The same with the device: it finds triangles and sides, the CPU's threads make the results of them. What the device
/// leaves undone, or all if it fails, the CPU does. For both jobs.
template <class Job>
void answerOnDevice(DeviceSlot& slot, ThreadPool& pool, const Job& job, std::size_t count,
                    const ArraySource<Job>& source, const ArraySink<Job>& sink);

/// Whether a device can do anything for the job.
bool canAnswer(const DeviceSlot& slot, const PointJob& job);
bool canAnswer(const DeviceSlot& slot, const RayJob& job);

/// Whether an array of so many items is expected to be done sooner with the device, where `threads` threads work.
bool isArraySoonerOnDevice(const PointJob& job, std::size_t count, const CostModel& costs, unsigned threads);
bool isArraySoonerOnDevice(const RayJob& job, std::size_t count, const CostModel& costs, unsigned threads);

}  // namespace otg
