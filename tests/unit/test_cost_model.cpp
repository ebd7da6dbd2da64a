// SPDX-License-Identifier: BSD-3-Clause
// What the cost model says, and how a batch is divided by it.
#include <cmath>
#include <numeric>

#include "dispatch/cost_model.h"
#include "dispatch/plan.h"
#include "dispatch/single_run.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/contact_samples.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

CostModel model(double host, double device, double launch = 0) {
  CostModel costs;
  costs.hostPairs = costs.hostPairwise = costs.hostSolid = {host, host / 100};
  costs.devicePairs = costs.devicePairwise = costs.batchPair = {device, device / 100};
  costs.batchLaunch = launch;
  costs.hostThreads = costs.hostSpeedup = 64;  // any number of threads up to that is so many times as quick
  return costs;
}

/// Predicted times of the blocks: the devices', then the CPU's.
std::vector<double> times(const Division& division, const std::vector<CostModel>& devices,
                          const std::vector<std::size_t>& ends) {
  std::vector<double> out;
  std::size_t begin = 0;
  const auto sum = [&](const Cost& cost, std::size_t from, std::size_t to) {
    double t = 0;
    for (std::size_t i = from; i < to; ++i) t += cost.of(division.work[i]);
    return t;
  };
  for (std::size_t d = 0; d < devices.size(); ++d) {
    const double all = sum(devices[d].batchPair, begin, ends[d]);
    out.push_back(ends[d] > begin ? devices[d].batchLaunch + all : 0);
    begin = ends[d];
  }
  out.push_back((division.hostBusy + sum(devices[0].hostPairwise, begin, division.work.size())) /
                devices[0].speedup(division.threads));
  return out;
}

}  // namespace

TEST_CASE("pairs of solids count by costs of their own") {
  CostModel costs = model(100, 1);
  costs.hostSolid = {100, 1};
  costs.batchSolid = {100, 1};
  std::vector<double> work(900, 0);
  std::vector<std::uint8_t> solid(900, 1);
  Division division;
  division.work = work;
  division.solid = solid;
  // As quick here as there.
  CHECK(divide(division, std::vector<CostModel>{costs})[0] == 450);
  // The first 600 cost the device next to nothing.
  std::fill(solid.begin(), solid.begin() + 600, std::uint8_t{0});
  const std::size_t end = divide(division, std::vector<CostModel>{costs})[0];
  CHECK(end > 740);
  CHECK(end < 750);
  // Not known: as others.
  costs.batchSolid = {};
  CHECK_FALSE(costs.knowsSolids());
  CHECK(divide(division, std::vector<CostModel>{costs})[0] > 880);
  // Either model has a launch.
  costs.batchSolid = {1, 0};
  costs.batchLaunch = 30;
  costs.solidLaunch = 50;
  CHECK(costs.launchCost(true, false) == 30);
  CHECK(costs.launchCost(false, true) == 50);
  CHECK(costs.launchCost(true, true) == 80);
  costs.batchSolid = {-1, 0};
  CHECK_FALSE(costs.isSane());
}

TEST_CASE("blocks of equal devices have equal cost") {
  Draw draw(1);
  std::vector<double> work(1000);
  for (double& w : work) w = draw.uniform(0, 1) < 0.1 ? draw.uniform(0, 20000) : draw.uniform(0, 200);
  for (std::size_t count = 1; count <= 4; ++count) {
    const std::vector<CostModel> devices(count, model(1000, 1));
    Division division;
    division.work = work;
    division.bound = work.size();
    const std::vector<std::size_t> ends = divide(division, devices);
    REQUIRE(ends.size() == count);
    CHECK(ends.back() == work.size());
    const std::vector<double> t = times(division, devices, ends);
    const double mean = std::accumulate(t.begin(), t.end(), 0.0) / static_cast<double>(count);
    for (std::size_t d = 0; d < count; ++d) CHECK(std::abs(t[d] - mean) < 250);  // no pair costs more than 201
    CHECK(ends == divide(division, devices));
  }
}

