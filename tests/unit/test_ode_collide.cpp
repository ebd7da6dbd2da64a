// SPDX-License-Identifier: BSD-3-Clause
// The collider function as dCollide shows it: what a contact says, call order, capacity, skip, flags, poses,
// parameters.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "ode/pairs/mesh_collider.h"
#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

dGpuTriMeshParams paramsOf(dGeomID g) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  CHECK(dGeomGpuTriMeshGetParams(g, &params) == dGPUTRIMESH_OK);
  return params;
}

void setReduction(dGeomID g, int reduction) {
  dGpuTriMeshParams params = paramsOf(g);
  params.reduction = reduction;
  CHECK(dGeomGpuTriMeshSetParams(g, &params) == dGPUTRIMESH_OK);
}

}  // namespace

TEST_CASE("contacts say what ODE's contacts say, in world coordinates, at any pose") {
  const OdeSession session;
  const Data lumpData(scenes::makeLump(1, 3, 0.3, 3)), torusData(scenes::makeTorus(1, 0.4, 16, 10));
  const Geom lump(lumpData), torus(torusData);
  test::usePairwise(lump.id);
  std::mt19937 random(11);
  std::size_t seen = 0;
  for (int i = 0; i < 40; ++i) {
    setRandomPose(lump.id, random, 1);
    setRandomPose(torus.id, random, 1);
    setReduction(lump.id, i % 3);
    for (const dContactGeom& c : test::collide(lump.id, torus.id)) {
      ++seen;
      REQUIRE(c.g1 == lump.id);
      REQUIRE(c.g2 == torus.id);
      REQUIRE(std::string(contactFault(c, 1e-9)) == "");
    }
  }
  CHECK(seen > 200);
}

TEST_CASE("contacts lie in the boxes of both geoms") {
  const OdeSession session;
  const Data data[] = {Data(scenes::makeBox({1, 2, 1.5})), Data(scenes::makeLump(1, 3, 0.3, 3)),
                       Data(scenes::makeTorus(1, 0.4, 16, 10)), Data(scenes::makeBox({0.3, 0.3, 3}))};
  const Geom first[] = {Geom(data[0]), Geom(data[1]), Geom(data[2]), Geom(data[3])};
  const Geom second[] = {Geom(data[0]), Geom(data[1]), Geom(data[2]), Geom(data[3])};
  std::mt19937 random(12);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < 640; ++i) {
    const dGeomID a = first[i % 4].id, b = second[i / 4 % 4].id;
    setRandomPose(a, random, 1);
    setRandomPose(b, random, 1);
    dReal boxOfA[6], boxOfB[6];
    dGeomGetAABB(a, boxOfA);
    dGeomGetAABB(b, boxOfB);
    for (const dContactGeom& c : test::collide(a, b)) {
      ++seen;
      for (std::size_t k = 0; k < 3; ++k) {
        REQUIRE(c.pos[k] >= std::max(boxOfA[2 * k], boxOfB[2 * k]) - 1e-12);
        REQUIRE(c.pos[k] <= std::min(boxOfA[2 * k + 1], boxOfB[2 * k + 1]) + 1e-12);
      }
    }
  }
  CHECK(seen > 1000);
}

TEST_CASE("triangles of contacts carry the caller's numbers, of any contacts too") {
  const OdeSession session;
  const Data lumpData(scenes::makeLump(1, 3, 0.3, 3)), torusData(scenes::makeTorus(1, 0.4, 16, 10));
  const Geom lump(lumpData), torus(torusData);
  std::mt19937 random(13);
  std::size_t seen = 0;
  for (int i = 0; i < 20; ++i) {
    setRandomPose(lump.id, random, 1);
    setRandomPose(torus.id, random, 1);
    for (const dContactGeom& c : test::collide(lump.id, torus.id, 64, CONTACTS_UNIMPORTANT)) {
      ++seen;
      REQUIRE(std::string(contactFault(c, 1e-9)) == "");
    }
  }
  CHECK(seen > 200);
}

