// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/array_lane.h"

#include <string>

namespace otg::opencl {
namespace {

static_assert(sizeof(LongRay) == OTG_RAY_DOUBLES * sizeof(double));

struct PointBounds {
  double lo[3], hi[3];
};

PointBounds boundsOf(const TriMesh& mesh) {
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  return {{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}};
}

std::string optionsFor(const Tuning& tuning) {
  return "-DOTG_GROUP=" + std::to_string(tuning.pointGroup);
}

}  // namespace

void PointKernels::build(Context& context, const Tuning& tuning) {
  nearest_ = context.makeKernel("queries/point_query.cl", optionsFor(tuning), "nearestPoints");
  inside_ = context.makeKernel("queries/point_query.cl", optionsFor(tuning), "insidePoints");
}

void PointKernels::run(WordArray& array, const CollisionMesh& mesh, const PointWish& wish) {
  if (wish.nearest) array.run(nearest_);
  if (wish.inside) array.run(inside_, boundsOf(mesh.mesh()), wish.nearest ? otg_uint{0} : otg_uint{1});
}

void RayKernels::build(Context& context, const Tuning& tuning) {
  cast_ = context.makeKernel("queries/ray_query.cl", optionsFor(tuning), "castRays");
}

void RayKernels::run(WordArray& array, const CollisionMesh&, const RayWish& wish) {
  array.run(cast_, wish.cullBack ? otg_uint{1} : otg_uint{0});
}

}  // namespace otg::opencl