TEST_CASE("what is open goes where it is done first") {
  const std::vector<double> work(1000, 100);
  Division division;
  division.work = work;
  const auto ends = [&](const std::vector<CostModel>& devices) { return divide(division, devices); };
  CHECK(ends({model(1, 1)})[0] == 500);
  division.threads = 3;
  CHECK(ends({model(1, 1)})[0] == 250);
  division.threads = 1;
  CHECK(ends({model(1, 1, 1e9)})[0] == 0);    // a launch that takes longer than everything
  CHECK(ends({model(1, 1, 400)})[0] == 400);  // 400 + 2 n = 2 (1000 - n)
  CHECK(ends({model(1, 1000)})[0] <= 1);
  CHECK(ends({model(1000, 1)})[0] >= 998);
  division.hostBusy = 1e6;
  CHECK(ends({model(1, 1)})[0] == 1000);
  division.hostBusy = 0;
  division.bound = 800;  // these must go, however slow
  CHECK(ends({model(1, 1)})[0] == 800);
  CHECK(ends({model(1, 1000, 1e6)})[0] == 800);
  CHECK(ends({model(1, 1), model(1, 1)}) == std::vector<std::size_t>({400, 800}));
  division.bound = 0;
  CHECK(ends({model(1, 1), model(1, 2)}) == std::vector<std::size_t>({400, 600}));
  CHECK(ends({model(1, 1, 1e9), model(1, 1)}) == std::vector<std::size_t>({0, 500}));
  division.work = {};
  CHECK(ends({model(1, 1)}) == std::vector<std::size_t>({0}));
  CHECK(divide(division, {}).empty());
}

TEST_CASE("no device is left out where there are pairs for all") {
  Draw draw(4);
  for (std::size_t pairs = 1; pairs <= 40; ++pairs) {
    for (std::size_t count = 1; count <= 5; ++count) {
      for (const bool equal : {true, false}) {
        INFO(pairs << " pairs on " << count << " devices");
        std::vector<double> work(pairs);
        for (double& w : work) w = equal ? 100 : draw.uniform(50, 100);
        const std::vector<CostModel> devices(count, model(1e6, 1, 20));
        Division division;
        division.work = work;
        division.bound = pairs;
        const std::vector<std::size_t> ends = divide(division, devices);
        REQUIRE(ends.back() == pairs);
        std::size_t begin = 0, idle = 0;
        double longest = 0, all = 0, largest = 0;
        for (const double w : work) {
          all += devices[0].batchPair.of(w);
          largest = std::max(largest, devices[0].batchPair.of(w));
        }
        for (const std::size_t end : ends) {
          REQUIRE(end >= begin);
          idle += end == begin ? 1 : 0;
          double time = 0;
          for (std::size_t i = begin; i < end; ++i) time += devices[0].batchPair.of(work[i]);
          longest = std::max(longest, time);
          begin = end;
        }
        if (pairs >= count) CHECK(idle == 0);
        CHECK(longest <= all / static_cast<double>(count) + largest);
      }
    }
  }
}

TEST_CASE("threads that hinder each other count for less") {
  CostModel costs = model(1, 1);
  costs.hostThreads = 16;
  costs.hostSpeedup = 8.5;
  CHECK(costs.speedup(0) == 1);
  CHECK(costs.speedup(1) == 1);
  CHECK(costs.speedup(3) == Approx(2));
  CHECK(costs.speedup(16) == Approx(8.5));
  CHECK(costs.speedup(100) == Approx(8.5));
  const std::vector<double> work(1000, 100);
  Division division;
  division.work = work;
  division.threads = 3;
  CHECK(divide(division, std::vector<CostModel>{costs})[0] == 333);  // as two threads
  costs.hostThreads = 1;
  costs.hostSpeedup = 1;
  CHECK(costs.speedup(4) == 1);
}

TEST_CASE("a device takes over so much that both are done at the same time") {
  CHECK(shareToTake({}) == 0);
  CHECK(shareToTake({100, 100, 0}) == Approx(0.5));
  CHECK(shareToTake({300, 100, 0}) == Approx(0.75));
  CHECK(shareToTake({300, 100, 100}) == Approx(0.5));  // 100 + 50 = 150
  CHECK(shareToTake({100, 100, 100}) == 0);            // the launch alone takes as long
  CHECK(shareToTake({100, 10, 1000}) == 0);
  CHECK(shareToTake({100, 1e6, 0}) == 0);  // nothing worth while
  CHECK(shareToTake({100, 0, 0}) == 1);
  CHECK(shareToTake({NAN, 1, 0}) == 0);
  for (const double host : {10.0, 1e3, 1e5}) {
    for (const double device : {10.0, 1e3, 1e5}) {
      const double launch = 7, share = shareToTake({host, device, launch});
      CHECK(share >= 0);
      CHECK(share <= 1);
      if (share > 0) CHECK(launch + share * device == Approx((1 - share) * host));
    }
  }
}

TEST_CASE("a batch like the calibration's is divided by what the device does when it is busy") {
  // One H200 beside 32 threads: 1.9 us a pair against 16.7, and 300 us for a batch however small.
  CostModel costs;
  costs.hostPairs = costs.hostPairwise = costs.hostSolid = {380, 0};
  costs.devicePairs = costs.devicePairwise = {100, 0};
  costs.batchPair = {1.9, 0};
  costs.batchLaunch = 300;
  costs.hostThreads = 32;
  costs.hostSpeedup = 22.8;
  const std::vector<double> work(10000, 1000);
  Division division;
  division.work = work;
  division.threads = 32;
  const std::size_t end = divide(division, std::vector<CostModel>{costs})[0];
  CHECK(end > 8800);
  CHECK(end < 9100);
}

