// SPDX-License-Identifier: BSD-3-Clause
#include "otg/bench_overlaps.h"

#include <algorithm>
#include <map>

#include "otg/bench_batch_scenes.h"
#include "otg/bench_geoms.h"

namespace otg::cli {
namespace {

Json overlapRow(const std::string& work, const std::vector<Query>& queries, int repeat, bool withDevices) {
  const GeomPairs pairs(queries);
  std::vector<unsigned char> expected, answers;
  int overlapping = 0;
  bool same = true;
  // The first call also uploads, and brings ODE's boxes up to date.
  const auto timed = [&](int backend, int threads) {
    pairs.setBackend(backend);
    dGpuTriMeshSetThreadCount(threads);
    answers.resize(queries.size());
    const auto ask = [&] { overlapping = dGpuTriMeshOverlaps(pairs.all().data(), pairs.count(), answers.data()); };
    ask();
    if (expected.empty()) expected = answers;
    same = same && answers == expected;
    return median(repeatTimes(repeat, [&] { return timeOnce(ask); }));
  };
  const double one = timed(dGPUTRIMESH_BACKEND_CPU, 1), all = timed(dGPUTRIMESH_BACKEND_CPU, 0);
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

}  // namespace

Json overlapRows(const BenchOptions& options, const std::vector<int>& pairCounts, int repeat, bool withDevices) {
  Json rows = Json::array();
  const BodyList bodies = batchBodies();
  for (const int count : pairCounts) {
    rows.push_back(overlapRow("bodies", batchQueries(bodies, count), repeat, withDevices));
  }
  for (const BenchMesh& entry : benchMeshes(options)) {
    const CollisionMesh mesh(sortedInSpace(*entry.mesh), BuildStrategy::kSah);
    for (const char* scene : {"touch", "nearmiss"}) {
      BenchOptions posed = options;
      posed.scene = scene;
      Query query;
      query.a = query.b = &mesh;
      query.bInA = benchPose(posed, mesh);
      for (const int count : pairCounts) {
        Random random(1);
        std::vector<Query> queries(static_cast<std::size_t>(count), query);
        for (Query& one : queries) {
          one.bInA.t =
              otgAdd(one.bInA.t, otgScale(random.direction(), 1e-4 * static_cast<double>(mesh.mesh().radius())));
        }
        rows.push_back(overlapRow(entry.name + " " + scene, queries, repeat, withDevices));
      }
    }
  }
  dGpuTriMeshSetThreadCount(0);
  return rows;
}

}  // namespace otg::cli
