// SPDX-License-Identifier: BSD-3-Clause
// The C++ header: ownership by scope.
#include <ode_trimesh_gpu/ode_trimesh_gpu.hpp>

#include "example.h"

int main() {
  EXPECT(dInitODE2(0));
  EXPECT(otg::initGpuTriMesh());
  dGeomID a = nullptr, b = nullptr;
  {
    otg::GpuTriMeshData data;
    EXPECT(data.build(kBoxVertices[0], 8, kBoxTriangles[0], 12) == dGPUTRIMESH_OK);
    EXPECT(data.report().solid && data.error().empty());
    a = data.createGeom();
    b = data.createGeom();
  }  // the geoms keep the mesh
  dGeomSetPosition(b, 0, 0, 0.9);
  dContactGeom contacts[16];
  EXPECT(dCollide(a, b, 16, contacts, sizeof contacts[0]) >= 4);
  dGeomDestroy(a);
  dGeomDestroy(b);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
