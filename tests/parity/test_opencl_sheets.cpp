// SPDX-License-Identifier: BSD-3-Clause
// Batches of closed bodies on sheets (open meshes: terrains), and of bodies of several components: the device's
// contacts are the host's, to the last bit, and the device is who makes them.
#include <algorithm>
#include <thread>

#include "collide/stages.h"
#include "support/draw.h"
#include "support/mesh_samples.h"
#include "support/sheet_scenes.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

MeshList bodies(double scale = 1) {
  MeshList meshes;
  for (const MeshArrays& arrays :
       {makeBox({1, 1.5, 0.8}, 1), makeBox({1, 1, 1}, 4), makeSphere(0.7, 3), makeTorus(0.7, 0.25, 31, 13),
        makeLump(0.8, 3, 0.2, 5), makeCylinder(0.6, 0.3, 40, 2), makeGear(12, 0.9, 0.2, 0.3, 0.1)}) {
    meshes.push_back(collisionMesh(scaled(arrays, {scale, scale, scale})));
  }
  return meshes;
}

std::size_t countModel(const std::vector<std::vector<Contact>>& contacts, bool pairwise) {
  return static_cast<std::size_t>(std::count_if(contacts.begin(), contacts.end(), [&](const auto& some) {
    return !some.empty() && (some[0].coherence == -1) == pairwise;
  }));
}

/// How many of the pairs the host has to do.
std::size_t leftOf(opencl::Backend& backend, const std::vector<Query>& queries,
                   const std::vector<std::vector<Contact>>& expected) {
  const std::size_t left = queries.size() - checkBatch(backend, queries, expected);
  return backend.device().doubles ? left : 0;
}

}  // namespace

TEST_CASE("bodies on terrains are the device's") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshPtr flat = collisionMesh(terrain(12, 24, 0)), rough = collisionMesh(terrain(12, 40, 0.5));
  const MeshList all = bodies();
  for (const MeshPtr& sheet : {flat, rough}) {
    const std::vector<Query> queries = lying(*sheet, all, 1, 150, 4, -0.01, 0.04);
    const auto expected = onHost(queries);
    CHECK(countModel(expected, false) > 100);
    CHECK(leftOf(*backend, queries, expected) <= 3);
    const std::vector<Query> deep = lying(*sheet, all, 2, 80, 4, 0.04, 0.4);
    CHECK(leftOf(*backend, deep, onHost(deep)) < 40);
  }
  // Fewer places than contacts.
  std::vector<Query> few = lying(*rough, all, 3, 60, 4, 0.01, 0.1);
  for (std::size_t i = 0; i < few.size(); ++i) few[i].options.maxContacts = static_cast<int>(1 + i % 8);
  CHECK(leftOf(*backend, few, onHost(few)) < 10);
}

TEST_CASE("terrains may be mirrored, scaled and large") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshArrays ground = terrain(12, 40, 0.5);
  const MeshList all = bodies();
  // Mirrored at a vertical plane a terrain faces down: it pushes down what comes from below.
  const MeshPtr down = collisionMesh(scaled(ground, {-1, 1, 1}));
  const std::vector<Query> below = lying(*down, all, 4, 60, 4, -0.01, 0.05, -1);
  std::vector<std::vector<Contact>> expected = onHost(below);
  CHECK(countModel(expected, false) > 40);
  for (std::size_t i = 0; i < below.size(); i += 2) {
    for (const Contact& c : expected[i]) CHECK(c.normal.z > 0);  // into A, the terrain
  }
  CHECK(leftOf(*backend, below, expected) <= 3);
  for (const double scale : {0.01, 300.0}) {
    const MeshPtr sheet = collisionMesh(scaled(ground, {scale, -scale, -scale}));  // turned over about x
    const MeshList some = bodies(scale);
    const std::vector<Query> queries = lying(*sheet, some, 5, 60, 4 * scale, -0.01, 0.05, -1);
    expected = onHost(queries);
    CHECK(countModel(expected, false) > 40);
    CHECK(leftOf(*backend, queries, expected) <= 3);
  }
  const MeshPtr large = collisionMesh(terrain(60, 224, 1.5));
  CHECK(large->mesh().triangleCount() > 100000);
  const std::vector<Query> queries = lying(*large, all, 6, 60, 25, -0.01, 0.05);
  expected = onHost(queries);
  CHECK(countModel(expected, false) > 40);
  CHECK(leftOf(*backend, queries, expected) <= 3);
}

