// SPDX-License-Identifier: BSD-3-Clause
// Pairs with a sheet, or with bodies of several components, whose overlap the device describes: the contacts are the
// host's, to the last bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "support/large_overlaps.h"
#include "support/sheet_scenes.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

MeshArrays at(const MeshArrays& mesh, const Vec3d& move) {
  return transformed(mesh, makeMove(move));
}

/// The same surface with its inside outside.
MeshArrays turnedOver(MeshArrays mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  return mesh;
}

/// Bodies side by side, shells within shells, a stool, and small ones in between.
MeshList compounds() {
  std::vector<MeshArrays> stool{at(makeBox({1.6, 1.2, 0.2}, 16), {0, 0, 0.5})}, pebbles;
  for (const double x : {-0.6, 0.6}) {
    for (const double y : {-0.4, 0.4}) stool.push_back(at(makeCylinder(0.1, 0.7, 24, 12), {x, y, 0}));
  }
  for (int i = 0; i < 8; ++i) {
    pebbles.push_back(at(makeSphere(0.3, 3), {0.7 * (i % 2), 0.7 * (i / 2 % 2), 0.7 * (i / 4)}));
  }
  MeshList meshes;
  for (const MeshArrays& arrays :
       {merge({at(makeSphere(0.5, 4), {-0.8, 0, 0}), at(makeLump(0.6, 4, 0.2, 3), {0.8, 0, 0})}), merge(stool),
        merge(pebbles), merge({makeSphere(1, 4), turnedOver(makeSphere(0.8, 4)), makeSphere(0.4, 4)})}) {
    meshes.push_back(collisionMesh(arrays));
    REQUIRE(meshes.back()->mesh().meshClass() == MeshClass::kSolid);
    REQUIRE(meshes.back()->mesh().topology().componentCount() > 1);
  }
  return meshes;
}

bool hasContained(const Workspace& workspace) {
  return std::any_of(workspace.reduced.begin(), workspace.reduced.end(),
                     [](const Contact& c) { return (c.flags & kContactContained) != 0; });
}

bool isPairwise(const Workspace& workspace) {
  return !workspace.reduced.empty() && workspace.reduced[0].coherence == -1;
}

std::size_t count(const std::vector<Workspace>& all, bool (*what)(const Workspace&)) {
  return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), what));
}

/// How many of these pairs the device describes, and makes the contacts of.
struct Described {
  std::uint64_t all, made;
};
Described checkPairs(opencl::Backend& backend, std::span<const Query> queries, std::span<const Workspace> expected) {
  const std::uint64_t made = backend.counts().contactsMade;
  const std::uint64_t all = checkAll(backend, queries, expected);
  return {all, backend.counts().contactsMade - made};
}

/// The same in a batch, in which pairs with more than 32 intersecting triangles are too large for its own kernels,
/// whatever the device.
std::uint64_t describedInBatch(const std::vector<Query>& queries, const std::vector<Workspace>& expected) {
  opencl::Tuning tuning = always();
  tuning.solidSizes = 1;
  tuning.solidLargeHits = 32;
  tuning.leastOverlaps = 1;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  std::size_t wrong = 0;
  for (int round = 0; round < 2; ++round) {
    opencl::BatchAnswer answer;
    CHECK(backend->collideBatch(queries, answer));
    for (std::size_t i = 0; i < queries.size(); ++i) wrong += sameBytes(answer.of(i), expected[i].reduced) ? 0 : 1;
  }
  CHECK(wrong == 0);
  CHECK(backend->counts().onHost == 0);
  return backend->counts().described / 2;
}

}  // namespace

TEST_CASE("overlaps of bodies of several components are described") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const MeshList some = compounds();
  MeshList all = some;
  for (const MeshPtr& body : bodies()) all.push_back(body);
  std::vector<Query> queries = overlaps(all, 51, 120, 1.6);
  std::erase_if(queries, [&](const Query& query) {
    return std::none_of(some.begin(), some.end(),
                        [&](const MeshPtr& mesh) { return mesh.get() == query.a || mesh.get() == query.b; });
  });
  const std::vector<Workspace> expected = answersOnHost(queries);
  CHECK(queries.size() > 60);
  CHECK(count(expected, hasContained) >= 5);
  const std::size_t uneven = unevenPairs(expected);  // which are the host's
  CHECK(uneven < 25);
  for (int round = 0; round < 2; ++round) {
    const Described described = checkPairs(*backend, queries, expected);
    CHECK(described.all + uneven > 50);
    CHECK(described.made + uneven > 50);
  }
  CHECK(describedInBatch(queries, expected) > 30);
}

