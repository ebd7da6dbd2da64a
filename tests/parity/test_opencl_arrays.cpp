// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points and of rays on a device against the same ones on the CPU, one by one, and rays against every
// triangle: byte for byte. What both promise is tested once, for either.
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>
#include <type_traits>

#include "dispatch/dispatcher.h"
#include "opencl/runtime/log.h"
#include "queries/surface_side.h"
#include "support/failing_calls.h"
#include "support/mesh_samples.h"
#include "support/opencl.h"
#include "support/ray_samples.h"

using namespace otg;
using namespace otg::test;
using samples::raysFor;

namespace {

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
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

/// What tests of arrays need to know of points.
struct Points {
  using Job = PointJob;
  /// All that is said of a point, as bits: NaN equals itself, and 0 is not -0.
  struct Bits {
    std::uint64_t x, y, z, distance;
    std::uint32_t triangle, part;
    bool inside;
    bool operator==(const Bits&) const = default;
  };
  static Bits bitsOf(const PointAnswer& a) {
    return {bits(a.nearest.point.x),
            bits(a.nearest.point.y),
            bits(a.nearest.point.z),
            bits(a.nearest.distance),
            a.nearest.triangle,
            static_cast<std::uint32_t>(a.nearest.part),
            a.inside};
  }
  static Job job(const CollisionMesh& mesh, Place place = Place::kOpencl) { return {&mesh, true, true, place}; }
  /// One of several questions.
  static Job job(const CollisionMesh& mesh, std::uint32_t number) {
    return {&mesh, true, number % 3 != 0, Place::kOpencl};
  }
  static std::vector<Vec3d> items(const TriMesh& mesh, std::uint32_t seed, std::size_t count) {
    return pointsFor(mesh, seed, count);
  }
  static std::uint64_t asked(const opencl::BackendCounts& counts) { return counts.points; }
  static std::uint64_t onHost(const opencl::BackendCounts& counts) { return counts.pointsOnHost; }
  static void run(Dispatcher& dispatcher, const Job& job, std::size_t count, const PointSource& source,
                  const PointSink& sink) {
    dispatcher.askPoints(job, count, source, sink);
  }
  /// An item takes a microsecond on one thread, and next to nothing on the device.
  static void setCosts(CostModel& costs) {
    costs.hostNearest = {0.5, 0};
    costs.hostInside = {0.5, 0};
    costs.deviceNearest = costs.deviceInside = {0.001, 0};
  }
  static Cost& launch(CostModel& costs) { return costs.pointLaunch; }
  static double& finish(CostModel& costs) { return costs.pointFinish; }
};

/// What they need to know of rays.
struct Rays {
  using Job = RayJob;
  /// All that is said of a ray, as bits: 0 is not -0.
  struct Bits {
    std::uint64_t distance;
    std::uint32_t triangle;
    bool back;
    bool operator==(const Bits&) const = default;
  };
  static Bits bitsOf(const RayHit& hit) { return {bits(hit.distance), hit.triangle, hit.back}; }
  static Job job(const CollisionMesh& mesh, Place place = Place::kOpencl) { return {&mesh, false, place}; }
  static Job job(const CollisionMesh& mesh, std::uint32_t number) { return {&mesh, number % 3 != 0, Place::kOpencl}; }
  static std::vector<LongRay> items(const TriMesh& mesh, std::uint32_t seed, std::size_t count) {
    return raysFor(mesh, seed, count);
  }
  static std::uint64_t asked(const opencl::BackendCounts& counts) { return counts.rays; }
  static std::uint64_t onHost(const opencl::BackendCounts& counts) { return counts.raysOnHost; }
  static void run(Dispatcher& dispatcher, const Job& job, std::size_t count, const RaySource& source,
                  const RaySink& sink) {
    dispatcher.castRays(job, count, source, sink);
  }
  static void setCosts(CostModel& costs) {
    costs.hostRay = {1, 0};
    costs.deviceRay = {0.001, 0};
  }
  static Cost& launch(CostModel& costs) { return costs.rayLaunch; }
  static double& finish(CostModel& costs) { return costs.rayFinish; }
};

template <class Kind>
using Items = std::vector<typename Kind::Job::Item>;
template <class Kind>
using AllBits = std::vector<typename Kind::Bits>;

/// Answers of all items, and that each was answered once.
template <class Kind, class Run>
AllBits<Kind> answers(const Items<Kind>& items, const Run& run) {
  using Item = typename Kind::Job::Item;
  AllBits<Kind> found(items.size());
  std::vector<std::atomic<int>> times(items.size());
  const ArraySource<typename Kind::Job> source = [&](std::size_t begin, std::size_t end, Item* to) {
    std::copy(items.data() + begin, items.data() + end, to);
  };
  const ArraySink<typename Kind::Job> sink = [&](std::size_t begin, std::size_t end, const Item* same,
                                                 const typename Kind::Job::Answer* some) {
    for (std::size_t i = begin; i < end; ++i) {
      found[i] = Kind::bitsOf(some[i - begin]);
      times[i] += std::memcmp(&same[i - begin], &items[i], sizeof(Item)) == 0 ? 1 : 100;
    }
  };
  run(source, sink);
  std::size_t wrong = 0;
  for (const auto& t : times) wrong += t != 1 ? 1 : 0;
  REQUIRE(wrong == 0);
  return found;
}

template <class Kind>
AllBits<Kind> onDevice(DeviceSlot& slot, ThreadPool& pool, const typename Kind::Job& job, const Items<Kind>& items) {
  return answers<Kind>(items, [&](const auto& source, const auto& sink) {
    answerOnDevice(slot, pool, job, items.size(), source, sink);
  });
}

template <class Kind>
AllBits<Kind> oneByOne(const typename Kind::Job& job, const Items<Kind>& items) {
  AllBits<Kind> found;
  for (const auto& item : items) found.push_back(Kind::bitsOf(answerOne(job, item)));
  return found;
}

template <class Bits>
std::size_t differences(const std::vector<Bits>& x, const std::vector<Bits>& y) {
  REQUIRE(x.size() == y.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < x.size(); ++i) count += x[i] == y[i] ? 0 : 1;
  return count;
}

/// Without a tree.
Rays::Bits throughAll(const RayJob& job, const LongRay& ray) {
  const TriMesh& mesh = job.mesh->mesh();
  const TriangleRay alone(mesh, ray.ray);
  RayHit best;
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    RayHit hit;
    if (mesh.isDegenerate(t) || !alone.hits(t, hit) || hit.distance > ray.length || (job.cullBack && hit.back))
      continue;
    if (best.triangle == kNone || hit.distance < best.distance) best = hit;
  }
  return Rays::bitsOf(best);
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
      if (!canAnswer(*slot, job)) {
        CHECK(kind == SurfaceKind::kShell);
        continue;
      }
      const auto device = onDevice<Points>(*slot, pool, job, points), host = oneByOne<Points>(job, points);
      INFO((nearest ? "nearest" : "") << (inside ? " inside" : ""));
      CHECK(differences(device, host) == 0);
      for (const Points::Bits& bits : host) insides += bits.inside ? 1 : 0;
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

TEST_CASE("rays have the same hits on the device, byte for byte") {
  const auto slot = openSlot();
  ThreadPool pool(3);
  std::size_t hits = 0, backs = 0, tried = 0, all = 0, hitsCulled = 0;
  for (const auto& [name, mesh] : samples::meshesToHit()) {
    if (mesh->triangleCount() == 0) continue;
    INFO(name);
    const auto tree = std::make_shared<CollisionMesh>(mesh, BuildStrategy::kSah);
    if (tree->tree().nodes.empty()) continue;
    // Meshes on which the tree is of no use take as long for a ray as they have triangles.
    const std::vector<LongRay> rays = raysFor(*mesh, 7, mesh->triangleCount() > 50000 ? 64 : 1600);
    for (const bool cullBack : {false, true}) {
      const RayJob job{tree.get(), cullBack, Place::kOpencl};
      REQUIRE(canAnswer(*slot, job));
      const auto device = onDevice<Rays>(*slot, pool, job, rays), host = oneByOne<Rays>(job, rays);
      INFO((cullBack ? "culled" : "all"));
      CHECK(differences(device, host) == 0);
      const std::size_t some = 200000 / mesh->triangleCount() + 2;  // tried against every triangle
      for (std::size_t i = 0; i < rays.size(); i += 1 + rays.size() / some, ++tried) {
        CHECK((device[i] == throughAll(job, rays[i])));
      }
      for (const Rays::Bits& bits : host) {
        (cullBack ? hitsCulled : hits) += bits.triangle != kNone ? 1 : 0;
        backs += bits.back ? 1 : 0;
        if (cullBack) CHECK_FALSE(bits.back);
      }
      all += rays.size();
    }
  }
  CHECK(slot->failedCalls == 0);
  CHECK(slot->backend->counts().rays == all);
  CHECK(slot->backend->counts().raysOnHost == 0);
  CHECK(hits > 5000);
  CHECK(backs > 1000);
  CHECK(hitsCulled > 3000);
  CHECK(tried > 2000);
}

TEMPLATE_TEST_CASE("the answer does not depend on the tree, the pieces or the number of threads", "", Points, Rays) {
  const auto mesh = scenes::build(scenes::makeBox({1, 1, 0.25}, 16));
  const CollisionMesh sah(mesh, BuildStrategy::kSah), other(mesh, BuildStrategy::kMeanSplit);
  const auto items = TestType::items(*mesh, 11, 3000);
  const auto job = TestType::job(sah), byOther = TestType::job(other);
  const auto expected = oneByOne<TestType>(job, items);
  CHECK(differences(oneByOne<TestType>(byOther, items), expected) == 0);
  for (const unsigned threads : {1u, 4u}) {
    ThreadPool pool(threads);
    const auto host = answers<TestType>(
        items, [&](const auto& source, const auto& sink) { answerOnHost(pool, job, 0, items.size(), source, sink); });
    CHECK(differences(host, expected) == 0);
    for (const auto& [piece, least, leaf] :
         {std::tuple{1u << 18, 1u << 15, 2u}, {100u, 1u, 8u}, {1u, 1u, 1u}, {3010u, 1000u, 4u}}) {
      opencl::Tuning tuning;
      tuning.pointPiece = piece;
      tuning.leastPointPiece = least;
      tuning.leafTriangles = leaf;
      const auto slot = openSlot(tuning);
      const std::ptrdiff_t count = piece == 1 ? 200 : 3000;
      const Items<TestType> some(items.begin(), items.begin() + count);
      const AllBits<TestType> expectedSome(expected.begin(), expected.begin() + count);
      INFO(threads << " threads, pieces of " << piece);
      CHECK(differences(onDevice<TestType>(*slot, pool, job, some), expectedSome) == 0);
      CHECK(differences(onDevice<TestType>(*slot, pool, byOther, some), expectedSome) == 0);
      CHECK(slot->failedCalls == 0);
    }
  }
}

TEMPLATE_TEST_CASE("an array of nothing is answered", "", Points, Rays) {
  const auto slot = openSlot();
  ThreadPool pool(2);
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 3));
  CHECK(onDevice<TestType>(*slot, pool, TestType::job(*lump), {}).empty());
  CHECK(slot->failedCalls == 0);
}

