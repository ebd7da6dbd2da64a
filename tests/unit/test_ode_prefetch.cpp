// SPDX-License-Identifier: BSD-3-Clause
// Prefetching: a world that prefetches goes on with the same bytes as one that does not. dCollide takes what is ready
// only where it is what it would compute.
#include "support/catch.h"
#include "support/ode_trimesh.h"
#include "support/pile_world.h"

using namespace otg;
using namespace otg::test;

namespace {

bool sameSums(const dGpuTriMeshStats& x, const dGpuTriMeshStats& y) {
  return x.queries == y.queries && x.failed_queries == y.failed_queries && x.box_tests == y.box_tests &&
         x.candidate_pairs == y.candidate_pairs && x.intersecting_pairs == y.intersecting_pairs &&
         x.decided_by_double == y.decided_by_double && x.decided_exactly == y.decided_exactly &&
         x.contacts_before_reduction == y.contacts_before_reduction && x.contacts == y.contacts;
}

/// Two entangled lumps in a space, whose history matters.
struct Entangled {
  Data lump{scenes::makeLump(0.5, 3, 0.4, 4)}, box{scenes::makeBox({1, 1, 1}, 3)};
  dSpaceID space = dSimpleSpaceCreate(nullptr);
  dGeomID a = dCreateGpuTriMesh(space, lump.id), b = dCreateGpuTriMesh(space, lump.id);
  Entangled() { dGeomSetPosition(b, 0.3, 0.2, 0.25); }
  ~Entangled() { dSpaceDestroy(space); }
  Entangled(const Entangled&) = delete;
  Entangled& operator=(const Entangled&) = delete;
  duint64 taken() const { return statsOf(a).prefetched; }
};

}  // namespace

TEST_CASE("a world with and without prefetch gives the same bytes") {
  const OdeSession session;
  std::vector<PileWorld::Choices> all(7);
  all[1].spaceClass = dSimpleSpaceClass;
  all[2].spaceClass = dSweepAndPruneSpaceClass;
  all[3].spaceClass = dQuadTreeSpaceClass;
  all[4].nested = true;
  all[5].pairwise = true;
  all[6].history = false;
  all[6].places = 3;  // what is ready has to be cut
  for (std::size_t i = 0; i < all.size(); ++i) {
    INFO("choice " << i);
    PileWorld plain(all[i]), ahead(all[i]);
    int ready = 0;
    plain.step(80);
    ahead.step(80, [&] { ready += dGpuTriMeshPrefetch(ahead.space()); });
    CHECK(plain.contacts() > 1000);
    CHECK(ahead.contacts() == plain.contacts());
    CHECK(ahead.bytes() == plain.bytes());
    CHECK(sameSums(ahead.stats(), plain.stats()));
    CHECK(plain.stats().prefetched == 0);
    // Every collision found its contacts ready, but for those of bounding boxes whose spheres are apart.
    CHECK(ahead.stats().prefetched == 2 * static_cast<duint64>(ready));
    CHECK(ready > ahead.collisions() / 2);
  }
}

TEST_CASE("a world whose spaces are collided into an array gives the same bytes") {
  const OdeSession session;
  std::vector<PileWorld::Choices> all(8);
  all[1].spaceClass = dSimpleSpaceClass;
  all[2].spaceClass = dSweepAndPruneSpaceClass;
  all[3].spaceClass = dQuadTreeSpaceClass;
  all[4].nested = true;
  all[5].pairwise = true;
  all[6].places = 3;
  all[7].nested = true;
  for (std::size_t i = 0; i < all.size(); ++i) {
    INFO("choice " << i);
    all[i].withShapes = true;
    PileWorld::Choices asArray = all[i];
    asArray.asArray = true;
    PileWorld plain(all[i]), array(asArray);
    CHECK(dGpuTriMeshSetThreadCount(i == 7 ? 1 : 3) == dGPUTRIMESH_OK);
    plain.step(80);
    array.step(80);
    CHECK(plain.contacts() > 1000);
    CHECK(array.contacts() == plain.contacts());
    CHECK(array.bytes() == plain.bytes());
    CHECK(sameSums(array.stats(), plain.stats()));
    CHECK((array.stats().prefetched > 0) == (i != 7));
  }
  CHECK(dGpuTriMeshSetThreadCount(0) == dGPUTRIMESH_OK);
}

