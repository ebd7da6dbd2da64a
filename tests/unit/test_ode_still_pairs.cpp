// SPDX-License-Identifier: BSD-3-Clause
// Pairs of meshes that stay where they are: what is kept of them changes no byte.
#include <cmath>
#include <functional>
#include <utility>

#include "ode/many/pair_batch.h"
#include "support/catch.h"
#include "support/still_pairs.h"

using namespace otg;
using namespace otg::test;

namespace {

scenes::MeshArrays hills() {
  return scenes::makeGround(8, 1, 24, [](double x, double y) { return 0.25 * std::cos(1.7 * x) * std::cos(1.3 * y); });
}

scenes::MeshArrays sheetOfHills() {
  scenes::MeshArrays sheet = hills();
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    const auto isTop = [&](std::uint32_t v) { return sheet.vertices[v].z > -0.5F; };
    return !isTop(t.v[0]) || !isTop(t.v[1]) || !isTop(t.v[2]);
  });
  return sheet;
}

scenes::MeshArrays openBox() {
  scenes::MeshArrays box = scenes::makeBox({0.3, 0.4, 0.2}, 2);
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return box.vertices[t.v[0]].z > 0 && box.vertices[t.v[1]].z > 0 && box.vertices[t.v[2]].z > 0;
  });
  return box;
}

void setParams(dGeomID geom, const std::function<void(dGpuTriMeshParams&)>& change) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  change(params);
  REQUIRE(dGeomGpuTriMeshSetParams(geom, &params) == dGPUTRIMESH_OK);
}

}  // namespace

TEST_CASE("a pair that is asked about again where it is has the contacts of one that is asked about once") {
  const OdeSession session;
  const scenes::MeshArrays torus = scenes::makeTorus(0.3, 0.1, 24, 12), open = openBox();
  int kept = 0;
  for (const scenes::MeshArrays& mesh : {hills(), sheetOfHills(), scenes::makeTorus(0.8, 0.3, 24, 12), open}) {
    const StillPair grounds(mesh);
    const Geom few(grounds.data);  // for fewer places
    for (const scenes::MeshArrays& of : {torus, open, scenes::makeBox({0.3, 0.2, 0.25}, 2)}) {
      const Data data(of);
      const Geom geom(data);
      const dGeomID body = geom.id;
      std::mt19937 random(3);
      std::uniform_real_distribution<double> step(-0.05, 0.05);
      int met = 0;
      for (int walk = 0; walk < 20; ++walk) {
        setRandomPose(body, random, 0.5);
        for (int i = 0; i < 8; ++i) {  // near enough to each other that the pair is remembered
          const dReal* const p = dGeomGetPosition(body);
          // In braces: as arguments of one call compilers draw them in different orders.
          const Vec3d to{p[0] + step(random), p[1] + step(random), p[2] + step(random)};
          dGeomSetPosition(body, to.x, to.y, to.z);
          const auto expected = asked(grounds.once.id, body), fewer = asked(few.id, body, 3);
          for (int k = 0; k < 4; ++k) REQUIRE(sameContacts(asked(grounds.often.id, body), expected));
          for (int k = 0; k < 3; ++k) REQUIRE(sameContacts(asked(grounds.often.id, body, 3), fewer));
          REQUIRE(sameContacts(asked(grounds.often.id, body), expected));
          met += expected.empty() ? 0 : 1;
        }
      }
      CHECK(met >= 10);
      kept += met;
    }
  }
  CHECK(kept > 300);
}