TEMPLATE_TEST_CASE("whichever call fails, the answers are the same", "", Points, Rays) {
  const scenes::MeshArrays arrays = scenes::makeLump(1, 2, 0.2, 1);
  const auto lump = collisionMesh(arrays);
  const auto items = TestType::items(lump->mesh(), 5, 400);
  const auto expected = oneByOne<TestType>(TestType::job(*lump), items);
  opencl::Tuning tuning;
  tuning.pointPiece = 150;  // three pieces
  ThreadPool pool(2);
  // With a mesh of its own each time, so that it is uploaded.
  const auto differ = [&](DeviceSlot& slot, int times) {
    const auto own = collisionMesh(arrays);
    std::size_t sum = 0;
    for (int i = 0; i < times; ++i) {
      sum += differences(onDevice<TestType>(slot, pool, TestType::job(*own), items), expected);
    }
    return sum;
  };
  const auto taken = [](const DeviceSlot& slot) { return TestType::onHost(slot.backend->counts()); };
  const FailedCalls sums = checkFailingCalls(tuning, 30, differ, taken);
  CHECK(sums.onHost > 100 * 150);
  CHECK(sums.onHost < sums.failed * items.size());  // pieces that were answered before are not asked about again
}

TEMPLATE_TEST_CASE("several threads ask at once, about meshes that have to make room for each other", "", Points,
                   Rays) {
  using Job = typename TestType::Job;
  opencl::Tuning tuning;
  tuning.meshBudget = 2 << 20;
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
        const auto items = TestType::items(own->mesh(), t * 100 + i, 200);
        const Job job = TestType::job(*own, i);
        AllBits<TestType> device(items.size());
        const ArraySource<Job> source = [&](std::size_t begin, std::size_t end, auto* to) {
          std::copy(items.data() + begin, items.data() + end, to);
        };
        const ArraySink<Job> sink = [&](std::size_t begin, std::size_t end, const auto*, const auto* some) {
          for (std::size_t k = begin; k < end; ++k) device[k] = TestType::bitsOf(some[k - begin]);
        };
        answerOnDevice(*slot, pool, job, items.size(), source, sink);
        std::size_t different = 0;
        for (std::size_t k = 0; k < items.size(); ++k) {
          if (!(device[k] == TestType::bitsOf(answerOne(job, items[k])))) ++different;
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
  CHECK(slot->backend->counts().meshBytes <= tuning.meshBudget);
}

TEMPLATE_TEST_CASE("a mesh that does not fit leaves its array to the CPU", "", Points, Rays) {
  opencl::Tuning tuning;
  tuning.meshBudget = 100 << 10;
  const auto slot = openSlot(tuning);
  ThreadPool pool(2);
  opencl::forgetFailures();
  std::vector<std::string> lines;
  opencl::setLogSink([&](const std::string& line) { lines.push_back(line); });
  const auto lump = collisionMesh(scenes::makeLump(1, 4, 0.2, 1));
  const auto items = TestType::items(lump->mesh(), 5, 100);
  const auto job = TestType::job(*lump);
  for (int i = 0; i < DeviceSlot::kMostFailures; ++i) {
    CHECK(differences(onDevice<TestType>(*slot, pool, job, items), oneByOne<TestType>(job, items)) == 0);
  }
  opencl::setLogSink({});
  CHECK(slot->failedCalls == DeviceSlot::kMostFailures);
  CHECK(slot->isOff);
  CHECK(lines.size() == 2);  // why, once; and that the device is off
  CHECK(TestType::onHost(slot->backend->counts()) == DeviceSlot::kMostFailures * items.size());
}

TEMPLATE_TEST_CASE("a device without doubles takes no part", "", Points, Rays) {
  opencl::Tuning tuning;
  tuning.doubles = false;
  const auto slot = openSlot(tuning);
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 1));
  const auto items = TestType::items(lump->mesh(), 5, 300);
  const auto job = TestType::job(*lump);
  CHECK_FALSE(canAnswer(*slot, job));
  Dispatcher dispatcher;
  dispatcher.setDevices({slot});
  const auto found = answers<TestType>(
      items, [&](const auto& source, const auto& sink) { TestType::run(dispatcher, job, items.size(), source, sink); });
  CHECK(differences(found, oneByOne<TestType>(job, items)) == 0);
  CHECK(TestType::asked(slot->backend->counts()) == 0);
}

