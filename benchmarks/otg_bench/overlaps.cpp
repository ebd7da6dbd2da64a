// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/overlaps.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "cli/progress.h"
#include "otg_bench/batch_scenes.h"
#include "otg_bench/geoms.h"

namespace otg::cli {
namespace {

/// Queries all pairs; returns how many overlap. `answers` gets the bytes of the results.
using AskPairs = std::function<int(const GeomPairs& pairs, std::vector<unsigned char>& answers)>;

int askOverlaps(const GeomPairs& pairs, std::vector<unsigned char>& answers) {
  answers.resize(static_cast<std::size_t>(pairs.count()));
  return dGpuTriMeshOverlaps(pairs.all().data(), pairs.count(), answers.data());
}

int askDistances(const GeomPairs& pairs, std::vector<unsigned char>& answers) {
  const auto count = static_cast<std::size_t>(pairs.count());
  answers.resize(count * sizeof(dGpuTriMeshDistance));
  auto* const distances = reinterpret_cast<dGpuTriMeshDistance*>(answers.data());
  if (dGpuTriMeshGetDistances(pairs.all().data(), pairs.count(), dInfinity, distances) != dGPUTRIMESH_OK) return -1;
  return static_cast<int>(
      std::count_if(distances, distances + count, [](const dGpuTriMeshDistance& one) { return one.distance == 0; }));
}

/// `alone`: most pairs that one thread does.
Json pairRow(const AskPairs& askPairs, const std::string& work, const std::vector<Query>& queries, std::size_t alone,
             int repeat, bool withDevices) {
  const GeomPairs pairs(queries);
  std::vector<unsigned char> expected, answers;
  int overlapping = 0;
  bool same = true;
  // The first call also uploads, and brings ODE's boxes up to date.
  const auto timed = [&](int backend, int threads) {
    pairs.setBackend(backend);
    dGpuTriMeshSetThreadCount(threads);
    const auto ask = [&] { overlapping = askPairs(pairs, answers); };
    ask();
    if (expected.empty()) expected = answers;
    same = same && answers == expected;
    return median(repeatTimes(repeat, [&] { return timeOnce(ask); }));
  };
  const Json one = queries.size() <= alone ? Json(timed(dGPUTRIMESH_BACKEND_CPU, 1)) : Json();
  const double all = timed(dGPUTRIMESH_BACKEND_CPU, 0);
  const Json device = withDevices ? Json(timed(dGPUTRIMESH_BACKEND_OPENCL, 0)) : Json();
  const std::uint64_t before = deviceSum(&dGpuTriMeshDevice::calls);
  const double automatic = timed(dGPUTRIMESH_BACKEND_AUTO, 0);
  Fnv1a hash;
  hash.add(expected.data(), expected.size());
  return {{"work", work},
          {"pairs", queries.size()},
          {"overlapping", overlapping},
          {"one_thread_ms", one},
          {"all_threads_ms", all},
          {"device_ms", device},
          {"auto_ms", automatic},
          {"times_all_threads", withDevices ? Json(all / device.get<double>()) : Json()},
          {"auto", deviceSum(&dGpuTriMeshDevice::calls) > before ? "opencl" : "cpu"},
          {"answers", same ? "same" : "DIFFERENT"},
          {"hash", hash.hex()}};
}

Json pairRows(const AskPairs& ask, const std::vector<std::pair<const char*, double>>& scenes,
              const BenchOptions& options, const std::vector<int>& pairCounts, std::size_t alone, int repeat,
              bool withDevices) {
  Json rows = Json::array();
  const BodyList bodies = batchBodies();
  const std::vector<BenchMesh> meshes = benchMeshes(options);
  Progress parts(pairCounts.size() * (1 + meshes.size() * scenes.size()));
  for (const int count : pairCounts) {
    rows.push_back(pairRow(ask, "bodies", batchQueries(bodies, count), alone, repeat, withDevices));
    parts.step();
  }
  for (const BenchMesh& entry : meshes) {
    const CollisionMesh mesh(sortedForLocality(*entry.mesh), BuildStrategy::kSah);
    const double radius = static_cast<double>(mesh.mesh().radius());
    for (const auto& [scene, further] : scenes) {
      BenchOptions posed = options;
      posed.scene = further > 0 ? "nearmiss" : scene;
      Query query;
      query.a = query.b = &mesh;
      query.bInA = benchPose(posed, mesh);
      const double apart = std::sqrt(otgDot(query.bInA.t, query.bInA.t));
      query.bInA.t = otgScale(query.bInA.t, 1 + further * radius / apart);
      for (const int count : pairCounts) {
        Random random(1);
        std::vector<Query> queries(static_cast<std::size_t>(count), query);
        for (Query& one : queries) {
          one.bInA.t = otgAdd(one.bInA.t, otgScale(random.direction(), 1e-4 * radius));
        }
        rows.push_back(pairRow(ask, entry.name + " " + scene, queries, alone, repeat, withDevices));
        parts.step();
      }
    }
  }
  dGpuTriMeshSetThreadCount(0);
  return rows;
}

}  // namespace

Json overlapRows(const BenchOptions& options, const std::vector<int>& pairCounts, int repeat, bool withDevices) {
  return pairRows(askOverlaps, {{"touch", 0}, {"nearmiss", 0}}, options, pairCounts, ~std::size_t{0}, repeat,
                  withDevices);
}

Json distanceRows(const BenchOptions& options, const std::vector<int>& pairCounts, int repeat, bool withDevices) {
  return pairRows(askDistances, {{"nearmiss", 0}, {"apart", 0.5}}, options, pairCounts, 1000, repeat, withDevices);
}

}  // namespace otg::cli
