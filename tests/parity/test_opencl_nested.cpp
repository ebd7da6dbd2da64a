// SPDX-License-Identifier: BSD-3-Clause
// Solids that share faces, on a device: contacts, overlap and distances are those of the CPU.
#include <memory>

#include "opencl/runtime/device_info.h"
#include "support/catch.h"
#include "support/flush_pairs.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr int kPoses = 12, kPlaces = 32;

/// Every pair in several poses, as geoms of its own.
class FlushGeoms {
 public:
  FlushGeoms() {
    std::mt19937 random(23);
    for (const FlushPair& pair : flushPairs()) {
      data_.push_back(std::make_unique<Data>(pair.first));
      data_.push_back(std::make_unique<Data>(pair.second));
      for (int i = 0; i < kPoses; ++i) {
        geoms_.push_back(std::make_unique<Geom>(*data_[data_.size() - 2]));
        geoms_.push_back(std::make_unique<Geom>(*data_.back()));
        const dGeomID first = geoms_[geoms_.size() - 2]->id, second = geoms_.back()->id;
        if (i > 0) setRandomPose(first, random, 2);  // else aligned exactly
        dGeomSetRotation(second, dGeomGetRotation(first));
        const dReal* const at = dGeomGetPosition(first);
        dGeomSetPosition(second, at[0], at[1], at[2]);
        pairs.push_back({first, second});
      }
    }
    for (const auto& geom : geoms_) {
      dGpuTriMeshParams params;
      dGpuTriMeshParamsInit(&params);
      params.history = dGPUTRIMESH_HISTORY_OFF;
      REQUIRE(dGeomGpuTriMeshSetParams(geom->id, &params) == dGPUTRIMESH_OK);
    }
  }
  std::vector<dGpuTriMeshPair> pairs;

 private:
  std::vector<std::unique_ptr<Data>> data_;
  std::vector<std::unique_ptr<Geom>> geoms_;
};

struct Answers {
  std::vector<std::vector<dContactGeom>> contacts;
  std::vector<unsigned char> overlaps;
  std::vector<double> distances;
};

Answers ask(const std::vector<dGpuTriMeshPair>& pairs) {
  const int count = static_cast<int>(pairs.size());
  Answers answers;
  std::vector<dContactGeom> found(pairs.size() * kPlaces);
  std::vector<int> counts(pairs.size());
  REQUIRE(dGpuTriMeshCollidePairs(pairs.data(), count, kPlaces, found.data(), sizeof(dContactGeom), counts.data()) > 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto begin = found.begin() + static_cast<std::ptrdiff_t>(i * kPlaces);
    answers.contacts.emplace_back(begin, begin + counts[i]);
  }
  answers.overlaps.assign(pairs.size(), 7);
  REQUIRE(dGpuTriMeshOverlaps(pairs.data(), count, answers.overlaps.data()) > 0);
  std::vector<dGpuTriMeshDistance> distances(pairs.size());
  REQUIRE(dGpuTriMeshGetDistances(pairs.data(), count, dInfinity, distances.data()) >= 0);
  for (const dGpuTriMeshDistance& d : distances) answers.distances.push_back(d.distance);
  return answers;
}

}  // namespace

TEST_CASE("answers about solids that share faces are the CPU's on a device") {
  const OdeSession session;
  const FlushGeoms all;
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
  const Answers expected = ask(all.pairs);
  const int index = opencl::defaultDevice(opencl::listDevices());
  REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  const Answers found = ask(all.pairs);
  int different = 0;
  for (std::size_t i = 0; i < all.pairs.size(); ++i)
    different += !sameContacts(found.contacts[i], expected.contacts[i]);
  CHECK(different == 0);
  CHECK(found.overlaps == expected.overlaps);
  CHECK(found.distances == expected.distances);
  dGpuTriMeshCloseDevices();
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
}
