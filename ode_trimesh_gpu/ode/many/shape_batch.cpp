// SPDX-License-Identifier: BSD-3-Clause
#include "ode/many/shape_batch.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "dispatch/dispatcher.h"
#include "ode/geom/trimesh_pairs.h"
#include "ode/shapes/convex_collider.h"
#include "ode/shapes/prefetched_shapes.h"
#include "ode/shapes/primitive_collider.h"
#include "ode/shapes/primitive_contacts.h"
#include "ode/shapes/primitive_history.h"

namespace otg {
namespace {

/// A pair to be computed. The mesh's vertices stay where they are while they are shared.
struct Job {
  PrimitiveTask task;
  std::unique_ptr<GeomUse> use;  ///< of the mesh geom, until the contacts are there
  std::shared_ptr<const CollisionMesh> mesh;
  ShapeQuery query;
  DetachedHistory detached;
  int most = 0;
  std::vector<Contact> contacts;
  bool done = false;
};

/// Threads read the geoms through ODE. What ODE works out on demand (poses of geoms with offsets) must be there by
/// then, which reading everything once sees to.
bool prepareJob(const dGpuTriMeshPair& pair, Job& job) {
  PrimitiveTask& task = job.task;
  task.o1 = pair.o1;
  task.o2 = pair.o2;
  task.side = meshSideOf(pair.o1);
  job.use = std::make_unique<GeomUse>(task.side.object);
  if (!job.use->good()) return false;  // dCollide says so
  task.side.takeMesh();
  job.mesh = task.side.sharedMesh();
  int failure = 0;
  if (!preparePrimitive(task, failure)) return false;
  if (dGeomGetClass(pair.o2) == dConvexClass && (task.shape = shapeOfGeom(pair.o2)) == nullptr) return false;
  job.query = shapeQuery(task);
  job.most = job.query.options.maxContacts;
  if (!canBeCut(job.query.geomClass)) {
    const int asked = task.side.object->prefetchedShapes.make().placesAskedFor(memoryKey(task.o2), job.most);
    job.most = std::min(job.most, asked);
  }
  job.detached = detachedHistory(task);
  return true;
}

void compute(Job& job) {
  job.task.detached = &job.detached;
  int failure = 0;
  try {
    primitiveContacts(job.task, job.most, job.contacts, failure);
    job.done = failure == 0;
  } catch (...) {  // no memory for it: it is computed when it is requested
  }
}

/// Items that a thread takes at once, where there are many.
constexpr std::size_t kPairsAtOnce = 4, kManyPairs = 256;

}  // namespace

bool isShapePair(dGeomID mesh, dGeomID other) noexcept {
  return isPrefetchedClass(dGeomGetClass(other)) && isMeshFor(mesh, other);
}

std::size_t prefetchShapes(std::span<const dGpuTriMeshPair> pairs) {
  std::vector<GeomObject*> meshes;
  for (const dGpuTriMeshPair& pair : pairs) meshes.push_back(meshObjectOf(pair.o1));
  std::sort(meshes.begin(), meshes.end());
  meshes.erase(std::unique(meshes.begin(), meshes.end()), meshes.end());
  for (GeomObject* mesh : meshes) mesh->prefetchedShapes.make().beginRound();

  std::size_t ready = 0;
  std::vector<Job> jobs;
  for (const dGpuTriMeshPair& pair : pairs) {
    Job job;
    if (!prepareJob(pair, job)) continue;
    if (job.task.side.object->prefetchedShapes.make().keep(memoryKey(pair.o2), job.query, job.most)) {
      ++ready;  // nothing has changed: bodies that are at rest or fixed
    } else {
      jobs.push_back(std::move(job));
    }
  }
  // Of planes whole meshes may lie below: the longest first.
  std::stable_partition(jobs.begin(), jobs.end(), [](const Job& job) { return job.query.geomClass == dPlaneClass; });
  dispatcher().runShort(jobs.size(), jobs.size() < kManyPairs ? 1 : kPairsAtOnce,
                        [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i) compute(jobs[i]);
                        });
  for (Job& job : jobs) {
    if (!job.done) continue;
    job.task.side.object->prefetchedShapes.make().add(memoryKey(job.task.o2), std::move(job.query), job.most,
                                                      std::move(job.contacts), job.detached);
    ++ready;
  }
  for (GeomObject* mesh : meshes) mesh->prefetchedShapes.make().endRound();
  return ready;
}

}  // namespace otg
