// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/phase_lane.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include "bvh/packed_tree.h"
#include "opencl/meshes/packed_motion.h"

namespace otg::opencl {
namespace {

constexpr std::size_t kGroup = 64;

/// Counters of one step of the middle phase.
struct StepCounters {
  otg_uint out, found, boxTestsLow, boxTestsHigh;
};

}  // namespace

std::shared_ptr<const SoupPlaces::Places> SoupPlaces::of(const CollisionMesh& mesh) {
  const std::weak_ptr<const void> alive = mesh.lifetime();
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = places_.find(alive); known != places_.end()) return known->second;
  }
  const PackedTree tree =
      mesh.withOwnBoxes([&](const BinaryTree& binary) { return makePackedTree(binary, leafTriangles_); });
  auto places = std::make_shared<Places>(tree.triangles.size());
  for (std::size_t i = 0; i < tree.triangles.size(); ++i) (*places)[tree.triangles[i]] = static_cast<std::uint32_t>(i);
  const std::lock_guard lock(mutex_);
  std::erase_if(places_, [](const auto& entry) { return entry.first.expired(); });
  return places_.emplace(alive, std::move(places)).first->second;
}

PhaseLane::PhaseLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      tuning_(tuning),
      queue_(context.makeQueue(false)) {
  const std::string options = "-DOTG_GROUP=" + std::to_string(kGroup) +
                              " -DOTG_CONTACTS=0 -DOTG_LEAF=" + std::to_string(meshes.leafTriangles());
  middle_.make(context, "published/single_phase.cl", options);
  near_.make(context, "published/single_phase.cl", options);
  counters_.reserve(context, sizeof(StepCounters) / sizeof(otg_step_counter));
}

template <class Run>
void PhaseLane::onMeshes(const Query& query, const PairFrame& frame, Run&& run) {
  const CollisionMesh* const both[] = {query.a, query.b};
  const MeshStore::Pinned pinned = meshes_.acquire(both);
  const otg_device_pair pair{deviceBoxes(frame), frame.floatError, pinned[0], pinned[1]};
  try {
    run(pair, pinned);
  } catch (...) {
    // Kernels may still be reading the meshes, which are not pinned any longer in a moment.
    clRelease(OTG_CL(clFinish), queue_.get());
    throw;
  }
}

void PhaseLane::findCandidates(const Query& query, const PairFrame& frame, std::vector<TrianglePair>& candidates,
                               std::uint64_t& boxTests) {
  candidates.clear();
  boxTests = 0;
  onMeshes(query, frame, [&](const otg_device_pair& pair, const MeshStore::Pinned& meshes) {
    walk(pair, meshes.units(), candidates, boxTests);
  });
}

void PhaseLane::walk(const otg_device_pair& pair, Meshes meshes, std::vector<TrianglePair>& candidates,
                     std::uint64_t& boxTests) {
  const cl_command_queue queue = queue_.get();
  in_.reserve(context_, tuning_.pairPlaces);
  out_.reserve(context_, tuning_.pairPlaces);
  found_.reserve(context_, tuning_.leafPlaces);
  fillZero(queue, in_.get(), sizeof(otg_node_pair));  // the roots
  for (std::uint32_t count = 1; count > 0;) {
    StepCounters counters{};
    for (;; ++repeats_) {
      fillZero(queue, counters_.get(), sizeof counters);
      middle_.give({.pair = pair,
                    .meshes = meshes,
                    .counters = counters_.buffer(),
                    .in = in_.buffer(),
                    .count = count,
                    .out = out_.buffer(),
                    .outCapacity = out_.places(),
                    .found = found_.buffer(),
                    .foundCapacity = found_.places()});
      launch(queue, middle_, kGroup, std::min<std::size_t>(groups_, (8 * std::size_t{count} + kGroup - 1) / kGroup));
      readBlocking(queue, counters_.get(), sizeof counters, &counters);
      if (counters.out <= out_.places() && counters.found <= found_.places()) break;
      out_.reserve(context_, std::bit_ceil(std::uint64_t{counters.out}));
      found_.reserve(context_, std::bit_ceil(std::uint64_t{counters.found}));
    }
    boxTests += std::uint64_t{counters.boxTestsHigh} << 32 | counters.boxTestsLow;
    if (counters.found > 0) {
      static_assert(sizeof(TrianglePair) == sizeof(otg_number_pair));
      const std::size_t before = candidates.size();
      candidates.resize(before + counters.found);
      readBlocking(queue, found_.get(), counters.found * sizeof(TrianglePair), candidates.data() + before);
    }
    count = counters.out;
    std::swap(in_, out_);
  }
}

std::span<const otg_pair_record> PhaseLane::decide(const Query& query, const PairFrame& frame, SoupPlaces& places,
                                                   std::span<const TrianglePair> candidates) {
  if (candidates.empty()) return {};
  onMeshes(query, frame, [&](const otg_device_pair& pair, const MeshStore::Pinned& meshes) {
    std::shared_ptr<const SoupPlaces::Places> made[2];
    const auto placesOf = [&](const CollisionMesh& mesh, std::size_t i) -> const SoupPlaces::Places& {
      if (const PackedPlaces* const packed = meshes.places(i)) return packed->soup();
      made[i] = places.of(mesh);
      return *made[i];
    };
    const SoupPlaces::Places &a = placesOf(*query.a, 0), &b = placesOf(*query.b, 1);
    pairs_.clear();
    pairs_.reserve(candidates.size());
    for (const TrianglePair& candidate : candidates) pairs_.push_back({a[candidate.a], b[candidate.b]});
    test(pair, query.bInA, meshes.units(), candidates.size());
  });
  return records_;
}

void PhaseLane::test(const otg_device_pair& pair, const Transformd& bInA, Meshes meshes, std::size_t count) {
  const cl_command_queue queue = queue_.get();
  asked_.reserve(context_, std::bit_ceil(std::uint64_t{count}));
  recordList_.reserve(context_, std::bit_ceil(std::uint64_t{count}));
  records_.resize(count);
  writeLater(queue, asked_.get(), count * sizeof(otg_place_pair), pairs_.data());
  near_.give({.pair = pair,
              .bInA = bInA,
              .meshes = meshes,
              .pairs = asked_.buffer(),
              .count = static_cast<otg_uint>(count),
              .records = recordList_.buffer()});
  launch(queue, near_, kGroup, std::min(groups_, (count + kGroup - 1) / kGroup));
  readBlocking(queue, recordList_.get(), count * sizeof(otg_pair_record), records_.data());
}

}  // namespace otg::opencl
