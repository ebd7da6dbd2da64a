// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points on a device against the same points on the CPU, one by one: byte for byte.
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "dispatch/dispatcher.h"
#include "opencl/runtime/log.h"
#include "queries/surface_side.h"
#include "support/failing_calls.h"
#include "support/mesh_samples.h"
#include "support/opencl.h"

using namespace otg;
using namespace otg::test;

namespace {

/// All that is said of a point, as bits: NaN equals itself, and 0 is not -0.
struct Bits {
  std::uint64_t x, y, z, distance;
  std::uint32_t triangle, part;
  bool inside;
  bool operator==(const Bits&) const = default;
};

Bits bitsOf(const PointAnswer& a) {
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v); };
  return {bits(a.nearest.point.x),
          bits(a.nearest.point.y),
          bits(a.nearest.point.z),
          bits(a.nearest.distance),
          a.nearest.triangle,
          static_cast<std::uint32_t>(a.nearest.part),
          a.inside};
}

/// Answers of all points, and that each point was answered once.
std::vector<Bits> ask(const std::function<void(const PointSource&, const PointSink&)>& run,
                      const std::vector<Vec3d>& points) {
  std::vector<Bits> answers(points.size());
  std::vector<std::atomic<int>> times(points.size());
  run(
      [&](std::size_t begin, std::size_t end, Vec3d* to) {
        std::copy(points.begin() + static_cast<std::ptrdiff_t>(begin),
                  points.begin() + static_cast<std::ptrdiff_t>(end), to);
      },
      [&](std::size_t begin, std::size_t end, const Vec3d* same, const PointAnswer* some) {
        for (std::size_t i = begin; i < end; ++i) {
          answers[i] = bitsOf(some[i - begin]);
          times[i] += std::memcmp(&same[i - begin], &points[i], sizeof(Vec3d)) == 0 ? 1 : 100;
        }
      });
  std::size_t wrong = 0;
  for (const auto& t : times) wrong += t != 1 ? 1 : 0;
  CHECK(wrong == 0);
  return answers;
}

std::vector<Bits> onDevice(DeviceSlot& slot, ThreadPool& pool, const PointJob& job, const std::vector<Vec3d>& points) {
  return ask([&](const PointSource& source,
                 const PointSink& sink) { askOnDevice(slot, pool, job, points.size(), source, sink); },
             points);
}

std::vector<Bits> oneByOne(const PointJob& job, const std::vector<Vec3d>& points) {
  std::vector<Bits> answers;
  for (const Vec3d& p : points) answers.push_back(bitsOf(answerPoint(job, p)));
  return answers;
}

std::size_t differences(const std::vector<Bits>& x, const std::vector<Bits>& y) {
  REQUIRE(x.size() == y.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) count += x[i] == y[i] ? 0 : 1;
  return count;
}

/// Anywhere near, on corners, edges and faces, a hair beside them, around the middle, far, and beyond all measure.
std::vector<Vec3d> pointsFor(const TriMesh& mesh, std::uint32_t seed, std::size_t count) {
  Draw draw(seed);
  std::vector<Vec3d> points;
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  const Vec3d middle{0.5 * lo.x + 0.5 * hi.x, 0.5 * lo.y + 0.5 * hi.y, 0.5 * lo.z + 0.5 * hi.z};
  const double radius = std::max(double{mesh.radius()}, 1e-30);
  const auto corner = [&](std::uint32_t t, int k) {
    const Vec3f& v = mesh.vertices()[mesh.triangles()[t].v[k]];
    return Vec3d{v.x, v.y, v.z};
  };
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<std::uint32_t>(draw.uniform(0, static_cast<double>(mesh.triangleCount())));
    const Vec3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    const Vec3d anywhere = draw.inBox(1);
    const double u = draw.uniform(0, 1), v = draw.uniform(0, 1 - u);
    const Vec3d onFace = otgAdd(a, otgAdd(otgScale(otgSub(b, a), u), otgScale(otgSub(c, a), v)));
    const double hair = std::pow(10, draw.uniform(-17, 0)) * radius;
    switch (i % 8) {
      case 0:
        points.push_back(a);
        break;
      case 1:
        points.push_back(otgAdd(a, otgScale(otgSub(b, a), i % 16 < 8 ? 0.5 : u)));
        break;
      case 2:
        points.push_back(onFace);
        break;
      case 3:
        points.push_back(otgAdd(onFace, otgScale(anywhere, hair)));
        break;
      case 4:
        points.push_back(otgAdd(a, otgScale(anywhere, hair)));
        break;
      case 5:
        points.push_back(otgAdd(middle, otgScale(anywhere, 1e-3 * radius)));
        break;
      case 6:
        points.push_back(otgAdd(middle, otgScale(anywhere, radius * std::pow(10, draw.uniform(0, 12)))));
        break;
      default:
        points.push_back(otgAdd(middle, otgScale(anywhere, radius)));
    }
  }
  for (const double far : {1e30, 1e99, 1e101, 1e160, std::numeric_limits<double>::max()}) {
    points.push_back({far, -far, 0.3 * far});
    points.push_back({middle.x, -far, middle.z});
  }
  points.push_back({0, -0.0, 0});
  return points;
}

