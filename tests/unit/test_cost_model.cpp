// SPDX-License-Identifier: BSD-3-Clause
// What the cost model says, and how a batch is divided by it.
#include <cmath>
#include <numeric>
#include <utility>

#include "dispatch/cost/calibration.h"
#include "dispatch/cost/calibration_mesh.h"
#include "dispatch/cost/cost_model.h"
#include "dispatch/cost/plan.h"
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

TEST_CASE("large overlaps of solids count by a line of their own") {
  CostModel costs = model(100, 1);
  costs.batchSolid = {1, 0};
  costs.batchLarge = {10, 0.001};
  costs.hostLarge = {1280, 0};
  costs.largeWork = 1000;
  CHECK(costs.isSane());
  CHECK(costs.deviceCost(true, 999) == 1);
  CHECK(costs.deviceCost(true, 2000) == 12);
  CHECK(costs.deviceCost(false, 2000) == costs.batchPair.of(2000));
  CHECK(costs.hostCost(true, 999) == costs.hostSolid.of(999));
  CHECK(costs.hostCost(true, 1000) == 1280);
  CHECK(costs.hostCost(false, 2000) == costs.hostPairwise.of(2000));
  CHECK(costModelFrom(toBytes(costs)) == costs);
  // 6,000 small pairs and 4,000 large ones, 12 times as dear: two devices get blocks of equal cost.
  std::vector<double> work(10000, 100);
  std::fill(work.begin() + 6000, work.end(), 2000);
  const std::vector<std::uint8_t> solid(work.size(), 1);
  Division division;
  division.work = work;
  division.solid = solid;
  division.bound = work.size();
  const std::vector<std::size_t> ends = divide(division, std::vector<CostModel>{costs, costs});
  CHECK(ends == std::vector<std::size_t>{7750, 10000});  // 6,000 + 21,000, and 27,000
  // Where a device of another kind does not know them, they are as the others to it.
  CostModel other = costs;
  other.largeWork = 0;
  const std::vector<std::size_t> unlike = divide(division, std::vector<CostModel>{costs, other});
  CHECK(unlike.back() == work.size());
  CHECK(unlike[0] == 5000);
  // A part of the open ones for the CPU, at 20 us each of its 64 threads.
  division.bound = 0;
  division.threads = 64;
  const std::size_t end = divide(division, std::vector<CostModel>{costs})[0];
  CHECK(end > 8300);  // 6,000 + 12 x = 20 (4,000 - x)
  CHECK(end < 8320);
  for (Cost* const cost : {&costs.batchLarge, &costs.hostLarge}) {
    CHECK(costs.isSane());
    const Cost kept = std::exchange(*cost, {});
    CHECK_FALSE(costs.isSane());
    *cost = kept;
  }
  costs.largeWork = NAN;
  CHECK_FALSE(costs.isSane());
}

TEST_CASE("large overlaps of solids are not divided between devices and the CPU") {
  CostModel costs = model(100, 1);
  costs.batchSolid = {1, 0};
  costs.batchLarge = {10, 0};
  costs.hostLarge = {100, 0};
  costs.largeWork = 1000;
  costs.solidLaunch = 500;
  costs.hostThreads = 16;
  costs.hostSpeedup = 16;
  const std::vector<double> many(1000, 2000), few(10, 2000);
  CHECK_FALSE(largeOnDevices({}, std::vector<CostModel>{costs}, 1));
  CHECK_FALSE(largeOnDevices(many, {}, 1));
  // 10,500 us there; by one thread 100,000, by eight 12,500, by sixteen 6,250.
  CHECK(largeOnDevices(many, std::vector<CostModel>{costs}, 1));
  CHECK(largeOnDevices(many, std::vector<CostModel>{costs}, 8));
  CHECK_FALSE(largeOnDevices(many, std::vector<CostModel>{costs}, 16));
  // Two devices have half each, and one of them alone may be so slow that it is no help.
  CHECK(largeOnDevices(many, std::vector<CostModel>{costs, costs}, 16));
  CostModel slow = costs;
  slow.batchLarge = {1000, 0};
  CHECK_FALSE(largeOnDevices(many, std::vector<CostModel>{costs, slow}, 16));
  // A launch is not worth while for a few.
  CHECK(largeOnDevices(few, std::vector<CostModel>{costs}, 1));
  CHECK_FALSE(largeOnDevices(few, std::vector<CostModel>{costs}, 2));
}

