// SPDX-License-Identifier: BSD-3-Clause
// Batches of solids: the device's contacts of the model `solid` are the host's, to the last bit.
#include <algorithm>
#include <thread>

#include "collide/consistent_contacts.h"
#include "collide/pair_history.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/region_contacts.h"
#include "collide/solid/region_refiner.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "scenes/concave_meshes.h"
#include "support/mesh_samples.h"
#include "support/posts.h"
#include "support/raised_corner.h"
#include "support/solid_batches.h"
#include "truth/fitting_bodies.h"
#include "truth/wild_bodies.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

MeshList solids() {
  MeshList meshes;
  for (const MeshArrays& arrays :
       {makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), makeBox({1, 1.5, 0.8}, 1), makeBox({1, 1, 1}, 5),
        makeSphere(0.8, 2), makeTorus(0.7, 0.25, 31, 13), makeLump(0.9, 3, 0.2, 5), makeGear(12, 0.9, 0.2, 0.3, 0.1),
        makeCylinder(0.5, 1.4, 24, 3), makeLump(0.9, 4, 0.2, 6), makeBowl(0.9, 0.15, 16, 6)}) {
    meshes.push_back(collisionMesh(arrays));
  }
  return meshes;
}

using IsSuch = bool (*)(const OverlapRegions&, const Region&, const RegionDirection&, RegionNormals&);

/// Says of a query of the host whether a region of it is such a one.
class RegionFinder : public RegionRefiner {
 public:
  explicit RegionFinder(IsSuch isSuch) : isSuch_(isSuch) {}
  bool direct(const PlacedMeshes& /*meshes*/, const OverlapRegions& all, const Region& region,
              const RegionDirection& direction, RegionNormals& normals) override {
    found = found || isSuch_(all, region, direction, normals);
    return false;
  }
  void refine(std::vector<Contact>& /*contacts*/, std::size_t /*first*/) override {}
  bool found = false;

 private:
  IsSuch isSuch_;
};

std::size_t countPairsWith(IsSuch isSuch, const std::vector<Query>& queries) {
  std::size_t count = 0;
  Workspace workspace;
  for (Query query : queries) {
    RegionFinder finder(isSuch);
    query.refiner = &finder;
    collide(query, workspace);
    count += finder.found ? 1 : 0;
  }
  return count;
}

/// A thin contact with a wedge beside it.
bool hasWedge(const OverlapRegions& all, const Region& region, const RegionDirection& /*direction*/,
              RegionNormals& normals) {
  RegionExtent extent(all, region);
  return isUneven(region, normals, extent);
}

/// An edge across an edge and nothing else.
bool isOfEdges(const OverlapRegions& /*all*/, const Region& /*region*/, const RegionDirection& direction,
               RegionNormals& /*normals*/) {
  return direction.depth > 0;
}

/// Of few large faces, with hollows between its corners.
MeshArrays spiky(Draw& draw) {
  MeshArrays mesh = makeSphere(1, 0);
  for (Vec3f& v : mesh.vertices) {
    const double factor = draw.uniform(0.4, 1.2);
    v = toFloat({factor * v.x, factor * v.y, factor * v.z});
  }
  return mesh;
}

/// How many pairs the host makes again: those that meet more on the way which their contacts ask for, and those that
/// may and have contacts in all places.
std::size_t madeAgain(const std::vector<Query>& queries, const std::vector<std::vector<Contact>>& contacts) {
  Workspace workspace;
  std::size_t count = 0;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (!mayMeetAhead(queries[i])) continue;
    findIntersectingPairs(queries[i], workspace);
    const bool isFull = contacts[i].size() == static_cast<std::size_t>(queries[i].options.maxContacts);
    if (!isFull && !solidContacts(queries[i], workspace)) continue;
    const std::optional<Transformd> pose = poseAhead(queries[i], workspace.contacts, workspace);
    Query ahead = queries[i];
    if (pose) {
      ahead.bInA = *pose;
      findIntersectingPairs(ahead, workspace);
    }
    count += isFull || (pose && !workspace.intersecting.empty());
  }
  return count;
}