TEST_CASE("the normal points into g1") {
  // A small tetrahedron whose tip dips a little into a large ground: the only short way out of its faces is up.
  const OdeSession session;
  const Data ground(scenes::makeGround(20, 1, 2));
  const Data tip(scenes::makeTetrahedron({0, 0, 0}, {1, 0, 2}, {-1, 1, 2}, {-1, -1, 2}));
  const Geom floor(ground), upper(tip);
  dGeomSetPosition(upper.id, 1.3, 0.7, -0.01);
  const auto contacts = test::collide(upper.id, floor.id);
  REQUIRE(!contacts.empty());
  for (const dContactGeom& c : contacts) {
    CHECK(c.normal[2] > 0.999);
    CHECK(std::abs(c.depth - 0.01) < 1e-6);
  }
  for (const dContactGeom& c : test::collide(floor.id, upper.id)) CHECK(c.normal[2] < -0.999);
}

TEST_CASE("dCollide(a, b) and dCollide(b, a) mirror each other exactly") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 2)), lump(scenes::makeLump(1, 2, 0.3, 9));
  const Geom a(sphere), b(lump), c(sphere);
  std::mt19937 random(5);
  std::size_t seen = 0;
  for (int i = 0; i < 60; ++i) {
    const dGeomID o1 = i % 2 ? a.id : c.id, o2 = i % 3 ? b.id : a.id;
    if (o1 == o2) continue;
    setRandomPose(o1, random, 0.8);
    setRandomPose(o2, random, 0.8);
    for (const int capacity : {4096, 5, 1}) {
      for (const unsigned flag : {0u, CONTACTS_UNIMPORTANT}) {
        const auto forward = test::collide(o1, o2, capacity, flag);
        const auto backward = test::collide(o2, o1, capacity, flag);
        REQUIRE(sameContacts(forward, mirrored(backward)));
        REQUIRE(sameContacts(forward, test::collide(o1, o2, capacity, flag)));
        seen += forward.size();
      }
    }
  }
  CHECK(seen > 500);
}

TEST_CASE("parameters of the two geoms combine in the same way in both orders") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 3)), lump(scenes::makeLump(1, 3, 0.3, 9));
  const Geom a(sphere), b(lump);
  dGeomSetPosition(b.id, 0.9, 0.4, 0.1);
  dGpuTriMeshParams pa = paramsOf(a.id), pb = pa;
  pa.reduction = dGPUTRIMESH_REDUCTION_CONE;
  pa.bins[2] = 9;
  pa.max_contacts = 12;
  pb.bins[4] = 7;
  CHECK(dGeomGpuTriMeshSetParams(a.id, &pa) == dGPUTRIMESH_OK);
  CHECK(dGeomGpuTriMeshSetParams(b.id, &pb) == dGPUTRIMESH_OK);
  const auto forward = test::collide(a.id, b.id);
  CHECK(!forward.empty());
  CHECK(forward.size() <= 12);
  CHECK(sameContacts(forward, mirrored(test::collide(b.id, a.id))));
  for (const bool swapped : {false, true}) {
    const CollideOptions options = swapped ? pairOptions(pb, pa) : pairOptions(pa, pb);
    CHECK(options.reduction.method == Reduction::kBinning);
    CHECK(options.reduction.bins == std::array<int, 6>{3, 3, 9, 3, 7, 3});
    CHECK(options.maxContacts == 12);
  }
}

