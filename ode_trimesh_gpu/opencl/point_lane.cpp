// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/point_lane.h"

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
    : context_(context), meshes_(meshes), group_(tuning.pointGroup), queue_(context.makeQueue(false)) {
  const std::string options = "-DOTG_GROUP=" + std::to_string(group_);
  nearest_ = context.makeKernel("point_query.cl", options, "nearestPoints");
  inside_ = context.makeKernel("point_query.cl", options, "insidePoints");
}

std::span<Vec3d> PointLane::makeRoom(std::size_t count) {
  sent_.reserve(context_, queue_.get(), count * sizeof(Vec3d));
  count_ = count;
  return {reinterpret_cast<Vec3d*>(sent_.data()), count};
}

void PointLane::begin(const CollisionMesh& mesh, PointWish wish) {
  const cl_command_queue queue = queue_.get();
  points_.reserve(context_, count_);
  answers_.reserve(context_, count_);
  received_.reserve(context_, queue, count_ * sizeof(otg_uint));
  const CollisionMesh* const one[] = {&mesh};
  mesh_ = meshes_.acquire(one);
  underWay_ = true;
  const otg_device_mesh place = mesh_[0];
  const auto count = static_cast<otg_uint>(count_);
  const std::size_t groups = (count_ + group_ - 1) / group_;
  writeLater(queue, points_.get(), count_ * sizeof(Vec3d), sent_.data());
  if (wish.nearest) {
    Arguments(nearest_) << place << mesh_.buffer() << points_.get() << count << answers_.get();
    launch(queue, nearest_, group_, groups);
  }
  if (wish.inside) {
    const otg_uint alone = wish.nearest ? 0 : 1;
    Arguments(inside_) << place << mesh_.buffer() << points_.get() << count << boundsOf(mesh.mesh()) << alone
                       << answers_.get();
    launch(queue, inside_, group_, groups);
  }
  clDo(OTG_CL(clEnqueueReadBuffer), queue, answers_.get(), cl_bool{CL_FALSE}, std::size_t{0}, count_ * sizeof(otg_uint),
       static_cast<void*>(received_.data()), cl_uint{0}, static_cast<const cl_event*>(nullptr),
       static_cast<cl_event*>(nullptr));
  clDo(OTG_CL(clFlush), queue);
}

std::span<const otg_uint> PointLane::end() {
  clDo(OTG_CL(clFinish), queue_.get());
  underWay_ = false;
  mesh_ = {};
  return {reinterpret_cast<const otg_uint*>(received_.data()), count_};
}

void PointLane::wait() noexcept {
  if (underWay_) clRelease(OTG_CL(clFinish), queue_.get());
}

}  // namespace otg::opencl
