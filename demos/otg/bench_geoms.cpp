// SPDX-License-Identifier: BSD-3-Clause
#include "otg/bench_geoms.h"

#include "otg/command.h"

namespace otg::cli {

dGpuTriMeshDataID meshData(const TriMesh& mesh, const std::string& name) {
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  if (dGpuTriMeshDataBuildSingle(data, mesh.vertices().data(), sizeof(Vec3f), static_cast<int>(mesh.vertices().size()),
                                 mesh.triangles().data(), static_cast<int>(3 * mesh.triangleCount()),
                                 sizeof(Triangle)) != dGPUTRIMESH_OK) {
    dGpuTriMeshDataDestroy(data);
    throw InputError(name + ": the library refuses this mesh");
  }
  return data;
}

void poseGeom(dGeomID geom, const Transformd& pose) {
  dMatrix3 r{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = pose.r[3 * row + column];
  }
  dGeomSetRotation(geom, r);
  dGeomSetPosition(geom, pose.t.x, pose.t.y, pose.t.z);
}

std::uint64_t deviceCalls() {
  std::uint64_t calls = 0;
  for (int i = 0; i < dGpuTriMeshGetDeviceCount(); ++i) {
    dGpuTriMeshDevice device;
    dGpuTriMeshDeviceInit(&device);
    if (dGpuTriMeshGetDevice(i, &device) == dGPUTRIMESH_OK) calls += device.calls;
  }
  return calls;
}

}  // namespace otg::cli
