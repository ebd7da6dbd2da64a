// SPDX-License-Identifier: BSD-3-Clause
// Pairs of a mesh and a geom of ODE's own that stay where they are: what is kept of them changes no byte.
#include <cmath>
#include <functional>

#include "scenes/convex_geom.h"
#include "support/catch.h"
#include "support/still_pairs.h"

using namespace otg;
using namespace otg::test;

namespace {

scenes::MeshArrays hills() {
  return scenes::makeGround(8, 1, 24, [](double x, double y) { return 0.25 * std::cos(1.7 * x) * std::cos(1.3 * y); });
}

std::vector<dGeomID> makeShapes(const scenes::ConvexData& convex) {
  return {dCreateBox(nullptr, 0.5, 0.4, 0.6), dCreateCapsule(nullptr, 0.2, 0.4), dCreateCylinder(nullptr, 0.25, 0.4),
          convex.makeGeom(nullptr)};
}

void askOften(const StillPair& pair, dGeomID shape) {
  for (int i = 0; i < 3; ++i) asked(pair.often.id, shape);
}

}  // namespace

TEST_CASE("a shape that is asked about again where it is has the contacts of one that is asked about once") {
  const OdeSession session;
  const scenes::ConvexData convex(scenes::makeSphere(0.3, 1));
  for (const scenes::MeshArrays& mesh : {hills(), scenes::makeTorus(0.8, 0.3, 24, 12), scenes::makeBox({1, 1, 1})}) {
    const StillPair pair(mesh);
    const Geom few(pair.data);  // for fewer places
    for (const dGeomID shape : makeShapes(convex)) {
      std::mt19937 random(3);
      std::uniform_real_distribution<double> step(-0.05, 0.05);
      int met = 0;
      for (int walk = 0; walk < 12; ++walk) {
        setRandomPose(shape, random, 0.7);
        for (int i = 0; i < 12; ++i) {  // near enough to each other that the pair is remembered
          const dReal* const p = dGeomGetPosition(shape);
          dGeomSetPosition(shape, p[0] + step(random), p[1] + step(random), p[2] + step(random));
          const auto expected = asked(pair.once.id, shape), fewer = asked(few.id, shape, 3);
          for (int k = 0; k < 4; ++k) REQUIRE(sameContacts(asked(pair.often.id, shape), expected));
          for (int k = 0; k < 3; ++k) REQUIRE(sameContacts(asked(pair.often.id, shape, 3), fewer));
          REQUIRE(sameContacts(asked(pair.often.id, shape), expected));
          met += expected.empty() ? 0 : 1;
        }
      }
      CHECK(met >= 30);
      dGeomDestroy(shape);
    }
  }
}

TEST_CASE("what a pair that stays where it is depends on may change") {
  const OdeSession session;
  const scenes::MeshArrays mesh = hills();
  const scenes::ConvexData convex(scenes::makeSphere(0.3, 1));
  struct Change {
    const char* name;
    std::function<void(const StillPair&, dGeomID shape)> make;
  };
  const auto setParams = [](dGeomID geom, const std::function<void(dGpuTriMeshParams&)>& change) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    change(params);
    REQUIRE(dGeomGpuTriMeshSetParams(geom, &params) == dGPUTRIMESH_OK);
  };
  const auto setBoth = [&](const std::function<void(dGpuTriMeshParams&)>& change) {
    return [=](const StillPair& pair, dGeomID) {
      setParams(pair.often.id, change);
      setParams(pair.once.id, change);
    };
  };
  const std::vector<Change> changes = {
      {"size", [](const StillPair&, dGeomID shape) { dGeomBoxSetLengths(shape, 0.6, 0.5, 0.7); }},
      {"contacts", setBoth([](dGpuTriMeshParams& p) { p.contacts_per_region = 2; })},
      {"model", setBoth([](dGpuTriMeshParams& p) { p.contact_model = dGPUTRIMESH_CONTACTS_PAIRWISE; })},
      {"memory",
       [](const StillPair& pair, dGeomID) {
         REQUIRE(dGeomGpuTriMeshForgetHistory(pair.often.id) == dGPUTRIMESH_OK);
         REQUIRE(dGeomGpuTriMeshForgetHistory(pair.once.id) == dGPUTRIMESH_OK);
       }},
      {"mesh's pose",
       [](const StillPair& pair, dGeomID) {
         dGeomSetPosition(pair.often.id, 0, 0, 0.02);
         dGeomSetPosition(pair.once.id, 0, 0, 0.02);
       }},
  };
  for (const Change& change : changes) {
    INFO(change.name);
    const StillPair pair(mesh);
    const dGeomID box = dCreateBox(nullptr, 0.5, 0.4, 0.6);
    dGeomSetPosition(box, 0.3, 0.2, 0.35);
    askOften(pair, box);
    const auto before = asked(pair.once.id, box);
    change.make(pair, box);
    const auto expected = asked(pair.once.id, box);
    for (int i = 0; i < 4; ++i) CHECK(sameContacts(asked(pair.often.id, box), expected));
    if (std::string(change.name) != "memory") CHECK(!sameContacts(before, expected));
    dGeomDestroy(box);
  }
}

