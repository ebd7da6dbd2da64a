// SPDX-License-Identifier: BSD-3-Clause
// Grounds in pieces that were joined (dGpuTriMeshJoin): bodies move on them as on the whole.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "support/catch.h"
#include "support/cut_ground.h"
#include "support/draw.h"
#include "support/ode_world.h"
#include "support/sheet_scenes.h"
#include "support/step_world.h"

using namespace otg;
using namespace otg::test;

namespace {

enum class Mover { kMeshBox, kMeshCylinder, kMeshBall, kBox, kSphere, kCapsule, kCylinder };
constexpr std::array kMovers = {Mover::kMeshBox, Mover::kMeshCylinder, Mover::kMeshBall, Mover::kBox,
                                Mover::kSphere,  Mover::kCapsule,      Mover::kCylinder};
const char* nameOf(Mover mover) {
  constexpr const char* kNames[] = {"mesh box", "mesh cylinder", "mesh ball", "dBox",
                                    "dSphere",  "dCapsule",      "dCylinder"};
  return kNames[static_cast<int>(mover)];
}

/// Pieces at their places: all at the origin, or `apart` along x.
struct Ground {
  std::vector<scenes::MeshArrays> pieces;
  double apart = 0, middle = 0;
  bool isJoined = false;
};

class GroundData {
 public:
  explicit GroundData(const Ground& ground) : ground_(ground) {
    for (const scenes::MeshArrays& piece : ground.pieces) data_.push_back(std::make_unique<Data>(piece));
  }
  void place(dSpaceID space) const {
    std::vector<dGeomID> geoms;
    for (std::size_t i = 0; i < data_.size(); ++i) {
      geoms.push_back(dCreateGpuTriMesh(space, data_[i]->id));
      dGeomSetPosition(geoms[i], static_cast<dReal>(ground_.apart * static_cast<double>(i)), 0, 0);
    }
    if (ground_.isJoined) {
      REQUIRE(dGpuTriMeshJoin(geoms.data(), static_cast<int>(geoms.size())) == static_cast<int>(geoms.size()));
    }
  }

 private:
  const Ground& ground_;
  std::vector<std::unique_ptr<Data>> data_;
};

struct Body {
  Mover mover{};
  Vec3d size{};
  Transformd pose{};
  Vec3d velocity{}, spin{};
};

Body randomBody(Mover mover, double reach, double height, Draw& draw) {
  Body body;
  body.mover = mover;
  body.size = {draw.uniform(0.3, 0.8), draw.uniform(0.3, 0.8), draw.uniform(0.3, 0.8)};
  body.pose = makePose(draw.direction(), draw.uniform(0, 6.28), {0, 0, 0});
  body.pose.t = {draw.uniform(-reach, reach), draw.uniform(-reach, reach), height + draw.uniform(0.6, 1)};
  body.velocity = {draw.uniform(-2, 2), draw.uniform(-2, 2), 0};
  return body;
}

/// Half the sides, or radius and length.
struct Made {
  dGeomID geom = nullptr;
  std::unique_ptr<Data> mesh;
  dMass mass{};
};
Made makeMover(const Body& body, dSpaceID space) {
  Made made;
  const Vec3d& s = body.size;
  const double r = 0.5 * s.x, length = s.z;
  switch (body.mover) {
    case Mover::kMeshBox:
      made.mesh = std::make_unique<Data>(scenes::makeBox(s));
      dMassSetBoxTotal(&made.mass, 1, s.x, s.y, s.z);
      break;
    case Mover::kBox:
      made.geom = dCreateBox(space, s.x, s.y, s.z);
      dMassSetBoxTotal(&made.mass, 1, s.x, s.y, s.z);
      break;
    case Mover::kMeshCylinder:
      made.mesh = std::make_unique<Data>(scenes::makeCylinder(r, length, 24));
      dMassSetCylinderTotal(&made.mass, 1, 3, r, length);
      break;
    case Mover::kCylinder:
      made.geom = dCreateCylinder(space, r, length);
      dMassSetCylinderTotal(&made.mass, 1, 3, r, length);
      break;
    case Mover::kMeshBall:
      made.mesh = std::make_unique<Data>(scenes::makeSphere(r, 3));
      dMassSetSphereTotal(&made.mass, 1, r);
      break;
    case Mover::kSphere:
      made.geom = dCreateSphere(space, r);
      dMassSetSphereTotal(&made.mass, 1, r);
      break;
    case Mover::kCapsule:
      made.geom = dCreateCapsule(space, r, length);
      dMassSetCapsuleTotal(&made.mass, 1, 3, r, length);
      break;
  }
  if (made.mesh != nullptr) made.geom = dCreateGpuTriMesh(space, made.mesh->id);
  return made;
}

class Run {
 public:
  Run(const GroundData& ground, const Body& body, double mu) : world_(mu) {
    ground.place(world_.space());
    made_ = makeMover(body, world_.space());
    body_ = world_.addBody(made_.geom, made_.mass);
    setPose(made_.geom, body.pose);
    dBodySetLinearVel(body_, body.velocity.x, body.velocity.y, body.velocity.z);
    dBodySetAngularVel(body_, body.spin.x, body.spin.y, body.spin.z);
  }
  void step() { world_.step(1); }
  double energy() const {
    const dReal *v = dBodyGetLinearVel(body_), *w = dBodyGetAngularVel(body_);
    dVector3 own;
    dBodyVectorFromWorld(body_, w[0], w[1], w[2], own);
    double sum = 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + 9.81 * dBodyGetPosition(body_)[2];
    for (int k = 0; k < 3; ++k) sum += 0.5 * made_.mass.I[5 * k] * own[k] * own[k];
    return sum;
  }
  Vec3d position() const { return vec(dBodyGetPosition(body_)); }
  Vec3d velocity() const { return vec(dBodyGetLinearVel(body_)); }

