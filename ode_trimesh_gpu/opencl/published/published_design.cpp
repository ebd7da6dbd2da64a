// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/published/published_design.h"

namespace otg::opencl {
namespace {

constexpr std::uint32_t kTrianglesOfLeaf = 1;

Tuning withProfile(Tuning tuning) {
  tuning.profile = true;
  return tuning;
}

}  // namespace

PublishedDesign::Levels::Levels(Context& context, const std::shared_ptr<MemoryBudget>& budget, const Tuning& tuning)
    : meshes(context, budget, kTrianglesOfLeaf, MeshLayout::kBinary),
      lanes(context, meshes, tuning),
      profiled(context, meshes, withProfile(tuning)) {}

PublishedDesign::Near::Near(Context& context, MeshStore& meshes, const Tuning& tuning)
    : lanes(context, meshes, tuning), profiled(context, meshes, withProfile(tuning)) {}

PublishedDesign::PublishedDesign(Context& context, MeshStore& meshes, const Tuning& tuning, Counters counters)
    : context_(context),
      meshes_(meshes),
      tuning_(tuning),
      counters_(counters),
      middle_(context, meshes, tuning),
      near_(context, meshes, tuning) {}

PublishedDesign::Levels& PublishedDesign::levels() {
  const std::lock_guard lock(mutex_);
  if (!levels_) levels_ = std::make_unique<Levels>(context_, meshes_.budget(), tuning_);
  return *levels_;
}

const PublishedDesign::Levels* PublishedDesign::levelsIfMade() const {
  const std::lock_guard lock(mutex_);
  return levels_.get();
}

std::uint64_t PublishedDesign::repeats() const {
  const Levels* const made = levelsIfMade();
  return middle_.repeats() + near_.lanes.repeats() + near_.profiled.repeats() +
         (made ? made->lanes.repeats() + made->profiled.repeats() : 0);
}

MeshStore::Counts PublishedDesign::meshCounts() const {
  const Levels* const made = levelsIfMade();
  return made ? made->meshes.counts() : MeshStore::Counts{};
}

}  // namespace otg::opencl
