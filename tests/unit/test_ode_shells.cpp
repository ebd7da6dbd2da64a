// SPDX-License-Identifier: BSD-3-Clause
// Geoms that are no solids through ODE: memory without contacts, saved and loaded; batches and prefetched pairs; boxes.
#include <cstring>

#include "support/catch.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

/// A sheet and a quad over it, which falls flat and fast: between two steps it passes the sheet.
struct Falling {
  Data sheetData{terrain(4, 1, 0)}, quadData{flatSheet(1, 1, 1)};
  Geom sheet{sheetData}, quad{quadData};
  void at(double height) const { dGeomSetPosition(quad.id, 0.1, 0.2, static_cast<dReal>(height)); }
};

std::vector<unsigned char> saved(const dGeomID* geoms, int count) {
  std::vector<unsigned char> bytes(dGpuTriMeshHistorySave(geoms, count, nullptr, 0));
  CHECK(dGpuTriMeshHistorySave(geoms, count, bytes.data(), bytes.size()) == bytes.size());
  return bytes;
}

}  // namespace

TEST_CASE("a pair of shells is remembered while it is apart") {
  const OdeSession session;
  const Falling f;
  f.at(0.02);
  CHECK(collide(f.sheet.id, f.quad.id).empty());
  f.at(-0.01);
  CHECK(collide(f.sheet.id, f.quad.id).size() == 4);
  CHECK(collide(f.quad.id, f.sheet.id).size() == 4);
  dGeomGpuTriMeshForgetHistory(f.quad.id);
  dGeomGpuTriMeshForgetHistory(f.sheet.id);
  CHECK(collide(f.sheet.id, f.quad.id).empty());
}

TEST_CASE("what shells remember without contacts is saved and loaded") {
  const OdeSession session;
  for (const bool isTwice : {false, true}) {
    const Data ground(isTwice ? twoSided(terrain(4, 1, 0)) : terrain(4, 1, 0)), quad(flatSheet(1, 1, 1));
    const Geom a(ground), b(quad);
    const dGeomID geoms[] = {a.id, b.id};
    dGeomSetPosition(b.id, 0.1, 0.2, 0.02);
    CHECK(collide(a.id, b.id).empty());
    const std::vector<unsigned char> bytes = saved(geoms, 2);
    dGeomSetPosition(b.id, 0.1, 0.2, -0.01);
    const std::vector<dContactGeom> contacts = collide(a.id, b.id);
    CHECK(contacts.size() == 4);
    dGeomGpuTriMeshForgetHistory(b.id);
    CHECK(collide(a.id, b.id).empty());
    REQUIRE(dGpuTriMeshHistoryLoad(geoms, 2, bytes.data(), bytes.size()) == dGPUTRIMESH_OK);
    CHECK(saved(geoms, 2) == bytes);
    CHECK(sameContacts(collide(a.id, b.id), contacts));
  }
}

TEST_CASE("a geom that is no solid has a box with a margin of at most a twentieth of its radius") {
  const OdeSession session;
  const Data quad(flatSheet(1, 1, 1)), box(scenes::makeBox({1, 1, 1})), fine(terrain(10, 40, 0));
  dReal aabb[6];
  const Geom open(quad), solid(box), ground(fine);
  dGeomGetAABB(open.id, aabb);
  const double radius = std::sqrt(0.5);
  CHECK(aabb[5] > 0.01);
  CHECK(aabb[5] < 0.0501 * radius);
  CHECK(aabb[1] < 0.5 + 0.0501 * radius);
  dGeomGetAABB(solid.id, aabb);
  CHECK(aabb[5] < 0.500001);
  dGeomGetAABB(ground.id, aabb);
  CHECK(aabb[5] > 0.001);
  CHECK(aabb[5] < 0.01 * std::sqrt(50.0));
  usePairwise(open.id);
  dGeomSetPosition(open.id, 0, 0, 0);
  dGeomGetAABB(open.id, aabb);
  CHECK(aabb[5] < 0.000001);
}