TEMPLATE_TEST_CASE("auto takes the side that is expected to be done sooner, and a choice is a choice", "", Points,
                   Rays) {
  const auto lump = collisionMesh(scenes::makeLump(1, 3, 0.2, 1));
  const auto items = TestType::items(lump->mesh(), 5, 1000);
  Dispatcher dispatcher;
  dispatcher.setThreadCount(2);
  const auto slot = openSlot();
  dispatcher.setDevices({slot});
  const auto run = [&](Place place, std::size_t count) {
    const std::uint64_t before = TestType::asked(slot->backend->counts());
    const auto job = TestType::job(*lump, place);
    const Items<TestType> some(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(count));
    const auto found = answers<TestType>(
        some, [&](const auto& source, const auto& sink) { TestType::run(dispatcher, job, some.size(), source, sink); });
    CHECK(differences(found, oneByOne<TestType>(job, some)) == 0);
    return TestType::asked(slot->backend->counts()) - before;
  };
  CHECK(run(Place::kAuto, 1000) == 0);  // costs are not known
  CHECK(run(Place::kOpencl, 10) == 10);
  TestType::launch(slot->costs) = {100, 0};  // as long as 100 items take on one thread
  TestType::setCosts(slot->costs);
  TestType::finish(slot->costs) = 0.1;
  CHECK(run(Place::kAuto, 50) == 0);
  CHECK(run(Place::kAuto, 1000) == 1000);
  CHECK(run(Place::kCpu, 1000) == 0);
  TestType::finish(slot->costs) = 2;  // what the CPU makes of triangles may cost more than it saves
  CHECK(run(Place::kAuto, 1000) == 0);
  if constexpr (std::is_same_v<TestType, Points>) {  // sides alone need nothing of the kind
    CHECK(isArraySoonerOnDevice(PointJob{lump.get(), false, true, Place::kAuto}, 1000, slot->costs, 2));
  }
  TestType::finish(slot->costs) = 0.1;
  TestType::launch(slot->costs) = {0, 1000};  // searches of trees as deep as this one's take too long
  CHECK(run(Place::kAuto, 1000) == 0);
  slot->isOff = true;
  CHECK(run(Place::kOpencl, 1000) == 0);
}
