// SPDX-License-Identifier: BSD-3-Clause
// One pair at a time: the device finds what the host finds, over meshes good and bad, whatever the sizes of launches
// and lists.
#include <cmath>
#include <stdexcept>

#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "support/mesh_samples.h"
#include "support/opencl.h"
#include "support/opencl_scenes.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

opencl::Backend& shared() {
  static const std::shared_ptr<opencl::Backend> backend = openBackend();
  REQUIRE(backend);
  return *backend;
}

}  // namespace

TEST_CASE("named scenes have the same contacts on the device") {
  std::size_t pairs = 0;
  for (const Scene& scene : makeScenes()) {
    INFO(scene.name);
    const auto a = collisionMesh(scene.a), b = collisionMesh(scene.b);
    for (const bool swapped : {false, true}) {
      for (const Reduction reduction : {Reduction::kNone, Reduction::kBinning, Reduction::kCone}) {
        if (reduction == Reduction::kCone && scene.a.triangles.size() > 4000) continue;  // slow on the host
        Query query = makeQuery(swapped ? *b : *a, swapped ? *a : *b, scene.bInA);
        query.options.reduction.method = reduction;
        query.options.maxContacts = 20;
        checkParity(shared(), query);
      }
    }
    Query query = makeQuery(*a, *b, scene.bInA);
    query.options.contacts = ContactModel::kSolid;
    checkParity(shared(), query);
    Workspace workspace;
    CHECK(shared().findIntersectingPairs(query, workspace));
    Workspace host;
    findIntersectingPairs(query, host);
    CHECK((workspace.intersecting == host.intersecting));
    pairs += host.intersecting.size();
  }
  CHECK(pairs > 3000);
}

TEST_CASE("meshes of every kind have the same intersecting pairs on the device") {
  std::vector<samples::NamedMesh> meshes = samples::ordinaryMeshes();
  for (samples::NamedMesh& mesh : samples::pathologicalMeshes()) {
    if (mesh.mesh->triangleCount() <= 1100) meshes.push_back(std::move(mesh));
  }
  std::vector<std::shared_ptr<CollisionMesh>> trees;
  for (const samples::NamedMesh& mesh : meshes) {
    trees.push_back(std::make_shared<CollisionMesh>(mesh.mesh, BuildStrategy::kSah));
  }
  Draw draw(1);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    for (std::size_t j = 0; j < trees.size(); ++j) {
      INFO(meshes[i].name << " and " << meshes[j].name);
      const Vec3f ca = trees[i]->mesh().center(), cb = trees[j]->mesh().center();
      const double reach = std::min({trees[i]->mesh().radius(), trees[j]->mesh().radius(), 1e30f});  // may be infinite
      const Transformd pose = makeQuarterTurn(draw.below(24), {0, 0, 0});
      const Vec3d moved = otgTransform(pose, Vec3d{cb.x, cb.y, cb.z});
      const Vec3d jitter = draw.inBox(0.3 * reach);
      // Hundreds of copies of one triangle against the same make all pairs intersect: seconds on the host.
      if (trees[i]->mesh().triangleCount() * trees[j]->mesh().triangleCount() > 10000000) continue;
      Query query = makeQuery(*trees[i], *trees[j], pose);
      query.bInA.t = {ca.x - moved.x + jitter.x, ca.y - moved.y + jitter.y, ca.z - moved.z + jitter.z};
      Workspace device, host;
      CHECK(shared().findIntersectingPairs(query, device));
      findIntersectingPairs(query, host);
      CHECK((device.intersecting == host.intersecting));
      pairs += host.intersecting.size();
      if (host.intersecting.size() > 20000) continue;
      query.options.maxContacts = 20;
      checkParity(shared(), query);
    }
  }
  CHECK(pairs > 10000);
}