TEST_CASE("an array that is too small, a filter, and what is refused") {
  const OdeSession session;
  Entangled pair;
  const dGeomID plane = dCreatePlane(pair.space, 0, 0, 1, 0.1), ball = dCreateSphere(pair.space, 0.3);
  dGeomSetPosition(ball, 0, 0, 0.35);
  const auto collide = [&](int capacity, int flags = 8, dGpuTriMeshPairFilter* filter = nullptr) {
    std::vector<dContactGeom> contacts(static_cast<std::size_t>(capacity));
    const int count =
        dGpuTriMeshCollideSpace(pair.space, flags, filter, ball, contacts.data(), sizeof(dContactGeom), capacity);
    CHECK(count >= 0);
    contacts.resize(static_cast<std::size_t>(std::max(count, 0)));
    return contacts;
  };
  const std::vector<dContactGeom> all = collide(100);
  CHECK(all.size() > 16);
  const auto isOf = [](const dContactGeom& c, dGeomID geom) { return c.g1 == geom || c.g2 == geom; };
  // Planes stand still, as all here; only ODE's own rules say what meets.
  CHECK(std::count_if(all.begin(), all.end(), [&](const dContactGeom& c) { return isOf(c, ball) && isOf(c, plane); }) ==
        1);
  CHECK(std::any_of(all.begin(), all.end(), [&](const dContactGeom& c) { return isOf(c, pair.a) && isOf(c, ball); }));
  for (const int capacity : {0, 1, 2, 7, static_cast<int>(all.size())}) {
    const std::vector<dContactGeom> some = collide(capacity);
    REQUIRE(some.size() == static_cast<std::size_t>(capacity));
    for (std::size_t i = 0; i < some.size(); ++i) {
      CHECK(some[i].g1 == all[i].g1);
      CHECK(some[i].g2 == all[i].g2);
    }
  }
  const auto withoutBall = [](void* data, dGeomID o1, dGeomID o2) { return int{o1 != data && o2 != data}; };
  const std::vector<dContactGeom> few = collide(100, 8, withoutBall);
  CHECK(few.size() < all.size());
  CHECK(std::none_of(few.begin(), few.end(), [&](const dContactGeom& c) { return isOf(c, ball); }));
  dContactGeom contact;
  const auto refused = [&](dSpaceID space, int flags, dContactGeom* place, int skip, int capacity) {
    dGpuTriMeshGetError();
    CHECK(dGpuTriMeshCollideSpace(space, flags, nullptr, nullptr, place, skip, capacity) == dGPUTRIMESH_ERROR_ARGUMENT);
    CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_ARGUMENT);
  };
  refused(nullptr, 1, &contact, sizeof contact, 1);
  refused(pair.space, 0, &contact, sizeof contact, 1);
  refused(pair.space, 1, nullptr, sizeof contact, 1);
  refused(pair.space, 1, &contact, sizeof contact - 1, 1);
  refused(pair.space, 1, &contact, sizeof contact, -1);
}

TEST_CASE("worlds that are prefetched together, by any number of threads") {
  const OdeSession session;
  std::vector<std::unique_ptr<PileWorld>> plain, ahead;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    PileWorld::Choices choices;
    choices.bodies = 4;
    choices.seed = seed;
    plain.push_back(std::make_unique<PileWorld>(choices));
    ahead.push_back(std::make_unique<PileWorld>(choices));
  }
  std::vector<dSpaceID> spaces;
  for (const auto& world : ahead) spaces.push_back(world->space());
  spaces.push_back(spaces[0]);  // done once
  for (int round = 0; round < 60; ++round) {
    CHECK(dGpuTriMeshSetThreadCount(1 + round % 4) == dGPUTRIMESH_OK);
    CHECK(dGpuTriMeshGetThreadCount() == 1 + round % 4);
    dGpuTriMeshPrefetchSpaces(spaces.data(), static_cast<int>(spaces.size()), nullptr, nullptr);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      plain[i]->step(1);
      ahead[i]->step(1);
    }
  }
  CHECK(dGpuTriMeshSetThreadCount(0) == dGPUTRIMESH_OK);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CHECK(ahead[i]->bytes() == plain[i]->bytes());
    CHECK(ahead[i]->stats().prefetched > 100);
  }
}

