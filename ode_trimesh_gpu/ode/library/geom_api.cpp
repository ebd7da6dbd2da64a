// SPDX-License-Identifier: BSD-3-Clause
// The C API of a geom: creation, data, parameters, scale, triangles, and temporal coherence by ODE's names.
#include "ode_trimesh_gpu/geom.h"

#include <ode/collision.h>

#include <cmath>
#include <memory>
#include <new>
#include <optional>

#include "ode/base/status.h"
#include "ode/data/mesh_data.h"
#include "ode/geom/check_params.h"
#include "ode/geom/class_number.h"
#include "ode/geom/geom_class.h"
#include "ode/geom/mesh_side.h"
#include "ode/library/class_registration.h"
#include "ode_trimesh_gpu/params.h"

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

void writeVector(const Vec3d& from, dReal* to) {
  to[0] = static_cast<dReal>(from.x);
  to[1] = static_cast<dReal>(from.y);
  to[2] = static_cast<dReal>(from.z);
  to[3] = 0;
}

/// dGPUTRIMESH_OK if there is such a geom and such a class.
int check(const GeomObject* object, int geomClass) {
  if (object == nullptr) return dGPUTRIMESH_ERROR_CLASS;
  return geomClass >= 0 && geomClass < dGeomNumClasses ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_ARGUMENT;
}

}  // namespace
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
        data->attach(object->serial, created, object.get());
      } catch (...) {
        dGeomDestroy(created);
        throw;
      }
      object->data = data;
    }
    try {
      otg::giveObject(created, object);
    } catch (...) {
      dGeomDestroy(created);  // the object goes with its own data
      throw;
    }
    geom = created;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  // Last: from here on ODE may request the box at any time.
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
      if (data != nullptr) data->attach(object->serial, g, object);
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

int dGeomGpuTriMeshSetScale(dGeomID g, dReal x, dReal y, dReal z) {
  return otg::guarded([&] {
    otg::GeomObject* const object = otg::liveObjectOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    const otg::MeshScale scale = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    for (const float s : scale) {
      if (!std::isfinite(s) || s == 0) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    const otg::ChangeHold change(&object->uses);
    const otg::UseHold use(change.good() && object->data != nullptr ? &object->data->uses : nullptr);
    if (!change.good() || !use.good()) return static_cast<int>(dGPUTRIMESH_ERROR_BUSY);
    if (const int status = object->rescale(object->data, scale)) return status;
    dGeomMoved(g);
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshGetScale(dGeomID g, dVector3 scale) {
  const otg::GeomObject* const object = otg::liveObjectOf(g);
  if (object == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_CLASS);
  if (scale == nullptr) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  for (std::size_t k = 0; k < 3; ++k) scale[k] = static_cast<dReal>(object->scale[k]);
  scale[3] = 0;
  return dGPUTRIMESH_OK;
}

int dGeomGpuTriMeshPrepare(dGeomID g) {
  return otg::guarded([&] {
    otg::GeomObject* const object = otg::liveObjectOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    const otg::GeomUse use(object);
    if (!use.good()) return static_cast<int>(dGPUTRIMESH_ERROR_BUSY);
    const otg::CollisionMesh* const mesh = object->mesh();
    if (mesh == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_MESH);
    if (object->params.contact_model == dGPUTRIMESH_CONTACTS_PAIRWISE) {
      mesh->wide();
    } else {
      mesh->prepare();
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

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
    if (out[k] != nullptr) otg::writeVector(triangle.corner[k], *out[k]);
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
  otg::writeVector(point, Out);
  return dGPUTRIMESH_OK;
}

int dGeomGpuTriMeshEnableTC(dGeomID g, int geomClass, int enable) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (const int status = otg::check(object.get(), geomClass)) return status;
    if (geomClass == otg::registeredClass()) {
      object->params.history = enable != 0 ? dGPUTRIMESH_HISTORY_ON : dGPUTRIMESH_HISTORY_OFF;
    } else if (enable != 0) {
      object->coherentClasses |= 1u << geomClass;
    } else {
      object->coherentClasses &= ~(1u << geomClass);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshIsTCEnabled(dGeomID g, int geomClass) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (const int status = otg::check(object.get(), geomClass)) return status;
    return object->remembersWith(geomClass) ? 1 : 0;
  });
}

int dGeomGpuTriMeshClearTCCache(dGeomID g) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    object->memory.clear();
    object->clearedAt = otg::PairMemory::now();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

dGpuTriMeshDataID dGeomGpuTriMeshGetTriMeshDataID(dGeomID g) {
  return dGeomGpuTriMeshGetData(g);
}
