// SPDX-License-Identifier: BSD-3-Clause
// dTriMesh geoms that collide through this library, ahead of their near callbacks and in arrays of pairs: the same
// bytes as one by one, and whatever has changed is computed.
#include <cstring>
#include <functional>
#include <memory>

#include "support/catch.h"
#include "support/ode_trimesh.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

dGpuTriMeshOverrideStats sums() {
  dGpuTriMeshOverrideStats stats;
  dGpuTriMeshOverrideStatsInit(&stats);
  CHECK(dGpuTriMeshOverrideGetStats(&stats) == dGPUTRIMESH_OK);
  return stats;
}

/// Lumps and boxes, most of them dTriMeshes, and shapes of ODE's that fall on a dTriMesh, with a plane below.
class MixedWorld {
 public:
  explicit MixedWorld(bool history) {
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetERP(world_, 0.2);
    dWorldSetCFM(world_, 1e-5);
    dWorldSetContactMaxCorrectingVel(world_, 1);
    add(dCreateTriMesh(space_, ground_.id, nullptr, nullptr, nullptr));
    geoms_.push_back(dCreatePlane(space_, 0, 0, 1, -1.5));
    std::mt19937 random(5);
    for (int i = 0; i < 14; ++i) {
      const dGeomID made = i % 7 == 5   ? dCreateGpuTriMesh(space_, own_.id)
                           : i % 7 == 6 ? dCreateSphere(space_, 0.3)
                           : i % 7 == 4 ? dCreateBox(space_, 0.5, 0.4, 0.6)
                                        : dCreateTriMesh(space_, i % 2 ? lump_.id : box_.id, nullptr, nullptr, nullptr);
      add(made);
      const dBodyID body = dBodyCreate(world_);
      dMass mass;
      dMassSetBoxTotal(&mass, 1, 0.5, 0.5, 0.5);
      dBodySetMass(body, &mass);
      dGeomSetBody(made, body);
      dBodySetPosition(body, 0.6 * (i % 4) - 0.9, 0.6 * (i / 4) - 0.9, 0.6 + 0.05 * (i % 3));
      dMatrix3 turn;
      randomRotation(turn, random);
      dBodySetRotation(body, turn);
    }
    if (history) return;  // and their order is that in which they are collided first
    for (const dGeomID geom : geoms_) {
      dGpuTriMeshParams params;
      dGpuTriMeshParamsInit(&params);
      params.history = dGPUTRIMESH_HISTORY_OFF;
      dGeomGpuTriMeshSetParams(geom, &params);
    }
  }
  ~MixedWorld() {
    for (const dGeomID geom : geoms_) dGpuTriMeshOverrideForgetGeom(geom);
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  MixedWorld(const MixedWorld&) = delete;
  MixedWorld& operator=(const MixedWorld&) = delete;

  void step() {
    dSpaceCollide(space_, this, &MixedWorld::near);
    dWorldStep(world_, 0.005);
    dJointGroupEmpty(joints_);
  }
  /// Everything that a step depends on, and the contacts so far.
  std::vector<unsigned char> bytes() const {
    std::vector<unsigned char> all = contacts_, state = stateOf(geoms_);
    all.insert(all.end(), state.begin(), state.end());
    return all;
  }
  dSpaceID space() const { return space_; }
  dGeomID ground() const { return geoms_[0]; }

 private:
  void add(dGeomID geom) {
    dGpuTriMeshOverrideForgetGeom(geom);  // the one that was at this address
    geoms_.push_back(geom);
  }
  static void near(void* self, dGeomID o1, dGeomID o2) {
    auto& world = *static_cast<MixedWorld*>(self);
    appendPositions(joinContacts(world.world_, world.joints_, o1, o2, 24), world.contacts_);
  }
  OdeMesh ground_{scenes::makeGround(8, 1, 8)}, lump_{scenes::makeLump(0.4, 2, 0.3, 2)};
  OdeMesh box_{scenes::makeBox({0.5, 0.4, 0.6}, 2)};
  Data own_{scenes::makeTorus(0.35, 0.15, 14, 8)};
  dWorldID world_ = dWorldCreate();
  dSpaceID space_ = dHashSpaceCreate(nullptr);
  dJointGroupID joints_ = dJointGroupCreate(0);
  std::vector<dGeomID> geoms_;
  std::vector<unsigned char> contacts_;
};

/// Two dTriMeshes that overlap, in a space.
struct Overlapping {
  OdeMesh lump{scenes::makeLump(0.5, 3, 0.4, 4)}, box{scenes::makeBox({1, 0.8, 0.6}, 2)};
  dSpaceID space = dSimpleSpaceCreate(nullptr);
  dGeomID a = dCreateTriMesh(space, lump.id, nullptr, nullptr, nullptr);
  dGeomID b = dCreateTriMesh(space, box.id, nullptr, nullptr, nullptr);
  Overlapping() {
    forget();
    dGeomSetPosition(b, 0.3, 0.2, 0.45);
  }
  ~Overlapping() {
    forget();
    dSpaceDestroy(space);
  }
  Overlapping(const Overlapping&) = delete;
  Overlapping& operator=(const Overlapping&) = delete;
  void forget() const {
    for (const dGeomID g : {a, b}) dGpuTriMeshOverrideForgetGeom(g);
  }
  /// As if they had never been seen, the first one before the second.
  void renew() const {
    forget();
    for (const dGeomID g : {a, b}) REQUIRE(dGpuTriMeshOverridePrepare(g) == dGPUTRIMESH_OK);
  }
  std::vector<dContactGeom> anew() const {
    renew();
    return test::collide(a, b);
  }
};

int refuseAll(dGeomID, dGeomID, int) {
  return 0;
}

}  // namespace

