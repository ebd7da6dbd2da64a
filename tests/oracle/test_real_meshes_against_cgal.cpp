// SPDX-License-Identifier: BSD-3-Clause
// Sets of intersecting triangle pairs of scanned and modelled meshes against CGAL's.
#include <algorithm>
#include <numbers>

#include "oracle/off_mesh.h"
#include "oracle/pair_checks.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

/// Scaled to a bounding radius of about one, because the files' units differ by orders of magnitude.
BothTrees load(const std::string& name) {
  scenes::MeshArrays arrays = readOff(OTG_ORACLE_MESH_DIR "/" + name + ".off");
  REQUIRE(arrays.triangles.size() >= 1000);
  const float scale = 1 / scenes::build(arrays)->radius();
  for (Vec3f& v : arrays.vertices) v = otgScale(v, scale);
  return BothTrees(scenes::build(arrays));
}

Vec3d centerOf(const TriMesh& mesh) {
  return {mesh.center().x, mesh.center().y, mesh.center().z};
}

/// B turned at random, its centre at `reach` radii from A's.
Transformd poseFor(Draw& draw, const TriMesh& a, const TriMesh& b, double reach) {
  Transformd pose = makePose(draw.direction(), draw.uniform(-3, 3), {0, 0, 0});
  const Vec3d target = otgAdd(centerOf(a), otgScale(draw.direction(), reach * a.radius()));
  pose.t = otgSub(target, otgTransform(pose, centerOf(b)));
  return pose;
}

}  // namespace

TEST_CASE("pairs of different real meshes") {
  const std::vector<BothTrees> meshes = {load("elephant"), load("pinion"), load("knot1"), load("couplingdown"),
                                         load("armadillo")};
  Draw draw(11);
  std::size_t pairs = 0;
  for (const BothTrees& a : meshes) {
    for (const BothTrees& b : meshes) {
      if (&a == &b) continue;
      pairs += checkPose(a, b, poseFor(draw, a.mesh(), b.mesh(), draw.uniform(0.2, 1)), draw.below(kVariants));
    }
  }
  CHECK(pairs > 5000);
}

TEST_CASE("copies of one real mesh, at random poses, on itself and nearly on itself") {
  Draw draw(12);
  for (const char* name : {"elephant", "pinion", "knot1", "couplingdown"}) {
    const BothTrees mesh = load(name);
    std::size_t pairs = 0;
    for (int round = 0; round < 3; ++round) {
      pairs += checkPose(mesh, mesh, poseFor(draw, mesh.mesh(), mesh.mesh(), 0.6), draw.below(kVariants));
    }
    CHECK(pairs > 0);
    CHECK(checkPose(mesh, mesh, makeMove({0, 0, 0}), draw.below(kVariants)) > 4 * mesh.mesh().triangleCount() - 100);
    checkPose(mesh, mesh, makeMove(otgScale(draw.direction(), 1e-7 * mesh.mesh().radius())), draw.below(kVariants));
  }
}

TEST_CASE("two armadillos in all variants") {
  const BothTrees armadillo = load("armadillo");
  Transformd pose = makePose({0, 1, 0}, std::numbers::pi / 2, {0, 0, 0});
  pose.t = otgSub(otgAdd(centerOf(armadillo.mesh()), otgVec(0.6 * armadillo.mesh().radius(), 0.0, 0.0)),
                  otgTransform(pose, centerOf(armadillo.mesh())));
  CHECK(checkPoseInAllVariants(armadillo, armadillo, pose) > 500);
}
