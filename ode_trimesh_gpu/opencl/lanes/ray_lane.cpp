// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/ray_lane.h"

#include <string>

#include "shared/layout/ray_layout.h"

namespace otg::opencl {

static_assert(sizeof(LongRay) == OTG_RAY_DOUBLES * sizeof(double));

RayLane::RayLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : array_(context, meshes, tuning.pointGroup, sizeof(LongRay)) {
  cast_ = context.makeKernel("queries/ray_query.cl", "-DOTG_GROUP=" + std::to_string(tuning.pointGroup), "castRays");
}

void RayLane::begin(const CollisionMesh& mesh, bool cullBack) {
  array_.send(mesh);
  array_.run(cast_, cullBack ? otg_uint{1} : otg_uint{0});
  array_.receive();
}

}  // namespace otg::opencl
