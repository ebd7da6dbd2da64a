// SPDX-License-Identifier: BSD-3-Clause
// Grounds of plain boxes: thin plates that fall over an edge. As one mesh: kerbs that stand on a floor, or are sunk
// into it; flush tiles; stairs of boxes that overlap.
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kGravity = 9.81;
constexpr int kPlaces = 32;

scenes::MeshArrays boxAt(const Vec3f& middle, const Vec3d& size) {
  scenes::MeshArrays box = scenes::makeBox(size);
  for (Vec3f& v : box.vertices) v = {v.x + middle.x, v.y + middle.y, v.z + middle.z};
  return box;
}

/// A mesh, or one of ODE's own boxes.
dGeomID boxGeom(bool isMesh, const Data& mesh, const Vec3d& size) {
  return isMesh ? dCreateGpuTriMesh(nullptr, mesh.id) : dCreateBox(nullptr, size.x, size.y, size.z);
}

void turnAboutZ(dBodyID body, double angle) {
  dMatrix3 rotation;
  dRFromAxisAndAngle(rotation, 0, 0, 1, angle);
  dBodySetRotation(body, rotation);
}

struct Stepping {
  double step = 1.0 / 60;
  bool quick = true;
  double friction = 0.6;
  bool turns = false;  ///< energy is that of rotation, too
};