TEST_CASE("no choice of traversal, descent or box axes changes a contact") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 3)), lump(scenes::makeLump(1, 3, 0.3, 9));
  const Geom a(sphere), b(lump);
  dGeomSetPosition(b.id, 0.9, 0.4, 0.1);
  const auto expected = test::collide(a.id, b.id);
  REQUIRE(!expected.empty());
  for (int traversal = dGPUTRIMESH_TRAVERSAL_STANDARD; traversal <= dGPUTRIMESH_TRAVERSAL_LEVELS; ++traversal) {
    for (int descent = dGPUTRIMESH_DESCENT_FIRST_TREE; descent <= dGPUTRIMESH_DESCENT_BOTH; ++descent) {
      for (const int axes : {6, 15}) {
        dGpuTriMeshParams params = paramsOf(a.id);
        params.traversal = traversal;
        params.descent = descent;
        params.box_axes = axes;
        CHECK(dGeomGpuTriMeshSetParams(a.id, &params) == dGPUTRIMESH_OK);
        CHECK(sameContacts(test::collide(a.id, b.id), expected));
        const dGpuTriMeshParams back = paramsOf(a.id);
        CHECK(std::memcmp(&back, &params, sizeof(params)) == 0);
      }
    }
  }
}

TEST_CASE("parameters out of range are refused and the geom keeps its own") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom geom(box);
  const dGpuTriMeshParams good = paramsOf(geom.id);
  const auto refused = [&](auto change, int status) {
    dGpuTriMeshParams bad = good;
    change(bad);
    CHECK(dGeomGpuTriMeshSetParams(geom.id, &bad) == status);
    const dGpuTriMeshParams kept = paramsOf(geom.id);
    CHECK(std::memcmp(&kept, &good, sizeof(good)) == 0);
  };
  refused([](auto& p) { p.size = 4; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.traversal = dGPUTRIMESH_TRAVERSAL_LEVELS + 1; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.descent = -1; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.box_axes = 7; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.contact_model = 3; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.reduction = 3; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.bins[5] = 65; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.bins[0] = 0; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.max_contacts = 0; }, dGPUTRIMESH_ERROR_ARGUMENT);
  refused([](auto& p) { p.max_contacts = 65536; }, dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshSetParams(geom.id, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshGetParams(geom.id, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  dGpuTriMeshParams out = good;
  CHECK(dGeomGpuTriMeshSetParams(nullptr, &good) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshGetParams(nullptr, &out) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_CLASS);
}

TEST_CASE("any capacity is kept to, and the deepest contact is always among the kept") {
  const OdeSession session;
  const Data a(scenes::makeLump(1, 4, 0.3, 2)), b(scenes::makeLump(1, 4, 0.3, 4));
  const Geom ga(a), gb(b);
  dGeomSetPosition(gb.id, 0.6, 0.5, 0.3);
  test::usePairwise(ga.id);
  setReduction(ga.id, dGPUTRIMESH_REDUCTION_NONE);
  const auto all = test::collide(ga.id, gb.id, 65535);
  REQUIRE(all.size() > 100);
  dReal deepest = 0;
  for (const dContactGeom& c : all) deepest = std::max(deepest, c.depth);
  for (const int capacity : {1, 2, 3, 7, 64, 100, 65535}) {
    const auto some = test::collide(ga.id, gb.id, capacity);
    CHECK(some.size() == std::min(all.size(), static_cast<std::size_t>(capacity)));
    CHECK(std::any_of(some.begin(), some.end(), [&](const dContactGeom& c) { return c.depth == deepest; }));
    for (const dContactGeom& c : some) {
      CHECK(std::any_of(all.begin(), all.end(), [&](const dContactGeom& d) { return sameContact(c, d); }));
    }
    const auto any = test::collide(ga.id, gb.id, capacity, CONTACTS_UNIMPORTANT);
    CHECK(any.size() == some.size());
  }
}

TEST_CASE("only the contacts are written, whatever the skip") {
  const OdeSession session;
  const Data lump(scenes::makeLump(0.5, 3, 0.1, 1));  // not convex: more contacts than places
  const Geom a(lump), b(lump);
  dGeomSetPosition(b.id, 0.2, 0.3, 0.9);
  const auto expected = test::collide(a.id, b.id, 6);
  REQUIRE(expected.size() == 6);
  // An odd skip is nothing that ODE's own structures lead to; it shows that no alignment is taken for granted.
  for (const std::size_t skip : {sizeof(dContactGeom), sizeof(dContact), sizeof(dContactGeom) + 8, std::size_t{131}}) {
    constexpr std::size_t kBefore = 16;
    std::vector<unsigned char> buffer(kBefore + 6 * skip + 64, 0xab);
    auto* const first = reinterpret_cast<dContactGeom*>(buffer.data() + kBefore);
    REQUIRE(dCollide(b.id, a.id, 6, first, static_cast<int>(skip)) >= 0);  // either order; next one is compared
    std::fill(buffer.begin(), buffer.end(), static_cast<unsigned char>(0xab));
    // The collider itself: dCollide's own exchange of sides would read misaligned elements.
    const bool aligned = skip % alignof(dContactGeom) == 0;
    const int n = aligned ? dCollide(a.id, b.id, 6, first, static_cast<int>(skip))
                          : collideMeshMesh(a.id, b.id, 6, first, static_cast<int>(skip));
    REQUIRE(n == 6);
    bool guardsWhole = true;
    for (std::size_t i = 0; i < buffer.size(); ++i) {
      const bool inContact = i >= kBefore && i - kBefore < 6 * skip && (i - kBefore) % skip < sizeof(dContactGeom);
      if (!inContact) guardsWhole = guardsWhole && buffer[i] == 0xab;
    }
    CHECK(guardsWhole);
    for (std::size_t i = 0; i < 6; ++i) {
      dContactGeom c;
      std::memcpy(&c, buffer.data() + kBefore + i * skip, sizeof(c));
      CHECK(sameContact(c, expected[i]));
    }
  }
  // Too small a skip would make contacts overlap: one is given.
  dContactGeom one;
  CHECK(collideMeshMesh(a.id, b.id, 6, &one, 0) == 1);
}

TEST_CASE("without contacts the array stays untouched") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1})), none(scenes::MeshArrays{});
  const Geom a(box), b(box), empty(none);
  const dGeomID bare = dCreateGpuTriMesh(nullptr, nullptr);
  unsigned char buffer[sizeof(dContactGeom)];
  std::memset(buffer, 0x5a, sizeof(buffer));
  dContactGeom* const contact = reinterpret_cast<dContactGeom*>(buffer);
  dGeomSetPosition(b.id, 1.5, 0, 0);
  const dReal nan = std::numeric_limits<dReal>::quiet_NaN(), inf = std::numeric_limits<dReal>::infinity();
  int answered = dCollide(a.id, b.id, 1, contact, sizeof(dContactGeom));
  for (const dReal x : {nan, inf, -inf, dReal(1e300), dReal(1e30), dReal(1e18)}) {
    dGeomSetPosition(b.id, x, 0, 0);
    answered += dCollide(a.id, b.id, 1, contact, sizeof(dContactGeom));
    answered += dCollide(b.id, a.id, 1, contact, sizeof(dContactGeom));
  }
  dGeomSetPosition(b.id, 0, 0, 0);
  dMatrix3 r = {nan, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  dGeomSetRotation(b.id, r);
  answered += dCollide(a.id, b.id, 1, contact, sizeof(dContactGeom));
  answered += dCollide(a.id, empty.id, 1, contact, sizeof(dContactGeom));
  answered += dCollide(a.id, bare, 1, contact, sizeof(dContactGeom));
  CHECK(answered == 0);
  CHECK(std::all_of(buffer, buffer + sizeof(buffer), [](unsigned char c) { return c == 0x5a; }));
  CHECK(statsOf(b.id).failed_queries == 7);  // NaN and both infinities in both orders, and the rotation
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_POSE);
  dGeomDestroy(bare);
}