TEST_CASE("one pair of solids goes where it is expected to be done sooner") {
  const CollisionMesh solid(scenes::build(scenes::makeBox({1, 1, 1}, 2)), BuildStrategy::kSah);
  PairJob job;
  job.query.a = job.query.b = &solid;
  job.query.options.contacts = ContactModel::kSolid;
  CostModel costs = model(10, 100);
  costs.hostSolid = {100, 1};
  // As long as nothing is known of solids, the pairs of triangles tell.
  CHECK_FALSE(isSoonerOnDevice(job, costs, 1000));
  costs.deviceSolid = {500, 0.1};
  CHECK(costs.isSane());
  CHECK_FALSE(isSoonerOnDevice(job, costs, 100));
  CHECK(isSoonerOnDevice(job, costs, 1000));
  job.any = true;  // the host's contacts
  CHECK_FALSE(isSoonerOnDevice(job, costs, 1000));
  job.any = false;
  job.query.options.contacts = ContactModel::kPairwise;
  CHECK_FALSE(isSoonerOnDevice(job, costs, 1000));
  CHECK(costModelFrom(toBytes(costs)) == costs);
  costs.deviceSolid.fixed = -1;
  CHECK_FALSE(costs.isSane());
}

TEST_CASE("the line through measured times") {
  const auto close = [](const Cost& cost, double fixed, double slope) {
    CHECK(cost.fixed == Approx(fixed).margin(1e-9));
    CHECK(cost.perTriangle == Approx(slope).margin(1e-9));
  };
  close(fitCost({{0, 5}, {100, 25}, {1000, 205}}), 5, 0.2);
  close(fitCost({{10, 10}, {1000, 10}}), 10, 0);
  close(fitCost({{10, 20}, {1000, 10}}).perTriangle == 0 ? Cost{} : Cost{1, 1}, 0, 0);  // never a negative slope
  CHECK(fitCost({{10, 20}, {1000, 10}}).fixed > 10);
  CHECK(fitCost({{1, 0.1}, {10, 10}, {100, 100}}).fixed >= 0);
  close(fitCost({}), 0, 0);
  close(fitCost({{7, 3}}), 3, 0);
}

TEST_CASE("a model survives its bytes, and other bytes are none") {
  const CostModel costs = model(3, 4, 5);
  const std::vector<unsigned char> bytes = toBytes(costs);
  CHECK(costModelFrom(bytes) == costs);
  for (std::size_t i = 0; i < 8; ++i) {
    std::vector<unsigned char> bad = bytes;
    bad[i] ^= 1;
    CHECK(!costModelFrom(bad).has_value());
  }
  CHECK(!costModelFrom({}).has_value());
  CHECK(!costModelFrom({bytes.begin(), bytes.end() - 1}).has_value());
  for (const double x : {-1.0, double(NAN), double(INFINITY)}) {
    CostModel bad = costs;
    bad.hostPairs.perTriangle = x;
    CHECK(!costModelFrom(toBytes(bad)).has_value());
  }
  CostModel free = costs;
  free.batchPair = {};
  CHECK(!free.isSane());
  for (const double x : {0.0, 0.5, double(NAN)}) {
    CostModel bad = costs;
    bad.hostSpeedup = x;
    CHECK(!bad.isSane());
    bad = costs;
    bad.hostThreads = x;
    CHECK(!bad.isSane());
  }
}

TEST_CASE("the expected work grows with the overlap and with the number of triangles") {
  const auto mesh = [](int level) {
    return std::make_shared<CollisionMesh>(scenes::build(scenes::makeSphere(1, level)), BuildStrategy::kSah);
  };
  const auto coarse = mesh(2), fine = mesh(4);
  const auto work = [](const CollisionMesh& a, const CollisionMesh& b, double x) {
    Query query;
    query.a = &a;
    query.b = &b;
    query.bInA = makeMove({x, 0, 0});
    return expectedWork(query);
  };
  CHECK(work(*fine, *fine, 3) == 0);
  CHECK(work(*fine, *fine, 1.9) > 0);
  CHECK(work(*fine, *fine, 1.5) > work(*fine, *fine, 1.9));
  CHECK(work(*fine, *fine, 1.9) > 3 * work(*coarse, *coarse, 1.9));
  CHECK(work(*fine, *fine, 0) == Approx(2.0 * static_cast<double>(fine->mesh().triangleCount())));
  CHECK(work(*coarse, *fine, 1.7) == Approx(work(*fine, *coarse, -1.7)).epsilon(1e-6));
  CHECK(work(*fine, *fine, NAN) == 0);
}