TEST_CASE("whatever differs is computed") {
  const OdeSession session;
  Entangled pair;
  const auto check = [&](bool expected, int capacity = 64, unsigned flags = 0) {
    const duint64 before = pair.taken();
    const std::vector<dContactGeom> found = test::collide(pair.a, pair.b, capacity, flags);
    CHECK(pair.taken() - before == (expected ? 1u : 0u));
    CHECK(!found.empty());
    return found;
  };
  const auto prefetch = [&] { CHECK(dGpuTriMeshPrefetch(pair.space) == 1); };
  const auto fresh = [&](int capacity = 64, unsigned flags = 0) {  // what a geom pair without prefetch would find
    const Geom a(pair.lump), b(pair.lump);
    dGeomSetPosition(b.id, dGeomGetPosition(pair.b)[0], dGeomGetPosition(pair.b)[1], dGeomGetPosition(pair.b)[2]);
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    dGeomGpuTriMeshGetParams(pair.b, &params);
    dGeomGpuTriMeshSetParams(b.id, &params);
    std::vector<dContactGeom> contacts = test::collide(a.id, b.id, capacity, flags);
    for (dContactGeom& c : contacts) {
      c.g1 = pair.a;
      c.g2 = pair.b;
    }
    return contacts;
  };
  check(false);  // nothing was prefetched
  prefetch();
  const std::vector<dContactGeom> all = check(true);
  CHECK(sameContacts(check(true), all));  // as often as it is asked for
  CHECK(sameContacts(test::collide(pair.b, pair.a, 64), mirrored(all)));
  CHECK(sameContacts(all, fresh()));
  for (const int capacity : {1, 2, 3, 5, 8, 13}) CHECK(sameContacts(check(true, capacity), fresh(capacity)));
  CHECK(sameContacts(check(false, 64, CONTACTS_UNIMPORTANT), fresh(64, CONTACTS_UNIMPORTANT)));
  CHECK(sameContacts(check(false), all));  // the pair was remembered anew by that call

  // One bit of the pose.
  dGeomSetPosition(pair.b, std::nextafter(0.3, 1), 0.2, 0.25);
  check(false);
  dGeomSetPosition(pair.b, 0.3, 0.2, 0.25);
  check(false);  // it now remembers another pose
  dGeomGpuTriMeshForgetHistory(pair.b);
  prefetch();
  check(true);
  // The parameters.
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  dGeomGpuTriMeshGetParams(pair.b, &params);
  params.contacts_per_region = 3;
  dGeomGpuTriMeshSetParams(pair.b, &params);
  check(false);
  prefetch();
  CHECK(check(true).size() <= 3 * all.size());
  params.max_contacts = 2;  // a cut list says nothing of others
  dGeomGpuTriMeshSetParams(pair.b, &params);
  prefetch();
  CHECK(sameContacts(check(true, 2), fresh(2)));
  CHECK(sameContacts(check(false, 1), fresh(1)));
  // History off.
  params.history = dGPUTRIMESH_HISTORY_OFF;
  dGeomGpuTriMeshSetParams(pair.b, &params);
  check(false);
  prefetch();
  check(true);
  // The mesh.
  const scenes::MeshArrays moved = scenes::makeLump(0.51, 3, 0.4, 4);
  CHECK(dGpuTriMeshDataUpdateVerticesSingle(pair.lump.id, moved.vertices.data(), 0,
                                            static_cast<int>(moved.vertices.size())) == dGPUTRIMESH_OK);
  check(false);
  prefetch();
  check(true);
  CHECK(dGeomGpuTriMeshSetData(pair.b, pair.box.id) == dGPUTRIMESH_OK);
  check(false);
}

TEST_CASE("a velocity that differs is computed") {
  const OdeSession session;
  Entangled pair;
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  dGeomSetBody(pair.b, body);
  dBodySetPosition(body, 0.3, 0.2, 0.25);
  dBodySetLinearVel(body, 0, 0, 1);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
  test::collide(pair.a, pair.b);
  CHECK(pair.taken() == 1);
  dBodySetLinearVel(body, 0, 1, 0);
  test::collide(pair.a, pair.b);
  CHECK(pair.taken() == 1);
  dWorldDestroy(world);
}

TEST_CASE("CollideEx takes what is ready, with its data") {
  const OdeSession session;
  Entangled pair;
  dContactGeom contacts[2][64];
  dGpuTriMeshContactData data[2][64];
  int count[2];
  for (int i = 0; i < 2; ++i) {
    count[i] = dGpuTriMeshCollideEx(pair.a, pair.b, 64, contacts[i], sizeof(dContactGeom), data[i],
                                    sizeof(dGpuTriMeshContactData));
    if (i == 0) CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
  }
  CHECK(pair.taken() == 1);
  REQUIRE(count[0] == count[1]);
  for (int i = 0; i < count[0]; ++i) {
    CHECK(sameContact(contacts[0][i], contacts[1][i]));
    CHECK(data[0][i].id == data[1][i].id);
    CHECK(data[0][i].triangle2 == data[1][i].triangle2);
    CHECK(data[0][i].coherence == data[1][i].coherence);
  }
}