/// Bodies with hollows.
MeshList cornered() {
  MeshList meshes;
  for (const MeshArrays& arrays :
       {makeGear(12, 0.9, 0.2, 0.3, 0.1), makeGear(17, 0.8, 0.15, 0.4, 0.2), makeTray({1, 1, 0.3}, 0.1),
        makeCorner(1, 0.3, 0.8), makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})}) {
    meshes.push_back(collisionMesh(arrays));
  }
  return meshes;
}

}  // namespace

TEST_CASE("the contacts of a batch of solids are the host's") {
  const MeshList meshes = solids();
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  // From apart to as deep as bodies get; one in ten has an uneven region.
  const std::vector<Query> queries = touching(meshes, 1, 300, -0.01, 0.06);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  CHECK(checkBatch(*backend, queries, expected) > 295);
  const std::vector<Query> deep = touching(meshes, 2, 200, 0.05, 0.6);
  CHECK(checkBatch(*backend, deep, onHost(deep)) > 100);
  // Fewer places than contacts, and than regions.
  std::vector<Query> few = touching(meshes, 3, 150, 0.01, 0.3);
  for (std::size_t i = 0; i < few.size(); ++i) few[i].options.maxContacts = static_cast<int>(1 + i % 8);
  CHECK(checkBatch(*backend, few, onHost(few)) > 75);
  for (Query& query : few) query.options.solid.contactsPerRegion = 5;
  CHECK(checkBatch(*backend, few, onHost(few)) > 75);
}

TEST_CASE("blocks with flush faces in one mesh, and cubes that touch, have the host's contacts") {
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  truth::Random random(8);
  MeshList meshes;
  for (int i = 0; i < 40; ++i) meshes.push_back(collisionMesh(truth::flushBlocks(random)));
  const std::vector<Query> queries = touching(meshes, 4, 200, 0.001, 0.05);
  CHECK(checkBatch(*backend, queries, onHost(queries)) > 100);
}

TEST_CASE("a plate whose corners are in different posts has the host's contacts") {
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  const auto posts = collisionMesh(makePosts(0)), plate = collisionMesh(makePlate());
  Draw draw(2);
  std::vector<Query> queries;
  for (int i = 0; i < 60; ++i) {
    queries.push_back(makeQuery(*posts, *plate, drawPlatePose(draw)));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 64;
  }
  CHECK(checkBatch(*backend, queries, onHost(queries)) > 50);
}

TEST_CASE("a box upon two triangles, one of which rises, has the host's contacts") {
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  const auto block = collisionMesh(makeRaisedCorner(0.125f));
  Draw draw(4);
  MeshList boxes;
  std::vector<Query> queries;
  for (int i = 0; i < 100; ++i) {
    const Vec3d half{draw.uniform(0.2, 0.69), draw.uniform(0.2, 0.69), draw.uniform(0.2, 0.5)};
    boxes.push_back(collisionMesh(scenes::makeBox(half * 2.0)));
    queries.push_back(makeQuery(*block, *boxes.back(), drawBoxPose(draw, half, draw.uniform(0.002, 0.06))));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 64;
  }
  CHECK(checkBatch(*backend, queries, onHost(queries)) > 80);
}

TEST_CASE("bodies that fit each other at acute angles have the host's contacts") {
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  truth::Random random(7);
  MeshList meshes;
  std::vector<Query> queries;
  for (const auto make : {truth::wedgeInGroove, truth::tileOnRidge, truth::hatOnPyramid}) {
    for (int i = 0; i < 40; ++i) {
      const truth::FittingPair pair = make(random);
      meshes.push_back(collisionMesh(pair.host));
      meshes.push_back(collisionMesh(pair.mover));
      const double tilt = i % 2 == 0 ? 0 : random.uniform(0, 1e-3), depth = random.uniform(1e-4, 1e-2);
      queries.push_back(
          makeQuery(*meshes[meshes.size() - 2], *meshes.back(), makePose({1, 0, 0}, tilt, {0, pair.along, -depth})));
      queries.back().options.contacts = ContactModel::kSolid;
      queries.back().options.maxContacts = 64;
    }
  }
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  CHECK(countPairsWith(hasWedge, queries) > 60);
  CHECK(checkBatch(*backend, queries, expected) > 25);
}