TEST_CASE("moved vertices are another mesh, though nothing else has changed") {
  const OdeSession session;
  scenes::MeshArrays mesh = hills();
  const StillPair pair(mesh);
  const dGeomID box = dCreateBox(nullptr, 0.5, 0.4, 0.6);
  dGeomSetPosition(box, 0.3, 0.2, 0.35);
  askOften(pair, box);
  const auto before = asked(pair.once.id, box);
  for (Vec3f& v : mesh.vertices) v.z += 0.01f;
  REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(pair.data.id, mesh.vertices.data(), sizeof(Vec3f),
                                              static_cast<int>(mesh.vertices.size())) == dGPUTRIMESH_OK);
  const auto expected = asked(pair.once.id, box);
  CHECK(!sameContacts(before, expected));
  for (int i = 0; i < 4; ++i) CHECK(sameContacts(asked(pair.often.id, box), expected));
  dGeomDestroy(box);
}

namespace {

/// A cylinder wholly inside a solid, which leaves along its velocity.
struct Contained {
  Contained() : pair(scenes::makeBox({2, 2, 2})) { dGeomSetBody(cylinder, body); }
  ~Contained() {
    dGeomDestroy(cylinder);
    dWorldDestroy(world);
  }
  Contained(const Contained&) = delete;
  Contained& operator=(const Contained&) = delete;
  const StillPair pair;
  const dWorldID world = dWorldCreate();
  const dBodyID body = dBodyCreate(world);
  const dGeomID cylinder = dCreateCylinder(nullptr, 0.1, 0.2);
};

}  // namespace

TEST_CASE("another velocity is another query") {
  const OdeSession session;
  const Contained scene;
  std::vector<dContactGeom> last;
  int different = 0;
  for (int i = 0; i < 12; ++i) {
    dBodySetLinearVel(scene.body, i % 3 == 0 ? 1 : 0, i % 3 == 1 ? 1 : 0, i % 3 == 2 ? 1 : 0);
    const auto expected = asked(scene.pair.once.id, scene.cylinder);
    REQUIRE(!expected.empty());
    for (int k = 0; k < 3; ++k) CHECK(sameContacts(asked(scene.pair.often.id, scene.cylinder), expected));
    different += sameContacts(expected, last) ? 0 : 1;
    last = expected;
  }
  CHECK(different == 12);
}

TEST_CASE("what was kept of a pair does not outlive what the pair remembers") {
  const OdeSession session;
  const Contained scene;
  const auto askAll = [&](dReal x, dReal vx, dReal vy) {
    dBodySetPosition(scene.body, x, 0, 0);
    dBodySetLinearVel(scene.body, vx, vy, 0);
    const auto expected = asked(scene.pair.once.id, scene.cylinder);
    for (int k = 0; k < 4; ++k) CHECK(sameContacts(asked(scene.pair.often.id, scene.cylinder), expected));
    return expected;
  };
  askAll(0, 1, 0);
  const auto remembered = askAll(0.001, 0, 1);  // leaves as it began to
  for (const dGeomID geom : {scene.pair.often.id, scene.pair.once.id}) {
    REQUIRE(dGeomGpuTriMeshForgetHistory(geom) == dGPUTRIMESH_OK);
  }
  CHECK(!sameContacts(askAll(0.001, 0, 1), remembered));
}