TEST_CASE("what a pair of meshes that stays where it is depends on may change") {
  const OdeSession session;
  const Data ball(scenes::makeSphere(0.3, 1)), torus(scenes::makeTorus(0.3, 0.15, 24, 12));
  struct Change {
    const char* name;
    std::function<void(const StillPair&, dGeomID body)> make;
  };
  const auto setBoth = [](const std::function<void(dGpuTriMeshParams&)>& change) {
    return [=](const StillPair& grounds, dGeomID) {
      setParams(grounds.often.id, change);
      setParams(grounds.once.id, change);
    };
  };
  const std::vector<Change> changes = {
      {"scale",
       [](const StillPair&, dGeomID body) { REQUIRE(dGeomGpuTriMeshSetScale(body, 1, 1, 1.1) == dGPUTRIMESH_OK); }},
      {"mesh",
       [&](const StillPair&, dGeomID body) { REQUIRE(dGeomGpuTriMeshSetData(body, ball.id) == dGPUTRIMESH_OK); }},
      {"contacts", setBoth([](dGpuTriMeshParams& p) { p.contacts_per_region = 2; })},
      {"model", setBoth([](dGpuTriMeshParams& p) { p.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE; })},
      {"memory",
       [](const StillPair& grounds, dGeomID body) {
         for (const dGeomID geom : {grounds.often.id, grounds.once.id, body}) {
           REQUIRE(dGeomGpuTriMeshForgetHistory(geom) == dGPUTRIMESH_OK);
         }
       }},
      {"ground's pose",
       [](const StillPair& grounds, dGeomID) {
         dGeomSetPosition(grounds.often.id, 0, 0, 0.02);
         dGeomSetPosition(grounds.once.id, 0, 0, 0.02);
       }},
      {"ground's vertices",
       [](const StillPair& grounds, dGeomID) {
         scenes::MeshArrays moved = hills();
         for (Vec3f& v : moved.vertices) v.z += 0.01F;
         REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(grounds.data.id, moved.vertices.data(), sizeof(Vec3f),
                                                     static_cast<int>(moved.vertices.size())) == dGPUTRIMESH_OK);
       }},
  };
  for (const Change& change : changes) {
    INFO(change.name);
    const StillPair grounds(hills());
    const Geom body(torus);
    dGeomSetPosition(body.id, 0.3, 0.2, 0.3);
    for (int i = 0; i < 3; ++i) asked(grounds.often.id, body.id);
    const auto before = asked(grounds.once.id, body.id);
    REQUIRE(!before.empty());
    change.make(grounds, body.id);
    const auto expected = asked(grounds.once.id, body.id);
    for (int i = 0; i < 4; ++i) CHECK(sameContacts(asked(grounds.often.id, body.id), expected));
    if (std::string(change.name) != "memory") CHECK(!sameContacts(before, expected));
  }
}

TEST_CASE("a body inside another, asked about often where it is, goes out the way that it would have gone") {
  // It leaves along its velocity, and is remembered to.
  const OdeSession session;
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  for (const bool remembers : {false, true}) {
    const StillPair grounds(scenes::makeTorus(1, 0.6, 24, 12));
    const Data inner(scenes::makeTorus(0.1, 0.04, 12, 8));
    const Geom geom(inner);
    for (const dGeomID g : {grounds.often.id, grounds.once.id}) {
      setParams(
          g, [&](dGpuTriMeshParams& p) { p.history = remembers ? dGPUTRIMESH_HISTORY_ON : dGPUTRIMESH_HISTORY_OFF; });
    }
    dGeomSetBody(geom.id, body);
    std::vector<dContactGeom> last;
    int different = 0;
    for (int i = 0; i < 120; ++i) {
      if (i % 4 == 0) dBodySetPosition(body, 1 + 0.0005 * i, 0, 0);
      dBodySetLinearVel(body, i % 3 == 0 ? 1 : 0, i % 3 == 1 ? 1 : 0, i % 3 == 2 ? 1 : 0);
      const auto expected = asked(grounds.once.id, geom.id);
      REQUIRE(!expected.empty());
      for (int k = 0; k < 3; ++k) CHECK(sameContacts(asked(grounds.often.id, geom.id), expected));
      different += sameContacts(expected, last) ? 0 : 1;
      last = expected;
    }
    CHECK(different >= (remembers ? 20 : 60));
    dGeomSetBody(geom.id, nullptr);
  }
  dWorldDestroy(world);
}

