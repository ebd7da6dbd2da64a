// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/point_run.h"

#include "queries/surface_side.h"

namespace otg {
namespace {

/// A device finds the nearest triangle where the answer, or the side, needs it; of a solid the side, by itself.
opencl::PointWish wishOf(const PointJob& job) {
  const SurfaceKind kind = surfaceKind(job.mesh->mesh());
  opencl::PointWish wish;
  wish.nearest = job.nearest || (job.inside && kind == SurfaceKind::kSheet);
  wish.inside = job.inside && kind == SurfaceKind::kSolid;
  return wish;
}

/// From what the device says of a point.
PointAnswer answerFrom(const PointJob& job, const opencl::PointWish& wish, const Vec3d& point, otg_uint word) {
  const otg_uint triangle = word & OTG_POINT_TRIANGLE;
  if (triangle == OTG_POINT_OPEN) return answerPoint(job, point);
  PointAnswer answer;
  if (triangle != OTG_POINT_NOTHING) answer.nearest = pointOnTriangle(job.mesh->mesh(), triangle, point);
  if (wish.inside) {
    answer.inside = (word & OTG_POINT_INSIDE) != 0;
  } else if (job.inside) {
    answer.inside = isInside(*job.mesh, point, answer.nearest);
  }
  return answer;
}

}  // namespace

PointAnswer answerPoint(const PointJob& job, const Vec3d& point) {
  PointAnswer answer;
  const SurfaceKind kind = surfaceKind(job.mesh->mesh());
  if (job.nearest || kind == SurfaceKind::kSheet) {
    answer.nearest = closestPoint(*job.mesh, point);
    answer.inside = job.inside && isInside(*job.mesh, point, answer.nearest);
  } else if (kind == SurfaceKind::kSolid) {
    SurfacePoint notAskedFor;
    notAskedFor.triangle = 0;
    answer.inside = job.inside && isInside(*job.mesh, point, notAskedFor);
  }
  return answer;
}

void askOnHost(ThreadPool& pool, const PointJob& job, std::size_t first, std::size_t count, const PointSource& source,
               const PointSink& sink) {
  answerOnHost<Vec3d, PointAnswer>(pool, first, count, source, sink,
                                   [&](const Vec3d& point) { return answerPoint(job, point); });
}

void askOnDevice(DeviceSlot& slot, ThreadPool& pool, const PointJob& job, std::size_t count, const PointSource& source,
                 const PointSink& sink) {
  const opencl::PointWish wish = wishOf(job);
  const auto ask = [&](const opencl::FillPoints& fill, const opencl::TakePoints& take) {
    return slot.backend->askPoints(*job.mesh, wish, count, fill, take);
  };
  const auto answer = [&](const Vec3d& point, otg_uint word) { return answerFrom(job, wish, point, word); };
  const std::size_t done = answerWithDevice<Vec3d, PointAnswer>(slot, pool, count, source, sink, ask, answer);
  if (done < count) askOnHost(pool, job, done, count - done, source, sink);
}

bool pointsOnDevice(const PointJob& job, const DeviceSlot& slot) {
  const opencl::PointWish wish = wishOf(job);
  return !slot.isOff && slot.backend->answersArrays() && (wish.nearest || wish.inside);
}

bool arePointsSoonerOnDevice(const PointJob& job, std::size_t count, const CostModel& costs, unsigned threads) {
  if (!costs.knowsPoints()) return false;
  const opencl::PointWish wish = wishOf(job);
  const double work = pointWork(job.mesh->mesh()), points = static_cast<double>(count);
  const double host = (wish.nearest ? costs.hostNearest.of(work) : 0) + (wish.inside ? costs.hostInside.of(work) : 0);
  const double device =
      (wish.nearest ? costs.deviceNearest.of(work) : 0) + (wish.inside ? costs.deviceInside.of(work) : 0);
  const double speedup = costs.speedup(threads);
  const double finish = wish.nearest ? costs.pointFinish / speedup : 0;
  return costs.pointLaunch.of(work) + points * (device + finish) < points * host / speedup;
}

}  // namespace otg
