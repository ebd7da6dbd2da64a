// SPDX-License-Identifier: BSD-3-Clause
// Bodies that would be solids but for a fault hold each other as whole ones do.
#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/faulty_mesh.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kLength = 0.3, kWidth = 0.18, kThick = 0.04;
constexpr int kLinks = 5;

/// A link of a chain: two bars along x and two across, whose ends are flush with the first or reach into them.
scenes::MeshArrays makeLink(bool isFlush) {
  std::vector<scenes::MeshArrays> bars;
  const auto add = [&](const Vec3d& size, const Vec3d& at) {
    bars.push_back(scenes::transformed(scenes::makeBox(size), {{1, 0, 0, 0, 1, 0, 0, 0, 1}, at}));
  };
  for (const double side : {-1.0, 1.0}) {
    add({kLength, kThick, kThick}, {0, side * (kWidth - kThick) / 2, 0});
    add({kThick, kWidth - (isFlush ? 2 : 1) * kThick, kThick}, {side * (kLength - kThick) / 2, 0, 0});
  }
  return scenes::merge(bars);
}

struct Fault {
  const char* name;
  void (*make)(Faulty&, std::mt19937&);
};
constexpr std::array<Fault, 6> kFaults = {{{"none", [](Faulty&, std::mt19937&) {}},
                                           {"lost", [](Faulty& f, std::mt19937& r) { f.loseTriangle(r); }},
                                           {"pierced", [](Faulty& f, std::mt19937& r) { f.pierce(r); }},
                                           {"cracked", [](Faulty& f, std::mt19937& r) { f.crack(r); }},
                                           {"turned", [](Faulty& f, std::mt19937& r) { f.turnOne(r); }},
                                           {"doubled", [](Faulty& f, std::mt19937&) { f.doubleAll(); }}}};

/// How many links of a hanging chain have fallen after three seconds.
int linksLost(const scenes::MeshArrays& link, double swing) {
  const ShellData data(link, GeomForm::kOurs);
  StepWorld world(0.6);
  std::vector<dBodyID> bodies;
  for (int i = 0; i < kLinks; ++i) {
    dMass mass;
    dMassSetBoxTotal(&mass, 1, kLength, kWidth, kThick);
    const dGeomID geom = data.geom(world.space());
    const dBodyID body = world.addBody(geom, mass);
    // Upright, and each turned by a right angle against the one before.
    const double c = i % 2 == 0 ? 1 : 0, s = i % 2 == 0 ? 0 : 1;
    setPose(geom, {{0, -s, c, 0, c, s, -1, 0, 0}, {0, 0, -i * (kLength - 2 * kThick - 0.004)}});
    if (i == 0) dBodySetKinematic(body);
    bodies.push_back(body);
  }
  dBodySetLinearVel(bodies.back(), swing, 0.5 * swing, 0);
  world.step(600);
  return static_cast<int>(
      std::ranges::count_if(bodies, [](dBodyID body) { return dBodyGetPosition(body)[2] < -kLinks * kLength - 0.3; }));
}

}  // namespace

TEST_CASE("links of a chain that have a fault hold each other") {
  const OdeSession session;
  std::mt19937 random(1);
  Draw draw(1);
  for (const bool isFlush : {false, true}) {
    for (const Fault& fault : kFaults) {
      int lost = 0, all = 0;
      for (int i = 0; i < 12; ++i) {
        Faulty link(makeLink(isFlush));
        fault.make(link, random);
        lost += linksLost(link.mesh, draw.uniform(-1, 1));
        all += kLinks - 1;
      }
      INFO((isFlush ? "flush, " : "reaching into each other, ") << fault.name << ": " << lost << " of " << all);
      CHECK(lost <= all / 40);
    }
  }
}

TEST_CASE("bodies stay in rooms with doubled faces, and in vessels whose mouth has three edges") {
  const OdeSession session;
  Faulty room(scenes::makeBox({2, 2, 2}));
  room.doubleAll();
  scenes::MeshArrays cup = scenes::makeTetrahedron({0, 0, -1}, {-3, -2, 1}, {0, 3, 1}, {3, -2, 1});
  std::erase_if(cup.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t.v, [&](std::uint32_t v) { return cup.vertices[v].z > 0; });
  });
  REQUIRE(cup.triangles.size() == 3);
  scenes::MeshArrays box = scenes::makeBox({0.3, 0.3, 0.3}), plate = scenes::makeBox({0.4, 0.4, 0.1});
  box.triangles.pop_back();
  std::erase_if(plate.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t.v, [&](std::uint32_t v) { return plate.vertices[v].z < 0; });
  });
  REQUIRE(plate.triangles.size() == 2);
  for (const scenes::MeshArrays* vessel : {&room.mesh, &cup}) {
    for (const scenes::MeshArrays* body : {&box, &plate}) {
      for (int i = 0; i < 6; ++i) {
        INFO((vessel == &cup ? "cup, " : "room, ") << (body == &box ? "box " : "plate ") << i);
        const ShellData ground(*vessel, GeomForm::kOurs), data(*body, GeomForm::kOurs);
        StepWorld world(0.6);
        ground.geom(world.space());
        const dGeomID geom = data.geom(world.space());
        dMass mass;
        dMassSetBoxTotal(&mass, 1, 0.3, 0.3, 0.3);
        const dBodyID fallen = world.addBody(geom, mass);
        const double c = std::cos(0.4 * i), s = std::sin(0.4 * i);
        setPose(geom, {{c, 0, s, 0, 1, 0, -s, 0, c}, {0.02 * i, 0.01 * i, 0.1}});
        world.step(500);
        CHECK(dBodyGetPosition(fallen)[2] > -1.1);
      }
    }
  }
}