TEST_CASE("boxes that stand on each other in one mesh have the host's contacts") {
  // An edge that passes from one box into the other crosses two faces in one point.
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  Draw draw(8);
  MeshList meshes;
  std::vector<Query> queries;
  for (int i = 0; i < 60; ++i) {
    const double height = draw.uniform(0.05, 0.6), low = std::pow(10, draw.uniform(-7, -2));
    const double in = std::pow(10, draw.uniform(-5, -2)), yaw = draw.uniform(-0.6, 0.6), y = draw.uniform(-1, 1);
    const Vec3d size{draw.uniform(0.5, 1.2), draw.uniform(0.5, 1.2), draw.uniform(0.4, 0.9)};
    const int fine = i % 2 == 0 ? 1 : 12;
    meshes.push_back(collisionMesh(merge(
        {at(makeBox({10, 10, 1}, fine), {0, 0, -0.5}), at(makeBox({0.6, 6, height}, fine), {2, 0, height / 2})})));
    meshes.push_back(collisionMesh(makeBox(size, fine)));
    const double reach = 0.5 * (size.x * std::cos(yaw) + size.y * std::abs(std::sin(yaw)));
    queries.push_back(makeQuery(*meshes[meshes.size() - 2], *meshes.back(),
                                makePose({0, 0, 1}, yaw, {1.7 - reach + in, y, size.z / 2 - low})));
    queries.back().options.contacts = ContactModel::kSolid;
  }
  const std::vector<Workspace> expected = answersOnHost(queries);
  CHECK(checkPairs(*backend, queries, expected).all > 20);
  describedInBatch(queries, expected);
}

TEST_CASE("boxes on flush tiles and on cubes that touch, in one mesh, have the host's contacts") {
  // An edge that goes through two tiles leaves one where it enters the next. Cubes touch along edges.
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  Draw draw(10);
  MeshList meshes;
  std::vector<Query> queries;
  std::size_t touching = 0;
  for (int i = 0; i < 90; ++i) {
    const int fine = i % 2 == 0 ? 1 : 6;
    std::vector<MeshArrays> tiles;
    for (int k = 0; k < 9; ++k) tiles.push_back(at(makeBox({1, 1, 0.5}, fine), {k % 3 - 1.0, k / 3 - 1.0, -0.25}));
    std::array<bool, 27> isFull{};
    for (std::size_t k = 0; k < isFull.size(); ++k) isFull[k] = k < 9 || draw.uniform(0, 1) < 0.5;
    const MeshArrays cubes =
        makeCubes(3, [&](int x, int y, int z) { return isFull[static_cast<std::size_t>(x + 3 * y + 9 * z)]; });
    const bool isOfCubes = i % 3 == 2;
    const MeshArrays ground = isOfCubes ? at(cubes, {-1.5, -1.5, -3}) : merge(tiles);
    RepairOptions repair;
    repair.weldVertices = i % 3 != 0;
    meshes.push_back(std::make_shared<CollisionMesh>(buildTriMesh(ground.input(), repair).mesh, BuildStrategy::kSah));
    REQUIRE(meshes.back()->mesh().meshClass() == MeshClass::kSolid);
    touching += meshes.back()->mesh().report().nonManifoldEdges > 0;
    const Vec3d size{draw.uniform(0.4, 1.2), draw.uniform(0.4, 1.2), draw.uniform(0.4, 0.9)};
    meshes.push_back(collisionMesh(makeBox(size, fine)));
    const double deep = std::pow(10, draw.uniform(-6, -1)), yaw = i % 4 == 0 ? 0 : draw.uniform(0, 3);
    const Vec3d place{draw.uniform(-0.7, 0.7), draw.uniform(-0.7, 0.7), size.z / 2 - deep};
    queries.push_back(makeQuery(*meshes[meshes.size() - 2], *meshes.back(), makePose({0, 0, 1}, yaw, place)));
    queries.back().options.contacts = ContactModel::kSolid;
  }
  CHECK(touching > 40);
  const std::vector<Workspace> expected = answersOnHost(queries);
  CHECK(checkPairs(*backend, queries, expected).all > 20);
  describedInBatch(queries, expected);
}

