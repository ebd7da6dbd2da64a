// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/distance_run.h"

#include <vector>

#include "queries/mesh_overlap.h"

namespace otg {
namespace {

bool hasSurfaces(const opencl::PosedMeshes& pair) {
  const auto any = [](const CollisionMesh* mesh) { return mesh != nullptr && !mesh->tree().nodes.empty(); };
  return any(pair.a) && any(pair.b);
}

}  // namespace

double distanceWork(const Query& query) {
  return static_cast<double>(query.a->mesh().triangleCount()) + static_cast<double>(query.b->mesh().triangleCount());
}

void measureOnHost(ThreadPool& pool, std::span<const OverlapJob> jobs, std::span<const std::size_t> which, double limit,
                   std::span<MeshDistance> answers) {
  pool.run(which.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const opencl::PosedMeshes& pair = jobs[which[k]].pair;
      answers[which[k]] = hasSurfaces(pair) ? meshDistance(opencl::queryOf(pair), limit) : MeshDistance();
    }
  });
}

void measureOnDevice(DeviceSlot& slot, ThreadPool& pool, std::span<const OverlapJob> jobs,
                     std::span<const std::size_t> which, double limit, std::span<MeshDistance> answers) {
  constexpr std::size_t kPart = 32;  // of a thread
  std::vector<Query> queries(which.size());
  pool.run(which.size(), kPart, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) queries[k] = opencl::queryOf(jobs[which[k]].pair);
  });
  std::vector<std::uint8_t> meet;
  bool good = slot.backend->intersectBatch(queries, meet);
  pool.run(which.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      // Where they meet is soon found.
      if (meet[k] != 0 || !contains(queries[k], answers[which[k]])) continue;
      meet[k] = 2;
    }
  });
  std::vector<std::size_t> apart;
  std::vector<Query> asked;
  for (std::size_t k = 0; k < which.size(); ++k) {
    if (meet[k] != 0) continue;
    apart.push_back(k);
    asked.push_back(queries[k]);
  }
  std::vector<TrianglePair> nearest(apart.size());
  const std::size_t done = slot.backend->nearestTriangles(
      asked, limit, nearest, [&](std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
        pool.run(count, kPart, work);
      });
  good = done == apart.size() && good;
  slot.note(which.size(), good);
  pool.run(which.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      if (meet[k] == 1) answers[which[k]] = meshDistance(queries[k], limit);
    }
  });
  pool.run(apart.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool isOpen = i >= done || nearest[i] == opencl::Backend::kLeftToHost;
      answers[which[apart[i]]] = isOpen ? distanceApart(asked[i], limit) : distanceOfTriangles(asked[i], nearest[i]);
    }
  });
}

bool areDistancesSoonerOnDevice(double work, std::size_t pairs, const CostModel& costs, unsigned threads) {
  if (!costs.knowsDistances()) return false;
  const auto of = [&](const Cost& cost) { return cost.fixed * static_cast<double>(pairs) + cost.perTriangle * work; };
  return costs.distanceLaunch + of(costs.batchDistance) < of(costs.hostDistance) / costs.speedup(threads);
}

void runDistances(ThreadPool& pool, DeviceSlot* slot, std::span<const OverlapJob> jobs, double limit,
                  std::span<MeshDistance> answers) {
  std::vector<std::size_t> bound, open, host;
  double work = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const bool isHosts = slot == nullptr || jobs[i].place == Place::kCpu || !hasSurfaces(jobs[i].pair) ||
                         (jobs[i].place == Place::kAuto && !slot->isForAuto);
    (isHosts ? host : jobs[i].place == Place::kOpencl ? bound : open).push_back(i);
    if (!isHosts && jobs[i].place != Place::kOpencl) work += distanceWork(opencl::queryOf(jobs[i].pair));
  }
  const bool sooner = slot != nullptr && !open.empty() &&
                      areDistancesSoonerOnDevice(work, open.size(), slot->costs, pool.threadCount());
  std::vector<std::size_t>& target = sooner ? bound : host;
  target.insert(target.end(), open.begin(), open.end());
  if (slot != nullptr && !bound.empty()) measureOnDevice(*slot, pool, jobs, bound, limit, answers);
  measureOnHost(pool, jobs, host, limit, answers);
}

}  // namespace otg