namespace {

/// Triangles about the origin: any, long and thin, or with corners on a small grid; and one of them far away.
MeshArrays makeHardSoup(Draw& draw, int kind) {
  MeshArrays soup;
  for (std::uint32_t i = 0; i < 24; ++i) {
    const Vec3d from = draw.inBox(1), along = draw.inBox(1), side = otgScale(draw.inBox(1), kind == 1 ? 1e-7 : 1.0);
    const Vec3d far = kind == 2 && i == 0 ? Vec3d{1e7, 0, 0} : Vec3d{0, 0, 0};
    for (const Vec3d& p : {from, otgAdd(from, along), otgAdd(otgAdd(from, otgScale(along, 0.4)), side)}) {
      Vec3f v{static_cast<float>(p.x + far.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      if (kind == 3) v = {std::round(2 * v.x), std::round(2 * v.y), std::round(2 * v.z)};
      if (kind == 1 && i % 2 == 0) v.z = draw.below(2) == 0 ? 0 : 1e-45f;
      soup.vertices.push_back(v);
    }
    soup.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  return soup;
}

}  // namespace

TEST_CASE("thin triangles, outliers, tiny and huge meshes and odd rotations have the host's pairs and contacts") {
  Draw draw(8);
  std::size_t pairs = 0;
  for (int round = 0; round < 240; ++round) {
    MeshArrays soups[2] = {makeHardSoup(draw, round % 4), makeHardSoup(draw, round / 4 % 4)};
    const float scale = std::ldexp(1.0f, round % 3 == 0 ? static_cast<int>(draw.below(101)) - 50 : 0);
    for (MeshArrays& soup : soups) {
      for (Vec3f& v : soup.vertices) v = otgScale(v, scale);
    }
    const auto a = collisionMesh(soups[0]), b = collisionMesh(soups[1]);
    Transformd pose = makeQuarterTurn(draw.below(24), {0, 0, 0});
    if (round % 5 == 0) pose = makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(0.2 * double{scale}));
    for (double& r : pose.r) {
      if (r == 0 && draw.below(2) == 0) r = std::ldexp(1.5, -30 - static_cast<int>(draw.below(1040)));
    }
    Query query = makeQuery(*a, *b, pose);
    Workspace device, host;
    CHECK(shared().findIntersectingPairs(query, device));
    findIntersectingPairs(query, host);
    CHECK((device.intersecting == host.intersecting));
    query.options.maxContacts = 1000;
    query.options.reduction.method = Reduction::kNone;
    checkParity(shared(), query);
    pairs += host.intersecting.size();
  }
  CHECK(pairs > 2000);
}

namespace {

/// Pages of a book: triangles that all use one edge, every second one in the opposite direction.
MeshArrays makeBook(std::uint32_t pages) {
  MeshArrays book;
  book.vertices = {{0, 0, -1}, {0, 0, 1}};
  for (std::uint32_t i = 0; i < pages; ++i) {
    const double angle = 6.0 * i / pages;
    book.vertices.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.1f});
    book.triangles.push_back(i % 2 ? Triangle{{0, 1, i + 2}} : Triangle{{1, 0, i + 2}});
  }
  return book;
}

}  // namespace

TEST_CASE("regions meet over edges of many triangles") {
  std::size_t regions = 0;
  for (const std::uint32_t pages : {2u, 3u, 5u, 16u, 17u, 40u}) {
    INFO(pages << " pages");
    const auto book = collisionMesh(makeBook(pages)), plate = collisionMesh(makeGround(1.5, 1, 7));
    const auto other = collisionMesh(makeBook(9));
    for (const CollisionMesh* mesh : {plate.get(), other.get()}) {
      for (const double z : {0.0, 0.3}) {
        Query query = makeQuery(*book, *mesh, makePose({0.6, 0.8, 0}, 0.4, {0.1, 0.05, z}));
        query.options.reduction.method = Reduction::kNone;
        checkParity(shared(), query);
        std::swap(query.a, query.b);
        checkParity(shared(), query);
        Workspace workspace;
        collide(query, workspace);
        for (const Contact& c : workspace.reduced) regions = std::max<std::size_t>(regions, c.region + 1);
      }
    }
  }
  CHECK(regions > 1);
}