TEST_CASE("shells have the same contacts alone, in either order, in a batch and prefetched") {
  const OdeSession session;
  Draw draw(4);
  const scenes::MeshArrays ground = terrain(10, 20, 0.3);
  for (const bool isTwice : {false, true}) {
    const Data groundData(isTwice ? twoSided(ground) : ground);
    std::vector<std::unique_ptr<Data>> data;
    const dSpaceID space = dSimpleSpaceCreate(nullptr);
    const dGeomID floor = dCreateGpuTriMesh(space, groundData.id);
    std::vector<dGeomID> bodies;
    std::vector<Transformd> poses;
    for (int i = 0; i < 42; ++i) {
      const ShellDrop drop = randomDrop(kShellBodies[i % 6], ground, 3, 0.0, draw);
      data.push_back(std::make_unique<Data>(drop.body));
      bodies.push_back(dCreateGpuTriMesh(space, data.back()->id));
      poses.push_back(drop.pose);
    }
    const auto place = [&](double lower) {
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        Transformd pose = poses[i];
        pose.t.z -= lower;
        setPose(bodies[i], pose);
      }
    };
    const auto forget = [&] {
      for (const dGeomID body : bodies) dGeomGpuTriMeshForgetHistory(body);
    };
    // Each way goes through the same poses from the same start.
    std::vector<std::vector<dContactGeom>> alone, others, batched, ready;
    const auto go = [&](std::vector<std::vector<dContactGeom>>& out, const auto& each) {
      forget();
      for (const double lower : {0.0, 0.1, 0.2, 0.25}) {
        place(lower);
        each(out);
      }
    };
    go(alone, [&](auto& out) {
      for (const dGeomID body : bodies) out.push_back(collide(floor, body));
    });
    go(others, [&](auto& out) {
      for (const dGeomID body : bodies) out.push_back(mirrored(collide(body, floor)));
    });
    go(batched, [&](auto& out) {
      std::vector<dGpuTriMeshPair> pairs;
      for (const dGeomID body : bodies) pairs.push_back({floor, body});
      std::vector<dContactGeom> contacts(bodies.size() * 4096);
      std::vector<int> counts(bodies.size());
      REQUIRE(dGpuTriMeshCollidePairs(pairs.data(), static_cast<int>(pairs.size()), 4096, contacts.data(),
                                      sizeof(dContactGeom), counts.data()) >= 0);
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto first = contacts.begin() + static_cast<std::ptrdiff_t>(4096 * i);
        out.emplace_back(first, first + counts[i]);
      }
    });
    go(ready, [&](auto& out) {
      REQUIRE(dGpuTriMeshPrefetch(space) >= 0);
      for (const dGeomID body : bodies) out.push_back(collide(floor, body));
    });
    REQUIRE(alone.size() == 4 * bodies.size());
    std::size_t found = 0;
    for (std::size_t i = 0; i < alone.size(); ++i) {
      found += alone[i].size();
      CHECK(sameContacts(alone[i], others[i]));
      CHECK(sameContacts(alone[i], batched[i]));
      CHECK(sameContacts(alone[i], ready[i]));
    }
    CHECK(found > 200);
    dSpaceDestroy(space);
  }
}

TEST_CASE("a world of shells that is saved and loaded continues with the same bytes") {
  const OdeSession session;
  const Data ground(terrain(4, 1, 0)), quad(flatSheet(1, 1, 1));
  StepWorld world(0.5);
  const dGeomID floor = dCreateGpuTriMesh(world.space(), ground.id), geom = dCreateGpuTriMesh(world.space(), quad.id);
  dMass mass;
  dMassSetBoxTotal(&mass, 1, 1, 1, 0.3);
  const dBodyID body = world.addBody(geom, mass);
  dBodySetPosition(body, 0, 0, 0.3);
  dBodySetLinearVel(body, 1, 0, 0);
  world.step(60);
  const dGeomID geoms[] = {floor, geom};
  const std::vector<unsigned char> state = stateOf({geom}), history = saved(geoms, 2);
  dVector3 position, velocity, spin;
  dQuaternion turn;
  std::memcpy(position, dBodyGetPosition(body), sizeof position);
  std::memcpy(velocity, dBodyGetLinearVel(body), sizeof velocity);
  std::memcpy(spin, dBodyGetAngularVel(body), sizeof spin);
  std::memcpy(turn, dBodyGetQuaternion(body), sizeof turn);
  const auto put = [&] {
    dBodySetPosition(body, position[0], position[1], position[2]);
    dBodySetQuaternion(body, turn);
    dBodySetLinearVel(body, velocity[0], velocity[1], velocity[2]);
    dBodySetAngularVel(body, spin[0], spin[1], spin[2]);
  };
  put();  // a quaternion that is set is normalised
  world.step(50);
  const std::vector<unsigned char> after = stateOf({geom});
  put();
  REQUIRE(dGpuTriMeshHistoryLoad(geoms, 2, history.data(), history.size()) == dGPUTRIMESH_OK);
  world.step(50);
  CHECK(stateOf({geom}) == after);
  CHECK(dBodyGetPosition(body)[2] > -0.01);
}
