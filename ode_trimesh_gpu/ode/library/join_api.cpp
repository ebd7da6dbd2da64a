// SPDX-License-Identifier: BSD-3-Clause
// The C API of geoms that are pieces of one surface.
#include "ode_trimesh_gpu/join.h"

#include <ode/ode.h>

#include <algorithm>
#include <vector>

#include "ode/base/status.h"
#include "ode/geom/joined_sides.h"

namespace otg {
namespace {

/// A geom that a program hands us, with its mesh; without an object if it is of another class.
MeshGeom joinable(dGeomID geom) {
  if (GeomObject* const object = liveObjectOf(geom)) {
    MeshGeom side{geom, object};
    side.takeMesh();
    return side;
  }
  if (objectOfTrimesh(geom) == nullptr) return {};
  return meshSideOf(geom);
}

int join(std::span<const dGeomID> geoms) {
  std::vector<dGeomID> sorted(geoms.begin(), geoms.end());
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return dGPUTRIMESH_ERROR_ARGUMENT;
  std::vector<MeshGeom> sides;
  std::vector<WorldPose> poses;
  for (const dGeomID geom : geoms) {
    MeshGeom side = joinable(geom);
    if (side.object == nullptr) return dGPUTRIMESH_ERROR_CLASS;
    if (side.mesh == nullptr || side.mesh->tree().nodes.empty()) continue;
    poses.push_back(readPose(geom));
    if (!poses.back().rigid) return dGPUTRIMESH_ERROR_POSE;
    sides.push_back(std::move(side));
  }
  return sides.empty() ? 0 : joinGeoms(sides, poses);
}

}  // namespace
}  // namespace otg

int dGpuTriMeshJoin(const dGeomID* geoms, int count) {
  return otg::guarded([&] {
    if (count < 0 || (geoms == nullptr && count > 0)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    return otg::join({geoms, static_cast<std::size_t>(count)});
  });
}

int dGpuTriMeshUnjoin(dGeomID g) {
  return otg::guarded([&] {
    const std::shared_ptr<otg::GeomObject> object = otg::settingsOf(g);
    if (object == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_CLASS);
    object->joined.leave();
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}