/// A body of mass 1 on a static ground.
class World {
 public:
  World(dGeomID ground, dGeomID geom, const Vec3d& size, const Stepping& stepping)
      : World(std::vector<dGeomID>{ground}, geom, size, stepping) {}
  World(std::vector<dGeomID> grounds, dGeomID geom, const Vec3d& size, const Stepping& stepping)
      : stepping_(stepping),
        grounds_(std::move(grounds)),
        geom_(geom),
        world_(dWorldCreate()),
        joints_(dJointGroupCreate(0)) {
    dWorldSetGravity(world_, 0, 0, -kGravity);
    dWorldSetCFM(world_, 1e-5);
    body_ = dBodyCreate(world_);
    dMass mass;
    dMassSetBoxTotal(&mass, 1, size.x, size.y, size.z);
    dBodySetMass(body_, &mass);
    dGeomSetBody(geom_, body_);
  }
  ~World() {
    dGeomDestroy(geom_);
    for (const dGeomID ground : grounds_) dGeomDestroy(ground);
    dJointGroupDestroy(joints_);
    dWorldDestroy(world_);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  dBodyID body() const { return body_; }
  dGeomID ground() const { return grounds_.front(); }
  dGeomID geom() const { return geom_; }

  /// The largest rise of energy in one step, in J for each kg.
  double run(double seconds) {
    double largest = 0, before = energy();
    for (int k = 0; k < static_cast<int>(seconds / stepping_.step); ++k) {
      step();
      const double now = energy();
      largest = std::max(largest, now - before);
      before = now;
    }
    return largest;
  }

 private:
  void step() {
    for (const dGeomID ground : grounds_) {
      for (const dContactGeom& found : collide(ground, geom_, kPlaces)) {
        dContact contact{};
        contact.geom = found;
        contact.surface.mode = dContactApprox1;
        contact.surface.mu = stepping_.friction;
        dJointAttach(dJointCreateContact(world_, joints_, &contact), dGeomGetBody(found.g1), dGeomGetBody(found.g2));
      }
    }
    (stepping_.quick ? dWorldQuickStep : dWorldStep)(world_, stepping_.step);
    dJointGroupEmpty(joints_);
  }
  double energy() const {
    const dReal* v = dBodyGetLinearVel(body_);
    return 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + kGravity * dBodyGetPosition(body_)[2] +
           (stepping_.turns ? energyOfRotation() : 0);
  }

  double energyOfRotation() const {
    const dReal* w = dBodyGetAngularVel(body_);
    dVector3 own;
    dBodyVectorFromWorld(body_, w[0], w[1], w[2], own);
    dMass mass;
    dBodyGetMass(body_, &mass);
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += 0.5 * mass.I[5 * k] * own[k] * own[k];
    return sum;
  }

  Stepping stepping_;
  std::vector<dGeomID> grounds_;
  dGeomID geom_;
  dWorldID world_;
  dJointGroupID joints_;
  dBodyID body_ = nullptr;
};

enum class Plate { kMesh, kBox, kCylinder };

/// A box of 4 x 4 x 1 m, whose top is at z = 0: alone, or with another one far off, so that the mesh is not convex.
scenes::MeshArrays groundWithEdge(bool isConvex) {
  const scenes::MeshArrays box = boxAt({0, 0, -0.5F}, {4, 4, 1});
  return isConvex ? box : scenes::merge({box, boxAt({-10, 0, -0.5F}, {2, 2, 1})});
}

/// A plate that falls about flat over the edge of such a ground.
double fallOverEdge(Plate kind, bool onConvex, int number, double thinnest, double thickest, const Stepping& stepping) {
  Draw draw(static_cast<std::uint32_t>(7000 + number));
  const double length = draw.uniform(0.5, 1.2), breadth = draw.uniform(0.5, 1.2);
  const double thickness = draw.uniform(thinnest, thickest), turn = draw.uniform(0, 2 * std::numbers::pi);
  const double direction = draw.uniform(0, 2 * std::numbers::pi), tilt = draw.uniform(0, 0.02);
  const double over = draw.uniform(0.02, 0.4), aside = draw.uniform(-1, 1), height = draw.uniform(0.3, 1);
  const Vec3d size{length, breadth, thickness};
  const Data ground(groundWithEdge(onConvex));
  const Data plate(scenes::makeBox(size));
  const dGeomID geom = kind == Plate::kMesh  ? dCreateGpuTriMesh(nullptr, plate.id)
                       : kind == Plate::kBox ? dCreateBox(nullptr, length, breadth, thickness)
                                             : dCreateCylinder(nullptr, length / 2, thickness);
  World world(dCreateGpuTriMesh(nullptr, ground.id), geom, size, stepping);
  dMatrix3 turned, tilted, rotation;
  dRFromAxisAndAngle(turned, 0, 0, 1, turn);
  dRFromAxisAndAngle(tilted, std::cos(direction), std::sin(direction), 0, tilt);
  dMultiply0(rotation, tilted, turned, 3, 3, 3);
  dBodySetRotation(world.body(), rotation);
  dBodySetPosition(world.body(), 2 - over, aside, height);
  return world.run(2.5);
}

/// A floor of 10 x 10 m, whose top is at z = 0, with a kerb from x = 1.7 on, in one mesh. The kerb begins so far below
/// the top.
scenes::MeshArrays floorWithKerb(double height, double sunk) {
  const auto middle = static_cast<float>((height - sunk) / 2);
  return scenes::merge({boxAt({0, 0, -0.5F}, {10, 10, 1}), boxAt({2, 0, middle}, {0.6, 6, height + sunk})});
}
constexpr std::array<double, 3> kSunk{0, 0.001, 0.1};

/// Of the boxes of some stairs on a floor: steps of 0.25 m that begin in the floor, each in those before it.
struct PlacedBox {
  Vec3f middle;
  Vec3d size;
};
std::vector<PlacedBox> stairs() {
  std::vector<PlacedBox> boxes{{{0, 0, -0.5F}, {10, 10, 1}}};
  for (int i = 0; i < 5; ++i) {
    const auto step = static_cast<float>(i);
    boxes.push_back({{1.5F + 0.6F * step, 0, 0.125F * (step + 1) - 0.05F}, {5, 4, 0.25 * (i + 1) + 0.1}});
  }
  return boxes;
}

/// A plate that falls on the stairs: the largest rise of energy. `native`: all of it is made of ODE's boxes.
double fallOnStairs(const Data& ground, int number, bool native, const Stepping& stepping) {
  Draw draw(static_cast<std::uint32_t>(500 + number));
  const Vec3d size{draw.uniform(0.5, 1.2), draw.uniform(0.5, 1.2), draw.uniform(0.003, 0.03)};
  const Data plate(scenes::makeBox(size));
  std::vector<dGeomID> grounds;
  if (native) {
    for (const PlacedBox& box : stairs()) {
      grounds.push_back(dCreateBox(nullptr, box.size.x, box.size.y, box.size.z));
      dGeomSetPosition(grounds.back(), box.middle.x, box.middle.y, box.middle.z);
    }
  } else {
    grounds.push_back(dCreateGpuTriMesh(nullptr, ground.id));
  }
  World world(grounds, native ? dCreateBox(nullptr, size.x, size.y, size.z) : dCreateGpuTriMesh(nullptr, plate.id),
              size, stepping);
  const Vec3d axis = draw.direction();
  dMatrix3 rotation;
  dRFromAxisAndAngle(rotation, axis.x, axis.y, axis.z, draw.uniform(0, 0.5));
  dBodySetRotation(world.body(), rotation);
  const double x = draw.uniform(-2, 2), y = draw.uniform(-1, 1);
  dBodySetPosition(world.body(), x, y, draw.uniform(1.8, 2.5));
  return world.run(4);
}

}  // namespace

