// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/point_run.h"

#include <algorithm>

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
  pool.run(count, kPointsAtOnce, [&](std::size_t begin, std::size_t end) {
    Vec3d points[kPointsAtOnce];
    PointAnswer answers[kPointsAtOnce];
    for (std::size_t from = begin; from < end; from += kPointsAtOnce) {
      const std::size_t to = std::min(end, from + kPointsAtOnce);
      source(first + from, first + to, points);
      for (std::size_t i = from; i < to; ++i) answers[i - from] = answerPoint(job, points[i - from]);
      sink(first + from, first + to, points, answers);
    }
  });
}

void askOnDevice(DeviceSlot& slot, ThreadPool& pool, const PointJob& job, std::size_t count, const PointSource& source,
                 const PointSink& sink) {
  const opencl::PointWish wish = wishOf(job);
  constexpr std::size_t kPart = 1024;  // of a thread
  const auto fill = [&](std::size_t begin, std::size_t end, Vec3d* to) {
    pool.run(end - begin, kPart, [&](std::size_t b, std::size_t e) { source(begin + b, begin + e, to + b); });
  };
  const auto take = [&](std::size_t begin, std::size_t end, const Vec3d* points, const otg_uint* words) {
    pool.run(end - begin, kPart, [&](std::size_t b, std::size_t e) {
      PointAnswer answers[kPointsAtOnce];
      for (std::size_t from = b; from < e; from += kPointsAtOnce) {
        const std::size_t to = std::min(e, from + kPointsAtOnce);
        for (std::size_t i = from; i < to; ++i) answers[i - from] = answerFrom(job, wish, points[i], words[i]);
        sink(begin + from, begin + to, points + from, answers);
      }
    });
  };
  slot.underWay.fetch_add(1, std::memory_order_relaxed);
  struct Done {
    DeviceSlot& slot;
    ~Done() { slot.underWay.fetch_sub(1, std::memory_order_relaxed); }
  } const done{slot};
  const std::size_t answered = slot.backend->askPoints(*job.mesh, wish, count, fill, take);
  slot.note(0, answered == count);
  if (answered < count) askOnHost(pool, job, answered, count - answered, source, sink);
}

bool pointsOnDevice(const PointJob& job, const DeviceSlot& slot) {
  const opencl::PointWish wish = wishOf(job);
  return !slot.isOff && slot.backend->answersPoints() && (wish.nearest || wish.inside);
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