TEST_CASE("bodies over the rim of a sheet get contacts of shells, from the host") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshPtr flat = collisionMesh(terrain(3, 6, 0)), rough = collisionMesh(terrain(3, 12, 0.2));
  const MeshList all = bodies();
  for (const MeshPtr& sheet : {flat, rough}) {
    std::vector<Query> queries = lying(*sheet, all, 7, 120, 2, -0.01, 0.3);
    std::vector<std::vector<Contact>> expected = onHost(queries);
    CHECK(countModel(expected, true) > 40);
    CHECK(countModel(expected, false) > 20);
    std::vector<Query> rim;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      if (!expected[i].empty() && expected[i][0].coherence == -1) rim.push_back(queries[i]);
    }
    // Hardly any but those at the rim, and all of these.
    CHECK(leftOf(*backend, queries, expected) < rim.size() + 20);
    const std::size_t left = backend->device().doubles ? rim.size() : 0;
    CHECK(leftOf(*backend, rim, onHost(rim)) == left);
    for (std::size_t i = 0; i < rim.size(); ++i) {
      rim[i].options.maxContacts = static_cast<int>(1 + i % 5);
      rim[i].options.reduction.method = i % 3 == 0 ? Reduction::kNone : Reduction::kBinning;
    }
    CHECK(leftOf(*backend, rim, onHost(rim)) == left);
    for (Query& query : rim) query.options.reduction.method = Reduction::kCone;
    CHECK(leftOf(*backend, rim, onHost(rim)) == left);
  }
}

TEST_CASE("a body wholly behind a sheet has no contacts, and none is the host's") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshPtr sheet = collisionMesh(terrain(12, 24, 0.3));
  const MeshList all = bodies();
  std::vector<Query> queries;
  Draw draw(9);
  std::vector<SolidHistory> onDevice(60), host(60);
  for (std::size_t i = 0; i < onDevice.size(); ++i) {
    const Transformd pose = makePose(draw.direction(), draw.uniform(0, 6),
                                     {draw.uniform(-7, 7), draw.uniform(-7, 7), draw.uniform(-5, -1.5)});
    queries.push_back(solidQuery(*sheet, *all[i % all.size()], pose));
  }
  std::vector<Query> forHost = queries;
  for (std::size_t i = 0; i < queries.size(); i += 2) {
    queries[i].history = &onDevice[i];
    forHost[i].history = &host[i];
  }
  const auto expected = onHost(forHost);
  for (const auto& contacts : expected) CHECK(contacts.empty());
  CHECK(leftOf(*backend, queries, expected) == 0);
  for (std::size_t i = 0; i < queries.size(); ++i) CHECK(same(onDevice[i].current, host[i].current));
}

TEST_CASE("boxes lie in the plane of a flat sheet, with edges along its edges") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshPtr coarse = collisionMesh(terrain(8, 8, 0)), fine = collisionMesh(terrain(8, 32, 0));
  MeshList boxes;
  for (const MeshArrays& box : {makeBox({1, 1, 1}, 1), makeBox({2, 1, 0.5}, 4), makeBox({0.5, 0.75, 1}, 2)}) {
    boxes.push_back(collisionMesh(box));
  }
  Draw draw(10);
  std::vector<Query> queries;
  for (int i = 0; i < 300; ++i) {
    const CollisionMesh& sheet = i % 2 == 0 ? *coarse : *fine;
    const CollisionMesh& box = *boxes[draw.below(3)];
    const auto cell = [&] { return 0.25 * static_cast<double>(draw.below(21)) - 2.5; };
    const double shift = i % 3 == 0 ? 0 : draw.uniform(-0.3, 0.3);
    const double tremble = std::vector<double>{0, 0, 1e-14, 1e-9, 1e-4}[draw.below(5)];
    Transformd pose = makePose({tremble, 0.5 * tremble, 1}, i % 4 == 0 ? draw.uniform(0, 3) : 0, {0, 0, 0});
    if (tremble == 0 && i % 4 != 0) pose = makeMove({0, 0, 0});
    pose.t = {cell() + shift, cell() + (i % 5 == 0 ? shift : 0), 0};
    if (i % 11 == 0) pose.t.x = 4;  // over the rim
    pose.t.z = -static_cast<double>(box.mesh().boundsMin().z) -
               std::vector<double>{0, 1e-12, 1e-6, 1e-4, 2e-3, 0.05}[draw.below(6)];
    queries.push_back(i % 7 < 4 ? solidQuery(sheet, box, pose) : solidQuery(box, sheet, inverse(pose)));
  }
  const auto expected = onHost(queries);
  CHECK(countModel(expected, false) > 150);
  CHECK(countModel(expected, true) > 10);
  // And those over the rim.
  CHECK(leftOf(*backend, queries, expected) < 30 + countModel(expected, true));
}