TEST_CASE("contacts are reduced in the same way whatever the method, the bins and the limit") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.3, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  const auto soup = std::make_shared<CollisionMesh>(samples::randomSoup(1, 3000, 1.0f, 0.1f), BuildStrategy::kSah);
  std::size_t limited = 0;
  for (const CollisionMesh* other : {torus.get(), static_cast<const CollisionMesh*>(soup.get())}) {
    for (const double x : {0.2, 0.7}) {
      Query query = makeQuery(*lump, *other, makePose({0.48, 0.6, 0.64}, 0.7, {x, 0.4, 0.1}));
      for (const Reduction method : {Reduction::kNone, Reduction::kBinning}) {
        for (const std::array<int, 6>& bins :
             {std::array<int, 6>{3, 3, 3, 3, 3, 3}, std::array<int, 6>{64, 64, 64, 64, 64, 64},
              std::array<int, 6>{1, 1, 1, 1, 1, 1}, std::array<int, 6>{7, 1, 2, 5, 64, 1}}) {
          for (const int places : {1, 2, 16, 64, 300, 65535}) {
            INFO("bins " << bins[0] << " places " << places);
            query.options.reduction = {method, bins};
            query.options.maxContacts = places;
            checkParity(shared(), query);
            Workspace workspace;
            collide(query, workspace);
            limited += workspace.reduced.size() == static_cast<std::size_t>(places) ? 1 : 0;
          }
        }
      }
    }
  }
  CHECK(limited > 50);
}

TEST_CASE("the answer does not depend on the sizes of launches, leaves and lists") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  std::vector<Query> queries;
  Draw draw(2);
  for (int i = 0; i < 6; ++i) {
    queries.push_back(makeQuery(*lump, *torus, makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(0.7))));
  }
  std::vector<Workspace> expected;
  for (const Query& query : queries) {
    expected.emplace_back();
    collide(query, expected.back());
    REQUIRE(expected.back().intersecting.size() > 50);
  }
  const auto check = [&](const opencl::Tuning& tuning, bool repeats) {
    INFO("leaf " << tuning.leafTriangles << " group " << tuning.group << " groups " << tuning.groupsPerUnit
                 << " places " << tuning.pairPlaces << " " << tuning.leafPlaces << " " << tuning.hitPlaces << " stack "
                 << tuning.stackRoom);
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    for (int round = 0; round < 2; ++round) {
      for (std::size_t i = 0; i < queries.size(); ++i) {
        Workspace device;
        CHECK(backend->collide(queries[i], device));
        checkSame(device, expected[i], !tuning.reduce);
      }
    }
    CHECK((backend->counts().repeats > 0) == repeats);
    CHECK(backend->counts().onHost == 0);
  };
  for (const std::uint32_t leaf : {1u, 2u, 3u, 4u, 7u}) {
    opencl::Tuning tuning;
    tuning.leafTriangles = leaf;
    check(tuning, false);
  }
  for (const std::uint32_t group : {64u, 192u, 256u}) {
    for (const std::uint32_t groups : {1u, 3u, 32u}) {
      opencl::Tuning tuning;
      tuning.group = group;
      tuning.groupsPerUnit = groups;
      check(tuning, false);
    }
  }
  for (const std::uint32_t room : {16u, 17u, 40u}) {
    opencl::Tuning tuning;
    tuning.stackRoom = room;
    check(tuning, false);
  }
  for (const std::uint32_t kept : {1u, 37u}) {  // more contacts than that go to the host
    opencl::Tuning tuning;
    tuning.keptPlaces = kept;
    tuning.chooseGroup = kept == 1 ? 32 : 256;
    tuning.recordGroup = kept == 1 ? 128 : 64;
    check(tuning, false);
  }
  for (int list = 0; list < 3; ++list) {  // every list too short, one after the other, down to one place
    for (const std::uint32_t places : {1u, 37u}) {
      opencl::Tuning tuning;
      (list == 0 ? tuning.pairPlaces : list == 1 ? tuning.leafPlaces : tuning.hitPlaces) = places;
      tuning.leafTriangles = list == 1 ? 16 : 1;  // shallow trees, so that the levels meet leaves
      if (list == 1) tuning.leafTriangles = 8;
      check(tuning, true);
    }
  }
  for (const std::uint32_t order : {1u, 2u, 3u}) {  // seeds in another order
    opencl::Tuning tuning;
    tuning.cutOrder = order;
    tuning.levels = 3 - order;
    tuning.levelTriangles = 0;
    tuning.fewHits = order == 1 ? 1 : 1024;
    check(tuning, false);
  }
  opencl::Tuning tuning;
  tuning.levelTriangles = 1u << 30;  // no levels
  for (const std::uint32_t mode : {0u, 1u, 2u, 3u}) {
    // Kernels may write to a buffer that is mapped where the device's memory is the host's.
    if (mode >= 2 && shared().device().kind != opencl::DeviceKind::kCpu) continue;
    tuning.hostAnswers = mode;
    tuning.fewHits = mode == 0 ? 1 : 512;
    check(tuning, false);
  }
  tuning = {};
  tuning.reduce = false;
  check(tuning, false);
  tuning.recordsExpected = 1;
  check(tuning, false);
}

