// SPDX-License-Identifier: BSD-3-Clause
// The C API of callbacks.
#include "ode_trimesh_gpu/callbacks.h"

#include "ode/base/status.h"
#include "ode/geom/geom_class.h"
#include "ode/geom/mesh_side.h"

namespace otg {
namespace {

template <class Callback>
int set(dGeomID g, Callback* GeomCallbacks::*which, Callback* callback) {
  GeomObject* const object = liveObjectOf(g);
  if (object == nullptr) return noteStatus(dGPUTRIMESH_ERROR_CLASS);
  object->callbacks.*which = callback;
  return dGPUTRIMESH_OK;
}

template <class Callback>
Callback* get(dGeomID g, Callback* GeomCallbacks::*which) {
  const GeomObject* const object = liveObjectOf(g);
  if (object == nullptr) noteStatus(dGPUTRIMESH_ERROR_CLASS);
  return object == nullptr ? nullptr : object->callbacks.*which;
}

}  // namespace
}  // namespace otg

int dGeomGpuTriMeshSetPairCallback(dGeomID g, dGpuTriMeshPairCallback* Callback) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    object->callbacks.pair = Callback;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
dGpuTriMeshPairCallback* dGeomGpuTriMeshGetPairCallback(dGeomID g) {
  dGpuTriMeshPairCallback* callback = nullptr;
  otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    callback = object->callbacks.pair;
    return static_cast<int>(dGPUTRIMESH_OK);
  });
  return callback;
}

int dGeomGpuTriMeshSetCallback(dGeomID g, dTriCallback* Callback) {
  return otg::set(g, &otg::GeomCallbacks::triangle, Callback);
}
dTriCallback* dGeomGpuTriMeshGetCallback(dGeomID g) {
  return otg::get(g, &otg::GeomCallbacks::triangle);
}

int dGeomGpuTriMeshSetArrayCallback(dGeomID g, dTriArrayCallback* ArrayCallback) {
  return otg::set(g, &otg::GeomCallbacks::triangles, ArrayCallback);
}
dTriArrayCallback* dGeomGpuTriMeshGetArrayCallback(dGeomID g) {
  return otg::get(g, &otg::GeomCallbacks::triangles);
}

int dGeomGpuTriMeshSetRayCallback(dGeomID g, dTriRayCallback* Callback) {
  return otg::set(g, &otg::GeomCallbacks::ray, Callback);
}
dTriRayCallback* dGeomGpuTriMeshGetRayCallback(dGeomID g) {
  return otg::get(g, &otg::GeomCallbacks::ray);
}

int dGeomGpuTriMeshSetTriMergeCallback(dGeomID g, dTriTriMergeCallback* Callback) {
  return otg::set(g, &otg::GeomCallbacks::merge, Callback);
}
dTriTriMergeCallback* dGeomGpuTriMeshGetTriMergeCallback(dGeomID g) {
  return otg::get(g, &otg::GeomCallbacks::merge);
}
