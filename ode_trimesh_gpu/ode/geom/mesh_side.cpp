// SPDX-License-Identifier: BSD-3-Clause
#include "ode/geom/mesh_side.h"

#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <unordered_map>

#include "base/fork_gate.h"
#include "ode/data/trimesh_cache.h"
#include "ode/geom/class_number.h"

namespace otg {
namespace {

/// The objects of all dTriMesh geoms that have collided. One per address: a geom that is destroyed without our
/// knowledge leaves it to the next one at that address. That one goes on with its number, parameters and statistics.
/// What is remembered of pairs does no harm there: it is dropped when a mesh has jumped.
struct Adopted {
  std::mutex mutex;
  std::unordered_map<dGeomID, std::shared_ptr<GeomObject>> objects;
  dGpuTriMeshParams params{};
  Adopted() { dGpuTriMeshParamsInit(&params); }
};

/// Never destroyed: see the cache of meshes.
Adopted& adopted() {
  static Adopted* const instance = new Adopted;
  return *instance;
}

}  // namespace

LastTransform lastTransformOf(const dReal* m) noexcept {
  LastTransform last;
  bool finite = true;
  std::copy(m, m + 16, last.matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) last.pose.r[3 * row + column] = static_cast<double>(m[4 * column + row]);
    for (int column = 0; column < 4; ++column) finite = finite && std::isfinite(m[4 * column + row]);
  }
  last.pose.t = {static_cast<double>(m[12]), static_cast<double>(m[13]), static_cast<double>(m[14])};
  // ODE's geoms begin with zeros, which are the pose of nothing. ODE 0.16 keeps only the first twelve numbers of what
  // it is given: a missing position looks like one at the origin.
  last.isSet = finite && m[15] != 0;
  return last;
}

std::shared_ptr<GeomObject> objectOfTrimesh(dGeomID geom) {
  if (geom == nullptr || dGeomGetClass(geom) != dTriMeshClass) return nullptr;
  Adopted& all = adopted();
  const CallLock lock(all.mutex);
  std::shared_ptr<GeomObject>& object = all.objects[geom];
  if (object == nullptr) {
    object = std::make_shared<GeomObject>();
    object->serial = nextSerial();
    object->params = all.params;
  }
  return object;
}

std::shared_ptr<GeomObject> settingsOf(dGeomID geom) {
  GeomObject* const object = liveObjectOf(geom);
  return object != nullptr ? object->shared_from_this() : objectOfTrimesh(geom);
}

GeomObject* meshObjectOf(dGeomID geom) {
  GeomObject* const object = objectOf(geom);
  return object != nullptr ? object : objectOfTrimesh(geom).get();
}

GeomCallbacks callbacksOf(dGeomID geom, const GeomObject& object) {
  GeomCallbacks callbacks = object.callbacks;
  if (dGeomGetClass(geom) != dTriMeshClass) return callbacks;
  callbacks.triangle = dGeomTriMeshGetCallback(geom);
  callbacks.triangles = dGeomTriMeshGetArrayCallback(geom);
  callbacks.ray = dGeomTriMeshGetRayCallback(geom);
  callbacks.merge = dGeomTriMeshGetTriMergeCallback(geom);
  return callbacks;
}

MeshSide meshSideOf(dGeomID geom) {
  MeshSide side;
  side.geom = geom;
  side.object = objectOf(geom);
  if (side.object != nullptr) {
    side.callbacks = side.object->callbacks;
    return side;
  }
  side.ownObject = objectOfTrimesh(geom);
  side.object = side.ownObject.get();
  if (side.object == nullptr) return side;
  side.ownMesh = meshOfTrimesh(geom);
  side.mesh = side.ownMesh.get();
  side.callbacks = callbacksOf(geom, *side.object);
  return side;
}

bool hasLastTransform(const MeshGeom& side) noexcept {
  if (side.object->last.isSet) return true;
  return side.ownObject != nullptr && lastTransformOf(dGeomTriMeshGetLastTransform(side.geom)).isSet;
}

Transformd lastPoseOf(const MeshGeom& side) noexcept {
  if (side.object->last.isSet) return side.object->last.pose;
  return lastTransformOf(dGeomTriMeshGetLastTransform(side.geom)).pose;
}

void forgetTrimesh(dGeomID geom) noexcept {
  const LibraryCall call;
  std::shared_ptr<GeomObject> last;  // goes after the lock
  Adopted& all = adopted();
  const CallLock lock(all.mutex);
  const auto it = all.objects.find(geom);
  if (it == all.objects.end()) return;
  last = std::move(it->second);
  if (last->joined.join != nullptr) last->joined.join->isBroken = true;
  all.objects.erase(it);
}

void forgetTrimeshes() noexcept {
  const LibraryCall call;
  std::unordered_map<dGeomID, std::shared_ptr<GeomObject>> last;
  Adopted& all = adopted();
  const CallLock lock(all.mutex);
  last.swap(all.objects);
}

void setTrimeshParams(const dGpuTriMeshParams& params) noexcept {
  Adopted& all = adopted();
  const CallLock lock(all.mutex);
  all.params = params;
  for (const auto& [geom, object] : all.objects) object->params = params;
}

dGpuTriMeshParams trimeshParams() noexcept {
  Adopted& all = adopted();
  const CallLock lock(all.mutex);
  return all.params;
}

}  // namespace otg
