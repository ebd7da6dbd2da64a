// SPDX-License-Identifier: BSD-3-Clause
// The oracle of `otg bench contacts`: overlaps whose volume and gradient are known, and formulas of separation against
// brute force.
#include <cmath>
#include <numbers>

#include "base/vectors.h"
#include "collide/solid/inside.h"
#include "collide/solid/regions.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "truth/contact_errors.h"
#include "truth/overlap_volume.h"
#include "truth/separation.h"

using namespace otg;
using namespace otg::test;

namespace {

constexpr double kPi = std::numbers::pi;

void checkVector(const Vec3d& got, const Vec3d& expected, double margin) {
  CHECK(got.x == Approx(expected.x).margin(margin));
  CHECK(got.y == Approx(expected.y).margin(margin));
  CHECK(got.z == Approx(expected.z).margin(margin));
}

}  // namespace

TEST_CASE("the overlap of two boxes is a box, with its gradient") {
  const auto box = scenes::build(scenes::makeBox({1, 1, 1}, 3));
  const auto g = truth::volumeGradient(*box, *box, makeMove({0.75, 0.5, 0.25}));
  CHECK(g.overlap.volume == Approx(0.25 * 0.5 * 0.75).epsilon(1e-12));
  checkVector(g.overlap.centroid, {0.375, 0.25, 0.125}, 1e-12);
  checkVector(g.push, {-0.5 * 0.75, -0.25 * 0.75, -0.25 * 0.5}, 1e-9);
  checkVector(g.moment, {0, 0, 0}, 1e-9);
  CHECK(truth::overlapOf(*box, *box, makeMove({1.5, 0, 0})).volume == 0);
  CHECK(truth::overlapOf(*box, *box, makeMove({0, 0, 0})).volume == Approx(1).epsilon(1e-12));
  // Contained: all of the smaller one, and nothing to be gained by a small move.
  const auto large = scenes::build(scenes::makeBox({4, 4, 4}, 2));
  const auto inside = truth::volumeGradient(*large, *box, makePose({0.6, 0, 0.8}, 0.7, {0.5, 0.2, 0.1}));
  CHECK(inside.overlap.volume == Approx(1).epsilon(1e-6));
  checkVector(inside.overlap.centroid, {0.5, 0.2, 0.1}, 1e-6);
  checkVector(inside.push, {0, 0, 0}, 1e-9);
}

TEST_CASE("squares turned in each other: the overlap and what turns them back") {
  // Two concentric unit squares turned by t overlap in 2 / (1 + sin t + cos t); here they are prisms, one shorter.
  const auto a = scenes::build(scenes::makeBox({1, 1, 1}, 2)), b = scenes::build(scenes::makeBox({1, 1, 0.5}, 1));
  for (const double t : {0.1, 0.5, 1.0, 1.4}) {
    const double s = 1 + std::sin(t) + std::cos(t);
    const auto g = truth::volumeGradient(*a, *b, makePose({0, 0, 1}, t, {0, 0, 0.5}));
    CHECK(g.overlap.volume == Approx(0.25 * 2 / s).epsilon(1e-7));
    // Turning A by +u makes the angle t - u; the moment is -dV/du.
    checkVector(g.moment, {0, 0, -0.25 * 2 * (std::cos(t) - std::sin(t)) / (s * s)}, 1e-7);
    checkVector(g.push, {0, 0, -2 / s}, 1e-7);
  }
}

TEST_CASE("the overlap of two spheres approaches the lens as they are subdivided") {
  const double d = 1.4, h = 1 - d / 2;
  const double lens = 2 * kPi * h * h * (3 - h) / 3, area = kPi * (1 - d * d / 4);
  double before = 0, areaBefore = 0;
  for (const int level : {2, 3, 4, 5}) {
    const auto sphere = scenes::build(scenes::makeSphere(1, level));
    const auto g = truth::volumeGradient(*sphere, *sphere, makePose({0, 0.6, 0.8}, 0.3, {0.6 * d, 0, 0.8 * d}));
    const double error = lens - g.overlap.volume;
    const double areaError = area - std::sqrt(otgDot(g.push, g.push));
    CHECK(error > 0);
    if (level > 2) {
      CHECK(before / error > 3.4);  // 4 in the limit: the facets' distance falls with the square of their size
      CHECK(before / error < 4.6);
      CHECK(areaBefore / areaError > 3);
    }
    before = error;
    areaBefore = areaError;
    // Each is nearer to a sphere the finer it is, and so is the direction.
    CHECK(truth::angleBetween(g.push, {-0.6, 0, -0.8}) < 20 / std::pow(4, level));
  }
  CHECK(before < 0.005 * lens);
}

