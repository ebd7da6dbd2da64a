// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/array_run.h"

#include <algorithm>

#include "queries/surface_side.h"

namespace otg {
namespace {

/// Items that one thread takes at a time.
constexpr std::size_t kItemsAtOnce = 64;

/// A device finds the nearest triangle where the result, or the side, needs it; of a solid the side, by itself.
opencl::PointRequest requestOf(const PointJob& job) {
  const SurfaceKind kind = surfaceKind(job.mesh->mesh());
  opencl::PointRequest request;
  request.nearest = job.nearest || (job.inside && kind == SurfaceKind::kSheet);
  request.inside = job.inside && kind == SurfaceKind::kSolid;
  return request;
}

/// The device's part of an array, and what becomes of the word that it finds for each item.
class PointWords {
 public:
  explicit PointWords(const PointJob& job) : job_(job), request_(requestOf(job)) {}
  std::size_t ask(opencl::Backend& device, std::size_t count, const opencl::FillPoints& fill,
                  const opencl::TakePoints& take) const {
    return device.askPoints(*job_.mesh, request_, count, fill, take);
  }
  PointAnswer answer(const Vec3d& point, otg_uint word) const {
    const otg_uint triangle = word & OTG_POINT_TRIANGLE;
    if (triangle == OTG_POINT_OPEN) return answerOne(job_, point);
    PointAnswer answer;
    if (triangle != OTG_POINT_NOTHING) answer.nearest = pointOnTriangle(job_.mesh->mesh(), triangle, point);
    if (request_.inside) {
      answer.inside = (word & OTG_POINT_INSIDE) != 0;
    } else if (job_.inside) {
      answer.inside = isInside(*job_.mesh, point, answer.nearest);
    }
    return answer;
  }

 private:
  const PointJob& job_;
  const opencl::PointRequest request_;
};

class RayWords {
 public:
  explicit RayWords(const RayJob& job) : job_(job) {}
  std::size_t ask(opencl::Backend& device, std::size_t count, const opencl::FillRays& fill,
                  const opencl::TakeRays& take) const {
    return device.castRays(*job_.mesh, job_.cullBack, count, fill, take);
  }
  RayHit answer(const LongRay& ray, otg_uint word) const {
    RayHit hit;
    if (word == OTG_RAY_OPEN) return answerOne(job_, ray);
    if (word != OTG_RAY_NOTHING) TriangleRay(job_.mesh->mesh(), ray.ray).hits(word, hit);
    return hit;
  }

 private:
  const RayJob& job_;
};

PointWords wordsOf(const PointJob& job) {
  return PointWords(job);
}
RayWords wordsOf(const RayJob& job) {
  return RayWords(job);
}

}  // namespace

PointAnswer answerOne(const PointJob& job, const Vec3d& point) {
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

RayHit answerOne(const RayJob& job, const LongRay& ray) {
  RayCast cast;
  cast.ray = ray.ray;
  cast.length = ray.length;
  cast.cullBack = job.cullBack;
  return castForOne(*job.mesh, cast);
}

template <class Job>
void answerOnHost(ThreadPool& pool, const Job& job, std::size_t first, std::size_t count,
                  const ArraySource<Job>& source, const ArraySink<Job>& sink) {
  pool.run(count, kItemsAtOnce, [&](std::size_t begin, std::size_t end) {
    typename Job::Item items[kItemsAtOnce];
    typename Job::Answer answers[kItemsAtOnce];
    for (std::size_t from = begin; from < end; from += kItemsAtOnce) {
      const std::size_t to = std::min(end, from + kItemsAtOnce);
      source(first + from, first + to, items);
      for (std::size_t i = from; i < to; ++i) answers[i - from] = answerOne(job, items[i - from]);
      sink(first + from, first + to, items, answers);
    }
  });
}

template <class Job>
void answerOnDevice(DeviceSlot& slot, ThreadPool& pool, const Job& job, std::size_t count,
                    const ArraySource<Job>& source, const ArraySink<Job>& sink) {
  constexpr std::size_t kPart = 1024;  // of a thread
  const auto words = wordsOf(job);
  const auto fill = [&](std::size_t begin, std::size_t end, typename Job::Item* to) {
    pool.run(end - begin, kPart, [&](std::size_t b, std::size_t e) { source(begin + b, begin + e, to + b); });
  };
  const auto take = [&](std::size_t begin, std::size_t end, const typename Job::Item* items, const otg_uint* found) {
    pool.run(end - begin, kPart, [&](std::size_t b, std::size_t e) {
      typename Job::Answer answers[kItemsAtOnce];
      for (std::size_t from = b; from < e; from += kItemsAtOnce) {
        const std::size_t to = std::min(e, from + kItemsAtOnce);
        for (std::size_t i = from; i < to; ++i) answers[i - from] = words.answer(items[i], found[i]);
        sink(begin + from, begin + to, items + from, answers);
      }
    });
  };
  std::size_t answered = 0;
  {
    slot.underWay.fetch_add(1, std::memory_order_relaxed);
    struct Done {
      DeviceSlot& slot;
      ~Done() { slot.underWay.fetch_sub(1, std::memory_order_relaxed); }
    } const done{slot};
    answered = words.ask(*slot.backend, count, fill, take);
    slot.note(0, answered == count);
  }
  if (answered < count) answerOnHost(pool, job, answered, count - answered, source, sink);
}

template void answerOnHost(ThreadPool&, const PointJob&, std::size_t, std::size_t, const PointSource&,
                           const PointSink&);
template void answerOnHost(ThreadPool&, const RayJob&, std::size_t, std::size_t, const RaySource&, const RaySink&);
template void answerOnDevice(DeviceSlot&, ThreadPool&, const PointJob&, std::size_t, const PointSource&,
                             const PointSink&);
template void answerOnDevice(DeviceSlot&, ThreadPool&, const RayJob&, std::size_t, const RaySource&, const RaySink&);

bool canAnswer(const DeviceSlot& slot, const PointJob& job) {
  const opencl::PointRequest request = requestOf(job);
  return !slot.isOff && slot.backend->answersPoints() && (request.nearest || request.inside);
}

bool canAnswer(const DeviceSlot& slot, const RayJob&) {
  return !slot.isOff && slot.backend->answersRays();
}

bool isArraySoonerOnDevice(const PointJob& job, std::size_t count, const CostModel& costs, unsigned threads) {
  if (!costs.knowsPoints()) return false;
  const opencl::PointRequest request = requestOf(job);
  const double work = pointWork(job.mesh->mesh()), points = static_cast<double>(count);
  const double host =
      (request.nearest ? costs.hostNearest.of(work) : 0) + (request.inside ? costs.hostInside.of(work) : 0);
  const double device =
      (request.nearest ? costs.deviceNearest.of(work) : 0) + (request.inside ? costs.deviceInside.of(work) : 0);
  const double speedup = costs.speedup(threads);
  const double finish = request.nearest ? costs.pointFinish / speedup : 0;
  return costs.pointLaunch.of(work) + points * (device + finish) < points * host / speedup;
}

bool isArraySoonerOnDevice(const RayJob& job, std::size_t count, const CostModel& costs, unsigned threads) {
  if (!costs.knowsRays()) return false;
  const double work = pointWork(job.mesh->mesh()), rays = static_cast<double>(count), speedup = costs.speedup(threads);
  return costs.rayLaunch.of(work) + rays * (costs.deviceRay.of(work) + costs.rayFinish / speedup) <
         rays * costs.hostRay.of(work) / speedup;
}

}  // namespace otg