TEST_CASE("pairs of two convex meshes, and of one on a surface, are the host's, alone and in a batch") {
  const MeshList meshes = solids();
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  std::vector<Query> queries = touching(meshes, 4, 200, -0.01, 0.06);
  std::size_t convex = 0;
  for (Query& query : queries) {
    query.options.solid.convexPath = true;
    convex += mayNeedNoTriangles(query);
  }
  CHECK(convex > 60);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  opencl::BatchAnswer answer;
  REQUIRE(backend->collideBatch(queries, answer));
  CHECK(countWrong(answer, expected) == 0);
  CHECK(backend->counts().onHost == 0);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const bool byHost = std::find(answer.byHost.begin(), answer.byHost.end(), i) != answer.byHost.end();
    if (mayNeedNoTriangles(queries[i])) CHECK(byHost);
  }
  CHECK(answer.byHost.size() < queries.size() - 50);
  Workspace workspace;
  for (std::size_t i = 0; i < queries.size(); i += 7) {
    REQUIRE(backend->collide(queries[i], workspace));
    CHECK(sameBytes(workspace.reduced, expected[i]));
  }
}

TEST_CASE("what meets more on the way that its contacts ask for is the host's, alone and in a batch") {
  const MeshList meshes = cornered();
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  std::vector<Query> queries = touching(meshes, 9, 300, 0.001, 0.1);
  for (Query& query : queries) query.options.maxContacts = 1000;
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  opencl::BatchAnswer answer;
  REQUIRE(backend->collideBatch(queries, answer));
  CHECK(countWrong(answer, expected) == 0);
  const std::size_t again = madeAgain(queries, expected);
  CHECK(again > 10);
  // Some of these were left to the host before.
  CHECK(answer.madeAgain <= again);
  CHECK(answer.madeAgain > again / 2);
  CHECK(answer.stats.contactsBeforeReduction == foundOnHost(queries));
  CHECK(checkBatch(*backend, queries, expected) > 100);
  Workspace workspace;
  for (std::size_t i = 0; i < queries.size(); i += 5) {
    REQUIRE(backend->collide(queries[i], workspace));
    CHECK(sameBytes(workspace.reduced, expected[i]));
  }
  for (std::size_t i = 0; i < queries.size(); ++i) queries[i].options.maxContacts = static_cast<int>(1 + i % 4);
  checkBatch(*backend, queries, onHost(queries));
  REQUIRE(backend->collideBatch(queries, answer));
  CHECK(answer.stats.contactsBeforeReduction == foundOnHost(queries));
}

TEST_CASE("edges across edges are the device's") {
  Draw draw(12);
  MeshList meshes;
  for (int i = 0; i < 12; ++i) meshes.push_back(collisionMesh(spiky(draw)));
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  const std::vector<Query> queries = touching(meshes, 13, 400, 0, 0.02);
  CHECK(countPairsWith(isOfEdges, queries) > 100);
  CHECK(checkBatch(*backend, queries, onHost(queries)) > 380);
}

