// SPDX-License-Identifier: BSD-3-Clause
// Closed meshes that are wound inward: to what is outside the body that they enclose, to what is inside a room.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/vectors.h"
#include "support/bodies.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kHalf = 0.05;  // of all bodies, along z

/// With meshes that are no solids.
class MoreBodies {
 public:
  std::vector<Body> all() const {
    std::vector<Body> all = solid_.all();
    all.push_back({"open mesh", [this](dSpaceID space) { return dCreateGpuTriMesh(space, open_.id); }});
    all.push_back({"mesh wound inward", [this](dSpaceID space) { return dCreateGpuTriMesh(space, inward_.id); }});
    return all;
  }

 private:
  Bodies solid_{kHalf, 0.02};
  scenes::MeshArrays box_ = scenes::makeBox({0.4, 0.3, 2 * kHalf});
  Data open_{withoutLid(box_, kHalf)}, inward_{turned(box_)};
};

struct OfBodies {
  OdeSession session;
  MoreBodies bodies;
};

scenes::MeshArrays moved(scenes::MeshArrays mesh, const Vec3f& by) {
  for (Vec3f& v : mesh.vertices) v = otgAdd(v, by);
  return mesh;
}

/// Boxes, apart; flush; and a ring.
std::vector<scenes::MeshArrays> grounds() {
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1}, 2);
  return {box, scenes::merge({box, moved(box, {1.6F, 0, 0})}), scenes::merge({box, moved(box, {0, 1, 0})}),
          scenes::makeTorus(0.6, 0.3, 24, 12)};
}

/// Whether the middle of a body is outside of a solid.
bool isOutside(dGeomID solid, dGeomID body) {
  dGpuTriMeshClosestPoint found;
  REQUIRE(dGeomGpuTriMeshClosestPoint(solid, dGeomGetPosition(body), &found) == dGPUTRIMESH_OK);
  return found.distance > 0;
}

/// A room of side 2, and what pushes a body there along z: the ground's normal, turned round; 0 without contacts.
struct Room : OfBodies {
  Data data{turned(scenes::makeBox({2, 2, 2}))};
  Geom room{data};
  double pushAt(dGeomID body, double z) const {
    dGeomSetPosition(body, 0.1, 0.2, z);
    const auto contacts = test::collide(room.id, body);
    return contacts.empty() ? 0 : -contacts[0].normal[2];
  }
};

}  // namespace

TEST_CASE_METHOD(OfBodies, "what is outside of a body wound inward has the contacts of the body turned round") {
  Draw draw(3);
  for (const scenes::MeshArrays& ground : grounds()) {
    const Data outward(ground), inward(turned(ground));
    int touching = 0;
    for (std::size_t i = 0; i < 400; ++i) {
      const Body body = bodies.all()[i % bodies.all().size()];
      INFO(ground.triangles.size() << " triangles, " << body.name << " " << i);
      const dSpaceID space = dSimpleSpaceCreate(nullptr);
      const dGeomID geom = body.make(space);
      const Geom known(outward);
      const Vec3d axis = draw.direction(), away = draw.direction();
      const double angle = draw.uniform(-3, 3), distance = draw.uniform(0.4, 1);
      setPose(geom, makePose(axis, angle, otgScale(away, distance)));
      if (isOutside(known.id, geom)) {
        const auto contacts = test::collide(known.id, geom);
        const dGeomID tested = dCreateGpuTriMesh(space, inward.id);
        const auto isSame = [](const dContactGeom& a, const dContactGeom& b) {
          dContactGeom c = b;
          c.g1 = a.g1;
          return sameContact(a, c);
        };
        const int ready = i % 3 == 0 ? dGpuTriMeshPrefetch(space) : 0;
        CHECK((ready > 0 || i % 3 != 0 || contacts.empty()));
        CHECK(std::ranges::equal(test::collide(tested, geom), contacts, isSame));
        CHECK(statsOf(tested).prefetched == static_cast<duint64>(ready));
        touching += contacts.empty() ? 0 : 1;
      }
      dSpaceDestroy(space);
    }
    CHECK(touching > 60);
  }
}

TEST_CASE_METHOD(OfBodies, "pairs of triangles are those of the mesh as it is wound") {
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  const Data outward(box), inward(turned(box));
  for (const Body& body : bodies.all()) {
    if (body.name == "ball" || body.name == "capsule") continue;  // have no triangles
    const dGeomID geom = body.make(nullptr);
    dGeomSetPosition(geom, 0.1, 0.1, 0.53);
    const Geom x(outward), y(inward);
    for (const dGeomID g : {x.id, y.id}) usePairwise(g);
    const auto known = test::collide(x.id, geom), tested = test::collide(y.id, geom);
    INFO(body.name);
    CHECK(!known.empty());
    // Some are turned round, or left out.
    CHECK(!std::ranges::equal(known, tested, [](const dContactGeom& a, const dContactGeom& b) {
      return std::equal(a.normal, a.normal + 3, b.normal) && a.depth == b.depth;
    }));
    dGeomDestroy(geom);
  }
}