namespace {

/// Boxes of few and of many triangles that touch, and a little plate upon a large one: where all or some of what
/// intersects is left open by double arithmetic.
struct TouchingBoxes {
  std::shared_ptr<const CollisionMesh> boxes[4] = {
      collisionMesh(makeBox({1, 1, 1}, 1)), collisionMesh(makeBox({1, 0.5, 0.75}, 2)),
      collisionMesh(makeBox({0.7, 0.9, 0.3}, 5)), collisionMesh(makeBox({1, 1, 1}, 8))};
  std::vector<Query> queries;
  std::vector<Workspace> expected;

  explicit TouchingBoxes(int poses, Reduction reduction = Reduction::kBinning) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      for (std::uint32_t j = 0; j < 4; ++j) {
        for (const Transformd& pose : touchingPoses(*boxes[i], *boxes[j], 4 * i + j, poses)) {
          queries.push_back(makeQuery(*boxes[i], *boxes[j], pose));
          queries.back().options.maxContacts = 16;
          queries.back().options.reduction.method = reduction;
          expected.emplace_back();
          collide(queries.back(), expected.back());
        }
      }
    }
  }

  /// The number of pairs with triangles that only exact arithmetic could decide.
  std::size_t check(opencl::Backend& backend) const {
    std::size_t exact = 0, wrong = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      Workspace device;
      CHECK(backend.collide(queries[i], device));
      wrong += sameBytes(device.reduced, expected[i].reduced) ? 0 : 1;
      wrong += device.stats.intersectingPairs == expected[i].stats.intersectingPairs ? 0 : 1;
      wrong += device.stats.contactsBeforeReduction == expected[i].stats.contactsBeforeReduction ? 0 : 1;
      exact += device.stats.decidedExactly > 0 ? 1 : 0;
    }
    CHECK(wrong == 0);
    return exact;
  }
};

}  // namespace

TEST_CASE("boxes that touch are decided on the device") {
  const TouchingBoxes scene(24), all(6, Reduction::kNone);
  std::size_t touching = 0, apart = 0;
  for (const Workspace& workspace : scene.expected) {
    (workspace.intersecting.empty() ? apart : touching) += 1;
    touching += workspace.intersecting.size() > 64 ? 1 : 0;
  }
  CHECK(touching > 250);
  CHECK(apart > 20);
  const auto check = [&](const opencl::Tuning& tuning) {
    INFO("few " << tuning.fewHits << " record group " << tuning.recordGroup << " hits " << tuning.hitPlaces);
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    if (!backend->device().doubles) return;
    for (int round = 0; round < 2; ++round) {
      CHECK(scene.check(*backend) > scene.queries.size() / 2);
      all.check(*backend);
    }
    CHECK(backend->counts().leftToHost == 0);
    CHECK(backend->counts().decidedOnHost == 0);
    CHECK(backend->counts().onHost == 0);
  };
  check({});
  opencl::Tuning tuning;
  tuning.fewHits = 1;  // records by many work-groups
  tuning.recordGroup = 64;
  check(tuning);
  tuning.fewHits = 512;  // by one, or by one whose result is dropped
  tuning.fewGroup = 32;
  tuning.hitPlaces = 1;
  check(tuning);
}

TEST_CASE("what exact arithmetic has decided once the device decides where the host makes contacts") {
  const TouchingBoxes scene(8);
  opencl::Tuning tuning;
  tuning.reduce = false;
  tuning.recordsExpected = 7;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  scene.check(*backend);
  // The first one is a surprise.
  const std::uint64_t first = backend->counts().decidedOnHost;
  CHECK(first > 0);
  CHECK(first < 100);
  scene.check(*backend);
  CHECK(backend->counts().decidedOnHost == first);
  // Pairs alone.
  for (std::size_t i = 0; i < scene.queries.size(); ++i) {
    Workspace device;
    CHECK(backend->findIntersectingPairs(scene.queries[i], device));
    CHECK((device.intersecting == scene.expected[i].intersecting));
  }
  CHECK(backend->counts().decidedOnHost == first);
  CHECK(backend->counts().leftToHost == 0);
}