TEST_CASE("a world of dTriMeshes with and without prefetch gives the same bytes") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
  for (const bool history : {true, false}) {
    INFO("history " << history);
    MixedWorld plain(history), ahead(history);
    for (int step = 0; step < 100; ++step) {
      CHECK(dGpuTriMeshSetThreadCount(1 + step % 3) == dGPUTRIMESH_OK);
      plain.step();
      CHECK(dGpuTriMeshPrefetch(ahead.space()) > 0);
      ahead.step();
      if (step % 20 != 19) continue;
      const bool same = ahead.bytes() == plain.bytes();
      REQUIRE(same);
    }
    const dGpuTriMeshStats x = statsOf(ahead.ground()), y = statsOf(plain.ground());
    CHECK(x.queries == y.queries);
    CHECK(x.contacts == y.contacts);
    CHECK(x.contacts > 500);
    CHECK(y.prefetched == 0);
    CHECK(x.prefetched + 100 > x.queries);  // but for bounding boxes whose spheres are apart
  }
  CHECK(dGpuTriMeshSetThreadCount(0) == dGPUTRIMESH_OK);
}

TEST_CASE("what has changed since the prefetch is computed: poses, vertices, data, callbacks, geoms that are gone") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  Overlapping pair;
  /// Whether dCollide took what was ready. Either way it has to give what a pair has that is seen for the first time.
  const auto taken = [&] {
    const duint64 before = statsOf(pair.a).prefetched;
    const auto found = test::collide(pair.a, pair.b);
    const bool was = statsOf(pair.a).prefetched == before + 1;
    CHECK(!found.empty());
    CHECK(sameContacts(found, pair.anew()));
    return was;
  };
  const auto prefetch = [&] {
    pair.renew();
    return dGpuTriMeshPrefetch(pair.space);
  };
  CHECK(!taken());
  REQUIRE(prefetch() == 1);
  CHECK(taken());
  REQUIRE(prefetch() == 1);
  dGeomSetPosition(pair.b, 0.3, 0.2, 0.44);
  CHECK(!taken());
  REQUIRE(prefetch() == 1);
  for (Vec3f& v : pair.lump.arrays.vertices) v.z *= 1.1f;
  dGeomTriMeshDataUpdate(pair.lump.id);
  CHECK(!taken());
  REQUIRE(prefetch() == 1);
  dGeomTriMeshSetData(pair.b, pair.lump.id);
  CHECK(!taken());
  // Callbacks are asked by the near callback, and not before.
  dGeomTriMeshSetCallback(pair.a, &refuseAll);
  CHECK(prefetch() == 0);
  CHECK(test::collide(pair.a, pair.b).empty());
  dGeomTriMeshSetCallback(pair.a, nullptr);
  REQUIRE(prefetch() == 1);
  dGeomTriMeshSetCallback(pair.a, &refuseAll);
  CHECK(test::collide(pair.a, pair.b).empty());
  dGeomTriMeshSetCallback(pair.a, nullptr);
  // A geom that is destroyed without a word, and another one, perhaps at its address.
  REQUIRE(prefetch() == 1);
  dGeomDestroy(pair.b);
  pair.b = dCreateTriMesh(pair.space, pair.box.id, nullptr, nullptr, nullptr);
  dGeomSetPosition(pair.b, 0.3, 0.2, 0.44);
  CHECK(!taken());
  // Data that are destroyed without a word.
  REQUIRE(prefetch() == 1);
  dGeomTriMeshDataDestroy(pair.box.id);
  pair.box.arrays = scenes::makeBox({1, 0.8, 0.7}, 2);
  pair.box.id = dGeomTriMeshDataCreate();
  pair.box.build();
  dGeomTriMeshSetData(pair.b, pair.box.id);
  CHECK(!taken());
  REQUIRE(prefetch() == 1);
  CHECK(taken());
}

