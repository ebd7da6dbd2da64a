// SPDX-License-Identifier: BSD-3-Clause
// A mesh with ODE's shapes: against a tessellation of the same shape as a second mesh, and against its own mirror
// image.
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/vectors.h"
#include "scenes/convex_geom.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/mirror.h"
#include "support/ode_trimesh.h"
#include "support/ode_world.h"
#include "truth/tessellated_bodies.h"

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

struct Shape {
  const char* name;
  std::function<dGeomID()> make;
  scenes::MeshArrays mesh;
  truth::ConvexBody body;
};

std::vector<Shape> shapes() {
  return {{"sphere", [] { return dCreateSphere(nullptr, 0.3); }, scenes::makeSphere(0.3, 5), truth::ballBody(0.3)},
          {"box", [] { return dCreateBox(nullptr, 0.5, 0.6, 0.4); }, scenes::makeBox({0.5, 0.6, 0.4}, 2),
           truth::boxBody({0.25, 0.3, 0.2})},
          {"capsule", [] { return dCreateCapsule(nullptr, 0.2, 0.6); }, scenes::makeCapsule(0.2, 0.6, 128, 32),
           truth::capsuleBody(0.2, 0.3)},
          {"cylinder", [] { return dCreateCylinder(nullptr, 0.2, 0.6); }, scenes::makeCylinder(0.2, 0.6, 96, 1),
           truth::cylinderBody(0.2, 0.3)}};
}

Transformd poseOf(dGeomID g) {
  const dReal *r = dGeomGetRotation(g), *t = dGeomGetPosition(g);
  return {{r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10]}, {t[0], t[1], t[2]}};
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
  truth::ConvexBody block = truth::boxBody({0.5, 0.35, 0.2});
  for (Shape& shape : shapes()) {
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
      // By formula, because the depths of bodies that go right through each other are clamped to small ones.
      block.pose = poseOf(mesh.id);
      shape.body.pose = poseOf(exact);
      if (truth::roughSeparation(block, shape.body) > 0.08) continue;
      const truth::WaysApart ways = truth::waysApart(block, shape.body, truth::kApartDegrees);
      if (ways.least > 0.05) continue;
      const dContactGeom *a = deepest(ours), *b = deepest(meshes);
      if ((a == nullptr) != (b == nullptr)) {
        // The tessellation is smaller than the shape, by 1 - cos(half a facet's angle) of its radius.
        REQUIRE(ways.least < 3e-3);
        ++onlyOne;
        continue;
      }
      if (a == nullptr) continue;
      depths.push_back(std::abs(a->depth - b->depth));
      if (ways.other <= (1 + truth::kAmbiguous) * ways.least) continue;
      angles.push_back(180 / M_PI * std::acos(std::clamp(otgDot(toVec(a->normal), toVec(b->normal)), -1.0, 1.0)));
    }
    INFO(shape.name << ": " << depths.size() << " overlaps, " << onlyOne << " seen by one; depth "
                    << quantile(depths, 0.5) << " / " << quantile(depths, 0.99) << " / " << quantile(depths, 1)
                    << ", angle " << quantile(angles, 0.5) << " / " << quantile(angles, 0.99) << " / "
                    << quantile(angles, 1));
    CHECK(angles.size() > 60);
    CHECK(quantile(depths, 0.5) < 2e-4);
    CHECK(quantile(depths, 0.99) < 0.01);
    CHECK(quantile(depths, 1) < 0.02);
    // Where two meshes are curved, or an edge is near a face's rim, their model leans by some degrees.
    CHECK(quantile(angles, 0.5) < 2);
    CHECK(quantile(angles, 0.99) < 25);
    CHECK(quantile(angles, 1) < 35);
    dGeomDestroy(exact);
  }
}

/// Whether the axis of a capsule of radius 0.2 and length 0.6 stays outside of a mesh: then its contacts are exact, and
/// else those of two meshes.
bool isAxisOutside(dGeomID mesh, const Transformd& pose) {
  constexpr int kPoints = 61;
  std::vector<dReal> points;
  std::vector<unsigned char> inside(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const Vec3d p = otgTransform(pose, Vec3d{0, 0, 0.01 * i - 0.3});
    points.insert(points.end(), {p.x, p.y, p.z});
  }
  const int found = dGeomGpuTriMeshPointsInside(mesh, points.data(), 3 * sizeof(dReal), kPoints, inside.data());
  REQUIRE(found >= 0);
  return found == 0;
}

