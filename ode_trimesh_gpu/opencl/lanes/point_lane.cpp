// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/point_lane.h"

#include <string>

namespace otg::opencl {
namespace {

struct PointBounds {
  double lo[3], hi[3];
};

PointBounds boundsOf(const TriMesh& mesh) {
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  return {{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}};
}

}  // namespace

PointLane::PointLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : array_(context, meshes, tuning.pointGroup, sizeof(Vec3d)) {
  const std::string options = "-DOTG_GROUP=" + std::to_string(tuning.pointGroup);
  nearest_ = context.makeKernel("queries/point_query.cl", options, "nearestPoints");
  inside_ = context.makeKernel("queries/point_query.cl", options, "insidePoints");
}

void PointLane::begin(const CollisionMesh& mesh, PointWish wish) {
  array_.send(mesh);
  if (wish.nearest) array_.run(nearest_);
  if (wish.inside) array_.run(inside_, boundsOf(mesh.mesh()), wish.nearest ? otg_uint{0} : otg_uint{1});
  array_.receive();
}

}  // namespace otg::opencl
