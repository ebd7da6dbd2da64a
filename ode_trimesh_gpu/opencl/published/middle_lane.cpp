// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/middle_lane.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

namespace otg::opencl {
namespace {

constexpr std::size_t kGroup = 64;

/// Counters of one step of the middle phase.
struct StepCounters {
  otg_uint out, found, boxTestsLow, boxTestsHigh;
};

}  // namespace

MiddleLane::MiddleLane(Context& context, MeshStore& meshes, const Tuning& tuning)
    : context_(context),
      meshes_(meshes),
      groups_(std::max<std::size_t>(1, std::size_t{context.info().computeUnits} * tuning.groupsPerUnit)),
      tuning_(tuning),
      queue_(context.makeQueue(false)) {
  const std::string options =
      "-DOTG_GROUP=" + std::to_string(kGroup) + " -DOTG_LEAF=" + std::to_string(meshes.leafTriangles());
  middle_.make(context, "published/middle_phase.cl", options);
  counters_.reserve(context, sizeof(StepCounters) / sizeof(otg_step_counter));
}

template <class Run>
void MiddleLane::onMeshes(const Query& query, const PairFrame& frame, Run&& run) {
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

bool MiddleLane::findCandidates(const Query& query, const PairFrame& frame, std::vector<TrianglePair>& candidates,
                                std::uint64_t& boxTests) {
  candidates.clear();
  boxTests = 0;
  bool isWhole = true;
  onMeshes(query, frame, [&](const otg_device_pair& pair, const MeshStore::Pinned& meshes) {
    isWhole = walk(pair, meshes.units(), static_cast<std::size_t>(query.options.middle.maxPairs), candidates, boxTests);
  });
  return isWhole;
}

bool MiddleLane::walk(const otg_device_pair& pair, Meshes meshes, std::size_t most,
                      std::vector<TrianglePair>& candidates, std::uint64_t& boxTests) {
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
      if (before + counters.found > most) return false;
      candidates.resize(before + counters.found);
      readBlocking(queue, found_.get(), counters.found * sizeof(TrianglePair), candidates.data() + before);
    }
    count = counters.out;
    std::swap(in_, out_);
  }
  return true;
}

}  // namespace otg::opencl
