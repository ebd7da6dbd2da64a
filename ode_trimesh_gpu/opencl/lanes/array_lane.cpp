// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/array_lane.h"

#include <string>

namespace otg::opencl {
namespace {

static_assert(sizeof(Vec3d) == 3 * sizeof(double));
static_assert(sizeof(LongRay) == OTG_RAY_DOUBLES * sizeof(double));

otg_point_bounds boundsOf(const TriMesh& mesh) {
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  return {{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}};
}

std::string optionsFor(const Tuning& tuning) {
  return "-DOTG_GROUP=" + std::to_string(tuning.pointGroup);
}

}  // namespace

void PointKernels::build(Context& context, const Tuning& tuning) {
  nearest_.make(context, "queries/point_query.cl", optionsFor(tuning));
  inside_.make(context, "queries/point_query.cl", optionsFor(tuning));
}

void PointKernels::run(Array& array, const CollisionMesh& mesh, const PointRequest& request) {
  const given::PointArray sent{
      .place = array.place(), .meshes = array.meshes(), .points = array.sentItems(), .count = array.sentCount()};
  if (request.nearest) array.run(nearest_, {.array = sent, .answers = array.words()});
  if (request.inside) {
    array.run(inside_, {.array = sent,
                        .bounds = boundsOf(mesh.mesh()),
                        .alone = request.nearest ? otg_uint{0} : otg_uint{1},
                        .answers = array.words()});
  }
}

void RayKernels::build(Context& context, const Tuning& tuning) {
  cast_.make(context, "queries/ray_query.cl", optionsFor(tuning));
}

void RayKernels::run(Array& array, const CollisionMesh&, const RayRequest& request) {
  array.run(cast_, {.place = array.place(),
                    .meshes = array.meshes(),
                    .rays = array.sentItems(),
                    .count = array.sentCount(),
                    .cullBack = request.cullBack ? otg_uint{1} : otg_uint{0},
                    .answers = array.words()});
}

}  // namespace otg::opencl
