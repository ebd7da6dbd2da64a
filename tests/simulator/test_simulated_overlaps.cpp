// SPDX-License-Identifier: BSD-3-Clause
// Large overlaps of solids that a simulated device describes, with work-groups as GPUs have them: the contacts are the
// host's.
#include "simulator/simulated_device.h"
#include "support/large_overlaps.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

/// As described pairs are on GPUs, but that small ones are, too.
opencl::Tuning describing() {
  opencl::Tuning tuning = simulated();
  tuning.overlapHits = 1;
  tuning.leastOverlaps = 1;
  tuning.solidLargeHits = 16;
  return tuning;
}

/// Whether the host describes a region of the overlap by cells.
bool isLarge(const Query& query) {
  const HostOverlap found(query);
  return std::any_of(found.regions.regions.begin(), found.regions.regions.end(),
                     [](const Region& region) { return region.cellEnd > region.cellBegin; });
}

struct Overlaps {
  MeshList meshes = {collisionMesh(makeBox({1, 1, 1}, 7)), collisionMesh(makeLump(0.8, 3, 0.2, 8))};
  std::vector<Query> queries;

  /// One region that is just large enough to be described by cells, and one that is not.
  Overlaps() {
    queries = {makeQuery(*meshes[0], *meshes[1], makePose({0.48, 0.6, 0.64}, 1, {0.2, 0.1, 0.7})),
               makeQuery(*meshes[1], *meshes[1], makePose({0, 0, 1}, 0.3, {0.1, 0.2, 1.4}))};
    for (Query& query : queries) {
      query.options.contacts = ContactModel::kSolid;
      query.options.maxContacts = 16;
    }
    REQUIRE(isLarge(queries[0]));
    REQUIRE(!isLarge(queries[1]));
  }
};

}  // namespace

TEST_CASE("the overlap of a single pair of solids is described as the host has it") {
  const Overlaps overlaps;
  const auto backend = openSimulated(describing());
  const std::vector<Query> one = {overlaps.queries[0]};
  CHECK(checkAll(*backend, one, answersOnHost(one)) == 1);
  CHECK(backend->counts().contactsMade >= 1);
}

TEST_CASE("overlaps of pairs in a batch are described as the host has them") {
  const Overlaps overlaps;
  const std::vector<Query>& queries = overlaps.queries;
  const auto backend = openSimulated(describing());
  opencl::BatchAnswer answer;
  CHECK(backend->collideBatch(queries, answer));
  CHECK(countWrong(answer, onHost(queries)) == 0);
  CHECK(backend->counts().described >= 1);  // the other one is small
  CHECK(backend->counts().contactsMade >= 1);
}
