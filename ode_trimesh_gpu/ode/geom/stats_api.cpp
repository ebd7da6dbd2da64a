// SPDX-License-Identifier: BSD-3-Clause
#include "ode_trimesh_gpu/stats.h"

#include "ode/base/status.h"
#include "ode/geom/mesh_side.h"

void dGpuTriMeshStatsInit(dGpuTriMeshStats* stats) {
  if (stats == nullptr) return;
  *stats = dGpuTriMeshStats{};
  stats->size = sizeof(dGpuTriMeshStats);
}

int dGeomGpuTriMeshGetStats(dGeomID g, dGpuTriMeshStats* stats) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    if (!otg::isCurrentSize(stats)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    const otg::GeomStats& from = object->stats;
    stats->queries = from.queries;
    stats->failed_queries = from.failedQueries;
    stats->box_tests = from.boxTests;
    stats->candidate_pairs = from.candidatePairs;
    stats->intersecting_pairs = from.intersectingPairs;
    stats->decided_by_double = from.decidedByDouble;
    stats->decided_exactly = from.decidedExactly;
    stats->contacts_before_reduction = from.contactsBeforeReduction;
    stats->contacts = from.contacts;
    stats->prefetched = from.prefetched;
    stats->on_device = from.onDevice;
    stats->device_failures = from.deviceFailures;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshResetStats(dGeomID g) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    otg::GeomStats& s = object->stats;
    for (std::atomic<std::uint64_t>* sum :
         {&s.queries, &s.failedQueries, &s.boxTests, &s.candidatePairs, &s.intersectingPairs, &s.decidedByDouble,
          &s.decidedExactly, &s.contactsBeforeReduction, &s.contacts, &s.prefetched, &s.onDevice, &s.deviceFailures}) {
      sum->store(0, std::memory_order_relaxed);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
