// SPDX-License-Identifier: BSD-3-Clause
// Bodies that are jammed in others, as after a fall that no time step resolves: they come out, and nothing throws them.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/ode_world.h"
#include "support/slot_mesh.h"
#include "support/step_world.h"

using namespace otg;
using namespace otg::test;

namespace {

scenes::MeshArrays boxAt(Vec3d size, Vec3d at) {
  return scenes::transformed(scenes::makeBox(size), {{1, 0, 0, 0, 1, 0, 0, 0, 1}, at});
}

/// The same slot of blocks that reach into each other.
scenes::MeshArrays makeSlotOfBlocks() {
  return scenes::merge({boxAt({1.6, 3, 0.3}, {0, 0, -0.15}), boxAt({0.3, 3, 1.2}, {-0.65, 0, 0.4}),
                        boxAt({0.3, 3, 1.2}, {0.65, 0, 0.4})});
}

struct Course {
  double height = 0;   ///< in the end
  double fastest = 0;  ///< at any step
};

/// A bar with its middle at half the height of the slot, let go.
Course letGo(const scenes::MeshArrays& ground, const scenes::MeshArrays& body, double width) {
  const OdeSession session;
  const Data slot(ground), bar(body);
  StepWorld world;
  dCreateGpuTriMesh(world.space(), slot.id);
  dMass mass;
  dMassSetBox(&mass, 1000, width, 0.6, 0.6);
  const dBodyID moving = world.addBody(dCreateGpuTriMesh(world.space(), bar.id), mass);
  dBodySetPosition(moving, 0, 0, 0.6);
  Course course;
  for (int i = 0; i < 1000; ++i) {
    world.step(1);
    const dReal* const v = dBodyGetLinearVel(moving);
    course.fastest = std::max(course.fastest, std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
  }
  course.height = dBodyGetPosition(moving)[2];
  return course;
}

}  // namespace

TEST_CASE("a bar that is jammed in a slot comes out, and rests on it") {
  const std::vector<std::pair<std::string, scenes::MeshArrays>> slots = {
      {"one solid", makeSlot()},
      {"of many triangles", scenes::subdivided(makeSlot(), 3)},
      {"of blocks", makeSlotOfBlocks()}};
  for (const auto& [name, slot] : slots) {
    for (const double width : {1.15, 1.3}) {
      for (const int n : {1, 6}) {
        const Course course = letGo(slot, scenes::makeBox({width, 0.6, 0.6}, n), width);
        INFO("slot " << name << ", bar " << width << " of " << 12 * n * n << " triangles: height " << course.height
                     << ", fastest " << course.fastest);
        CHECK(course.height > 1.295);
        CHECK(course.height < 1.305);
        CHECK(course.fastest < 2);
      }
    }
  }
}

TEST_CASE("a bar that is hardly wider than a slot stays in it") {
  const Course course = letGo(makeSlot(), scenes::makeBox({1.01, 0.6, 0.6}), 1.01);
  INFO("height " << course.height << ", fastest " << course.fastest);
  CHECK(course.height < 0.61);
  CHECK(course.height > 0.29);
  CHECK(course.fastest < 2.6);  // that of its fall to the floor
}