TEST_CASE("boxes upon each other are the device's") {
  MeshList meshes;
  for (const MeshArrays& arrays : {makeBox({1, 1, 1}, 1), makeBox({1, 1.5, 0.8}, 1), makeBox({2, 2, 0.5}, 4)}) {
    meshes.push_back(collisionMesh(arrays));
  }
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  // Sunk in by what a solver leaves, by nothing, by much; aligned, shifted along axes, trembling, turned about the
  // vertical by a right angle or any; one over the edge or corner of the other.
  Draw draw(8);
  std::vector<Query> queries;
  for (int i = 0; i < 400; ++i) {
    const CollisionMesh& a = *meshes[draw.below(3)];
    const CollisionMesh& b = *meshes[draw.below(3)];
    const double height = static_cast<double>(a.mesh().boundsMax().z - b.mesh().boundsMin().z);
    const double shift = i % 2 != 0 ? draw.uniform(-0.4, 0.4) : 0;
    const double tremble = std::vector<double>{0, 0, 1e-14, 1e-9, 1e-4}[draw.below(5)];
    const double turn = i % 3 == 0 ? 0 : i % 3 == 1 ? 1.5707963267948966 : draw.uniform(0, 3);
    Query query = makeQuery(a, b, makePose({tremble, 0.5 * tremble, 1}, turn, {shift, i % 5 == 0 ? shift : 0.0, 0}));
    if (turn == 0 && tremble == 0) query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, query.bInA.t};
    query.bInA.t.z = height - std::vector<double>{0, 1e-12, 1e-6, 1e-4, 2e-3, 0.05}[draw.below(6)];
    if (i % 7 == 0) query.bInA.t.x += a.mesh().boundsMax().x;
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 16;
    queries.push_back(query);
  }
  const std::size_t done = checkBatch(*backend, queries, onHost(queries));
  CHECK(done > 380);
}

TEST_CASE("boxes whose faces lie in part on each other, nearly parallel, are the device's") {
  const auto tall = collisionMesh(makeBox({1, 1, 2}, 2)), flat = collisionMesh(makeBox({1, 1.5, 0.8}, 1));
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  // Edges cross at the rims of the faces, where a ray along the normal runs in the wall beside the face.
  Draw draw(12);
  std::vector<Query> queries;
  for (int i = 0; i < 200; ++i) {
    const double turn = std::pow(10, draw.uniform(-5, -2)), depth = std::pow(10, draw.uniform(-5, -2));
    Query query = makeQuery(*tall, *flat, makePose(draw.direction(), turn, {0, 0, 0}));
    query.bInA.t = {1 - depth, draw.uniform(-1, 1), draw.uniform(-1.2, 1.2)};
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 16;
    queries.push_back(query);
  }
  const std::size_t done = checkBatch(*backend, queries, onHost(queries));
  CHECK(done > 150);
}

TEST_CASE("of regions of very many pieces the flat ones are the device's") {
  const auto fine = collisionMesh(makeBox({1, 1, 1}, 11)), coarse = collisionMesh(makeBox({3, 3, 3}, 1));
  const auto ball = collisionMesh(makeSphere(0.8, 3));
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  // A face of 242 triangles lies in another body, little deep. Of lenses as large the host makes faces of the pieces.
  Draw draw(10);
  std::vector<Query> flat, round;
  const auto add = [](std::vector<Query>& queries, const CollisionMesh& a, const CollisionMesh& b,
                      const Transformd& pose) {
    queries.push_back(makeQuery(a, b, pose));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 16;
  };
  for (int i = 0; i < 40; ++i) {
    const double depth = std::pow(10, draw.uniform(-5, -2.5));
    add(flat, *coarse, *fine,
        makePose({0, 0, 1}, draw.uniform(0.1, 1.4), {draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), 2 - depth}));
    add(round, *ball, *ball,
        makePose(draw.direction(), draw.uniform(0, 3), otgScale(draw.direction(), draw.uniform(1.25, 1.35))));
  }
  std::size_t most = 0;
  Workspace workspace;
  for (const Query& query : flat) {
    collide(query, workspace);
    for (const Contact& contact : workspace.reduced) CHECK(contact.coherence >= OTG_SOLID_FLAT);
    most = std::max(most, workspace.intersecting.size());
  }
  CHECK(most <= opencl::Tuning{}.solidLargeHits);
  CHECK(checkBatch(*backend, flat, onHost(flat)) == flat.size());
  CHECK(checkBatch(*backend, round, onHost(round)) < round.size());
}