TEST_CASE("geoms whose pose is not rigid have no contacts, and the report says so once for each call") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom a(box), b(box);
  const auto poseBy = [](dGeomID g, dReal scaleX, dReal scaleYZ, dReal shear) {
    const dMatrix3 r = {scaleX, shear, 0, 0, 0, scaleYZ, 0, 0, 0, 0, scaleYZ, 0};
    dGeomSetRotation(g, r);
    dGeomSetPosition(g, 0, 0, 0);
  };
  dGeomSetPosition(a.id, 0.8, 0.1, 0.2);
  const auto refused = [&](dGeomID first, dGeomID second) {
    for (const bool swapped : {false, true}) {
      const auto before = statsOf(b.id);
      CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_OK);
      CHECK(test::collide(swapped ? second : first, swapped ? first : second).empty());
      CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_POSE);
      CHECK(statsOf(b.id).queries == before.queries + 1);
      CHECK(statsOf(b.id).failed_queries == before.failed_queries + 1);
      CHECK(statsOf(b.id).box_tests == before.box_tests);
    }
  };
  struct Case {
    dReal scaleX, scaleYZ, shear;
  };
  for (const Case& c :
       {Case{2, 2, 0}, {1.001, 1.001, 0}, {1, 1, 0.01}, {-1, 1, 0}, {1, -1, 0.5}, {-1, -1, 0}, {0, 1, 0}}) {
    poseBy(b.id, c.scaleX, c.scaleYZ, c.shear);
    refused(a.id, b.id);
  }
  // Both scaled, so that the one's frame in the other's is a rotation again.
  poseBy(a.id, 2, 2, 0);
  poseBy(b.id, 2, 2, 0);
  refused(a.id, b.id);
  // Near enough: still collides.
  poseBy(a.id, 1.0001, 1.0002, 3e-4);
  poseBy(b.id, 0.9999, 1, -1e-4);
  CHECK(!test::collide(a.id, b.id).empty());
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_OK);
}