TEST_CASE("a pair that stays where it is has the same contacts in every way of asking") {
  const OdeSession session;
  const dSpaceID space = dSimpleSpaceCreate(nullptr);
  constexpr int kPlaces = 24;
  int kept = 0;
  for (const scenes::MeshArrays& mesh : {hills(), sheetOfHills(), openBox()}) {
    const StillPair grounds(mesh);
    const Data torus(scenes::makeTorus(0.3, 0.1, 24, 12));
    const Geom body(torus);
    dSpaceAdd(space, grounds.often.id);
    dSpaceAdd(space, body.id);
    const auto inSpace = [&](std::size_t most) {
      std::vector<dContactGeom> contacts(most);
      const int count = dGpuTriMeshCollideSpace(space, kPlaces, nullptr, nullptr, contacts.data(), sizeof(dContactGeom),
                                                static_cast<int>(most));
      REQUIRE(count >= 0);
      contacts.resize(static_cast<std::size_t>(count));
      return contacts;
    };
    const auto inArray = [&] {
      const dGpuTriMeshPair pairs[] = {{grounds.often.id, body.id}, {grounds.often.id, body.id}};
      std::vector<dContactGeom> contacts(2 * kPlaces);
      int counts[2] = {0, 0};
      REQUIRE(dGpuTriMeshCollidePairs(pairs, 2, kPlaces, contacts.data(), sizeof(dContactGeom), counts) >= 0);
      REQUIRE(counts[0] == counts[1]);
      contacts.resize(static_cast<std::size_t>(counts[0]));
      return contacts;
    };
    const auto ahead = [&] {
      REQUIRE(dGpuTriMeshPrefetch(space) == 1);
      return asked(grounds.often.id, body.id, kPlaces);
    };
    // Spaces give the geoms of a pair in an order of their own.
    const auto withoutGeoms = [&](std::vector<dContactGeom> contacts) {
      for (dContactGeom& c : contacts) {
        if (c.g1 == body.id) {
          for (int axis = 0; axis < 3; ++axis) c.normal[axis] = -c.normal[axis];
          std::swap(c.side1, c.side2);
        }
        c.g1 = c.g2 = nullptr;
      }
      return contacts;
    };
    std::mt19937 random(5);
    int met = 0;
    for (int i = 0; i < 60; ++i) {
      setRandomPose(body.id, random, 0.6);
      const auto expected = asked(grounds.once.id, body.id, kPlaces);
      if (expected.empty()) continue;
      ++met;
      for (int k = 0; k < 6; ++k) {
        const auto way = random() % 4;
        INFO(i << ", " << k << ": way " << way);
        const auto found = way == 0   ? asked(grounds.often.id, body.id, kPlaces)
                           : way == 1 ? withoutGeoms(inSpace(64))
                           : way == 2 ? withoutGeoms(inArray())
                                      : ahead();
        REQUIRE(sameContacts(found, expected));
      }
    }
    CHECK(met >= 10);
    kept += met;
    dSpaceRemove(space, grounds.often.id);
    dSpaceRemove(space, body.id);
  }
  CHECK(kept > 60);
  dSpaceDestroy(space);
}

TEST_CASE("an array of pairs that stay where they are computes nothing from the third time on") {
  const OdeSession session;
  for (const scenes::MeshArrays& mesh : {hills(), openBox()}) {
    const Data ground(mesh), torus(scenes::makeTorus(0.3, 0.1, 24, 12));
    const Geom floor(ground), body(torus);
    dGeomSetPosition(body.id, 0.1, 0.2, 0.1);
    const dGpuTriMeshPair pair{floor.id, body.id};
    std::size_t contacts = 0;
    const auto isKept = [&](int places) {
      PairBatch batch({&pair, 1}, {.capacity = places});
      batch.run();
      const bool is = batch.isKept(0);
      contacts = batch.contactCount();
      CHECK(contacts > 0);
      batch.remember();
      return is;
    };
    CHECK(!isKept(64));
    CHECK(!isKept(64));
    CHECK(isKept(64));
    CHECK(isKept(0));  // for any number that leaves out none
    const int all = static_cast<int>(contacts);
    CHECK(isKept(all + 1));
    CHECK(!isKept(all));
    dGeomSetPosition(body.id, 0.1, 0.2, 0.101);
    CHECK(!isKept(64));
  }
}

TEST_CASE("a batch in flight whose contacts were kept leaves with a pair what a computed one leaves") {
  const OdeSession session;
  const scenes::MeshArrays torus = scenes::makeTorus(0.45, 0.15, 16, 8);
  int met = 0, apart = 0, kept = 0;
  for (const scenes::MeshArrays& of : {torus, openBox(), scenes::makeLump(0.5, 2, 0.4, 4)}) {
    const Data mesh(torus), other(of);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> step(-0.1, 0.1);
    for (int i = 0; i < 150; ++i) {
      const Geom first(mesh), second(other), once(mesh), twin(other);
      Geom const* const pairs[2][2] = {{&first, &second}, {&once, &twin}};
      setRandomPose(second.id, random, 0.4);
      dQuaternion turn;
      dGeomGetQuaternion(second.id, turn);
      Vec3d at[3];
      const dReal* const p = dGeomGetPosition(second.id);
      at[0] = {p[0], p[1], p[2]};
      for (int k = 1; k < 3; ++k) {
        at[k] = {at[k - 1].x + step(random), at[k - 1].y + step(random), at[k - 1].z + step(random)};
      }
      std::vector<dContactGeom> last[2];
      std::size_t inFlight[2];
      for (int k = 0; k < 2; ++k) {
        const dGeomID a = pairs[k][0]->id, b = pairs[k][1]->id;
        const int times = k == 0 ? 3 : 1;  // so often that what is found is kept
        const auto go = [&](const Vec3d& to) {
          dGeomSetQuaternion(b, turn);
          dGeomSetPosition(b, to.x, to.y, to.z);
        };
        go(at[0]);
        for (int t = 0; t < times; ++t) asked(a, b);
        const dGpuTriMeshPair pair{a, b};
        PairBatch batch({&pair, 1}, {.capacity = 24});
        if (batch.isKept(0)) ++kept;
        CHECK((k == 0 || !batch.isKept(0)));
        batch.run();
        go(at[1]);
        asked(a, b);
        go(at[2]);
        for (int t = 0; t < times; ++t) asked(a, b);
        inFlight[k] = batch.contactCount();
        batch.remember();
        last[k] = asked(a, b);
      }
      INFO(i);
      CHECK(inFlight[0] == inFlight[1]);
      CHECK(sameContacts(last[0], last[1]));
      (inFlight[0] > 0 ? met : apart) += 1;
    }
  }
  CHECK(met > 200);
  CHECK(apart > 10);
  CHECK(kept > met);  // some of those that are apart, too
}