TEST_CASE("the device makes the contacts of boxes in a valley that have a wedge beside a thin contact") {
  const MeshList meshes = {collisionMesh(samples::makeValley(0.5, 0.5, 8, 4)),
                           collisionMesh(samples::makeValley(1, 0.3, 8, 4)), collisionMesh(makeBox({0.6, 0.6, 0.6}, 1)),
                           collisionMesh(makeBox({0.6, 0.6, 0.6}, 3))};
  const auto backend = openBackend();
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  Draw draw(9);
  std::vector<Query> queries;
  for (int i = 0; i < 300; ++i) {
    // On the right side, a little in it, the leading lower edge beyond the kink by more or by less.
    const double angle = std::atan(i % 2 == 0 ? 0.5 : 0.3), sine = std::sin(angle), cosine = std::cos(angle);
    const double along = 0.3 - std::pow(10, draw.uniform(-7, -1)), up = 0.3 - std::pow(10, draw.uniform(-6, -2));
    const Vec3d place = {along * cosine - up * sine, draw.uniform(-1, 1), along * sine + up * cosine};
    const CollisionMesh& valley = *meshes[i % 2];
    const CollisionMesh& box = *meshes[2 + i / 2 % 2];
    Transformd valleyInBox = makePose({0, 1, 0}, angle, {0, 0, 0});
    valleyInBox.t = otgScale(otgRotate(valleyInBox, place), -1.0);
    queries.push_back(i % 3 == 0 ? makeQuery(box, valley, valleyInBox)
                                 : makeQuery(valley, box, makePose({0, -1, 0}, angle, place)));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 16;
  }
  const std::size_t wedges = countPairsWith(hasWedge, queries);
  INFO(wedges);
  CHECK(wedges > 60);
  CHECK(wedges < 240);
  // Left to the host: a corner that both slopes hold alike.
  CHECK(checkBatch(*backend, queries, onHost(queries)) >= queries.size() - 3);
}

TEST_CASE("contacts of a batch that contradict each other come out as on the CPU") {
  const MeshList meshes = {collisionMesh(makeBowl(1, 0.1, 16, 8)), collisionMesh(makeGear(12, 1, 0.2, 0.4, 0.3))};
  std::vector<Query> queries;
  std::vector<int> found;
  Workspace workspace;
  for (const Query& query : touching(meshes, 6, 6000, 0.1, 0.5)) {
    findIntersectingPairs(query, workspace);
    if (!solidContacts(query, workspace) || !contradict(workspace.contacts, smallerRadius(query))) continue;
    found.push_back(static_cast<int>(workspace.contacts.size()));
    queries.push_back(query);
  }
  opencl::Tuning tuning;
  tuning.leastOverlaps = std::numeric_limits<std::uint32_t>::max();  // the host chooses contacts of described pairs
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  for (const int missing : {0, 1, 3, 5, 8}) {  // places, of some: the device drops contacts
    for (std::size_t i = 0; i < queries.size(); ++i) queries[i].options.maxContacts = std::max(1, found[i] - missing);
    INFO(missing << " contacts have no place");
    const std::size_t byDevice = checkBatch(*backend, queries, onHost(queries));
    INFO(byDevice << " of " << queries.size());
    if (backend->device().doubles) CHECK((byDevice > 1) == (missing == 0));
  }
}

