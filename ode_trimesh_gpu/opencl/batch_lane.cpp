// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/batch_lane.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace otg::opencl {

BatchLane::BatchLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      tuning_(tuning),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      queue_(context.makeQueue(tuning.profile)),
      results_(tuning.recordsExpected),
      chosen_(tuning.readMode),
      contactPlaces_(std::max(1u, tuning.contactPlaces)),
      reducer_(context, tuning, false),
      profile_(tuning.profile) {
  const std::string walk =
      "-DOTG_GROUP=" + std::to_string(tuning.batchGroup) + " -DOTG_LEAF=" + std::to_string(meshes.leafTriangles());
  const std::string results = "-DOTG_GROUP=" + std::to_string(tuning.recordGroup) + " -DOTG_CONTACTS=";
  prepare_ = context.makeKernel("batch_prepare.cl", walk, "batchPrepare");
  walk_ = context.makeKernel("batch_walk.cl", walk, "batchWalk");
  pairs_ = context.makeKernel("batch_results.cl", results + "0", "batchResults");
  if (reducer_.works()) contacts_ = context.makeKernel("batch_results.cl", results + "1", "batchResults");
  counters_ = context.makeBuffer(CL_MEM_READ_WRITE, OTG_COUNTERS * sizeof(otg_uint));
  fillZero(queue_.get(), counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
  hits_.reserve(context, tuning.hitPlaces);
}

std::span<otg_batch_task> BatchLane::stage(std::size_t count) {
  staged_.reserve(context_, queue_.get(), std::max<std::size_t>(1, count) * sizeof(otg_batch_task));
  count_ = static_cast<std::uint32_t>(count);
  if (!context_.info().doubles) frames_.assign(count, {});
  return {reinterpret_cast<otg_batch_task*>(staged_.data()), count};
}

std::span<otg_batch_pair> BatchLane::stageFrames() {
  return frames_;
}

BatchFound BatchLane::run(std::span<const CollisionMesh* const> meshes, std::span<const otg_reduction> reductions,
                          BatchWish wish) {
  std::vector<const CollisionMesh*> full;
  for (const CollisionMesh* mesh : meshes) {
    if (!mesh->tree().nodes.empty()) full.push_back(mesh);
  }
  const MeshStore::Pinned pinned = meshes_.acquire(full);
  try {
    return runOn(pinned, meshes, reductions, wish);
  } catch (...) {
    // Kernels may still be reading the meshes and this memory, both of which are gone in a moment.
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

void BatchLane::send(const MeshStore::Pinned& pinned, std::span<const CollisionMesh* const> meshes,
                     std::span<const otg_reduction> reductions) {
  const cl_command_queue queue = queue_.get();
  std::vector<otg_device_mesh> places;
  std::size_t next = 0;
  std::uint32_t depth = 0;
  for (const CollisionMesh* mesh : meshes) {
    places.push_back(mesh->tree().nodes.empty() ? otg_device_mesh{} : pinned[next++]);
    depth = std::max(depth, places.back().depth);
  }
  stackSize_ = stackSizeFor(tuning_, 2 * depth);
  // Meshes stay where they are from one batch to the next, as a rule.
  if (places.size() != sentPlaces_.size() ||
      std::memcmp(places.data(), sentPlaces_.data(), places.size() * sizeof(otg_device_mesh)) != 0) {
    sentPlaces_.clear();
    places_.reserve(context_, std::bit_ceil(places.size()));
    clDo(OTG_CL(clEnqueueWriteBuffer), queue, places_.get(), cl_bool{CL_TRUE}, std::size_t{0},
         places.size() * sizeof(otg_device_mesh), static_cast<const void*>(places.data()), cl_uint{0},
         static_cast<const cl_event*>(nullptr), static_cast<cl_event*>(nullptr));
    sentPlaces_ = std::move(places);
  }
  reducer_.send(queue, reductions);
  tasks_.reserve(context_, std::bit_ceil(count_));
  writeLater(queue, tasks_.get(), count_ * sizeof(otg_batch_task), staged_.data(), profile_.next(Profile::kWrite));
  pairList_.reserve(context_, std::bit_ceil(count_));
  if (!frames_.empty()) writeLater(queue, pairList_.get(), count_ * sizeof(otg_batch_pair), frames_.data());
  order_.reserve(context_, std::uint64_t{OTG_CLASSES} * std::bit_ceil(count_));
  reducer_.reserveStates(count_);
}

void BatchLane::enqueue(cl_mem meshes, BatchWish wish) {
  const cl_command_queue queue = queue_.get();
  const cl_mem counters = counters_.get();
  const otg_uint orderRoom = order_.places() / OTG_CLASSES, any = wish == BatchWish::kAny ? 1 : 0;
  // Of the precision of a pair all but delta is the same for all pairs.
  const otg_pair_error precision = floatFilterError(0);
  Arguments(prepare_) << count_ << tasks_.get() << places_.get() << reducer_.reductions() << pairList_.get()
                      << reducer_.states() << chosen_.get() << counters << order_.get() << orderRoom;
  launch(queue, prepare_, tuning_.batchGroup, (count_ + tuning_.batchGroup - 1) / tuning_.batchGroup, 1,
         profile_.next(Profile::kTop));
  if (tuning_.flushes & 1) clDo(OTG_CL(clFlush), queue);
  (Arguments(walk_) << pairList_.get() << places_.get() << precision << meshes << counters << order_.get() << orderRoom
                    << chosen_.get() << hits_.get() << hits_.places() << any << stackSize_)
      .local(stackSize_ * sizeof(cl_uint2));
  launch(queue, walk_, tuning_.batchGroup, count_, 1, profile_.next(Profile::kMain));
  if (tuning_.flushes & 2) clDo(OTG_CL(clFlush), queue);
  Kernel& last = contactRecords_ ? contacts_ : pairs_;
  Arguments arguments(last);
  arguments << pairList_.get() << places_.get() << tasks_.get() << meshes << counters << hits_.get() << hits_.places()
            << results_.get() << chosen_.get();
  if (contactRecords_) arguments << reducer_.links() << reducer_.tables() << reducer_.tableSize() << reducer_.states();
  launch(queue, last, tuning_.recordGroup, groups_, 1, profile_.next(Profile::kContacts));
  if (!contactRecords_) return;
  reducer_.enqueue(queue, meshes, counters, results_.get(), hits_.places(), count_, chosen_, groups_, profile_);
}

BatchFound BatchLane::runOn(const MeshStore::Pinned& pinned, std::span<const CollisionMesh* const> meshes,
                            std::span<const otg_reduction> reductions, BatchWish wish) {
  const cl_command_queue queue = queue_.get();
  contactRecords_ = wish == BatchWish::kContacts;
  otg_uint places = 1;
  for (const otg_reduction& how : reductions) places = std::max(places, how.places);
  send(pinned, meshes, reductions);
  const otg_uint* counters = nullptr;
  for (;; ++repeats_) {
    results_.reserve(context_, hits_.places());
    if (contactRecords_) reducer_.reserve(queue, count_, hits_.places(), places);
    chosen_.reserve(context_, std::bit_ceil(count_), contactRecords_ ? contactPlaces_ : 0);
    enqueue(pinned.buffer(), wish);
    counters = chosen_.readHead(context_, queue, count_, contactRecords_, &profile_);
    const otg_uint hits = counters[OTG_COUNT_HITS], contacts = counters[OTG_COUNT_REDUCED];
    if (hits <= hits_.places() && contacts <= contactPlaces_) break;
    if (hits > hits_.places()) hits_.reserve(context_, std::bit_ceil(std::uint64_t{hits}));
    if (contacts > contactPlaces_) contactPlaces_ = std::bit_ceil(contacts);
  }
  BatchFound found;
  if (contactRecords_) found.contacts = chosen_.readRest(context_, queue, counters[OTG_COUNT_REDUCED], &profile_);
  found.counters = chosen_.counters();  // only now: reading the rest may have moved the memory
  found.flags = chosen_.flags();
  found.first = chosen_.first();
  if (profile_.on()) profile_.collect();
  return found;
}

Answer BatchLane::records() {
  try {
    return results_.readAll(context_, queue_.get(), contactRecords_, chosen_.counters(), nullptr);
  } catch (...) {
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

}  // namespace otg::opencl