TEST_CASE("thin plates below the top of a body, over its edge, have the host's contacts") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  Draw draw(9);
  MeshList meshes;
  std::vector<Query> queries;
  for (int i = 0; i < 60; ++i) {
    const double thickness = draw.uniform(0.004, 0.05), deep = thickness * draw.uniform(0.3, 2);
    const Vec3d size{draw.uniform(0.5, 1.2), draw.uniform(0.5, 1.2), thickness};
    const double over = draw.uniform(-0.1, 0.1), y = draw.uniform(-1, 1), turn = draw.uniform(0, 6);
    const int fine = i % 3 == 0 ? 8 : 1;
    meshes.push_back(
        collisionMesh(merge({at(makeBox({4, 4, 1}, fine), {0, 0, -0.5}), at(makeBox({2, 2, 1}), {-10, 0, -0.5})})));
    meshes.push_back(collisionMesh(makeBox(size, fine)));
    queries.push_back(makeQuery(*meshes[meshes.size() - 2], *meshes.back(),
                                makePose({0, 0, 1}, turn, {2 + over, y, thickness / 2 - deep})));
    queries.back().options.contacts = ContactModel::kSolid;
  }
  const std::vector<Workspace> expected = answersOnHost(queries);
  checkPairs(*backend, queries, expected);
  describedInBatch(queries, expected);
}

TEST_CASE("pairs of a solid whose components overlap are the host's") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  const MeshPtr ground =
      collisionMesh(merge({at(makeBox({4, 4, 1}, 8), {0, 0, -0.5}), at(makeBox({0.6, 3, 0.5}, 4), {1, 0, 0.1}),
                           at(makeSphere(0.5, 3), {-0.8, 0.2, 0.1})}));
  REQUIRE(ground->parts() != nullptr);
  const MeshPtr lump = collisionMesh(makeLump(0.5, 3, 0.2, 4)), box = collisionMesh(makeBox({0.8, 0.6, 0.5}, 4));
  Draw draw(10);
  std::vector<Query> queries;
  for (int i = 0; i < 40; ++i) {
    const Vec3d axis = draw.direction(), at{draw.uniform(-1.5, 1.5), draw.uniform(-1, 1), draw.uniform(0, 0.6)};
    const CollisionMesh& body = i % 2 == 0 ? *lump : *box;
    const Transformd pose = makePose(axis, draw.uniform(0, 3), at);
    queries.push_back(i % 3 == 0 ? makeQuery(body, *ground, pose) : makeQuery(*ground, body, pose));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.push_back(makeQuery(*lump, *box, makePose(axis, 1, {0.6, 0, 0})));
    queries.back().options.contacts = ContactModel::kSolid;
  }
  const std::vector<Workspace> expected = answersOnHost(queries);
  std::size_t several = 0;  // pairs with contacts with more than one component
  for (std::size_t i = 0; i < queries.size(); i += 2) {
    const bool isFirst = queries[i].a == ground.get();
    std::set<std::uint32_t> components;
    for (const Contact& c : expected[i].reduced) {
      components.insert(ground->mesh().topology().componentOf[isFirst ? c.triangleA : c.triangleB]);
    }
    several += components.size() > 1;
  }
  CHECK(several > 10);
  checkPairs(*backend, queries, expected);
  CHECK(describedInBatch(queries, expected) <= queries.size() / 2);
}

TEST_CASE("a component that lies wholly inside another body is left to the host with its pair") {
  opencl::Tuning tuning = always();
  SECTION("by work-groups of the usual size") {}
  SECTION("by small ones") {
    tuning.overlapGroup = 64;
  }
  SECTION("by large ones") {
    tuning.overlapGroup = 256;
  }
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const MeshPtr ball = collisionMesh(makeSphere(1, 4));
  // The box crosses the ball. The small one is inside it, or far away; as the first component or the last.
  for (const bool first : {false, true}) {
    const MeshArrays small = makeSphere(0.2, 2), box = at(makeBox({1, 1, 1}, 12), {1.4, 0, 0});
    const MeshPtr two = collisionMesh(first ? merge({small, box}) : merge({box, small}));
    const auto both = [&](const Vec3d& move) {
      return std::vector<Query>{solidQuery(*ball, *two, makeMove(move)),
                                solidQuery(*two, *ball, makeMove(otgScale(move, -1.0)))};
    };
    const std::vector<Query> inside = both({0, 0, 0}), away = both({-2.8, 0, 0});
    const std::vector<Workspace> expected = answersOnHost(inside);
    CHECK(count(expected, hasContained) == 2);
    CHECK(checkAll(*backend, inside, expected) == 0);
    CHECK(checkAll(*backend, away, answersOnHost(away)) == 2);
    CHECK(checkAll(*backend, inside, expected) == 0);
    CHECK(describedInBatch(inside, expected) == 0);
    CHECK(describedInBatch(away, answersOnHost(away)) == 2);
    // In the ball's bounds, but not inside: in a corner of them, and in the hole of a torus. The host tells.
    const MeshPtr corner = collisionMesh(first ? merge({at(small, {0.75, 0.75, 0.75}), box})
                                               : merge({box, at(small, {-0.75, 0.75, -0.75})}));
    const MeshPtr ring = collisionMesh(makeTorus(1, 0.3, 90, 40)),
                  flat = collisionMesh(first ? merge({small, box}) : merge({box, small}));
    const std::vector<Query> beside = {solidQuery(*ball, *corner, makeMove({0, 0, 0})),
                                       solidQuery(*corner, *ball, makeMove({0, 0, 0})),
                                       solidQuery(*ring, *flat, makePose({1, 0, 0}, 0.1, {0.1, 0, 0}))};
    const std::vector<Workspace> expectedBeside = answersOnHost(beside);
    CHECK(count(expectedBeside, hasContained) == 0);
    CHECK(checkAll(*backend, beside, expectedBeside) == 0);
    CHECK(describedInBatch(beside, expectedBeside) == 0);
  }
}