std::vector<samples::NamedMesh> meshesToAsk() {
  std::vector<samples::NamedMesh> meshes = samples::ordinaryMeshes();
  for (samples::NamedMesh& bad : samples::pathologicalMeshes()) meshes.push_back(std::move(bad));
  // Solids whose points are nearest to several triangles at once, and whose rays run along faces.
  meshes.push_back({"flat and fine", scenes::build(scenes::makeBox({1, 1, 0.25}, 16))});
  meshes.push_back({"block with a hole", scenes::build(scenes::makeBlockWithHole({2, 2, 1}, 0.505))});
  scenes::MeshArrays away = scenes::makeLump(1, 4, 0.3, 5);
  for (Vec3f& v : away.vertices) v = {v.x + 3e4f, v.y - 1e4f, v.z + 2e3f};
  meshes.push_back({"a solid far from its origin", scenes::build(away)});
  return meshes;
}

}  // namespace

TEST_CASE("points have the same answers on the device, byte for byte") {
  const auto slot = openSlot();
  ThreadPool pool(3);
  std::size_t solids = 0, sheets = 0, shells = 0, insides = 0, all = 0;
  for (const auto& [name, mesh] : meshesToAsk()) {
    if (mesh->triangleCount() == 0) continue;
    INFO(name);
    const auto tree = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kSah);
    const SurfaceKind kind = surfaceKind(*mesh);
    ++(kind == SurfaceKind::kSolid ? solids : kind == SurfaceKind::kSheet ? sheets : shells);
    // Meshes on which the tree is of no use take as long for a point as they have triangles.
    const std::vector<Vec3d> points = pointsFor(*mesh, 7, mesh->triangleCount() > 50000 ? 64 : 800);
    for (const auto& [nearest, inside] : {std::pair{true, true}, {true, false}, {false, true}}) {
      const PointJob job{tree.get(), nearest, inside, Place::kOpencl};
      if (!pointsOnDevice(job, *slot)) {
        CHECK(kind == SurfaceKind::kShell);
        continue;
      }
      const std::vector<Bits> device = onDevice(*slot, pool, job, points), host = oneByOne(job, points);
      INFO((nearest ? "nearest" : "") << (inside ? " inside" : ""));
      CHECK(differences(device, host) == 0);
      for (const Bits& bits : host) insides += bits.inside ? 1 : 0;
      all += points.size();
    }
  }
  CHECK(slot->failedCalls == 0);
  CHECK(slot->backend->counts().points == all);
  CHECK(slot->backend->counts().pointsOnHost == 0);
  CHECK(solids >= 8);
  CHECK(sheets >= 2);
  CHECK(shells >= 3);
  CHECK(insides > 2000);
}