TEST_CASE("a batch of solids does not depend on the sizes of lists and work-groups") {
  const MeshList meshes = solids();
  const std::vector<Query> queries = touching(meshes, 4, 150, -0.01, 0.15);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  opencl::Tuning tuning;
  tuning.arenaUnits = 1;
  tuning.contactPlaces = 1;
  tuning.hitPlaces = 1;
  tuning.recordsExpected = 1;
  tuning.batchPairs = 60;
  auto backend = openBackend(tuning);
  REQUIRE(backend);
  const std::size_t done = checkBatch(*backend, queries, expected);
  if (backend->device().doubles) CHECK(backend->counts().repeats > 0);
  tuning = {};
  tuning.solidLargeHits = 32;  // most are left to the host
  backend = openBackend(tuning);
  REQUIRE(backend);
  CHECK(checkBatch(*backend, queries, expected) < done);
  // Those by threads of the caller's.
  std::vector<const CollisionMesh*> list;
  std::vector<opencl::MeshPair> pairs;
  for (const auto& mesh : meshes) list.push_back(mesh.get());
  const auto number = [&](const CollisionMesh* mesh) {
    return static_cast<std::uint32_t>(std::find(list.begin(), list.end(), mesh) - list.begin());
  };
  for (const Query& query : queries) pairs.push_back({number(query.a), number(query.b), query.bInA});
  const opencl::NumberedPairs batch{list, pairs, queries[0].options};
  std::size_t parts = 0;
  opencl::BatchAnswer answer;
  CHECK(backend->collideBatch(batch, answer, nullptr, [&](std::size_t count, const auto& work) {
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < 3; ++k) {
      threads.emplace_back([&, k] { work(count * k / 3, count * (k + 1) / 3); });
    }
    for (std::thread& thread : threads) thread.join();
    ++parts;
  }));
  CHECK(countWrong(answer, expected) == 0);
  if (backend->device().doubles) CHECK(parts > 0);
  // Two sizes of kernels, as devices with little local memory have them.
  tuning = {};
  tuning.solidSizes = 2;
  tuning.solidHits = 32;
  tuning.solidPoints = 96;
  tuning.solidFaces = 40;
  backend = openBackend(tuning);
  REQUIRE(backend);
  CHECK(checkBatch(*backend, queries, expected) == done);
  tuning = {};
  tuning.solid = false;
  CHECK(checkBatch(*openBackend(tuning), queries, expected) == 0);
  tuning.solid = true;
  tuning.doubles = false;
  CHECK(checkBatch(*openBackend(tuning), queries, expected) == 0);
}

TEST_CASE("what the device cannot do of a batch of solids the host does") {
  MeshList meshes = solids();
  // Sheets and shells, several components, an empty mesh, a body inside another, faces that lie upon each other.
  meshes.push_back(collisionMesh(MeshArrays{}));
  samples::Soup one;
  one.add({-1, -0.5f, 0}, {1, -0.5f, 0.1f}, {0, 1, 0});
  meshes.push_back(std::make_shared<CollisionMesh>(one.build(), BuildStrategy::kSah));
  MeshArrays two = makeBox({0.4, 0.4, 0.4}, 2);
  const auto moved = static_cast<std::uint32_t>(two.vertices.size());
  const MeshArrays box = two;
  for (Vec3f v : box.vertices) two.vertices.push_back({v.x + 0.7f, v.y, v.z});
  for (const Triangle& t : box.triangles) two.triangles.push_back({t.v[0] + moved, t.v[1] + moved, t.v[2] + moved});
  meshes.push_back(collisionMesh(two));
  std::vector<Query> queries;
  const auto add = [&](std::size_t a, std::size_t b, const Transformd& pose) {
    queries.push_back(makeQuery(*meshes[a], *meshes[b], pose));
    queries.back().options.contacts = ContactModel::kSolid;
    queries.back().options.maxContacts = 16;
  };
  const Transformd same = makePose({0, 0, 1}, 0, {0, 0, 0});
  for (std::size_t a = 0; a < meshes.size(); ++a) {
    for (std::size_t b = 0; b < meshes.size(); ++b) {
      if (meshes[a]->mesh().meshClass() != MeshClass::kSolid && meshes[b]->mesh().meshClass() != MeshClass::kSolid) {
        continue;  // contacts of the other model
      }
      add(a, b, same);
      add(a, b, makePose({0.36, 0.48, 0.8}, 0.4, {0.3, 0.1, 0.2}));
    }
  }
  const auto backend = openBackend();
  REQUIRE(backend);
  checkBatch(*backend, queries, onHost(queries));
  // Those that are given up for crossings in one point, among pairs whose overlaps are described.
  opencl::Tuning describing;
  describing.overlapHits = 1;
  describing.leastOverlaps = 1;
  const auto other = openBackend(describing);
  REQUIRE(other);
  checkBatch(*other, queries, onHost(queries));
  // Some with an option that only the host knows.
  for (std::size_t i = 0; i < queries.size(); i += 5) queries[i].options.solid.regionMerge = 0.05;
  checkBatch(*backend, queries, onHost(queries));
}