 private:
  static Vec3d vec(const dReal* p) { return {p[0], p[1], p[2]}; }
  StepWorld world_;
  Made made_;
  dBodyID body_;
};

struct Gain {
  double all = 0, most = 0;  ///< J/kg: of all bodies together, and in one step
};

Gain gainOn(const Ground& ground, Mover mover, int bodies, double height) {
  const GroundData data(ground);
  Draw draw(7 + static_cast<std::uint32_t>(mover));
  Gain gain;
  for (int b = 0; b < bodies; ++b) {
    Body body = randomBody(mover, 2, height, draw);
    body.pose.t.x += ground.middle;
    Run run(data, body, 0.5);
    double before = run.energy();
    for (int i = 0; i < 300; ++i) {
      run.step();
      const double now = run.energy();
      gain.all += std::max(0.0, now - before);
      gain.most = std::max(gain.most, now - before);
      before = now;
    }
    CHECK(run.position().z > -1);
  }
  return gain;
}

/// What a pile of roundings may gain.
constexpr double kNothing = 1e-4;

void compare(const Ground& whole, const Ground& pieces, int bodies, double height) {
  for (const Mover mover : kMovers) {
    const Gain one = gainOn(whole, mover, bodies, height), many = gainOn(pieces, mover, bodies, height);
    std::printf("%s: gained %g, largest %g J/kg; in pieces %g, %g\n", nameOf(mover), one.all / bodies, one.most,
                many.all / bodies, many.most);
    INFO(nameOf(mover));
    CHECK(many.all <= 1.2 * one.all + kNothing);
    CHECK(many.most <= 1.2 * one.most + kNothing);
  }
}

}  // namespace

TEST_CASE("bodies gain no more energy on a terrain in 8 x 8 joined sheets than on the whole") {
  const OdeSession session;
  const scenes::MeshArrays whole = terrain(10, 40, 0.3);
  compare({{whole}}, {cutTerrain(whole, 10, 8), 0, 0, true}, 8, 0.3);
}

TEST_CASE("bodies gain no more energy on a terrain of 8 x 8 joined blocks than on the whole") {
  const OdeSession session;
  const scenes::MeshArrays whole = terrain(10, 40, 0.3);
  std::vector<scenes::MeshArrays> blocks;
  for (const scenes::MeshArrays& piece : cutTerrain(whole, 10, 8)) blocks.push_back(blockUnder(piece, -2));
  compare({{blockUnder(whole, -2)}}, {std::move(blocks), 0, 0, true}, 8, 0.3);
}

TEST_CASE("bodies gain no more energy on joined slabs in a row than on one") {
  const OdeSession session;
  const scenes::MeshArrays slab = scenes::makeBox({1.3, 10, 1});
  scenes::MeshArrays whole = scenes::makeBox({8 * 1.3, 10, 1});
  for (Vec3f& v : whole.vertices) v.x += 3.5F * 1.3F;
  constexpr double kMiddle = 3.5 * 1.3;
  compare({{whole}, 0, kMiddle}, {std::vector<scenes::MeshArrays>(8, slab), 1.3, kMiddle, true}, 8, 0.5);
}

TEST_CASE("what rolls over the seams of eight joined slabs loses no speed") {
  const OdeSession session;
  const double length = 1.3;
  const scenes::MeshArrays slab = scenes::makeBox({length, 4, 1});
  scenes::MeshArrays whole = scenes::makeBox({8 * length, 4, 1});
  for (Vec3f& v : whole.vertices) v.x += static_cast<float>(3.5 * length);
  const Ground oneSlab{{whole}}, row{std::vector<scenes::MeshArrays>(8, slab), length, 0, true};
  const GroundData onWhole(oneSlab), onRow(row);
  Draw draw(3);
  for (const Mover mover :
       {Mover::kSphere, Mover::kCapsule, Mover::kCylinder, Mover::kMeshBall, Mover::kMeshCylinder}) {
    double sumOnRow = 0, sumOnOne = 0;
    for (int i = 0; i < 4; ++i) {
      Body body;
      body.mover = mover;
      const double r = draw.uniform(0.2, 0.5), speed = draw.uniform(1.5, 3);
      body.size = {2 * r, 2 * r, draw.uniform(0.4, 1)};
      // Its axis along y: it rolls along x.
      body.pose = makePose({1, 0, 0}, 1.5707963267948966, {-0.4, draw.uniform(-0.5, 0.5), 0.5 + r});
      body.velocity = {speed, 0, 0};
      body.spin = {0, speed / r, 0};
      Run one(onWhole, body, 1), many(onRow, body, 1);
      for (int k = 0; k < 2000 && many.position().x < 7.3 * length; ++k) {
        one.step();
        many.step();
      }
      sumOnRow += many.velocity().x / speed;
      sumOnOne += one.velocity().x / speed;
    }
    INFO(nameOf(mover));
    std::printf("%s: %.9g of its speed, on the whole %.9g\n", nameOf(mover), sumOnRow / 4, sumOnOne / 4);
    // What has facets rocks from one to the next, and roundings decide how.
    const bool isRound = mover != Mover::kMeshBall && mover != Mover::kMeshCylinder;
    CHECK(sumOnRow >= (isRound ? 1 - 1e-6 : 0.95) * sumOnOne);
    if (isRound) CHECK(sumOnRow >= 4 * (1 - 1e-5));
  }
}
