// SPDX-License-Identifier: BSD-3-Clause
// Poses out of raw bytes, through every traversal: they find the same pairs, or refuse the pose together.
#include <stdexcept>

#include "collide/query.h"
#include "fuzz/fuzz_target.h"
#include "scenes/generated_meshes.h"

using namespace otg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const CollisionMesh lump(scenes::build(scenes::makeLump(1, 1, 0.2, 3)), BuildStrategy::kSah);
  static const CollisionMesh box(scenes::build(scenes::makeBox({1, 1, 1}, 2)), BuildStrategy::kMeanSplit);
  fuzz::Taker taker(data, size);
  Query query;
  query.a = &lump;
  query.b = &box;
  for (double& r : query.bInA.r) r = taker.number<double>();
  query.bInA.t = {taker.number<double>(), taker.number<double>(), taker.number<double>()};
  bool first = true, refused = false;
  std::vector<TrianglePair> pairs;
  for (const Traversal traversal :
       {Traversal::kStandard, Traversal::kQuantized, Traversal::kNoLeaf, Traversal::kWide}) {
    query.options.middle.traversal = traversal;
    query.options.contacts = taker.byte() % 2 == 0 ? ContactModel::kSolid : ContactModel::kPairwise;
    Workspace workspace;
    bool no = false;
    try {
      collide(query, workspace);
    } catch (const std::invalid_argument&) {
      no = true;
    }
    if (first) {
      refused = no;
      pairs = workspace.intersecting;
    }
    fuzz::require(no == refused && (no || workspace.intersecting == pairs));
    first = false;
  }
  return 0;
}

std::vector<fuzz::Input> fuzz::seeds() {
  std::vector<Input> all;
  for (const double reach : {0.0, 0.9, 1e3, 1e-200, 1e200}) {
    const double numbers[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, reach, reach / 2, -reach / 3};
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(numbers);
    all.emplace_back(bytes, bytes + sizeof numbers);
  }
  return all;
}
