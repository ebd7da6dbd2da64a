// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/batch_lane.h"

#include <algorithm>
#include <bit>
#include <string>
#include <unordered_map>

namespace otg::opencl {
namespace {

constexpr std::size_t kResultGroup = 64;

}  // namespace

/// What goes to the device for one batch.
struct BatchLane::Upload {
  std::vector<otg_batch_pair> pairs;
  std::vector<Transformd> poses;
  std::vector<otg_device_mesh> places;
  otg_pair_error precision{};
  std::uint32_t depths = 0;  ///< of the two deepest trees that meet
};

BatchLane::BatchLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      tuning_(tuning),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      queue_(context.makeQueue(false)),
      results_(tuning.recordsExpected) {
  const std::string walk =
      "-DOTG_GROUP=" + std::to_string(tuning.batchGroup) + " -DOTG_LEAF=" + std::to_string(meshes.leafTriangles());
  const std::string results = "-DOTG_GROUP=" + std::to_string(kResultGroup) + " -DOTG_CONTACTS=";
  walk_ = context.makeKernel("batch_walk.cl", walk, "batchWalk");
  pairs_ = context.makeKernel("batch_results.cl", results + "0", "batchResults");
  if (context.info().doubles) contacts_ = context.makeKernel("batch_results.cl", results + "1", "batchResults");
  counters_ = context.makeBuffer(CL_MEM_READ_WRITE, OTG_COUNTERS * sizeof(otg_uint));
  fillZero(queue_.get(), counters_.get(), OTG_COUNTERS * sizeof(otg_uint));
  hits_.reserve(context, tuning.hitPlaces);
}

Answer BatchLane::run(std::span<const Query* const> queries, std::span<const PairFrame> frames, bool contacts,
                      bool anyHit) {
  Upload upload;
  std::vector<const CollisionMesh*> meshes;
  std::unordered_map<const CollisionMesh*, std::uint32_t> numberOf;
  const auto number = [&](const CollisionMesh* mesh) {
    const auto [entry, isNew] = numberOf.emplace(mesh, static_cast<std::uint32_t>(meshes.size()));
    if (isNew) meshes.push_back(mesh);
    return entry->second;
  };
  upload.precision = frames[0].floatError;  // all but delta is the same for all pairs
  upload.pairs.reserve(queries.size());
  upload.poses.reserve(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const BoxFrame<float> boxes = deviceBoxes(frames[i]);
    otg_batch_pair pair{};
    std::copy(std::begin(boxes.r), std::end(boxes.r), pair.r);
    pair.t = boxes.t;
    pair.eps = boxes.eps;
    pair.delta = frames[i].floatError.delta;
    pair.meshA = number(queries[i]->a);
    pair.meshB = number(queries[i]->b);
    upload.pairs.push_back(pair);
    upload.poses.push_back(queries[i]->bInA);
  }
  const MeshStore::Pinned pinned = meshes_.acquire(meshes);
  for (std::size_t i = 0; i < meshes.size(); ++i) upload.places.push_back(pinned[i]);
  for (const otg_batch_pair& pair : upload.pairs) {
    upload.depths = std::max(upload.depths, upload.places[pair.meshA].depth + upload.places[pair.meshB].depth);
  }
  try {
    return runOn(upload, pinned.buffer(), contacts && contacts_, anyHit);
  } catch (...) {
    // Kernels may still be reading the meshes and this memory, both of which are gone in a moment.
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

Answer BatchLane::runOn(const Upload& upload, cl_mem meshes, bool contacts, bool anyHit) {
  const cl_command_queue queue = queue_.get();
  const auto send = [&](DeviceList& list, const auto& items) {
    list.reserve(context_, std::bit_ceil(items.size()));
    writeLater(queue, list.get(), items.size() * sizeof items[0], items.data());
  };
  send(pairList_, upload.pairs);
  send(places_, upload.places);
  if (context_.info().doubles) {
    send(poses_, upload.poses);
  } else {
    poses_.reserve(context_, 1);
  }
  const otg_uint any = anyHit ? 1 : 0, stackSize = stackSizeFor(tuning_, upload.depths);
  const cl_kernel last = contacts ? contacts_.get() : pairs_.get();
  for (;; ++repeats_) {
    results_.reserve(context_, hits_.places());
    (Arguments(walk_.get()) << pairList_.get() << places_.get() << upload.precision << meshes << counters_.get()
                            << hits_.get() << hits_.places() << any << stackSize)
        .local(stackSize * sizeof(cl_uint2));
    launch(queue, walk_.get(), tuning_.batchGroup, upload.pairs.size());
    Arguments(last) << pairList_.get() << places_.get() << poses_.get() << meshes << counters_.get() << hits_.get()
                    << hits_.places() << results_.get();
    launch(queue, last, kResultGroup, groups_);
    const otg_uint found = results_.readHead(context_, queue, contacts)[OTG_COUNT_HITS];
    if (found <= hits_.places()) break;
    hits_.reserve(context_, std::bit_ceil(std::uint64_t{found}));
  }
  return results_.readRest(context_, queue, contacts);
}

}  // namespace otg::opencl