TEST_CASE("A thin plate that falls over the edge of a box is not shot out of it") {
  // Native boxes gain so much in 1 of 150.
  constexpr double kShot = 0.5;
  const OdeSession session;
  struct Kind {
    Stepping stepping;
    double thinnest, thickest;
  };
  const std::array<Kind, 3> kinds{
      {{{1.0 / 60, true}, 0.005, 0.03}, {{1.0 / 60, false}, 0.005, 0.03}, {{1.0 / 240, true}, 0.005, 0.01}}};
  for (const Kind& kind : kinds) {
    for (const Plate plate : {Plate::kMesh, Plate::kBox, Plate::kCylinder}) {
      int shot = 0;
      for (int i = 0; i < 50; ++i) {
        if (fallOverEdge(plate, i % 2 == 0, i, kind.thinnest, kind.thickest, kind.stepping) > kShot) ++shot;
      }
      INFO("step " << kind.stepping.step << ", quick " << kind.stepping.quick << ", plate " << static_cast<int>(plate));
      CHECK(shot <= 1);
    }
  }
}

TEST_CASE("A plate wholly below a box's top beside its edge leaves by the top") {
  const OdeSession session;
  Draw draw(3);
  for (int i = 0; i < 200; ++i) {
    const double thickness = draw.uniform(0.004, 0.05), deep = thickness * draw.uniform(0.3, 2);
    const double length = draw.uniform(0.5, 1.2), breadth = draw.uniform(0.5, 1.2), over = draw.uniform(-0.1, 0.1);
    const double aside = draw.uniform(-1, 1), turn = draw.uniform(0, 2 * std::numbers::pi);
    const Data ground(groundWithEdge(i % 2 == 0));
    const Data plate(scenes::makeBox({length, breadth, thickness}));
    World world(dCreateGpuTriMesh(nullptr, ground.id), dCreateGpuTriMesh(nullptr, plate.id),
                {length, breadth, thickness}, {});
    turnAboutZ(world.body(), turn);
    dBodySetPosition(world.body(), 2 + over, aside, thickness / 2 - deep);
    const std::vector<dContactGeom> contacts = collide(world.geom(), world.ground(), kPlaces);
    INFO(i);
    REQUIRE(contacts.size() >= 3);
    for (const dContactGeom& contact : contacts) {
      CHECK(contact.normal[2] > 0.99);
      CHECK(contact.depth < 1.001 * deep);
    }
  }
}

