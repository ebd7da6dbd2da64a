// SPDX-License-Identifier: BSD-3-Clause
// The C API that reads a geom: triangles, points, statistics.
#include "ode/base/status.h"
#include "ode/geom/geom_class.h"
#include "ode/geom/mesh_side.h"
#include "ode_trimesh_gpu/geom.h"

namespace otg {
namespace {

/// World coordinates of a triangle's corners.
struct WorldTriangle {
  Vec3d corner[3];
};

/// A status; `triangle` is set when it is dGPUTRIMESH_OK.
int worldTriangle(dGeomID g, int index, WorldTriangle& triangle) {
  GeomObject* const object = liveObjectOf(g);
  if (object == nullptr) return dGPUTRIMESH_ERROR_CLASS;
  const GeomUse use(object);
  if (!use.good()) return dGPUTRIMESH_ERROR_BUSY;
  const CollisionMesh* const placed = object->mesh();
  if (placed == nullptr || index < 0 || static_cast<std::size_t>(index) >= placed->mesh().triangleCount()) {
    return dGPUTRIMESH_ERROR_ARGUMENT;
  }
  const TriMesh& mesh = placed->mesh();
  const WorldPose pose = readPose(g);
  const Triangle& t = mesh.triangles()[mesh.triangleOfCaller(static_cast<std::uint32_t>(index))];
  for (int k = 0; k < 3; ++k) {
    const Vec3f v = mesh.vertices()[t.v[k]];
    triangle.corner[k] = otgTransform(pose.transform, Vec3d{v.x, v.y, v.z});
  }
  return dGPUTRIMESH_OK;
}

void write(const Vec3d& from, dReal* to) {
  to[0] = static_cast<dReal>(from.x);
  to[1] = static_cast<dReal>(from.y);
  to[2] = static_cast<dReal>(from.z);
  to[3] = 0;
}

}  // namespace
}  // namespace otg

int dGeomGpuTriMeshGetTriangleCount(dGeomID g) {
  otg::GeomObject* const object = otg::liveObjectOf(g);
  const otg::GeomUse use(object);
  if (!use.good()) otg::noteStatus(dGPUTRIMESH_ERROR_BUSY);
  const otg::CollisionMesh* const mesh = object == nullptr || !use.good() ? nullptr : object->mesh();
  return mesh == nullptr ? 0 : static_cast<int>(mesh->mesh().triangleCount());
}

int dGeomGpuTriMeshGetTriangle(dGeomID g, int Index, dVector3* v0, dVector3* v1, dVector3* v2) {
  otg::WorldTriangle triangle;
  if (const int status = otg::worldTriangle(g, Index, triangle)) return otg::noteStatus(status);
  dVector3* const out[3] = {v0, v1, v2};
  for (int k = 0; k < 3; ++k) {
    if (out[k] != nullptr) otg::write(triangle.corner[k], *out[k]);
  }
  return dGPUTRIMESH_OK;
}

int dGeomGpuTriMeshGetPoint(dGeomID g, int Index, dReal u, dReal v, dVector3 Out) {
  if (Out == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  otg::WorldTriangle triangle;
  if (const int status = otg::worldTriangle(g, Index, triangle)) return otg::noteStatus(status);
  const double w = 1.0 - static_cast<double>(u) - static_cast<double>(v);
  const otg::Vec3d point = otgAdd(otgAdd(otgScale(triangle.corner[0], w), otgScale(triangle.corner[1], double(u))),
                                  otgScale(triangle.corner[2], double(v)));
  otg::write(point, Out);
  return dGPUTRIMESH_OK;
}

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