TEST_CASE("the answer does not depend on the tree, the pieces or the number of threads") {
  const auto mesh = scenes::build(scenes::makeBox({1, 1, 0.25}, 16));
  const auto sah = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kSah);
  const auto other = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kMeanSplit);
  const std::vector<Vec3d> points = pointsFor(*mesh, 11, 3000);
  const PointJob job{sah.get(), true, true, Place::kOpencl};
  const std::vector<Bits> expected = oneByOne(job, points);
  PointJob byOther = job;
  byOther.mesh = other.get();
  CHECK(differences(oneByOne(byOther, points), expected) == 0);
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    CHECK(differences(ask([&](const PointSource& source,
                              const PointSink& sink) { askOnHost(pool, job, 0, points.size(), source, sink); },
                          points),
                      expected) == 0);
    for (const auto& [piece, least, leaf] :
         {std::tuple{1u << 18, 1u << 15, 2u}, {100u, 1u, 8u}, {1u, 1u, 1u}, {3010u, 1000u, 4u}}) {
      opencl::Tuning tuning;
      tuning.pointPiece = piece;
      tuning.leastPointPiece = least;
      tuning.leafTriangles = leaf;
      const auto slot = openSlot(tuning);
      const std::vector<Vec3d> some(points.begin(), points.begin() + (piece == 1 ? 200 : 3000));
      const std::vector<Bits> expectedSome(expected.begin(),
                                           expected.begin() + static_cast<std::ptrdiff_t>(some.size()));
      INFO(threads << " threads, pieces of " << piece);
      CHECK(differences(onDevice(*slot, pool, job, some), expectedSome) == 0);
      CHECK(differences(onDevice(*slot, pool, byOther, some), expectedSome) == 0);
      CHECK(slot->failedCalls == 0);
    }
  }
}

TEST_CASE("an array without points is answered") {
  const auto slot = openSlot();
  ThreadPool pool(2);
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 3));
  CHECK(onDevice(*slot, pool, {lump.get(), true, true, Place::kOpencl}, {}).empty());
  CHECK(slot->failedCalls == 0);
}

TEST_CASE("whichever call fails, the answers are the same") {
  const scenes::MeshArrays arrays = scenes::makeLump(1, 2, 0.2, 1);
  const auto lump = collisionMesh(arrays);
  const std::vector<Vec3d> points = pointsFor(lump->mesh(), 5, 400);
  const std::vector<Bits> expected = oneByOne({lump.get(), true, true, Place::kOpencl}, points);
  opencl::Tuning tuning;
  tuning.pointPiece = 150;  // three pieces
  ThreadPool pool(2);
  // With a mesh of its own each time, so that it is uploaded.
  const auto differ = [&](DeviceSlot& slot, int times) {
    const auto own = collisionMesh(arrays);
    std::size_t sum = 0;
    for (int i = 0; i < times; ++i) {
      sum += differences(onDevice(slot, pool, {own.get(), true, true, Place::kOpencl}, points), expected);
    }
    return sum;
  };
  const auto taken = [](const DeviceSlot& slot) { return slot.backend->counts().pointsOnHost; };
  const FailedCalls sums = checkFailingCalls(tuning, 30, differ, taken);
  CHECK(sums.onHost > 100 * 150);
  CHECK(sums.onHost < sums.failed * points.size());  // pieces that were answered before are not asked about again
}

TEST_CASE("several threads ask at once, about meshes that have to make room for each other") {
  opencl::Tuning tuning;
  tuning.memoryBudget = 2 << 20;
  tuning.pointPiece = 64;
  const auto slot = openSlot(tuning);
  ThreadPool pool(2);
  std::atomic<std::size_t> wrong{0};
  std::atomic<int> done{0};
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint32_t i = 0; i < 12; ++i) {
        const auto own = collisionMesh(scenes::makeLump(1, 3 + i % 2, 0.2, 10 + 7 * t + i % 3));
        const std::vector<Vec3d> points = pointsFor(own->mesh(), t * 100 + i, 200);
        const PointJob job{own.get(), true, i % 3 != 0, Place::kOpencl};
        std::vector<Bits> device(points.size());
        askOnDevice(
            *slot, pool, job, points.size(),
            [&](std::size_t begin, std::size_t end, Vec3d* to) {
              std::copy(points.data() + begin, points.data() + end, to);
            },
            [&](std::size_t begin, std::size_t end, const Vec3d*, const PointAnswer* answers) {
              for (std::size_t k = begin; k < end; ++k) device[k] = bitsOf(answers[k - begin]);
            });
        std::size_t different = 0;
        for (std::size_t k = 0; k < points.size(); ++k) {
          if (!(device[k] == bitsOf(answerPoint(job, points[k])))) ++different;
        }
        wrong += different;
        ++done;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(done == 48);
  CHECK(wrong == 0);
  CHECK(slot->backend->counts().meshUploads >= 12);
  CHECK(slot->backend->counts().meshBytes <= tuning.memoryBudget);
}

