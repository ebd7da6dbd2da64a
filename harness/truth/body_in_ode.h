// SPDX-License-Identifier: BSD-3-Clause
// A body of a pair as a geom: of one of ODE's shapes, of the library's class, or a dTriMesh.
#pragma once

#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <memory>

#include "truth/pair_body.h"

namespace otg::scenes {
class ConvexData;
}

namespace otg::truth {

struct GeomChoices {
  bool secondFirst = false;   ///< the geom of B is created before that of A
  bool byUpdate = false;      ///< meshes are built from other vertices and moved to theirs
  bool reversedCall = false;  ///< dCollide(B, A), the result turned round
  int places = 64;
  bool asTriMesh = false;  ///< meshes are ODE's dTriMesh: stock ODE's contacts, or with the override the library's
  bool remembers = false;  ///< pairs of the library's geoms remember what they do from query to query
};

/// One of ODE's shapes, in no space and not placed. `mesh`: of a polyhedron, its faces; `convex` keeps what its geom
/// points to.
dGeomID makeShapeGeom(const ConvexBody& shape, const scenes::MeshArrays& mesh,
                      std::unique_ptr<scenes::ConvexData>& convex);

/// In no space, where the body's pose says. ODE and the geom class must be initialised. Throws std::runtime_error where
/// the library refuses a mesh.
class BodyInOde {
 public:
  BodyInOde(const PairBody& body, const GeomChoices& choices);
  ~BodyInOde();
  BodyInOde(const BodyInOde&) = delete;
  BodyInOde& operator=(const BodyInOde&) = delete;

  dGeomID geom() const { return geom_; }
  bool isMesh() const { return data_ != nullptr; }

 private:
  void makeTriMesh(const scenes::MeshArrays& mesh, bool byUpdate);
  void makeMesh(const scenes::MeshArrays& mesh, const GeomChoices& choices);

  dGpuTriMeshDataID data_ = nullptr;
  dTriMeshDataID triMeshData_ = nullptr;
  scenes::MeshArrays arrays_;
  std::unique_ptr<scenes::ConvexData> convex_;
  dGeomID geom_ = nullptr;
};

}  // namespace otg::truth