TEST_CASE("a dTriMesh and shapes of ODE's are computed ahead for the classes that are taken over") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
  Overlapping pair;
  const dGeomID ball = dCreateSphere(pair.space, 0.3), block = dCreateBox(pair.space, 0.4, 0.5, 0.6);
  dGeomSetPosition(ball, -0.5, 0.1, 0.2);
  dGeomSetPosition(block, 0.1, -0.6, 0.1);
  for (const dGeomID other : {ball, block}) {
    pair.forget();
    const auto plain = test::collide(pair.a, other);
    REQUIRE(!plain.empty());
    pair.forget();
    REQUIRE(dGpuTriMeshPrefetch(pair.space) >= 3);
    CHECK(sameContacts(test::collide(pair.a, other), plain));
    CHECK(statsOf(pair.a).prefetched == 1);
    const dReal* const at = dGeomGetPosition(other);
    dGeomSetPosition(other, at[0] + 0.01, at[1], at[2]);
    const auto moved = test::collide(pair.a, other);
    CHECK(statsOf(pair.a).prefetched == 1);
    CHECK(!sameContacts(moved, plain));
  }
}

TEST_CASE(
    "arrays of pairs take dTriMeshes: the contacts, counts and memory of dCollide, at once and in the background") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  auto lump = std::make_unique<OdeMesh>(scenes::makeLump(0.5, 3, 0.3, 4));
  const OdeMesh box(scenes::makeBox({0.8, 0.6, 0.7}, 2));
  const Data torus(scenes::makeTorus(0.5, 0.2, 20, 12));
  std::vector<dGeomID> geoms;
  std::mt19937 random(17);
  for (int i = 0; i < 12; ++i) {
    geoms.push_back(i % 3 == 2 ? dCreateGpuTriMesh(nullptr, torus.id)
                               : dCreateTriMesh(nullptr, i % 3 ? box.id : lump->id, nullptr, nullptr, nullptr));
    dGpuTriMeshOverrideForgetGeom(geoms.back());
    setRandomPose(geoms.back(), random, 0.6);
  }
  std::vector<dGpuTriMeshPair> pairs;
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k)
      pairs.push_back(i % 2 ? dGpuTriMeshPair{geoms[i], geoms[k]} : dGpuTriMeshPair{geoms[k], geoms[i]});
  }
  const auto forget = [&] {
    for (const dGeomID g : geoms) {
      dGpuTriMeshOverrideForgetGeom(g);
      if (dGeomGetClass(g) == dGpuTriMeshGetClass()) dGeomGpuTriMeshForgetHistory(g);
    }
    for (const dGeomID g : geoms) dGpuTriMeshOverridePrepare(g);  // the same order each time
  };
  constexpr int kPlaces = 16;
  forget();
  std::vector<std::vector<dContactGeom>> wanted;
  const dGpuTriMeshOverrideStats start = sums();
  for (const dGpuTriMeshPair& p : pairs) wanted.push_back(test::collide(p.o1, p.o2, kPlaces));
  const dGpuTriMeshOverrideStats middle = sums();
  const std::vector<unsigned char> left = stateOf(geoms);
  const auto check = [&](std::size_t pair, const dContactGeom* from, int count) {
    REQUIRE(static_cast<std::size_t>(count) == wanted[pair].size());
    CHECK(std::equal(wanted[pair].begin(), wanted[pair].end(), from, sameContact));
  };
  forget();
  std::vector<dContactGeom> contacts(kPlaces * pairs.size());
  std::vector<int> counts(pairs.size());
  const int total = dGpuTriMeshCollidePairs(pairs.data(), static_cast<int>(pairs.size()), kPlaces, contacts.data(),
                                            sizeof(dContactGeom), counts.data());
  CHECK(total > 100);
  for (std::size_t i = 0; i < pairs.size(); ++i) check(i, &contacts[kPlaces * i], counts[i]);
  const dGpuTriMeshOverrideStats end = sums();
  CHECK(middle.queries > start.queries);
  CHECK(end.queries - middle.queries == middle.queries - start.queries);
  CHECK(end.contacts - middle.contacts == middle.contacts - start.contacts);
  CHECK(stateOf(geoms) == left);

  forget();
  const dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(pairs.data(), static_cast<int>(pairs.size()), kPlaces);
  REQUIRE(batch != nullptr);
  // All is gone before anything is collected.
  for (const dGeomID g : geoms) {
    dGeomDestroy(g);
    dGpuTriMeshOverrideForgetGeom(g);
  }
  dGpuTriMeshOverrideForgetData(lump->id);
  lump = nullptr;
  REQUIRE(dGpuTriMeshBatchWait(batch) == total);
  std::vector<int> first(pairs.size() + 1);
  contacts.resize(static_cast<std::size_t>(total));
  REQUIRE(dGpuTriMeshBatchCollect(batch, contacts.data(), sizeof(dContactGeom), nullptr, 0, first.data()) == total);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    check(i, contacts.data() + first[i], first[i + 1] - first[i]);
  }
  dGpuTriMeshBatchDestroy(batch);
}