TEST_CASE("A box in a floor and in a kerb of the same mesh leaves each by its own depth") {
  const OdeSession session;
  Draw draw(5);
  for (int i = 0; i < 300; ++i) {
    const double height = draw.uniform(0.05, 0.6);
    const Vec3d size{draw.uniform(0.5, 1.2), draw.uniform(0.5, 1.2), draw.uniform(0.4, 0.9)};
    const double yaw = draw.uniform(-0.6, 0.6), low = std::pow(10, draw.uniform(-7, -3));
    const double in = std::pow(10, draw.uniform(-5, -2)), aside = draw.uniform(-1, 1);
    const Data ground(floorWithKerb(height, kSunk[static_cast<std::size_t>(i) % kSunk.size()]));
    const Data box(scenes::makeBox(size));
    World world(dCreateGpuTriMesh(nullptr, ground.id), boxGeom(i % 2 == 0, box, size), size, {});
    turnAboutZ(world.body(), yaw);
    const double reach = 0.5 * (size.x * std::cos(yaw) + size.y * std::abs(std::sin(yaw)));
    dBodySetPosition(world.body(), 1.7 - reach + in, aside, size.z / 2 - low);
    INFO(i << ": " << low << " in the floor, " << in << " in the kerb");
    bool onFloor = false;
    for (const dContactGeom& contact : collide(world.geom(), world.ground(), kPlaces)) {
      CHECK(contact.depth < 1.5 * std::max(low, in) + 1e-6);
      onFloor = onFloor || (contact.normal[2] > 0.9 && contact.depth < 2 * low + 1e-6);
    }
    CHECK(onFloor);
  }
}

TEST_CASE("A box over the end of a block that is flush with its floor does not touch the block's wall") {
  const OdeSession session;
  Draw draw(7);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d size{draw.uniform(0.5, 1.2), draw.uniform(0.5, 1.2), draw.uniform(0.4, 0.9)};
    const double yaw = draw.uniform(-0.6, 0.6), low = std::pow(10, draw.uniform(-5, -2.3));
    const double over = std::pow(10, draw.uniform(-5, -0.5)), aside = draw.uniform(-1, 1);
    const Data ground(floorWithKerb(0, 1.2));  // through the floor
    const Data box(scenes::makeBox(size));
    World world(dCreateGpuTriMesh(nullptr, ground.id), boxGeom(i % 2 == 0, box, size), size, {});
    const double direction = draw.uniform(0, 2 * std::numbers::pi), tilt = draw.uniform(0, low);
    dMatrix3 turned, tilted, rotation;
    dRFromAxisAndAngle(turned, 0, 0, 1, yaw);
    dRFromAxisAndAngle(tilted, std::cos(direction), std::sin(direction), 0, tilt);
    dMultiply0(rotation, tilted, turned, 3, 3, 3);
    dBodySetRotation(world.body(), rotation);
    const double reach = 0.5 * (size.x * std::cos(yaw) + size.y * std::abs(std::sin(yaw)));
    dBodySetPosition(world.body(), 1.7 - reach + over, aside, size.z / 2 - low);
    INFO(i << ": " << low << " in the floor, " << over << " over the block");
    const std::vector<dContactGeom> contacts = collide(world.geom(), world.ground(), kPlaces);
    CHECK(contacts.size() >= 3);
    for (const dContactGeom& contact : contacts) {
      CHECK(contact.normal[2] > 0.999);
      CHECK(contact.depth < 2 * low + 1e-6);
    }
  }
}

TEST_CASE("A box over corners of a floor's flush tiles is lifted by its depth, and no more") {
  const OdeSession session;
  Draw draw(11);
  std::vector<scenes::MeshArrays> tiles;
  for (int i = -4; i < 4; ++i) {
    for (int j = -4; j < 4; ++j) {
      tiles.push_back(
          boxAt({0.25F + 0.5F * static_cast<float>(i), 0.25F + 0.5F * static_cast<float>(j), -0.25F}, {0.5, 0.5, 0.5}));
    }
  }
  const Data ground(scenes::merge(tiles));
  for (int i = 0; i < 200; ++i) {
    const Vec3d size{draw.uniform(0.6, 1.2), draw.uniform(0.6, 1.2), draw.uniform(0.4, 0.9)};
    const double low = std::pow(10, draw.uniform(-7, -2)), x = draw.uniform(-0.5, 0.5), y = draw.uniform(-0.5, 0.5);
    const double yaw = draw.uniform(0, 6);
    const Data box(scenes::makeBox(size));
    World world(dCreateGpuTriMesh(nullptr, ground.id), boxGeom(i % 2 == 0, box, size), size, {});
    turnAboutZ(world.body(), yaw);
    dBodySetPosition(world.body(), x, y, size.z / 2 - low);
    INFO(i << ": " << low << " in the floor");
    double lifted = 0;
    for (const dContactGeom& contact : collide(world.geom(), world.ground(), kPlaces)) {
      CHECK(contact.depth < 1.5 * low + 1e-6);
      if (contact.normal[2] > 0.99) lifted = std::max(lifted, contact.depth);
    }
    CHECK(lifted > 0.5 * low);
  }
}

