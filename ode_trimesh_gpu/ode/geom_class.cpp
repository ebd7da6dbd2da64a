// SPDX-License-Identifier: BSD-3-Clause
// The life of a geom, its bounding box, and its C API of creation, data and parameters.
#include "ode/geom_class.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <shared_mutex>

#include "collide/rotation_tolerance.h"
#include "ode/class_registration.h"
#include "ode/geom_table.h"
#include "ode/mesh_side.h"
#include "ode/status.h"
#include "ode_trimesh_gpu/geom.h"

namespace otg {
namespace {

GeomObject*& slotOf(dGeomID geom) {
  return *static_cast<GeomObject**>(dGeomGetClassData(geom));
}

/// All geoms of ours, so that one that was destroyed is told from one that was not.
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

int checkParams(const dGpuTriMeshParams* params) noexcept {
  if (!isCurrentSize(params)) return dGPUTRIMESH_ERROR_ARGUMENT;
  const dGpuTriMeshParams& p = *params;
  const auto within = [](int value, int low, int high) { return value >= low && value <= high; };
  bool good = within(p.traversal, dGPUTRIMESH_TRAVERSAL_STANDARD, dGPUTRIMESH_TRAVERSAL_WIDE) &&
              within(p.descent, dGPUTRIMESH_DESCENT_FIRST_TREE, dGPUTRIMESH_DESCENT_BOTH) &&
              (p.box_axes == 6 || p.box_axes == 15) &&
              within(p.contact_model, dGPUTRIMESH_CONTACTS_AUTO, dGPUTRIMESH_CONTACTS_SOLID) &&
              within(p.reduction, dGPUTRIMESH_REDUCTION_NONE, dGPUTRIMESH_REDUCTION_CONE) &&
              within(p.max_contacts, 1, 65535) && within(p.contacts_per_region, 1, 64) &&
              within(p.history, dGPUTRIMESH_HISTORY_OFF, dGPUTRIMESH_HISTORY_ON) && p.region_merge >= 0 &&
              std::isfinite(p.region_merge);
  for (const int place : {p.backend, p.middle_phase, p.near_phase}) {
    good = good && within(place, dGPUTRIMESH_BACKEND_DEFAULT, dGPUTRIMESH_BACKEND_OPENCL);
  }
  for (const int bins : p.bins) good = good && within(bins, 1, 64);
  if (!good) return dGPUTRIMESH_ERROR_ARGUMENT;
  return dGPUTRIMESH_OK;
}

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
  if (data != nullptr) data->detach(serial);
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
  // Of a geom with an offset ODE works out the pose when it is asked for, in the geom: several threads may ask.
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
  return withRigidity(pose);
}

WorldPose withRigidity(WorldPose pose) noexcept {
  const Transformd& t = pose.transform;
  pose.finite = std::isfinite(t.t.x) && std::isfinite(t.t.y) && std::isfinite(t.t.z);
  for (const double r : t.r) pose.finite = pose.finite && std::isfinite(r);
  pose.rigid = pose.finite && rotationDefect(t) <= kRotationTolerance;
  return pose;
}

/// How far beyond its mesh a geom's box reaches. A shell has no inside by which a body that lies on it is found, and a
/// flat one no height: the two must be asked about before and while they touch. What a body moves in a step is not
/// known here. Where triangles are many the surface is seldom flat, and neighbours would be asked in vain.
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

void destroyObject(dGeomID geom) noexcept {
  // The class number may be out of date by now (ODE closed with geoms alive); the slot is ours all the same, because
  // ODE calls this function only through our class record.
  GeomObject*& slot = slotOf(geom);
  if (slot == nullptr) return;
  {
    const std::unique_lock lock(live().mutex);
    live().objects.erase(geom);
  }
  const std::shared_ptr<GeomObject> last = std::move(slot->self);
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

dGeomID dCreateGpuTriMesh(dSpaceID space, dGpuTriMeshDataID data) {
  dGeomID geom = nullptr;
  otg::guarded([&] {
    if (const int status = otg::ensureRegistered()) return status;
    if (data != nullptr && !dxGpuTriMeshData::isLive(data)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    const auto object = std::make_shared<otg::GeomObject>();  // its counts lie beside what is read of it
    object->serial = otg::nextSerial();
    dGpuTriMeshParamsInit(&object->params);
    const dGeomID created = dCreateGeom(otg::registeredClass());
    if (data != nullptr) {
      try {
        data->attach(object->serial, created);
      } catch (...) {
        dGeomDestroy(created);
        throw;
      }
      object->data = data;
    }
    try {
      const std::unique_lock lock(otg::live().mutex);
      otg::live().objects.insertOrAssign(created, object.get());
    } catch (...) {
      dGeomDestroy(created);  // the object goes with its own data
      throw;
    }
    otg::slotOf(created) = object.get();
    object->self = object;
    geom = created;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  // Last: from here on ODE may ask for the box at any time.
  if (geom != nullptr && space != nullptr) dSpaceAdd(space, geom);
  return geom;
}

int dGeomGpuTriMeshSetData(dGeomID g, dGpuTriMeshDataID data) {
  return otg::guarded([&] {
    otg::GeomObject* const object = otg::liveObjectOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    const otg::ChangeHold change(&object->uses);
    if (!change.good()) return static_cast<int>(dGPUTRIMESH_ERROR_BUSY);
    dxGpuTriMeshData* const before = object->data;
    if (before != data) {
      if (data != nullptr && !dxGpuTriMeshData::isLive(data)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
      // Neither may be about to give the geom a mesh of its own accord.
      std::optional<otg::UseHold> useBefore(before == nullptr ? nullptr : &before->uses);
      std::optional<otg::UseHold> use(data == nullptr ? nullptr : &data->uses);
      if (!useBefore->good() || !use->good()) return static_cast<int>(dGPUTRIMESH_ERROR_BUSY);
      if (data != nullptr) data->attach(object->serial, g);
      int status = dGPUTRIMESH_ERROR_MEMORY;
      try {
        status = object->rescale(data, object->scale);
      } catch (const std::bad_alloc&) {
      }
      if (status == dGPUTRIMESH_OK) object->data = data;
      if (dxGpuTriMeshData* const unused = status == dGPUTRIMESH_OK ? before : data) {
        unused->forgetGeom(object->serial);
        useBefore.reset();  // the object may go now
        use.reset();
        unused->detach(object->serial);
      }
      if (status != dGPUTRIMESH_OK) return status;
    }
    dGeomMoved(g);
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

dGpuTriMeshDataID dGeomGpuTriMeshGetData(dGeomID g) {
  const otg::GeomObject* const object = otg::liveObjectOf(g);
  if (object == nullptr) {
    otg::noteStatus(dGPUTRIMESH_ERROR_CLASS);
    return nullptr;
  }
  return object->data != nullptr && object->data->hasHandle() ? object->data : nullptr;
}

int dGeomGpuTriMeshSetLastTransform(dGeomID g, const dReal* last_trans) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    const otg::LastTransform last = last_trans == nullptr ? otg::LastTransform{} : otg::lastTransformOf(last_trans);
    if (last_trans != nullptr && !last.isSet) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    object->last = last;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

const dReal* dGeomGpuTriMeshGetLastTransform(dGeomID g) {
  const dReal* matrix = nullptr;
  otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    matrix = object->last.matrix;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return matrix;
}

void dGpuTriMeshParamsInit(dGpuTriMeshParams* params) {
  if (params == nullptr) return;
  *params = dGpuTriMeshParams{};
  params->size = sizeof(dGpuTriMeshParams);
  params->traversal = dGPUTRIMESH_TRAVERSAL_WIDE;
  params->descent = dGPUTRIMESH_DESCENT_LARGER;
  params->box_axes = 6;
  params->contact_model = dGPUTRIMESH_CONTACTS_AUTO;
  params->reduction = dGPUTRIMESH_REDUCTION_BINNING;
  std::fill(std::begin(params->bins), std::end(params->bins), 3);
  params->max_contacts = 65535;
  params->contacts_per_region = otg::SolidOptions{}.contactsPerRegion;
  params->history = dGPUTRIMESH_HISTORY_ON;
  params->region_merge = static_cast<dReal>(otg::SolidOptions{}.regionMerge);
}

int dGeomGpuTriMeshSetParams(dGeomID g, const dGpuTriMeshParams* params) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    if (const int status = otg::checkParams(params)) return status;
    object->params = *params;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshGetParams(dGeomID g, dGpuTriMeshParams* params) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    if (!otg::isCurrentSize(params)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    *params = object->params;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