TEST_CASE("the gradient agrees with the areas that the contact model computes, for bodies with holes and dents") {
  const CollisionMesh torus(scenes::build(scenes::makeTorus(1, 0.4, 40, 20)), BuildStrategy::kSah);
  const CollisionMesh lump(scenes::build(scenes::makeLump(0.8, 3, 0.2, 3)), BuildStrategy::kSah);
  Draw draw(5);
  int tried = 0;
  for (int i = 0; i < 24; ++i) {
    const Vec3d axis = draw.direction();
    const double angle = draw.uniform(0, 6);
    Query query;
    query.a = &torus;
    query.b = &lump;
    query.bInA = makePose(axis, angle, draw.inBox(1.2));
    Workspace workspace;
    findIntersectingPairs(query, workspace);
    const PlacedMeshes meshes(query);
    Contour contour;
    InsideFlags inside;
    OverlapRegions regions;
    traceContour(meshes, workspace.intersecting, contour);
    floodInside(meshes, contour, inside);
    RegionBuilder().build(meshes, contour, inside, regions);
    if (regions.regions.empty()) continue;
    ++tried;
    double volume = 0;
    Vec3d push{0, 0, 0};
    for (const Region& r : regions.regions) {
      volume += r.volume;
      push = otgAdd(push, r.push);
    }
    const auto g = truth::volumeGradient(torus.mesh(), lump.mesh(), query.bInA);
    CHECK(g.overlap.volume == Approx(volume).margin(1e-9));
    checkVector(g.push, push, 1e-7);
  }
  CHECK(tried > 12);
}

TEST_CASE("no direction separates boxes sooner than the separating-axis answer") {
  const Vec3d halfA{1, 0.8, 0.6}, halfB{0.5, 0.4, 0.7};
  const auto a = scenes::build(scenes::makeBox(otgScale(halfA, 2.0))),
             b = scenes::build(scenes::makeBox(otgScale(halfB, 2.0)));
  Draw draw(3);
  for (int i = 0; i < 40; ++i) {
    const Vec3d axis = draw.direction();
    const double angle = i < 10 ? 0 : draw.uniform(0, 3);
    const Transformd pose = makePose(axis, angle, draw.inBox(0.7));
    const truth::Separation answer = truth::boxBox(halfA, halfB, pose);
    CHECK(truth::extentDepth(*a, *b, pose, answer.direction) == Approx(answer.depth).epsilon(1e-6));
    for (int k = 0; k < 2000; ++k) {
      REQUIRE(truth::extentDepth(*a, *b, pose, draw.direction()) >= answer.depth * (1 - 1e-6));
    }
    // In small steps around the answer, too.
    for (int k = 0; k < 500; ++k) {
      Vec3d d = otgAdd(answer.direction, draw.inBox(0.02));
      d = otgScale(d, 1 / norm(d));
      REQUIRE(truth::extentDepth(*a, *b, pose, d) >= answer.depth * (1 - 1e-6));
    }
  }
}

TEST_CASE("distances are those of the nearest points, gradients point away from them") {
  Draw draw(8);
  const Vec3d half{1, 0.8, 0.6};
  for (int i = 0; i < 200; ++i) {
    const Vec3d p = draw.inBox(2);
    const truth::Distance all[] = {truth::distanceToBall(0.7, p), truth::distanceToBox(half, p),
                                   truth::distanceToCylinder(0.5, 1, p), truth::distanceToTorus(1, 0.4, p)};
    for (const truth::Distance& d : all) {
      CHECK(otgDot(d.outward, d.outward) == Approx(1));
      // Going back by the distance along the gradient leads to the surface.
      const Vec3d q = otgSub(p, otgScale(d.outward, d.value));
      const double there = &d == &all[0]   ? truth::distanceToBall(0.7, q).value
                           : &d == &all[1] ? truth::distanceToBox(half, q).value
                           : &d == &all[2] ? truth::distanceToCylinder(0.5, 1, q).value
                                           : truth::distanceToTorus(1, 0.4, q).value;
      CHECK(there == Approx(0).margin(1e-12));
    }
  }
  CHECK(truth::distanceToTorus(1, 0.4, {0, 0, 0}).value == Approx(0.6));
  CHECK(truth::distanceToCylinder(0.5, 1, {0.8, 0, 1.4}).value == Approx(0.5));
  CHECK(truth::distanceToBox(half, {0.9, 0, 0}).value == Approx(-0.1));
}

TEST_CASE("quantiles and wrenches") {
  truth::Errors errors;
  CHECK(errors.largest() == 0);
  for (const double x : {5.0, 1.0, 2.0, 4.0, 3.0}) errors.add(x);
  CHECK(errors.quantile(0.5) == 3);
  CHECK(errors.quantile(0.95) == 5);
  CHECK(errors.quantile(0.2) == 1);
  CHECK(errors.largest() == 5);
  const truth::PlainContact contacts[] = {{{1, 0, 0}, {0, 0, 1}, 2}, {{-1, 0, 0}, {0, 0, 1}, 1}};
  const truth::Wrench wrench = truth::wrenchOf(contacts, {0, 0, 0});
  checkVector(wrench.force, {0, 0, 3}, 0);
  checkVector(wrench.moment, {0, -1, 0}, 0);
  CHECK(truth::armError(wrench, {{0, 0, 6}, {0, 0, 0}}) == Approx(1.0 / 3));
  CHECK(truth::angleBetween({1, 0, 0}, {0, 2, 0}) == Approx(90));
  CHECK(truth::angleBetween({0, 0, 0}, {0, 2, 0}) == 180);
}