TEST_CASE("which pairs are prefetched, and what is refused") {
  const OdeSession session;
  Entangled pair;
  const dGeomID far = dCreateGpuTriMesh(pair.space, pair.box.id), empty = dCreateGpuTriMesh(pair.space, nullptr);
  dGeomSetPosition(far, 10, 0, 0);
  dCreateRay(pair.space, 1);  // not worth the look-up
  (void)empty;
  CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
  dGeomSetCategoryBits(pair.a, 1);
  dGeomSetCollideBits(pair.a, 0);
  dGeomSetCategoryBits(pair.b, 2);
  dGeomSetCollideBits(pair.b, 0);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 0);
  dGeomSetCollideBits(pair.a, ~0ul);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 1);
  dGeomDisable(pair.a);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 0);
  dGeomEnable(pair.a);
  // The filter.
  struct Call {
    dGeomID a, b;
    int answer, calls;
  } call{pair.a, pair.b, 0, 0};
  const auto filter = [](void* data, dGeomID o1, dGeomID o2) {
    auto& c = *static_cast<Call*>(data);
    const bool meant = (o1 == c.a && o2 == c.b) || (o1 == c.b && o2 == c.a);
    if (meant) ++c.calls;
    return meant ? c.answer : 1;
  };
  CHECK(dGpuTriMeshPrefetchSpaces(&pair.space, 1, filter, &call) == 0);
  call.answer = 1;
  CHECK(dGpuTriMeshPrefetchSpaces(&pair.space, 1, filter, &call) == 1);
  CHECK(call.calls == 2);
  // A pose that dCollide refuses.
  dGeomSetPosition(pair.b, std::numeric_limits<dReal>::quiet_NaN(), 0, 0);
  CHECK(dGpuTriMeshPrefetch(pair.space) == 0);
  CHECK(statsOf(pair.b).failed_queries == 0);  // nobody has asked for it
  // Arguments.
  dGpuTriMeshGetError();
  const dSpaceID withNull[] = {pair.space, nullptr};
  CHECK(dGpuTriMeshPrefetch(nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshPrefetchSpaces(withNull, 2, nullptr, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshPrefetchSpaces(withNull, -1, nullptr, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshPrefetchSpaces(nullptr, 1, nullptr, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshPrefetchSpaces(nullptr, 0, nullptr, nullptr) == 0);
}

// Nothing in this file is taken over, which lasts as long as the process.
TEST_CASE("of dTriMeshes that were not taken over, only pairs with a mesh of this library are computed ahead") {
  const OdeSession session;
  const OdeMesh lump(scenes::makeLump(0.5, 3, 0.4, 4)), box(scenes::makeBox({1, 0.8, 0.6}, 2));
  const Data data(scenes::makeBox({1, 1, 1}, 2));
  const dSpaceID space = dSimpleSpaceCreate(nullptr);
  const dGeomID a = dCreateTriMesh(space, lump.id, nullptr, nullptr, nullptr);
  const dGeomID b = dCreateTriMesh(space, box.id, nullptr, nullptr, nullptr);
  dCreateSphere(space, 0.5);
  dGeomSetPosition(b, 0.3, 0.2, 0.45);
  CHECK(dGpuTriMeshPrefetch(space) == 0);
  const dGeomID own = dCreateGpuTriMesh(space, data.id);
  dGeomSetPosition(own, 0.2, -0.1, 0.4);
  CHECK(dGpuTriMeshPrefetch(space) == 3);
  const auto ready = test::collide(own, a);
  CHECK(statsOf(own).prefetched == 1);
  CHECK(!ready.empty());
  dGpuTriMeshOverrideForgetGeom(a);
  CHECK(sameContacts(test::collide(own, a), ready));
  CHECK(statsOf(own).prefetched == 1);
  // Arrays know dTriMeshes only when they are taken over.
  const dGpuTriMeshPair pairs[] = {{own, a}};
  dContactGeom contacts[4];
  int count = 0;
  CHECK(dGpuTriMeshCollidePairs(pairs, 1, 4, contacts, sizeof(dContactGeom), &count) == dGPUTRIMESH_ERROR_CLASS);
  CHECK(dGpuTriMeshBatchSubmit(pairs, 1, 4) == nullptr);
  for (const dGeomID g : {a, b}) dGpuTriMeshOverrideForgetGeom(g);
  dSpaceDestroy(space);
}