namespace {

struct Remembered {
  std::size_t deep = 0, byDevice = 0;
};

/// Five steps of pairs, three in four with histories: what these are is compared with the host's.
Remembered checkHistories(opencl::Backend& backend, std::vector<Query> queries) {
  std::vector<Query> forHost = queries;
  std::vector<SolidHistory> onDevice(queries.size()), host(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (i % 4 == 0) continue;
    queries[i].history = &onDevice[i];
    forHost[i].history = &host[i];
  }
  Draw draw(7);
  Remembered found;
  for (int step = 0; step < 5; ++step) {
    found.byDevice += checkBatch(backend, queries, onHost(forHost));
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      found.deep += otgDot(host[i].current.deepNormal, host[i].current.deepNormal) > 0;
      wrong += !same(onDevice[i].current, host[i].current) || !same(onDevice[i].before, host[i].before);
      const Vec3d move = otgScale(draw.direction(), step < 3 ? 0.005 : 0.3);
      if (step == 1) continue;  // the same pose again
      queries[i].bInA.t = otgAdd(queries[i].bInA.t, move);
      forHost[i].bInA.t = queries[i].bInA.t;
    }
    CHECK(wrong == 0);
  }
  return found;
}

}  // namespace

TEST_CASE("histories of pairs of a batch are what the host would have left") {
  const MeshList meshes = solids();
  const auto backend = openBackend();
  REQUIRE(backend);
  const std::vector<Query> queries = touching(meshes, 6, 80, -0.01, 0.2);
  const Remembered found = checkHistories(*backend, queries);
  // Few are left to the host, although many have deep regions.
  CHECK(found.deep > 100);
  if (backend->device().doubles) CHECK(found.byDevice + found.deep / 4 > 9 * queries.size() / 2);
}

TEST_CASE("histories are what the host would have left where it completes what the device made") {
  const MeshList meshes = cornered();
  const auto backend = openBackend();
  REQUIRE(backend);
  std::vector<Query> queries = touching(meshes, 9, 120, 0.001, 0.3);
  CHECK(madeAgain(queries, onHost(queries)) > 10);
  CHECK(checkHistories(*backend, queries).deep > 100);
}

TEST_CASE("a batch of solids comes out the same whatever call fails") {
  const MeshList meshes = solids();
  const std::vector<Query> queries = touching(meshes, 5, 24, 0, 0.1);
  const std::vector<std::vector<Contact>> expected = onHost(queries);
  opencl::setLogSink([](const std::string&) {});
  const auto backend = openBackend();
  REQUIRE(backend);
  const std::uint64_t before = opencl::FaultInjection::callCount();
  checkBatch(*backend, queries, expected);
  const std::uint64_t calls = opencl::FaultInjection::callCount() - before;
  CHECK(calls > 30);
  for (std::uint64_t n = 1; n <= calls + 40; ++n) {  // a lane that failed is made anew, which takes more calls
    opencl::FaultInjection::failAt(n, CL_OUT_OF_RESOURCES);
    opencl::BatchAnswer answer;
    backend->collideBatch(queries, answer);
    opencl::FaultInjection::failAt(0);
    REQUIRE(countWrong(answer, expected) == 0);
  }
  CHECK(backend->counts().onHost > 0);
  opencl::setLogSink({});
}