TEST_CASE("two lines through the measured times of pairs of solids") {
  CostModel costs = model(1, 1);
  std::vector<std::pair<double, double>> host = {{100, 20}, {400, 80}, {1000, 300}, {5000, 700}};
  const auto fit = [&](const std::vector<SolidTime>& measured) { fitSolids(measured, host, costs); };
  fit({{2500, 30, true}, {100, 2, false}, {400, 5, false}, {1600, 21, true}});
  CHECK(costs.batchSolid.of(200) == Approx(3));
  CHECK(costs.batchLarge.of(3400) == Approx(39));
  CHECK(costs.largeWork == Approx(800));
  CHECK(costs.hostSolid.of(200) == Approx(40));
  CHECK(costs.hostLarge.of(3000) == Approx(500));
  // None described, or all of them.
  fit({{100, 2, false}, {400, 5, false}});
  CHECK(costs.batchSolid.of(200) == Approx(3));
  CHECK(costs.largeWork == 0);
  CHECK(costs.batchLarge == Cost{});
  CHECK(costs.hostLarge == Cost{});
  CHECK(costs.hostSolid == fitCost(host));
  fit({{100, 2, true}, {400, 5, true}});
  CHECK(costs.batchSolid.of(200) == Approx(3));
  CHECK(costs.largeWork == 0);
  // Some on the wrong side, two with the same work.
  fit({{100, 1, false},
       {300, 1, true},
       {400, 1, false},
       {450, 1, false},
       {900, 9, true},
       {900, 9, true},
       {999, 9, false}});
  CHECK(costs.largeWork == Approx(std::sqrt(450.0 * 900)));
  CHECK(costs.batchSolid.of(450) == Approx(1));
  CHECK(costs.batchLarge.of(900) == Approx(9));
  fit({{0, 1, false}, {40000, 2, true}});
  CHECK(costs.largeWork == Approx(200));
  fit({});
  CHECK(costs.largeWork == 0);
  CHECK_FALSE(costs.knowsSolids());
  CHECK(costs.hostSolid == fitCost(host));
  // The CPU has been timed with large ones only.
  host = {{1000, 300}, {5000, 700}};
  fit({{100, 2, false}, {400, 5, false}, {1600, 17, true}});
  CHECK(costs.largeWork == 0);
  CHECK(costs.batchSolid.of(1000) == Approx(11));
  CHECK(costs.hostSolid.of(3000) == Approx(500));
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

TEST_CASE("the bodies that are timed are solids") {
  for (const int steps : {2, 6, 18, 36, 50}) {
    for (const double phase : {0.0, 1.0}) {
      const auto body = calibrationBody(steps, phase);
      CHECK(body->mesh().meshClass() == MeshClass::kSolid);
      CHECK(body->mesh().triangleCount() == static_cast<std::size_t>(8 * steps * steps - 4 * steps));
      // Else devices leave it to the CPU.
      const auto isNegativeZero = [](float x) { return x == 0 && std::signbit(x); };
      for (const Vec3f& v : body->mesh().vertices()) {
        CHECK_FALSE((isNegativeZero(v.x) || isNegativeZero(v.y) || isNegativeZero(v.z)));
      }
    }
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
  // Balls that hardly touch across the corners of their boxes, or not at all.
  Query query;
  query.a = query.b = fine.get();
  const auto across = [&](double distance) {
    query.bInA = makeMove({distance / std::sqrt(3.0), distance / std::sqrt(3.0), distance / std::sqrt(3.0)});
    return expectedWork(query);
  };
  CHECK(across(2.01) == 0);
  CHECK(across(1.95) > 0);
  CHECK(across(1.95) < 0.2 * work(*fine, *fine, 0));
  CHECK(across(1.0) > 3 * across(1.95));
  // A small one within a large one: all of it, and as much of the other as its box says at most.
  const CollisionMesh large(scenes::build(scenes::makeSphere(10, 4)), BuildStrategy::kSah);
  const double triangles = static_cast<double>(coarse->mesh().triangleCount());
  CHECK(work(large, *coarse, 2) >= triangles);
  CHECK(work(large, *coarse, 2) < 1.1 * triangles + 0.02 * static_cast<double>(large.mesh().triangleCount()));
  CHECK(work(*coarse, large, -2) == Approx(work(large, *coarse, 2)).epsilon(1e-6));
}