TEST_CASE("a batch in flight that keeps nothing of a pair ends what was remembered of it meanwhile") {
  // The depths of a body inside another are cut for some queries. It is in the hole, where it touches nothing, first.
  const OdeSession session;
  const Data ring(scenes::makeTorus(1, 0.6, 24, 12)), inner(scenes::makeTorus(0.1, 0.04, 12, 8));
  std::vector<dContactGeom> last[3];
  for (int k = 0; k < 3; ++k) {
    const Geom ground(ring), body(inner);
    const int times = k == 0 ? 3 : 1;
    for (int t = 0; t < times; ++t) CHECK(asked(ground.id, body.id).empty());
    const dGpuTriMeshPair pair{ground.id, body.id};
    PairBatch batch({&pair, 1}, {.capacity = 24});
    CHECK(batch.isKept(0) == (k == 0));
    batch.run();
    for (int i = 30; i >= 0; --i) {
      dGeomSetPosition(body.id, 1, 1e-5 * i, 0);
      CHECK(!asked(ground.id, body.id).empty());
    }
    if (k < 2) batch.remember();
    last[k] = asked(ground.id, body.id);
  }
  CHECK(sameContacts(last[0], last[1]));
  CHECK(!sameContacts(last[0], last[2]));
}

TEST_CASE("what an array of pairs leaves with a pair ends what was kept of it") {
  // The depths of a body inside another are cut for some queries, and arrays count as such.
  const OdeSession session;
  const StillPair grounds(scenes::makeTorus(1, 0.6, 24, 12));
  const Data inner(scenes::makeTorus(0.1, 0.04, 12, 8));
  const Geom body(inner);
  const auto askAll = [&] {
    const auto expected = asked(grounds.once.id, body.id);
    for (int k = 0; k < 3; ++k) CHECK(sameContacts(asked(grounds.often.id, body.id), expected));
    return expected;
  };
  dGeomSetPosition(body.id, 1, 0, 0);
  const auto before = askAll();
  for (int i = 1; i <= 30; ++i) {
    dGeomSetPosition(body.id, 1, 1e-5 * i, 0);
    const dGpuTriMeshPair pairs[] = {{grounds.often.id, body.id}, {grounds.once.id, body.id}};
    std::vector<dContactGeom> contacts(128);
    int counts[2] = {0, 0};
    REQUIRE(dGpuTriMeshCollidePairs(pairs, 2, 64, contacts.data(), sizeof(dContactGeom), counts) >= 0);
    REQUIRE(counts[0] > 0);
  }
  dGeomSetPosition(body.id, 1, 0, 0);
  CHECK(!sameContacts(askAll(), before));
}

TEST_CASE("statistics of a pair that stays where it is count what every query would have") {
  const OdeSession session;
  const Data ground(hills()), torus(scenes::makeTorus(0.3, 0.15, 24, 12));
  const Geom once(ground), often(ground), body(torus);
  dGeomSetPosition(body.id, 0.3, 0.2, 0.3);
  const auto contacts = static_cast<std::uint64_t>(asked(once.id, body.id).size());
  for (int i = 0; i < 5; ++i) asked(often.id, body.id);
  const dGpuTriMeshStats one = statsOf(once.id), five = statsOf(often.id);
  CHECK(one.contacts == contacts);
  CHECK(five.queries == 5);
  CHECK(five.contacts == 5 * one.contacts);
  CHECK(five.intersecting_pairs == 5 * one.intersecting_pairs);
  CHECK(five.box_tests == 5 * one.box_tests);
  CHECK(five.contacts_before_reduction == 5 * one.contacts_before_reduction);
}