TEST_CASE("a mesh that does not fit leaves its points to the CPU") {
  opencl::Tuning tuning;
  tuning.memoryBudget = 100 << 10;
  const auto slot = openSlot(tuning);
  ThreadPool pool(2);
  opencl::forgetFailures();
  std::vector<std::string> lines;
  opencl::setLogSink([&](const std::string& line) { lines.push_back(line); });
  const auto lump = collisionMesh(scenes::makeLump(1, 4, 0.2, 1));
  const std::vector<Vec3d> points = pointsFor(lump->mesh(), 5, 100);
  const PointJob job{lump.get(), true, true, Place::kOpencl};
  for (int i = 0; i < DeviceSlot::kMostFailures; ++i) {
    CHECK(differences(onDevice(*slot, pool, job, points), oneByOne(job, points)) == 0);
  }
  opencl::setLogSink({});
  CHECK(slot->failedCalls == DeviceSlot::kMostFailures);
  CHECK(slot->isOff);
  CHECK(lines.size() == 2);  // why, once; and that the device is off
  CHECK(slot->backend->counts().pointsOnHost == DeviceSlot::kMostFailures * points.size());
}

TEST_CASE("auto takes the side that is expected to be done sooner, and a choice is a choice") {
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 1));
  const std::vector<Vec3d> points = pointsFor(lump->mesh(), 5, 1000);
  Dispatcher dispatcher;
  dispatcher.setThreadCount(2);
  const auto slot = openSlot();
  dispatcher.setDevices({slot});
  const auto run = [&](Place place, std::size_t count) {
    const std::uint64_t before = slot->backend->counts().points;
    const PointJob job{lump.get(), true, true, place};
    const std::vector<Vec3d> some(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count));
    CHECK(differences(ask([&](const PointSource& source,
                              const PointSink& sink) { dispatcher.askPoints(job, some.size(), source, sink); },
                          some),
                      oneByOne(job, some)) == 0);
    return slot->backend->counts().points - before;
  };
  CHECK(run(Place::kAuto, 1000) == 0);  // costs are not known
  CHECK(run(Place::kOpencl, 10) == 10);
  slot->costs.pointLaunch = {100, 0};  // as long as 100 points take on one thread
  slot->costs.hostNearest = {0.5, 0};
  slot->costs.hostInside = {0.5, 0};
  slot->costs.deviceNearest = slot->costs.deviceInside = {0.001, 0};
  slot->costs.pointFinish = 0.1;
  CHECK(run(Place::kAuto, 50) == 0);
  CHECK(run(Place::kAuto, 1000) == 1000);
  CHECK(run(Place::kCpu, 1000) == 0);
  // What the CPU makes of nearest triangles may cost more than it saves; sides alone need nothing of the kind.
  slot->costs.pointFinish = 2;
  CHECK(run(Place::kAuto, 1000) == 0);
  CHECK(arePointsSoonerOnDevice({lump.get(), false, true, Place::kAuto}, 1000, slot->costs, 2));
  slot->costs.pointFinish = 0.1;
  slot->costs.pointLaunch = {0, 1000};  // searches of trees as deep as this one's take too long
  CHECK(run(Place::kAuto, 1000) == 0);
  slot->isOff = true;
  CHECK(run(Place::kOpencl, 1000) == 0);
}