TEST_CASE("a body that touches a sheet in several places") {
  const auto backend = openBackend();
  REQUIRE(backend);
  // A slab on feet.
  const auto feet = [](double x, double y) { return 0.3 * std::sin(4 * x) * std::sin(4 * y); };
  MeshArrays table = makeGround(2.2, 0.6, 24, feet);
  const MeshPtr body = collisionMesh(transformed(table, {{1, 0, 0, 0, -1, 0, 0, 0, -1}, {0, 0, 0}}));
  const MeshPtr flat = collisionMesh(terrain(12, 30, 0)), rough = collisionMesh(terrain(12, 40, 0.2));
  Draw draw(11);
  std::vector<Query> queries;
  for (int i = 0; i < 40; ++i) {
    const CollisionMesh& sheet = i % 2 == 0 ? *flat : *rough;
    Transformd pose = makePose({0, 0, 1}, draw.uniform(0, 6), {draw.uniform(-3, 3), draw.uniform(-3, 3), 0});
    queries.push_back(solidQuery(sheet, *body, loweredOn(sheet, *body, pose, draw.uniform(0.001, 0.03), 1)));
    queries.back().options.maxContacts = 64;
  }
  const auto expected = onHost(queries);
  const auto regions = std::count_if(expected.begin(), expected.end(), [](const auto& contacts) {
    return std::any_of(contacts.begin(), contacts.end(), [](const Contact& c) { return c.region >= 3; });
  });
  CHECK(regions > 15);
  CHECK(leftOf(*backend, queries, expected) < 15);
}

