// SPDX-License-Identifier: BSD-3-Clause
// One side of a query: a geom of our class, or a dTriMesh of ODE's that collides through us.
#pragma once

#include <ode/collision.h>

#include <memory>

#include "ode/geom/geom_class.h"
#include "ode/geom/mesh_join.h"

namespace otg {

/// A geom and its mesh at one moment: what is kept of a side as long as its query is under way.
struct MeshGeom {
  dGeomID geom = nullptr;
  GeomObject* object = nullptr;         ///< null: the geom is neither of our class nor a dTriMesh
  const CollisionMesh* mesh = nullptr;  ///< null: nothing to collide with; see takeMesh()
  /// Of a dTriMesh, which may be destroyed or changed without our knowledge: shares of its object and mesh.
  std::shared_ptr<GeomObject> ownObject{};
  std::shared_ptr<const CollisionMesh> ownMesh{};
  /// What the geom is a piece of, whose mesh `mesh` is then; see enterJoin().
  std::shared_ptr<const MeshJoin> join{};
  std::uint32_t part = 0;

  /// Of a geom of our class, once it is held (GeomUse): until then its mesh may be changed.
  void takeMesh() {
    if (object != nullptr && ownObject == nullptr) mesh = object->mesh();
  }
  std::shared_ptr<const CollisionMesh> sharedMesh() const {
    if (join != nullptr) return join->mesh;
    return ownMesh != nullptr || object == nullptr ? ownMesh : object->sharedMesh();
  }
};

/// With the program's callbacks for the geom's triangles, at the same moment.
struct MeshSide : MeshGeom {
  GeomCallbacks callbacks;
};

/// For geoms of our class as objectOf(). A dTriMesh gets an object at the first request. It holds its serial number,
/// its parameters and what is remembered of its pairs; its mesh is read through trimesh_cache.h, its callbacks through
/// ODE. May throw std::bad_alloc.
MeshSide meshSideOf(dGeomID geom);

/// The object of a geom that is alive, of our class or a dTriMesh, which gets one; null for others. It lives as long as
/// the geom, of a dTriMesh until forgetTrimesh(). May throw std::bad_alloc.
GeomObject* meshObjectOf(dGeomID geom);

/// The callbacks to call for the triangles of a geom with that object: a dTriMesh's own callbacks are among them.
GeomCallbacks callbacksOf(dGeomID geom, const GeomObject& object);

/// The object of a dTriMesh; null for geoms of other classes. May throw std::bad_alloc.
std::shared_ptr<GeomObject> objectOfTrimesh(dGeomID geom);

/// What settings of a geom belong to: of our class, or a dTriMesh. Null for others. May throw std::bad_alloc.
std::shared_ptr<GeomObject> settingsOf(dGeomID geom);

/// A dTriMesh is about to be destroyed: its object goes when the queries that have it are done.
void forgetTrimesh(dGeomID geom) noexcept;
/// No dTriMesh has an object any more.
void forgetTrimeshes() noexcept;

/// What a dTriMesh gets when it is first requested.
void setTrimeshParams(const dGpuTriMeshParams& params) noexcept;
dGpuTriMeshParams trimeshParams() noexcept;

/// Whether the program has set where the geom, alive and with an object, was a step before.
bool hasLastTransform(const MeshGeom& side) noexcept;
/// Where, if it has.
Transformd lastPoseOf(const MeshGeom& side) noexcept;

/// The pose in ODE's dMatrix4: a rotation's columns, then the position, each as four numbers.
LastTransform lastTransformOf(const dReal* matrix) noexcept;

}  // namespace otg