TEST_CASE("rotations in single precision, chains of offsets and years of steps stay rigid") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom a(box), b(box);
  std::mt19937 random(2);
  const auto single = [](dMatrix3 r) {
    for (int i = 0; i < 12; ++i) r[i] = static_cast<float>(r[i]);
  };
  // Products of many rotations, every one rounded to single precision, set on geoms without a body (ODE would make a
  // body's orthonormal).
  dMatrix3 product, turn, next;
  randomRotation(product, random);
  for (int i = 0; i < 1000; ++i) {
    randomRotation(turn, random);
    dMultiply0(next, product, turn, 3, 3, 3);
    single(next);
    std::copy(next, next + 12, product);
    if (i % 100 != 99) continue;
    dGeomSetRotation(a.id, product);
    dGeomSetRotation(b.id, turn);
    CHECK(!test::collide(a.id, b.id).empty());
  }
  // A body with an offset geom, tumbling for 10,000 steps.
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  dGeomSetBody(b.id, body);
  dGeomSetOffsetRotation(b.id, product);
  dBodySetAngularVel(body, 7, -5, 3);
  for (int i = 0; i < 10000; ++i) dWorldQuickStep(world, 0.01);
  CHECK(!test::collide(a.id, b.id).empty());
  CHECK(statsOf(b.id).failed_queries == 0);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_OK);
  dGeomSetBody(b.id, nullptr);
  dWorldDestroy(world);
}

TEST_CASE("geoms of other classes that are far away have no contacts, and may be asked again") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom mesh(box);
  const dGeomID others[] = {dCreateSphere(nullptr, 1),     dCreateBox(nullptr, 1, 1, 1),
                            dCreateCapsule(nullptr, 1, 1), dCreateCylinder(nullptr, 1, 1),
                            dCreateRay(nullptr, 3),        dCreatePlane(nullptr, 0, 0, 1, -5)};
  for (const dGeomID other : others) {
    if (dGeomGetClass(other) != dPlaneClass) dGeomSetPosition(other, 5, 5, 5);
  }
  for (int round = 0; round < 2; ++round) {
    for (const dGeomID other : others) {
      CHECK(test::collide(mesh.id, other).empty());
      CHECK(test::collide(other, mesh.id).empty());
    }
  }
  for (const dGeomID other : others) dGeomDestroy(other);
}

