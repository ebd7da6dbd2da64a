// SPDX-License-Identifier: BSD-3-Clause
// The life of a geom, and its bounding box.
#include "ode/geom/geom_class.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <shared_mutex>

#include "base/fork_gate.h"
#include "collide/rotation_tolerance.h"
#include "ode/base/geom_table.h"
#include "ode/base/status.h"
#include "ode/geom/class_number.h"

namespace otg {
namespace {

GeomObject*& slotOf(dGeomID geom) {
  return *static_cast<GeomObject**>(dGeomGetClassData(geom));
}

/// All geoms of ours that are alive: a geom that was destroyed is not among them.
struct LiveGeoms {
  std::shared_mutex mutex;
  GeomTable objects;
};

/// Never destroyed: programs may destroy geoms in the destructors of their own globals.
LiveGeoms& live() {
  static LiveGeoms* const instance = new LiveGeoms;
  return *instance;
}

/// To the dReal at or beyond x in the direction of `towards`, and never infinite.
dReal roundOutward(double x, double towards) {
  constexpr double kLargest = std::numeric_limits<dReal>::max();
  const dReal rounded = static_cast<dReal>(std::clamp(x, -kLargest, kLargest));
  return towards < 0 ? std::max(std::nextafter(rounded, static_cast<dReal>(-kLargest)), static_cast<dReal>(-kLargest))
                     : std::min(std::nextafter(rounded, static_cast<dReal>(kLargest)), static_cast<dReal>(kLargest));
}

}  // namespace

GeomObject* objectOf(dGeomID geom) noexcept {
  return geom != nullptr && dGeomGetClass(geom) == registeredClass() ? slotOf(geom) : nullptr;
}

GeomObject* liveObjectOf(dGeomID geom) noexcept {
  return geom == nullptr ? nullptr : LiveObjects().of(geom);
}

LiveObjects::LiveObjects() : lock_(live().mutex) {}

GeomObject* LiveObjects::of(dGeomID geom) const noexcept {
  return live().objects.find(geom);
}

void LiveObjects::fetch(dGeomID geom) const noexcept {
  live().objects.fetch(geom);
}

GeomObject::~GeomObject() {
  joined.leave();
  if (data != nullptr) data->detach(serial);
}

int GeomObject::rescale(dxGpuTriMeshData* of, const MeshScale& by) {
  std::shared_ptr<CollisionMesh> made;
  if (!isOne(by) && of != nullptr && of->mesh() != nullptr) {
    made = of->scaledMesh(by);
    if (made == nullptr) return dGPUTRIMESH_ERROR_MESH;
  }
  scale = by;
  scaled = std::move(made);
  return dGPUTRIMESH_OK;
}

const CollisionMesh* GeomObject::mesh() const {
  return isOne(scale) ? (data == nullptr ? nullptr : data->mesh()) : scaled.get();
}

std::shared_ptr<const CollisionMesh> GeomObject::sharedMesh() const {
  return isOne(scale) ? (data == nullptr ? nullptr : data->meshPtr()) : scaled;
}

bool GeomObject::remembersWith(int geomClass) const {
  if (params.history != dGPUTRIMESH_HISTORY_ON) return false;
  return geomClass == registeredClass() || (coherentClasses >> geomClass & 1u) != 0;
}

GeomUse::GeomUse(GeomObject* first, GeomObject* second) {
  GeomObject* const objects[2] = {first, second};
  for (int i = 0; i < 2; ++i) {
    if (objects[i] == nullptr) continue;
    if (!objects[i]->uses.beginUse()) {
      good_ = false;
      break;
    }
    // The data are what they are now: no one gives the geom others.
    if (objects[i]->data != nullptr && !objects[i]->data->uses.beginUse()) {
      objects[i]->uses.endUse();
      good_ = false;
      break;
    }
    held_[i] = objects[i]->shared_from_this();
  }
  if (!good_) release();
}

GeomUse::~GeomUse() {
  release();
}

void GeomUse::release() noexcept {
  for (std::shared_ptr<GeomObject>& object : held_) {
    if (object == nullptr) continue;
    if (object->data != nullptr) object->data->uses.endUse();
    object->uses.endUse();
    object = nullptr;
  }
}

WorldPose readPose(dGeomID geom) noexcept {
  // Of a geom with an offset ODE works out the pose when it is requested, in the geom: several threads may do so.
  static std::mutex offsets;
  std::unique_lock lock(offsets, std::defer_lock);
  if (dGeomIsOffset(geom)) lock.lock();
  const dReal* const x = dGeomGetPosition(geom);
  const dReal* const r = dGeomGetRotation(geom);
  WorldPose pose{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      pose.transform.r[3 * row + column] = r[4 * row + column];  // ODE pads rows to four
    }
  }
  pose.transform.t = {x[0], x[1], x[2]};
  judgePose(pose);
  return pose;
}