TEST_CASE("without doubles the host decides what is open, and where even exact arithmetic has no range") {
  const TouchingBoxes scene(4);
  opencl::Tuning tuning;
  tuning.doubles = false;
  const auto single = openBackend(tuning);
  REQUIRE(single);
  scene.check(*single);
  CHECK(single->counts().decidedOnHost > 0);
  // Plates whose planes are so near each other that products of coordinates may underflow.
  const auto plate = collisionMesh(makeGround(1, 0, 2));
  for (const std::uint32_t few : {1u, 64u}) {
    tuning = {};
    tuning.fewHits = few;
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    if (!backend->device().doubles) return;
    for (int round = 0; round < 3; ++round) {
      checkParity(*backend, makeQuery(*plate, *plate, makeMove({0.1, 0.2, 1e-100})));
      checkParity(*backend, makeQuery(*plate, *plate, makeMove({0.1, 0.2, 0})));
    }
    CHECK(backend->counts().leftToHost == 3);
    CHECK(backend->counts().decidedOnHost > 0);
  }
}

TEST_CASE("whichever call fails, boxes that touch have the same contacts") {
  const TouchingBoxes scene(1);
  opencl::setLogSink([](const std::string&) {});
  for (const std::uint32_t few : {1u, 64u}) {
    opencl::Tuning tuning;
    tuning.fewHits = few;
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    scene.check(*backend);
    for (std::uint64_t n = 1; n <= 160; ++n) {
      opencl::FaultInjection::failAt(n, CL_OUT_OF_RESOURCES);
      std::size_t wrong = 0;
      for (std::size_t i = n % 5; i < scene.queries.size(); i += 5) {
        Workspace device;
        backend->collide(scene.queries[i], device);
        wrong += sameBytes(device.reduced, scene.expected[i].reduced) ? 0 : 1;
      }
      opencl::FaultInjection::failAt(0);
      REQUIRE(wrong == 0);
    }
    CHECK(backend->counts().onHost > 50);
  }
  opencl::setLogSink({});
}

TEST_CASE("a device makes contacts of pairwise for shells, and leaves those of solid to the host") {
  const auto book = collisionMesh(makeBook(9));
  MeshArrays torn = makeSphere(0.8, 3);  // a triangle that is wound the other way
  std::swap(torn.triangles[30].v[1], torn.triangles[30].v[2]);
  const auto shell = collisionMesh(torn), lump = collisionMesh(makeLump(1, 4, 0.3, 3));
  REQUIRE(lump->mesh().meshClass() == MeshClass::kSolid);
  REQUIRE(shell->mesh().meshClass() == MeshClass::kShell);
  REQUIRE(shell->mesh().report().inconsistentEdges > 0);
  REQUIRE(book->mesh().report().nonManifoldEdges > 0);
  for (const ContactModel model : {ContactModel::kPairwise, ContactModel::kSolid}) {
    std::size_t made = 0, touching = 0;
    for (const CollisionMesh* other : {static_cast<const CollisionMesh*>(book.get()), shell.get()}) {
      for (const double x : {0.1, 0.4, 0.9, 1.3}) {
        Query query = makeQuery(*lump, *other, makePose({0.48, 0.6, 0.64}, 0.7, {x, 0.4, 0.1}));
        query.options.contacts = model;
        query.options.maxContacts = 20;
        for (const bool swapped : {false, true}) {
          if (swapped) std::swap(query.a, query.b);
          Workspace device, host;
          CHECK(shared().collide(query, device));
          collide(query, host);
          checkSame(device, host);
          touching += host.reduced.empty() ? 0 : 1;
          made += !device.reduced.empty() && device.intersecting.empty() ? 1 : 0;
        }
      }
    }
    CHECK(touching >= 12);
    if (shared().device().doubles) CHECK(made == (model == ContactModel::kPairwise ? touching : 0));
  }
}