TEST_CASE("overlaps of bodies with sheets are described") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const MeshArrays ground = terrain(6, 150, 0.4);
  MeshList all = bodies();
  for (const MeshPtr& body : compounds()) all.push_back(body);
  const MeshPtr up = collisionMesh(ground), down = collisionMesh(scaled(ground, {-1, 1, 1}));
  for (const double sign : {1.0, -1.0}) {
    std::vector<Query> queries = lying(sign > 0 ? *up : *down, all, 52, 60, 1, 0.01, 0.3, sign);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      queries[i].options.maxContacts = static_cast<int>(4 + 20 * (i % 3));
      queries[i].options.solid.contactsPerRegion = std::array{3, 16, 64}[i % 3];
    }
    const std::vector<Workspace> expected = answersOnHost(queries);
    CHECK(count(expected, isPairwise) == 0);
    for (int round = 0; round < 2; ++round) {
      const Described described = checkPairs(*backend, queries, expected);
      CHECK(described.all > 45);
      CHECK(described.made > 45);
    }
    CHECK(describedInBatch(queries, expected) > 30);
  }
}

namespace {

/// How many pairs get contacts of the model `pairwise` from the device: it leaves no list of triangles then.
std::size_t pairwiseOnDevice(opencl::Backend& backend, const std::vector<Query>& queries) {
  Workspace workspace;
  std::size_t made = 0;
  for (const Query& query : queries) {
    CHECK(backend.collide(query, workspace));
    made += isPairwise(workspace) && workspace.intersecting.empty() ? 1 : 0;
  }
  return made;
}

}  // namespace

TEST_CASE("where a sheet's contour does not close the host makes contacts of shells") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const MeshPtr sheet = collisionMesh(terrain(2.6, 50, 0.2));
  const MeshList all = bodies();
  const std::vector<Query> queries = lying(*sheet, all, 53, 60, 1.2, 0.01, 0.3);
  const std::vector<Workspace> expected = answersOnHost(queries);
  const std::size_t open = count(expected, isPairwise);
  CHECK(open > 20);
  CHECK(open < 50);
  CHECK(checkAll(*backend, queries, expected) <= queries.size() - open);
  CHECK(pairwiseOnDevice(*backend, queries) == 0);
  CHECK(backend->counts().leftToHost == 0);
  describedInBatch(queries, expected);
  // With the reduction that only the host knows, in other limits.
  std::vector<Query> others = queries;
  for (std::size_t i = 0; i < others.size(); ++i) {
    others[i].options.reduction.method = std::array{Reduction::kNone, Reduction::kCone, Reduction::kBinning}[i % 3];
    others[i].options.maxContacts = static_cast<int>(1 + i % 7);
  }
  checkAll(*backend, others, answersOnHost(others));
  // Islands that cross themselves here and there are at odds, and their contour does not close either.
  const MeshPtr folded = collisionMesh(crumpled(terrain(4, 40, 0.2), 0.12f, 5));
  const std::vector<Query> onFolds = lying(*folded, all, 54, 40, 0.8, 0.01, 0.3);
  const std::vector<Workspace> expectedOnFolds = answersOnHost(onFolds);
  CHECK(count(expectedOnFolds, isPairwise) > 10);
  checkAll(*backend, onFolds, expectedOnFolds);
  CHECK(pairwiseOnDevice(*backend, onFolds) == 0);
  describedInBatch(onFolds, expectedOnFolds);
}

