// SPDX-License-Identifier: BSD-3-Clause
// A mesh with ODE's shapes: against a tessellation of the same shape as a second mesh, and against its own mirror
// image.
#include <algorithm>
#include <cmath>
#include <functional>

#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

Vec3d toVec(const dReal* p) {
  return {p[0], p[1], p[2]};
}
const dContactGeom* deepest(const std::vector<dContactGeom>& contacts) {
  const auto it = std::max_element(contacts.begin(), contacts.end(),
                                   [](const dContactGeom& a, const dContactGeom& b) { return a.depth < b.depth; });
  return it == contacts.end() ? nullptr : &*it;
}

/// A sphere drawn apart along z.
scenes::MeshArrays makeCapsule(double radius, double halfLength, int level) {
  scenes::MeshArrays mesh = scenes::makeSphere(radius, level);
  // The ring at the equator of the subdivided icosahedron is none; triangles across it stretch to the straight side.
  for (Vec3f& v : mesh.vertices) v.z += static_cast<float>(v.z > 0 ? halfLength : -halfLength);
  return mesh;
}

struct Shape {
  const char* name;
  std::function<dGeomID()> make;
  scenes::MeshArrays mesh;
};

std::vector<Shape> shapes() {
  return {{"sphere", [] { return dCreateSphere(nullptr, 0.3); }, scenes::makeSphere(0.3, 5)},
          {"box", [] { return dCreateBox(nullptr, 0.5, 0.6, 0.4); }, scenes::makeBox({0.5, 0.6, 0.4}, 2)},
          {"capsule", [] { return dCreateCapsule(nullptr, 0.2, 0.6); }, makeCapsule(0.2, 0.3, 5)},
          {"cylinder", [] { return dCreateCylinder(nullptr, 0.2, 0.6); }, scenes::makeCylinder(0.2, 0.6, 96, 1)}};
}

void copyPose(dGeomID from, dGeomID to) {
  dGeomSetRotation(to, dGeomGetRotation(from));
  const dReal* p = dGeomGetPosition(from);
  dGeomSetPosition(to, p[0], p[1], p[2]);
}

double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

}  // namespace

TEST_CASE("each shape has with a mesh the contacts of its own tessellation as a second mesh") {
  const OdeSession session;
  const Data data(scenes::makeBox({1, 0.7, 0.4}, 3));
  const Geom mesh(data);
  for (const Shape& shape : shapes()) {
    const dGeomID exact = shape.make();
    const Data tessellated(shape.mesh);
    const Geom second(tessellated);
    std::mt19937 random(3);
    std::vector<double> depths, angles;
    int onlyOne = 0;
    for (int i = 0; i < 1500; ++i) {
      setRandomPose(mesh.id, random, 0.45);
      setRandomPose(exact, random, 0.45);
      copyPose(exact, second.id);
      const auto ours = test::collide(mesh.id, exact), meshes = test::collide(mesh.id, second.id);
      const dContactGeom *a = deepest(ours), *b = deepest(meshes);
      const double depth = std::max(a == nullptr ? 0 : a->depth, b == nullptr ? 0 : b->depth);
      if (depth > 0.05) continue;
      if ((a == nullptr) != (b == nullptr)) {
        // The tessellation is smaller than the shape, by 1 - cos(half a facet's angle) of its radius.
        REQUIRE(depth < 3e-3);
        ++onlyOne;
        continue;
      }
      if (a == nullptr) continue;
      depths.push_back(std::abs(a->depth - b->depth));
      angles.push_back(180 / M_PI * std::acos(std::clamp(otgDot(toVec(a->normal), toVec(b->normal)), -1.0, 1.0)));
    }
    INFO(shape.name << ": " << depths.size() << " overlaps, " << onlyOne << " seen by one; depth "
                    << quantile(depths, 0.5) << " / " << quantile(depths, 0.99) << " / " << quantile(depths, 1)
                    << ", angle " << quantile(angles, 0.5) << " / " << quantile(angles, 0.99) << " / "
                    << quantile(angles, 1));
    CHECK(depths.size() > 60);
    CHECK(quantile(depths, 0.5) < 1e-3);
    // Where two meshes are curved their model leans by some degrees.
    CHECK(quantile(angles, 0.5) < 5);
    dGeomDestroy(exact);
  }
}