TEST_CASE("far from the world's origin the contacts are as good as near it") {
  const OdeSession session;
  const Data box(scenes::makeBox({1, 1, 1})), lump(scenes::makeLump(1, 3, 0.3, 9));
  const Geom a(box), b(lump);
  dGeomSetPosition(b.id, 0.75, 0.5, 0.25);
  const auto near = test::collide(a.id, b.id);
  REQUIRE(!near.empty());
  constexpr dReal kFar = 1048576;  // a power of two, so that differences of positions are exact
  dGeomSetPosition(a.id, kFar, -kFar, kFar);
  dGeomSetPosition(b.id, kFar + 0.75, 0.5 - kFar, kFar + 0.25);
  const auto far = test::collide(a.id, b.id);
  REQUIRE(far.size() == near.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    CHECK(far[i].side1 == near[i].side1);
    CHECK(far[i].depth == near[i].depth);
    CHECK(std::abs(far[i].pos[0] - kFar - near[i].pos[0]) < 1e-9);
  }
}

TEST_CASE("statistics count queries and pairs, and can be reset") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 3)), lump(scenes::makeLump(1, 2, 0.3, 9));
  const Geom a(sphere), b(lump);
  dGeomSetPosition(b.id, 0.9, 0.4, 0.1);
  const auto contacts = test::collide(a.id, b.id);
  // Mesh A has more triangles. The same query without ODE in between.
  const auto meshFor = [](const scenes::MeshArrays& arrays) {
    return buildTriMesh(arrays.input(), {}, MeshOrder::kBySize).mesh;
  };
  const CollisionMesh treeA(meshFor(scenes::makeSphere(1, 3)), BuildStrategy::kSah);
  const CollisionMesh treeB(meshFor(scenes::makeLump(1, 2, 0.3, 9)), BuildStrategy::kSah);
  Query query;
  query.a = &treeA;
  query.b = &treeB;
  query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.9, 0.4, 0.1}};
  query.options.maxContacts = 4096;
  query.options.contacts = ContactModel::kSolid;
  Workspace workspace;
  otg::collide(query, workspace);
  REQUIRE(workspace.reduced.size() == contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    CHECK(contacts[i].side1 == static_cast<int>(workspace.reduced[i].triangleA));
    CHECK(contacts[i].side2 == static_cast<int>(workspace.reduced[i].triangleB));
    CHECK(contacts[i].depth == workspace.reduced[i].depth);
  }
  for (const dGeomID g : {a.id, b.id}) {
    const dGpuTriMeshStats stats = statsOf(g);
    CHECK(stats.queries == 1);
    CHECK(stats.failed_queries == 0);
    CHECK(stats.box_tests == workspace.stats.boxTests);
    CHECK(stats.candidate_pairs == workspace.stats.candidatePairs);
    CHECK(stats.intersecting_pairs == workspace.intersecting.size());
    CHECK(stats.contacts_before_reduction == workspace.contacts.size());
    CHECK(stats.contacts == contacts.size());
  }
  test::collide(b.id, a.id);
  CHECK(statsOf(a.id).queries == 2);
  CHECK(statsOf(a.id).intersecting_pairs == 2 * workspace.intersecting.size());
  CHECK(dGeomGpuTriMeshResetStats(a.id) == dGPUTRIMESH_OK);
  CHECK(statsOf(a.id).contacts == 0);
  CHECK(statsOf(a.id).queries == 0);
  CHECK(statsOf(b.id).queries == 2);
  dGpuTriMeshStats stats;
  stats.size = 1;
  CHECK(dGeomGpuTriMeshGetStats(a.id, &stats) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGeomGpuTriMeshGetStats(nullptr, &stats) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGeomGpuTriMeshResetStats(nullptr) == dGPUTRIMESH_ERROR_CLASS);
}