TEST_CASE("a pair that is mirrored has mirrored contacts, with each shape, and exchanged geoms negated ones") {
  const OdeSession session;
  const scenes::MeshArrays lump = scenes::makeLump(0.5, 3, 0.3, 3);
  const Data data(lump), mirroredData(mirror(lump));
  const Geom mesh(data), image(mirroredData);
  // Two shapes that are not their own images.
  scenes::MeshArrays skew = scenes::makeSphere(0.35, 0);
  for (Vec3f& v : skew.vertices) v = {v.x + 0.3f * v.y, 0.8f * v.y, 0.6f * v.z + 0.1f * v.x};
  const scenes::ConvexData polyhedron(skew), polyhedronImage(mirror(skew));
  const OdeMesh native(scenes::makeLump(0.35, 2, 0.3, 9)), nativeImage(mirror(native.arrays));
  struct Images {
    const char* name;
    std::function<dGeomID()> make, makeImage;
  };
  std::vector<Images> all;
  for (const Shape& shape : shapes()) all.push_back({shape.name, shape.make, shape.make});
  all.push_back(
      {"convex", [&] { return polyhedron.makeGeom(nullptr); }, [&] { return polyhedronImage.makeGeom(nullptr); }});
  all.push_back({"dTriMesh", [&] { return dCreateTriMesh(nullptr, native.id, nullptr, nullptr, nullptr); },
                 [&] { return dCreateTriMesh(nullptr, nativeImage.id, nullptr, nullptr, nullptr); }});
  Draw draw(5);
  for (const Images& shape : all) {
    const dGeomID first = shape.make(), second = shape.makeImage();
    // The distances of spheres and capsules know nothing of the mesh's order. The others are met as meshes, of which
    // those of boxes and cylinders have diagonals that are not mirrored with them: where the surface is not convex,
    // other places are chosen.
    const int kind = dGeomGetClass(first);
    std::vector<double> depths, angles;
    int exact = 0;
    for (int i = 0; i < 400; ++i) {
      const Transformd poseOfMesh = makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(0.45));
      const Transformd poseOfShape = makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(0.45));
      setPose(mesh.id, poseOfMesh);
      setPose(first, poseOfShape);
      setPose(image.id, mirror(poseOfMesh));
      setPose(second, mirror(poseOfShape));
      for (const dGeomID g : {mesh.id, image.id}) dGeomGpuTriMeshForgetHistory(g);
      for (const dGeomID g : {first, second}) dGpuTriMeshOverrideForgetGeom(g);  // each pose is one of its own
      const auto contacts = test::collide(mesh.id, first), images = test::collide(image.id, second);
      REQUIRE(sameContacts(test::collide(first, mesh.id), test::mirrored(contacts)));
      INFO(shape.name << " pose " << i);
      REQUIRE(contacts.empty() == images.empty());
      if (contacts.empty() || deepest(contacts)->depth > 0.1) continue;
      const dContactGeom *a = deepest(contacts), *b = deepest(images);
      depths.push_back(std::abs(a->depth - b->depth));
      angles.push_back(norm(otgSub(mirror(toVec(a->normal)), toVec(b->normal))));
      if (kind != dSphereClass && (kind != dCapsuleClass || !isAxisOutside(mesh.id, poseOfShape))) continue;
      ++exact;
      REQUIRE(depths.back() < 1e-6);
      REQUIRE(angles.back() < 1e-5);
      // Every one has its image.
      REQUIRE(contacts.size() == images.size());
      for (const dContactGeom& c : contacts) {
        const bool found = std::any_of(images.begin(), images.end(), [&](const dContactGeom& d) {
          return norm(otgSub(mirror(toVec(c.pos)), toVec(d.pos))) < 1e-5 &&
                 norm(otgSub(mirror(toVec(c.normal)), toVec(d.normal))) < 1e-4 && std::abs(c.depth - d.depth) < 1e-5;
        });
        REQUIRE(found);
      }
    }
    INFO(shape.name << ": " << depths.size() << ", depth " << quantile(depths, 0.5) << " / " << quantile(depths, 0.9)
                    << " / " << quantile(depths, 1) << ", normal " << quantile(angles, 0.5) << " / "
                    << quantile(angles, 0.9) << " / " << quantile(angles, 1));
    CHECK(depths.size() > 30);
    CHECK((exact > 20) == (kind == dSphereClass || kind == dCapsuleClass));
    CHECK(quantile(depths, 0.5) < 1e-6);
    CHECK(quantile(angles, 0.5) < 1e-5);
    CHECK(quantile(depths, 0.9) < 5e-3);
    CHECK(quantile(angles, 0.9) < 0.1);
    dGeomDestroy(first);
    dGeomDestroy(second);
  }
}

TEST_CASE("a round shape whose middle is deep in a bumpy ball has contacts at each step") {
  const OdeSession session;
  constexpr std::uint32_t kWalks = 60;
  int steps = 0, without = 0;
  for (std::uint32_t seed = 0; seed < kWalks; ++seed) {
    Draw draw(seed);
    scenes::MeshArrays ball = scenes::makeSphere(0.45, 2);
    for (Vec3f& v : ball.vertices) {
      const Vec3d off = draw.inBox(0.02);
      v = scenes::toFloat({v.x + off.x, v.y + off.y, v.z + off.z});
    }
    const Data data(ball);
    const dGeomID mesh = dCreateGpuTriMesh(nullptr, data.id);
    const double radius = draw.uniform(0.1, 0.2), length = draw.uniform(0.2, 0.6);
    const dGeomID shape =
        seed % 4 == 3 ? dCreateCylinder(nullptr, radius, length) : dCreateCapsule(nullptr, radius, length);
    Vec3d middle = draw.inBox(0.2);
    const double stride = draw.uniform(0.002, 0.06);
    Vec3d axis = draw.direction();
    for (int i = 0; i < 60; ++i) {
      middle = (middle + draw.inBox(stride)) * (1 - 0.2 * stride);
      axis = unit(axis + draw.inBox(stride));
      if (norm(middle) > 0.35) continue;
      dMatrix3 turn;
      dRFromZAxis(turn, axis.x, axis.y, axis.z);
      dGeomSetRotation(shape, turn);
      dGeomSetPosition(shape, middle.x, middle.y, middle.z);
      ++steps;
      without += collide(mesh, shape, 16).empty();
    }
    dGeomDestroy(mesh);
    dGeomDestroy(shape);
  }
  CHECK(steps > 30 * static_cast<int>(kWalks));
  CHECK(without == 0);
}