TEST_CASE("A box that slides on a floor into a kerb of the same mesh is not lifted over it") {
  constexpr double kLifted = 0.5;  // J for each kg
  const OdeSession session;
  const std::array<Stepping, 3> steppings{{{1.0 / 240, true, 0}, {1.0 / 240, false, 0}, {1.0 / 60, true, 0}}};
  for (const Stepping& stepping : steppings) {
    for (int i = 0; i < 45; ++i) {
      Draw draw(static_cast<std::uint32_t>(100 + i));
      const double height = draw.uniform(0.1, 0.4);
      const Vec3d size{draw.uniform(0.5, 1.2), draw.uniform(0.5, 1.2), draw.uniform(0.4, 0.9)};
      const double yaw = draw.uniform(-0.6, 0.6), x = draw.uniform(-0.3, 0.3), y = draw.uniform(-0.5, 0.5);
      const double speed = draw.uniform(0.3, 2);
      const Data ground(floorWithKerb(height, kSunk[static_cast<std::size_t>(i) % kSunk.size()]));
      const Data box(scenes::makeBox(size));
      World world(dCreateGpuTriMesh(nullptr, ground.id), dCreateGpuTriMesh(nullptr, box.id), size, stepping);
      turnAboutZ(world.body(), yaw);
      dBodySetPosition(world.body(), x, y, size.z / 2 + 1e-4);
      dBodySetLinearVel(world.body(), speed, 0, 0);
      INFO(i << " at " << stepping.step);
      CHECK(world.run(4) < kLifted);
    }
  }
}

TEST_CASE("A small body that goes from one block through the end of another one inside always has contacts") {
  const OdeSession session;
  const Data ground(scenes::merge({boxAt({-0.5F, 0, 0}, {2, 1, 1}), boxAt({0.5F, 0, 0}, {2, 1, 1})}));
  const Vec3d size{0.1, 0.1, 0.1};
  const Data box(scenes::makeBox(size));
  World world(dCreateGpuTriMesh(nullptr, ground.id), dCreateGpuTriMesh(nullptr, box.id), size, {});
  for (const double z : {0.43, 0.4, 0.3}) {
    for (const double x : {0.0, -1.2, -0.5, -0.47, -0.45, 0.47}) {
      dBodySetPosition(world.body(), x, 0, z);
      INFO(x << ", " << z);
      CHECK_FALSE(collide(world.geom(), world.ground(), kPlaces).empty());
    }
  }
}

TEST_CASE("Stairs of overlapping boxes in one mesh throw thin plates no more often than boxes of ODE's own") {
  constexpr double kThrown = 0.1;  // J for each kg
  const OdeSession session;
  std::vector<scenes::MeshArrays> boxes;
  for (const PlacedBox& box : stairs()) boxes.push_back(boxAt(box.middle, box.size));
  const Data ground(scenes::merge(boxes));
  const std::array<Stepping, 3> steppings{
      {{1.0 / 60, true, 0.6, true}, {1.0 / 60, false, 0.6, true}, {1.0 / 240, true, 0.6, true}}};
  for (const Stepping& stepping : steppings) {
    int thrown = 0, thrownByBoxes = 0;
    for (int i = 0; i < 60; ++i) {
      if (fallOnStairs(ground, i, false, stepping) > kThrown) ++thrown;
      if (fallOnStairs(ground, i, true, stepping) > kThrown) ++thrownByBoxes;
    }
    INFO("step " << stepping.step << ", quick " << stepping.quick);
    CHECK(thrown <= thrownByBoxes);
  }
}
