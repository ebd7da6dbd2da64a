// SPDX-License-Identifier: BSD-3-Clause
// ODE's own triangle meshes, for tests that have them collide through this library.
#pragma once

#include <ode/ode.h>

#include "ode_trimesh_gpu/override.h"
#include "scenes/generated_meshes.h"

namespace otg::test {

/// Data of ODE's with the arrays that they point to.
struct OdeMesh {
  scenes::MeshArrays arrays;
  dTriMeshDataID id = dGeomTriMeshDataCreate();
  explicit OdeMesh(const scenes::MeshArrays& from) : arrays(from) {
    build();
    // Data that a test before has destroyed may have had the same address and as many triangles: what is kept of them
    // would be refitted, numbered inside as they were.
    dGpuTriMeshOverrideForgetData(id);
  }
  ~OdeMesh() { dGeomTriMeshDataDestroy(id); }
  OdeMesh(const OdeMesh&) = delete;
  OdeMesh& operator=(const OdeMesh&) = delete;
  void build() {
    dGeomTriMeshDataBuildSingle(id, arrays.vertices.data(), sizeof(Vec3f), static_cast<int>(arrays.vertices.size()),
                                arrays.triangles.data(), static_cast<int>(3 * arrays.triangles.size()),
                                sizeof(Triangle));
  }
};

/// A dTriMesh outside of any space, of which nothing is known yet.
struct OdeGeom {
  const dGeomID id;
  explicit OdeGeom(const OdeMesh& mesh) : id(dCreateTriMesh(nullptr, mesh.id, nullptr, nullptr, nullptr)) {
    dGpuTriMeshOverrideForgetGeom(id);  // the one that was at this address
  }
  ~OdeGeom() { dGeomDestroy(id); }
  OdeGeom(const OdeGeom&) = delete;
  OdeGeom& operator=(const OdeGeom&) = delete;
};

}  // namespace otg::test
