// SPDX-License-Identifier: BSD-3-Clause
// A user's program in C++: the same through the C++ header.
#include <ode/ode.h>

#include <cstdint>
#include <cstdio>
#include <ode_trimesh_gpu/ode_trimesh_gpu.hpp>

int main() {
  const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::uint32_t triangles[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  if (!dInitODE2(0) || !otg::initGpuTriMesh()) return 1;
  int count = 0;
  {
    otg::GpuTriMeshData mesh;
    if (mesh.build(corners, 4, triangles, 4) != dGPUTRIMESH_OK || mesh.report().triangles != 4) return 2;
    const dGeomID a = mesh.createGeom(), b = mesh.createGeom();
    dGeomSetPosition(b, 0.1, 0.15, 0.6);
    dContactGeom contacts[8];
    count = dCollide(a, b, 8, contacts, sizeof contacts[0]);
    dGeomDestroy(a);
    dGeomDestroy(b);
  }
  std::printf("%d contacts\n", count);
  dGpuTriMeshClose();
  dCloseODE();
  return count > 0 ? 0 : 3;
}
