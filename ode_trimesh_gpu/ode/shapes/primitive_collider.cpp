// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/primitive_collider.h"

#include <algorithm>

#include "base/fork_gate.h"
#include "dispatch/threads/workspace_lease.h"
#include "ode/base/status.h"
#include "ode/geom/class_number.h"
#include "ode/geom/joined_sides.h"
#include "ode/pairs/mesh_collider.h"
#include "ode/pairs/pair_task.h"
#include "ode/shapes/convex_collider.h"
#include "ode/shapes/heightfield_collider.h"
#include "ode/shapes/kept_shapes.h"
#include "ode/shapes/prefetched_shapes.h"
#include "ode/shapes/primitive_callbacks.h"
#include "ode/shapes/primitive_contacts.h"
#include "ode/shapes/primitive_history.h"

namespace otg {

bool preparePrimitive(PrimitiveTask& task, int& failure) {
  if (task.side.mesh == nullptr || task.side.mesh->tree().nodes.empty()) return false;
  WorldPose pose = readPose(task.o1);
  if (pose.rigid && dGeomGetClass(task.o2) != dRayClass && !task.side.callbacks.asked()) enterJoin(task.side, pose);
  task.pose = pose.transform;
  bool rigid = pose.rigid;
  const int classOfOther = dGeomGetClass(task.o2);
  if (classOfOther == dRayClass) {  // only the last column of a ray's matrix is set: its direction
    rigid = rigid && readPose(task.o2).finite;
  } else if (classOfOther != dPlaneClass) {  // planes have no pose
    const WorldPose other = classOfOther == dHeightfieldClass ? readHeightfieldPose(task.o2) : readPose(task.o2);
    rigid = rigid && other.rigid;
    task.other = relativePose(pose.transform, other.transform);
  }
  if (!rigid) failure = dGPUTRIMESH_ERROR_POSE;
  if (rigid && classOfOther != dRayClass) turnInward(task);
  return rigid;
}

namespace {

/// What was computed ahead, if it was; in the mesh's own numbers.
bool takePrefetched(PrimitiveTask& task, int most, std::vector<Contact>& out) {
  PrefetchedShapes* const ready = task.side.object->prefetchedShapes.get();
  const int classOfOther = dGeomGetClass(task.o2);
  if (ready == nullptr || ready->empty() || !isPrefetchedClass(classOfOther)) return false;
  if (classOfOther == dConvexClass) task.shape = shapeOfGeom(task.o2);
  const ShapeQuery query = shapeQuery(task);
  const std::uint64_t key = memoryKey(task.o2);
  DetachedHistory left;
  if (!ready->find(key, query, most, out, left)) return false;
  if (const std::optional<std::uint64_t> stamp = leaveHistory(task, left)) ready->seen(key, query.stamp, *stamp);
  task.side.object->stats.prefetched.fetch_add(1, std::memory_order_relaxed);
  return true;
}

/// primitiveContacts(), unless the pair is where it was at its last queries: in the mesh's own numbers.
void keptContacts(PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure) {
  const int classOfOther = dGeomGetClass(task.o2);
  const bool isPolyhedron = classOfOther == dBoxClass || classOfOther == dConvexClass;
  // Pairs of two convex bodies keep their direction, and take little else.
  if (!isKeptClass(classOfOther) || !task.side.object->remembersWith(classOfOther) ||
      (isPolyhedron && task.side.mesh->convex() != nullptr)) {
    primitiveContacts(task, most, out, failure);
    return;
  }
  if (classOfOther == dConvexClass && task.shape == nullptr) task.shape = shapeOfGeom(task.o2);
  KeptShapes& kept = task.side.object->keptShapes.make();
  const std::uint64_t key = memoryKey(task.o2);
  std::uint64_t before = 0;
  const auto query = [&] {
    ShapeQuery now = shapeQuery(task);
    before = now.stamp;
    return now;
  };
  if (kept.find(key, task.other, query, most, out)) {
    kept.seen(key, before, task.side.object->memory.renew(key));
    return;
  }
  primitiveContacts(task, most, out, failure);
  if (failure == 0) kept.note(key, task.other, query, most, out);
}

/// In the caller's numbers of triangles.
void findContacts(PrimitiveTask& task, int most, std::vector<Contact>& out, int& failure) {
  if (task.side.callbacks.asked() && dGeomGetClass(task.o2) != dRayClass) {
    askedContacts(task, most, out, failure);
    return;
  }
  if (!takePrefetched(task, most, out)) keptContacts(task, most, out, failure);
  for (Contact& c : out) c.triangleA = task.side.mesh->mesh().callerTriangle(c.triangleA);
}

WorldBox boxOf(dGeomID geom) {
  dReal box[6];
  dGeomGetAABB(geom, box);
  return {{box[0], box[2], box[4]}, {box[1], box[3], box[5]}};
}

int collidePrimitive(PrimitiveTask& task, dContactGeom* contact, int skip) {
  const GeomUse use(task.side.object);
  GeomStats& stats = task.side.object->stats;
  stats.queries.fetch_add(1, std::memory_order_relaxed);
  int failure = dGPUTRIMESH_OK;
  try {
    const int most = std::min(task.capacity, task.side.object->params.max_contacts);
    const WorkspaceLease lease;
    std::vector<Contact>& contacts = (*lease).contacts;
    contacts.clear();
    if (use.good()) {
      task.side.takeMesh();
      if (preparePrimitive(task, failure)) findContacts(task, most, contacts, failure);
      if (task.side.join != nullptr) keepOwn(task.side, 0, task.pose, task.pose, boxOf(task.o2), contacts);
    } else {
      failure = dGPUTRIMESH_ERROR_BUSY;
    }
    if (failure != dGPUTRIMESH_OK) {
      noteStatus(failure);
      stats.failedQueries.fetch_add(1, std::memory_order_relaxed);
      return 0;
    }
    if (contacts.empty()) return 0;  // a geom without a mesh among others
    char* place = reinterpret_cast<char*>(contact);
    const ContactFrame frame{task.pose, true, task.o1, task.o2, boxOfSolid(task.side, task.pose)};
    for (const Contact& found : contacts) {
      writeContact(found, frame, place);
      place += skip;
    }
    stats.contacts.fetch_add(contacts.size(), std::memory_order_relaxed);
    return static_cast<int>(contacts.size());
  } catch (...) {
    // Only want of memory throws. ODE's space would stay locked for ever if we let it through.
    noteStatus(dGPUTRIMESH_ERROR_MEMORY);
    stats.failedQueries.fetch_add(1, std::memory_order_relaxed);
    return 0;
  }
}

}  // namespace

int collideMeshPrimitive(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept {
  const LibraryCall call;
  // A dTriMesh becomes a mesh of ours.
  if (dGeomGetClass(o2) == dTriMeshClass && objectOf(o1) != nullptr)
    return collideMeshMesh(o1, o2, flags, contact, skip);
  PrimitiveTask task;
  task.o1 = o1;
  task.o2 = o2;
  try {
    task.side = meshSideOf(o1);
  } catch (...) {  // no memory for the mesh of a dTriMesh
    noteStatus(dGPUTRIMESH_ERROR_MEMORY);
    return 0;
  }
  if (task.side.object == nullptr) {
    answerProbe();
    return 0;
  }
  task.capacity = capacityOf(flags);
  if (contact == nullptr || task.capacity == 0) return 0;
  // A skip that makes elements overlap is an error of the caller's; the first element is there in any case.
  if (skip < static_cast<int>(sizeof(dContactGeom))) task.capacity = 1;
  return collidePrimitive(task, contact, skip);
}

}  // namespace otg