TEST_CASE("an edge with too many crossings in one point is the host's, and not taken for an open contour") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  // Two triangles, whose common edge runs through all of a row of boxes that touch.
  MeshArrays sheet;
  sheet.vertices = {{-5, 0, 0}, {128, 0, 0}, {20, 60, 0}, {20, -60, 0}};
  sheet.triangles = {Triangle{{0, 1, 2}}, Triangle{{1, 0, 3}}};
  const MeshPtr a = collisionMesh(sheet);
  MeshList rows;
  std::vector<Query> queries;
  for (const int boxes : {15, 19, 31}) {
    std::vector<MeshArrays> row;
    for (int j = 0; j < boxes; ++j) {
      const int i = j * 7 % boxes;  // those that touch do not follow each other
      const double half = 0.4 + 0.01 * (i % 5);
      row.push_back(at(makeBox({1, 2 * half, 2 * half}, 1), {i + 0.5, 0.003 * i + 0.0625, 0.01}));
    }
    rows.push_back(collisionMesh(merge(row)));
    queries.push_back(solidQuery(*a, *rows.back(), makeMove({0, 0, 0})));
    queries.back().options.maxContacts = 1000;
  }
  const std::vector<Workspace> expected = answersOnHost(queries);
  CHECK(count(expected, isPairwise) == 0);
  CHECK(checkAll(*backend, queries, expected) < queries.size());
}

TEST_CASE("a sheet's rim may lie inside the other body") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  // Domes whose tops are outside. Rims lead in one direction only, and how their vertices are numbered differs with
  // where they lie.
  std::vector<Query> queries;
  MeshList domes;
  Draw draw(55);
  const MeshPtr box = collisionMesh(makeBox({3, 3, 1}, 8));
  for (int i = 0; i < 48; ++i) {
    HeightGrid grid;
    grid.sizeX = grid.sizeY = 2;
    grid.columns = 3 + static_cast<int>(draw.below(30));
    grid.rows = 3 + static_cast<int>(draw.below(30));
    const double low = draw.uniform(-0.3, 0.2), x = draw.uniform(-0.4, 0.4), y = draw.uniform(-0.4, 0.4);
    setHeights(grid,
               [&](double u, double v) { return low + 0.9 * std::exp(-4 * ((u - x) * (u - x) + (v - y) * (v - y))); });
    MeshArrays dome = sheetOf(grid);
    if (i % 3 == 1) dome = turnedOver(dome);
    if (i % 3 == 2) dome = transformed(dome, makeQuarterTurn(draw.below(24), {0, 0, 0}));
    // Vertices in another order.
    const auto vertices = static_cast<std::uint32_t>(dome.vertices.size());
    if (i % 2 != 0) {
      std::vector<std::uint32_t> to(vertices);
      for (std::uint32_t v = 0; v < vertices; ++v) to[v] = v;
      for (std::uint32_t v = vertices; v-- > 1;) std::swap(to[v], to[draw.below(v + 1)]);
      const std::vector<Vec3f> before = dome.vertices;
      for (std::uint32_t v = 0; v < vertices; ++v) dome.vertices[to[v]] = before[v];
      for (Triangle& t : dome.triangles) {
        for (std::uint32_t& v : t.v) v = to[v];
      }
    }
    domes.push_back(collisionMesh(dome));
  }
  for (std::size_t i = 0; i < domes.size(); ++i) {
    // The pose in which the dome stands upright in the box, whichever way it was turned.
    for (unsigned turn = 0; turn < 24; ++turn) {
      Query query = solidQuery(*box, *domes[i], makeQuarterTurn(turn, {0, 0, 0}));
      Workspace workspace;
      collide(query, workspace);
      if (workspace.intersecting.empty()) continue;
      queries.push_back(i % 2 == 0 ? query : solidQuery(*domes[i], *box, inverse(query.bInA)));
      break;
    }
  }
  CHECK(queries.size() > 35);
  const std::vector<Workspace> expected = answersOnHost(queries);
  // The box is larger than its dome, which is the visitor: the host makes contacts of shells.
  CHECK(checkAll(*backend, queries, expected) == 0);
  describedInBatch(queries, expected);
}

TEST_CASE("histories of pairs with sheets and several components are what the host would have left") {
  const auto backend = openBackend(always());
  REQUIRE(backend);
  if (!canDescribe(*backend)) return;
  const MeshPtr sheet = collisionMesh(terrain(6, 100, 0.4));
  MeshList all = bodies();
  for (const MeshPtr& body : compounds()) all.push_back(body);
  checkHistories(lying(*sheet, all, 56, 16, 1, 0.02, 0.4), 8, 5, [&](const auto& queries, const auto& forHost) {
    checkAll(*backend, queries, answersOnHost(forHost));
  });
  CHECK(backend->counts().described > 40);
}