void judgePose(WorldPose& pose) noexcept {
  const Transformd& t = pose.transform;
  pose.rigid = isRotationWithin(t, kRotationTolerance, pose.defect);
  // What is a rotation is finite.
  pose.finite = std::isfinite(t.t.x) && std::isfinite(t.t.y) && std::isfinite(t.t.z);
  for (int i = 0; i < 9 && !pose.rigid; ++i) pose.finite = pose.finite && std::isfinite(t.r[i]);
  pose.rigid = pose.rigid && pose.finite;
}

/// How far beyond its mesh a geom's box reaches. A shell has no inside by which a body that lies on it is found, and a
/// flat one no height: the two must be queried before and while they touch. What a body moves in a step is not
/// known here. Where triangles are many the surface is seldom flat, and queries of neighbours would find nothing.
double shellMargin(const GeomObject& object, const TriMesh& mesh) {
  constexpr double kMost = 0.05, kFewTriangles = 64;  // of the radius
  const bool isPairwise = object.params.contact_model == dGPUTRIMESH_CONTACTS_PAIRWISE;
  if (isPairwise || mesh.meshClass() == MeshClass::kSolid) return 0;
  const double few = std::sqrt(kFewTriangles / std::max(kFewTriangles, static_cast<double>(mesh.triangleCount())));
  return kMost * few * static_cast<double>(mesh.radius());
}

void computeAabb(dGeomID geom, dReal aabb[6]) noexcept {
  // Never dGeomGetAABB here: the box is marked bad until we return, and it would call us again.
  const WorldPose pose = readPose(geom);
  std::fill(aabb, aabb + 6, dReal(0));
  // The hash space and the sweep-and-prune space do arithmetic on boxes that NaN would break.
  if (!pose.finite) return;
  const double position[3] = {pose.transform.t.x, pose.transform.t.y, pose.transform.t.z};
  const GeomObject* const object = objectOf(geom);
  const CollisionMesh* const mesh = object == nullptr ? nullptr : object->mesh();
  if (mesh == nullptr || mesh->tree().nodes.empty()) {
    for (int i = 0; i < 3; ++i) aabb[2 * i] = aabb[2 * i + 1] = static_cast<dReal>(position[i]);
    return;
  }
  const Vec3f& low = mesh->mesh().boundsMin();
  const Vec3f& high = mesh->mesh().boundsMax();
  const double lows[3] = {low.x, low.y, low.z};
  const double highs[3] = {high.x, high.y, high.z};
  const double margin = shellMargin(*object, mesh->mesh());
  for (int row = 0; row < 3; ++row) {
    double least = position[row], most = position[row], magnitude = std::abs(position[row]);
    for (int column = 0; column < 3; ++column) {
      const double r = pose.transform.r[3 * row + column];
      const double a = r * lows[column], b = r * highs[column];
      least += std::min(a, b);
      most += std::max(a, b);
      magnitude += std::max(std::abs(a), std::abs(b));
    }
    // Contacts are computed in a mesh's frame and carried to the world in double: sixteen roundings cover both ways.
    const double slack = 16 * std::numeric_limits<double>::epsilon() * magnitude;
    aabb[2 * row] = roundOutward(least - slack - margin, -1);
    aabb[2 * row + 1] = roundOutward(most + slack + margin, 1);
  }
}

void giveObject(dGeomID geom, const std::shared_ptr<GeomObject>& object) {
  {
    const CallLock lock(live().mutex);
    live().objects.insertOrAssign(geom, object.get());
  }
  slotOf(geom) = object.get();
  object->self = object;
}

void destroyObject(dGeomID geom) noexcept {
  const LibraryCall call;  // what goes with the geom has locks of its own
  // The class number may be out of date by now (ODE closed with geoms alive); the slot is ours all the same, because
  // ODE calls this function only through our class record.
  GeomObject*& slot = slotOf(geom);
  if (slot == nullptr) return;
  {
    const CallLock lock(live().mutex);
    live().objects.erase(geom);
  }
  const std::shared_ptr<GeomObject> last = std::move(slot->self);
  if (last->joined.join != nullptr) last->joined.join->isBroken = true;
  slot = nullptr;
  if (last->uses.beginChange()) {
    if (last->data != nullptr) last->data->detach(last->serial);
    last->data = nullptr;
    last->uses.endChange();
  } else {  // the query under way goes on with what it has
    if (last->data != nullptr) last->data->forgetGeom(last->serial);
    noteStatus(dGPUTRIMESH_ERROR_BUSY);
  }
}

}  // namespace otg