TEST_CASE("histories of bodies on sheets are what the host would have left") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshPtr sheet = collisionMesh(terrain(5, 16, 0.2));
  const MeshList all = bodies();
  std::vector<Query> queries = lying(*sheet, all, 12, 160, 2.6, -0.01, 0.1), forHost = queries;
  std::vector<SolidHistory> onDevice(queries.size()), host(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (i % 4 == 1) queries[i].options.maxContacts = forHost[i].options.maxContacts = static_cast<int>(2 + i % 3);
    if (i % 4 == 0) continue;
    queries[i].history = &onDevice[i];
    forHost[i].history = &host[i];
  }
  Draw draw(13);
  for (int step = 0; step < 5; ++step) {
    const auto expected = onHost(forHost);
    if (step == 3) {
      const auto isCut = [](const Contact& c) { return (c.flags & kContactClamped) != 0; };
      const auto cut = std::count_if(expected.begin(), expected.end(), [&](const std::vector<Contact>& contacts) {
        return std::any_of(contacts.begin(), contacts.end(), isCut);
      });
      CHECK(cut > 5);
    }
    if (step == 0) CHECK(countModel(expected, true) > 5);
    CHECK(leftOf(*backend, queries, expected) < 60);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      wrong += onDevice[i].used != host[i].used || !same(onDevice[i].current, host[i].current) ||
               !same(onDevice[i].before, host[i].before);
      if (step == 1) continue;  // the same pose again
      // As if they had touched without depth: the next contacts are too deep.
      if (step == 2 && i % 4 == 1) onDevice[i].current.deepest = host[i].current.deepest = 0;
      queries[i].bInA.t = otgAdd(queries[i].bInA.t, otgScale(draw.direction(), step < 3 ? 0.005 : 0.3));
      forHost[i].bInA.t = queries[i].bInA.t;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("boxes on a flat sheet that have more contacts than places, all too deep for their motion") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshPtr sheet = collisionMesh(terrain(8, 8, 0)), box = collisionMesh(makeBox({1, 1, 1}, 2));
  Draw draw(14);
  std::vector<Query> queries;
  for (std::size_t i = 0; i < 60; ++i) {
    const double angle = draw.uniform(0, 0.02);
    queries.push_back(
        solidQuery(*sheet, *box, makePose(draw.direction(), angle, {draw.uniform(-3, 3), draw.uniform(-3, 3), 0.48})));
    queries.back().options.maxContacts = static_cast<int>(2 + i % 4);
  }
  std::vector<Query> forHost = queries;
  std::vector<SolidHistory> onDevice(queries.size()), host(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    queries[i].history = &onDevice[i];
    forHost[i].history = &host[i];
  }
  for (int step = 0; step < 2; ++step) {
    const auto expected = onHost(forHost);
    CHECK(leftOf(*backend, queries, expected) < queries.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      wrong += same(onDevice[i].current, host[i].current) ? 0 : 1;
      onDevice[i].current.deepest = host[i].current.deepest = 0;
      queries[i].bInA.t.z = forHost[i].bInA.t.z -= 0.002;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("batches that mix solids, sheets and other meshes") {
  MeshList meshes = bodies();
  meshes.push_back(collisionMesh(terrain(6, 20, 0.3)));
  meshes.push_back(collisionMesh(terrain(2, 3, 0)));
  meshes.push_back(collisionMesh(MeshArrays{}));
  samples::Soup one;
  one.add({-1, -0.5f, 0}, {1, -0.5f, 0.1f}, {0, 1, 0});
  meshes.push_back(std::make_shared<CollisionMesh>(one.build(), BuildStrategy::kSah));
  MeshArrays torn = terrain(4, 8, 0.2);  // two triangles that disagree with the others
  std::swap(torn.triangles[30].v[1], torn.triangles[30].v[2]);
  meshes.push_back(collisionMesh(torn));
  meshes.push_back(std::make_shared<CollisionMesh>(samples::randomSoup(3, 60, 0.6f, 0.4f), BuildStrategy::kSah));
  Draw draw(14);
  std::vector<Query> queries;
  const auto any = [&] { return draw.below(static_cast<std::uint32_t>(meshes.size())); };
  std::vector<const CollisionMesh*> list;
  for (const auto& mesh : meshes) list.push_back(mesh.get());
  std::vector<opencl::MeshPair> pairs;
  for (int i = 0; i < 500; ++i) {
    const std::uint32_t a = any(), b = any();
    const Transformd pose = makePose(draw.direction(), draw.uniform(0, 6), draw.inBox(0.9));
    queries.push_back(solidQuery(*list[a], *list[b], pose));
    pairs.push_back({a, b, pose});
  }
  std::vector<std::vector<Contact>> expected = onHost(queries);
  CHECK(countModel(expected, true) > 50);
  CHECK(countModel(expected, false) > 50);
  opencl::Tuning tuning;
  for (const bool small : {false, true}) {
    if (small) {  // lists that are too short at first
      tuning.arenaUnits = 1;
      tuning.contactPlaces = 1;
      tuning.hitPlaces = 1;
      tuning.batchPairs = 130;
      tuning.solidSizes = 2;
      tuning.solidHits = 32;
    }
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    CHECK(leftOf(*backend, queries, expected) < 250);
    opencl::BatchAnswer answer;
    CHECK(backend->collideBatch(opencl::NumberedPairs{list, pairs, queries[0].options}, answer));
    CHECK(countWrong(answer, expected) == 0);
    if (small && backend->device().doubles) CHECK(backend->counts().repeats > 0);
  }
  // Options that differ from pair to pair, contacts of the other model among what is asked for.
  const auto backend = openBackend();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (i % 5 == 0) queries[i].options.contacts = ContactModel::kPairwise;
    if (i % 7 == 0) queries[i].options.maxContacts = static_cast<int>(i % 13);
    if (i % 11 == 0) queries[i].options.reduction.method = Reduction::kNone;
    if (i % 17 == 0) queries[i].options.solid.regionMerge = 0.05;
  }
  expected = onHost(queries);
  CHECK(leftOf(*backend, queries, expected) < 300);
  for (const bool doubles : {true, false}) {
    tuning = {};
    tuning.solid = false;
    tuning.doubles = doubles;
    checkBatch(*openBackend(tuning), queries, expected);
  }
}

TEST_CASE("bodies of several components") {
  const auto at = [](const MeshArrays& mesh, const Vec3d& move) { return transformed(mesh, makeMove(move)); };
  const auto stool = [&] {
    std::vector<MeshArrays> parts{at(makeBox({1.6, 1.2, 0.2}, 2), {0, 0, 0.5})};
    for (const double x : {-0.6, 0.6}) {
      for (const double y : {-0.4, 0.4}) parts.push_back(at(makeCylinder(0.1, 0.7, 12), {x, y, 0}));
    }
    return merge(parts);
  };
  std::vector<MeshArrays> pebbles;
  for (int i = 0; i < 8; ++i) {
    pebbles.push_back(at(makeSphere(0.3, 1), {0.7 * (i % 2), 0.7 * (i / 2 % 2), 0.7 * (i / 4)}));
  }
  MeshList compounds;
  for (const MeshArrays& arrays : {merge({at(makeSphere(0.5, 2), {-1, 0, 0}), at(makeLump(0.6, 3, 0.2, 3), {1, 0, 0})}),
                                   stool(), merge(pebbles)}) {
    compounds.push_back(collisionMesh(arrays));
    REQUIRE(compounds.back()->mesh().meshClass() == MeshClass::kSolid);
    REQUIRE(compounds.back()->mesh().topology().componentCount() > 1);
  }
  const auto backend = openBackend();
  REQUIRE(backend);
  const MeshPtr sheet = collisionMesh(terrain(12, 30, 0.3));
  const std::vector<Query> ground = lying(*sheet, compounds, 15, 90, 4, -0.01, 0.05);
  std::vector<std::vector<Contact>> expected = onHost(ground);
  CHECK(countModel(expected, false) > 60);
  CHECK(leftOf(*backend, ground, expected) <= 5);
  MeshList all = compounds;
  for (const MeshPtr& body : bodies()) all.push_back(body);
  const std::vector<Query> each = touching(all, 16, 200, -0.01, 0.06);
  expected = onHost(each);
  CHECK(countModel(expected, false) > 130);
  CHECK(leftOf(*backend, each, expected) < 60);  // those with a component in the bounds of the other body
  const std::vector<Query> deep = touching(all, 17, 100, 0.1, 0.5);
  CHECK(leftOf(*backend, deep, onHost(deep)) < 70);
}

TEST_CASE("what components lie inside another body, and sheets of several") {
  const auto at = [](const MeshArrays& mesh, const Vec3d& move) { return transformed(mesh, makeMove(move)); };
  const auto backend = openBackend();
  REQUIRE(backend);
  const bool doubles = backend->device().doubles;
  const MeshPtr ball = collisionMesh(makeSphere(1, 3));
  const MeshPtr two = collisionMesh(merge({makeSphere(0.2, 1), at(makeBox({1, 1, 1}, 2), {1.4, 0, 0})}));
  const auto run = [&](const std::vector<Query>& queries, std::size_t left) {
    const auto expected = onHost(queries);
    CHECK(leftOf(*backend, queries, expected) == (doubles ? left : 0));
    return expected;
  };
  // One component crosses the ball and the other is inside it, or far away.
  const Transformd here = makeMove({0, 0, 0});
  const auto inside = run({solidQuery(*ball, *two, here), solidQuery(*two, *ball, here)}, 2);
  for (const auto& contacts : inside) {
    CHECK(std::any_of(contacts.begin(), contacts.end(), [](const Contact& c) { return c.flags & kContactContained; }));
  }
  run({solidQuery(*ball, *two, makeMove({-2.8, 0, 0})), solidQuery(*two, *ball, makeMove({2.8, 0, 0}))}, 0);
  // Behind a sheet nothing is inside: a component may lie there whole.
  const MeshPtr sheet = collisionMesh(terrain(8, 16, 0.2));
  const MeshPtr pair =
      collisionMesh(merge({at(makeSphere(0.4, 2), {0, 0, 0.35}), at(makeSphere(0.3, 2), {1, 0, -0.9})}));
  run({solidQuery(*sheet, *pair, here), solidQuery(*pair, *sheet, here)}, 0);
  // Two islands and a rock between them in one mesh: a sheet with a closed component.
  const MeshPtr islands =
      collisionMesh(merge({at(terrain(4, 10, 0.2), {-4, 0, 0}), at(terrain(4, 10, 0.2, 2), {4, 0, 0}),
                           makeSphere(0.8, 2), at(makeSphere(0.1, 1), {0, 0, 5})}));
  REQUIRE(islands->mesh().meshClass() == MeshClass::kShell);
  const MeshList all = bodies();
  std::vector<Query> queries;
  for (const double x : {-4.0, 0.0, 4.0}) {
    for (const MeshPtr& body : all) {
      Transformd pose = makePose({0.48, 0.6, 0.64}, 0.7, {x, 0.1, 0});
      queries.push_back(solidQuery(*islands, *body, loweredOn(*islands, *body, pose, 0.02, 1)));
    }
  }
  const auto expected = run(queries, 0);
  CHECK(countModel(expected, false) > 15);
  // The small ball is a component of the sheet inside a solid; the solid's own are never inside the sheet.
  run({solidQuery(*islands, *ball, makeMove({0, 0, 5})), solidQuery(*ball, *islands, makeMove({0, 0, -5}))}, 2);
  // More components than a device keeps.
  std::vector<MeshArrays> many;
  for (int i = 0; i < 70; ++i) many.push_back(at(makeBox({0.1, 0.1, 0.1}), {0.2 * (i % 10), 0.2 * (i / 10), 0}));
  const MeshPtr grid = collisionMesh(merge(many));
  run({solidQuery(*grid, *ball, makeMove({0.3, 0.2, 1})), solidQuery(*sheet, *grid, makeMove({0, 0, 0.05}))}, 2);
}