TEST_CASE_METHOD(Room, "a body that is half through the wall of a room leaves to the side that it has come from") {
  for (const Body& body : bodies.all()) {
    const dGeomID geom = body.make(nullptr);
    INFO(body.name);
    for (int step = 0; step < 8; ++step) {  // up from inside, until the middle is outside
      const double push = pushAt(geom, 0.94 + 0.01 * step);
      CHECK((step < 1 ? push == 0 : step < 2 || push < -0.9));
    }
    CHECK(pushAt(geom, 3) == 0);
    for (int step = 0; step < 8; ++step) {  // down from outside, until the middle is inside
      const double push = pushAt(geom, 1.06 - 0.01 * step);
      CHECK((step < 1 ? push == 0 : step < 2 || push > 0.9));
    }
    CHECK(pushAt(geom, 0.96) > 0.9);
    CHECK(pushAt(geom, 0) == 0);  // put there
    CHECK(pushAt(geom, -0.96) > 0.9);
    CHECK(pushAt(geom, -0.98) > 0.9);
    dGeomDestroy(geom);
  }
}

TEST_CASE_METHOD(Room, "a body that went far into a wall in one step is on the same side when it is asked again") {
  for (const Body& body : bodies.all()) {
    for (const double step : {0.05, 0.08, 0.12, 0.2, 0.3}) {
      const dGeomID geom = body.make(nullptr);
      INFO(body.name << ", step " << step);
      CHECK(pushAt(geom, 3) == 0);
      CHECK(pushAt(geom, 1.04) > 0.9);
      const double first = pushAt(geom, 1.04 - step);
      for (int k = 0; k < 3; ++k) CHECK(pushAt(geom, 1.04 - step) == first);
      dGeomDestroy(geom);
    }
  }
}

TEST_CASE_METHOD(OfBodies, "a shape that is larger than a mesh wound inward is no visitor of a room") {
  const scenes::MeshArrays cube = scenes::makeBox({0.4, 0.4, 0.4});
  const Data outward(cube), inward(turned(cube));
  const Geom known(outward), tested(inward);
  const dGeomID plate = dCreateBox(nullptr, 2, 2, 0.05);
  for (const dGeomID geom : {known.id, tested.id}) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.history = dGPUTRIMESH_HISTORY_OFF;
    REQUIRE(dGeomGpuTriMeshSetParams(geom, &params) == dGPUTRIMESH_OK);
  }
  for (int i = 0; i < 40; ++i) {  // also where the plate's middle is in the cube
    dGeomSetPosition(plate, 0.01 * i, 0.05, -0.22 + 0.01 * i);
    auto expected = test::collide(known.id, plate);
    for (dContactGeom& c : expected) c.g1 = tested.id;
    CHECK(!expected.empty());
    CHECK(sameContacts(test::collide(tested.id, plate), expected));
  }
  dGeomDestroy(plate);
}

TEST_CASE_METHOD(Room, "bodies fall on the floor of a room, and on its roof, and stay there") {
  for (const Body& body : bodies.all()) {
    for (const double from : {0.3, 1.5}) {
      StepWorld world(1);
      dCreateGpuTriMesh(world.space(), data.id);
      dMass mass;
      dMassSetBoxTotal(&mass, 1, 0.4, 0.3, 2 * kHalf);
      const dBodyID of = world.addBody(body.make(world.space()), mass);
      dBodySetPosition(of, 0.1, 0.2, from);
      dBodySetAngularDamping(of, 0.02);
      world.step(240, 1.0 / 120);
      INFO(body.name << " from " << from);
      CHECK(std::abs(dBodyGetPosition(of)[2] - (from < 1 ? -1 : 1) - kHalf) < 0.005);
    }
  }
}

TEST_CASE("a dTriMesh of long bars that are wound inward is none of loose slivers, which are left to ODE") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);
  const scenes::MeshArrays bar = scenes::makeBox({4, 0.1, 0.1});
  const OdeMesh bars(turned(scenes::merge({bar, moved(bar, {0, 0.5F, 0})}))), box(scenes::makeBox({1, 1, 1}));
  const OdeGeom ground(bars), visitor(box);
  dGeomSetPosition(visitor.id, 0.1, 0.2, 0.54);
  const auto contacts = test::collide(ground.id, visitor.id);
  CHECK(statsOf(ground.id).queries == 1);
  CHECK(contacts.size() > 3);
  for (const dContactGeom& c : contacts) CHECK(c.normal[2] < -0.9);
}
