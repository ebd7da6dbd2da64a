// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/lanes/distance_lane.h"

#include <algorithm>
#include <string>

namespace otg::opencl {

DistanceLane::DistanceLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context), meshes_(meshes), group_(tuning.batchGroup), tuning_(tuning), queue_(context.makeQueue(false)) {
  walk_.make(
      context, "queries/batch_distance.cl",
      "-DOTG_GROUP=" + std::to_string(tuning.batchGroup) + " -DOTG_LEAF=" + std::to_string(meshes.leafTriangles()));
}

DistanceLane::~DistanceLane() {
  if (underWay_) clRelease(OTG_CL(clFinish), queue_.get());
}

std::span<otg_distance_task> DistanceLane::stage(std::size_t count) {
  staged_.reserve(context_, queue_.get(), count * sizeof(otg_distance_task));
  count_ = count;
  return {reinterpret_cast<otg_distance_task*>(staged_.data()), count};
}

std::span<const otg_uint> DistanceLane::run(std::span<const CollisionMesh* const> meshes, const RunParts& threads) {
  const cl_command_queue queue = queue_.get();
  tasks_.reserve(context_, count_);
  places_.reserve(context_, meshes.size());
  answers_.reserve(context_, count_);
  received_.reserve(context_, queue, 2 * count_ * sizeof(otg_uint));
  pinned_ = meshes_.acquire(meshes, &threads);
  underWay_ = true;
  table_.clear();
  std::uint32_t depth = 0;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    table_.push_back(pinned_[i]);
    depth = std::max(depth, pinned_[i].depth);
  }
  const std::uint32_t stackSize = stackSizeFor(tuning_, 2 * depth);
  writeLater(queue, tasks_.get(), count_ * sizeof(otg_distance_task), staged_.data());
  writeLater(queue, places_.get(), table_.size() * sizeof(otg_device_mesh), table_.data());
  walk_.give({.tasks = tasks_.buffer(),
              .places = places_.buffer(),
              .meshes = pinned_.units(),
              .answers = answers_.buffer(),
              .stackSize = stackSize,
              .stack = {stackSize},
              .stackGaps = {stackSize}});
  launch(queue, walk_, group_, count_);
  clDo(OTG_CL(clEnqueueReadBuffer), queue, answers_.get(), cl_bool{CL_FALSE}, std::size_t{0},
       2 * count_ * sizeof(otg_uint), static_cast<void*>(received_.data()), cl_uint{0},
       static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
  clDo(OTG_CL(clFinish), queue);
  underWay_ = false;
  pinned_ = {};
  return {reinterpret_cast<const otg_uint*>(received_.data()), 2 * count_};
}

}  // namespace otg::opencl