TEST_CASE("a pose that the host refuses is refused") {
  const auto box = collisionMesh(makeBox({1, 1, 1}));
  Query query = makeQuery(*box, *box, makeMove({0.9, 0, 0}));
  Workspace workspace;
  query.bInA.r[0] = 1.5;
  CHECK_THROWS_AS(shared().collide(query, workspace), std::invalid_argument);
  CHECK_THROWS_AS(shared().findIntersectingPairs(query, workspace), std::invalid_argument);
  query.bInA.r[0] = NAN;
  CHECK_THROWS_AS(shared().collide(query, workspace), std::invalid_argument);
}

TEST_CASE("taking times changes nothing") {
  const auto a = collisionMesh(makeLump(1, 5, 0.2, 3)), b = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  const Query query = makeQuery(*a, *b, makePose({0, 0, 1}, 1, {0.3, 0.2, 0.1}));
  Workspace device, host;
  collide(query, host);
  for (int i = 0; i < 3; ++i) {
    opencl::StageTimes times;
    CHECK(shared().collideProfiled(query, device, times));
    checkSame(device, host);
    for (const double ms : {times.top, times.contacts, times.readBack, times.host, times.reduction}) CHECK(ms >= 0);
    CHECK(times.main > 0);
    CHECK(times.total > 0);
  }
}

TEST_CASE("one phase on the device and the other one on the host find the same pairs") {
  const auto check = [](opencl::Backend& backend, const Query& query) {
    Workspace host, device;
    findIntersectingPairs(query, host);
    REQUIRE(backend.findCandidates(query, device));
    CHECK(device.candidates.size() == device.stats.candidatePairs);
    std::vector<TrianglePair> sorted = device.candidates;
    std::sort(sorted.begin(), sorted.end());
    CHECK(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
    CHECK(std::includes(sorted.begin(), sorted.end(), host.intersecting.begin(), host.intersecting.end()));
    nearPhase(query, device);
    CHECK((device.intersecting == host.intersecting));
    middlePhase(query, device);
    REQUIRE(backend.decideCandidates(query, device));
    CHECK((device.intersecting == host.intersecting));
    CHECK(device.stats.intersectingPairs == host.stats.intersectingPairs);
    CHECK(device.stats.decidedExactly == host.stats.decidedExactly);
    return host.intersecting.size();
  };
  std::size_t pairs = 0;
  for (const Scene& scene : makeScenes()) {
    INFO(scene.name);
    const auto a = collisionMesh(scene.a), b = collisionMesh(scene.b);
    pairs += check(shared(), makeQuery(*a, *b, scene.bInA));
    if (scene.a.triangles.size() < 4000) pairs += check(shared(), makeQuery(*b, *a, scene.bInA));
  }
  CHECK(pairs > 5000);
  CHECK(shared().counts().onHost == 0);
  // Lists that have to grow, leaves of one triangle, no double arithmetic; and nothing to do.
  opencl::Tuning tuning;
  tuning.pairPlaces = tuning.leafPlaces = 1;
  tuning.leafTriangles = 1;
  tuning.doubles = false;
  const auto small = openBackend(tuning);
  REQUIRE(small);
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), box = collisionMesh(makeBox({1, 1, 1}, 1));
  CHECK(check(*small, makeQuery(*lump, *lump, makeMove({0.5, 0.1, 0}))) > 100);
  CHECK(check(*small, makeQuery(*box, *box, makeMove({0, 0, 1}))) > 0);
  CHECK(small->counts().repeats > 0);
  CHECK(small->counts().onHost == 0);
  const auto empty = collisionMesh({});
  CHECK(check(*small, makeQuery(*empty, *box, makeMove({0, 0, 0}))) == 0);
  CHECK(check(*small, makeQuery(*box, *box, makeMove({5, 0, 0}))) == 0);
  samples::Soup one;
  one.add({-1, -0.5f, 0}, {1, -0.5f, 0.1f}, {0, 1, 0});
  const auto triangle = std::make_shared<CollisionMesh>(one.build(), BuildStrategy::kSah);
  CHECK(check(*small, makeQuery(*triangle, *triangle, makePose({0, 0, 1}, 1, {0.1, 0, 0}))) == 1);  // roots are leaves
}
