// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/ray_run.h"

namespace otg {

RayHit answerRay(const RayJob& job, const LongRay& ray) {
  RayCast cast;
  cast.ray = ray.ray;
  cast.length = ray.length;
  cast.cullBack = job.cullBack;
  return castForOne(*job.mesh, cast);
}

void castOnHost(ThreadPool& pool, const RayJob& job, std::size_t first, std::size_t count, const RaySource& source,
                const RaySink& sink) {
  answerOnHost<LongRay, RayHit>(pool, first, count, source, sink,
                                [&](const LongRay& ray) { return answerRay(job, ray); });
}

void castOnDevice(DeviceSlot& slot, ThreadPool& pool, const RayJob& job, std::size_t count, const RaySource& source,
                  const RaySink& sink) {
  const auto ask = [&](const opencl::FillRays& fill, const opencl::TakeRays& take) {
    return slot.backend->castRays(*job.mesh, job.cullBack, count, fill, take);
  };
  const auto answer = [&](const LongRay& ray, otg_uint word) {
    RayHit hit;
    if (word == OTG_RAY_OPEN) return answerRay(job, ray);
    if (word != OTG_RAY_NOTHING) TriangleRay(job.mesh->mesh(), ray.ray).hits(word, hit);
    return hit;
  };
  const std::size_t done = answerWithDevice<LongRay, RayHit>(slot, pool, count, source, sink, ask, answer);
  if (done < count) castOnHost(pool, job, done, count - done, source, sink);
}

bool raysOnDevice(const DeviceSlot& slot) {
  return !slot.isOff && slot.backend->answersArrays();
}

bool areRaysSoonerOnDevice(const RayJob& job, std::size_t count, const CostModel& costs, unsigned threads) {
  if (!costs.knowsRays()) return false;
  const double work = pointWork(job.mesh->mesh()), rays = static_cast<double>(count), speedup = costs.speedup(threads);
  return costs.rayLaunch.of(work) + rays * (costs.deviceRay.of(work) + costs.rayFinish / speedup) <
         rays * costs.hostRay.of(work) / speedup;
}

}  // namespace otg
