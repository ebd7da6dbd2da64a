// SPDX-License-Identifier: BSD-3-Clause
// Contours close, regions measure the overlap, and the push is the gradient of its volume: against closed forms and
// finite differences.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/vectors.h"
#include "collide/shortest_translation.h"
#include "collide/solid/contour.h"
#include "collide/solid/extent.h"
#include "collide/solid/inside.h"
#include "collide/solid/regions.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/make_query.h"
#include "support/posts.h"
#include "support/raised_corner.h"

using namespace otg;

namespace {

struct Overlap {
  Contour contour;
  InsideFlags inside;
  OverlapRegions regions;
  Query query;  // the regions' extents refer to it

  Overlap(const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose) {
    query.a = &a;
    query.b = &b;
    query.bInA = pose;
    Workspace workspace;
    findIntersectingPairs(query, workspace);
    const PlacedMeshes meshes(query);
    traceContour(meshes, workspace.intersecting, contour);
    floodInside(meshes, contour, inside);
    RegionBuilder().build(meshes, contour, inside, regions);
  }
  double volume() const {
    double sum = 0;
    for (const Region& r : regions.regions) sum += r.volume;
    return sum;
  }
  Vec3d push() const {
    Vec3d sum{0, 0, 0};
    for (const Region& r : regions.regions) sum = otgAdd(sum, r.push);
    return sum;
  }
  std::size_t anomalies() const { return contour.anomalies + inside.anomalies + regions.anomalies; }
};

Transformd at(const Vec3d& t) {
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, t};
}

Transformd randomPose(std::mt19937& random, double reach) {
  std::normal_distribution<double> normal;
  double q[4], length = 0;
  for (double& x : q) {
    x = normal(random);
    length += x * x;
  }
  for (double& x : q) x /= std::sqrt(length);
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  std::uniform_real_distribution<double> uniform(-reach, reach);
  return {
      {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
       2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
      {uniform(random), uniform(random), uniform(random)}};
}

/// Every crossing begins one chord and ends one: the contour is a set of closed loops.
void requireClosedContour(const Contour& contour) {
  std::vector<int> starts(contour.crossings.size(), 0), ends(contour.crossings.size(), 0);
  for (const Chord& chord : contour.chords) {
    ++starts[chord.start];
    ++ends[chord.end];
  }
  for (std::size_t i = 0; i < starts.size(); ++i) {
    REQUIRE(starts[i] == 1);
    REQUIRE(ends[i] == 1);
  }
}

}  // namespace

TEST_CASE("two boxes overlap in a box") {
  const CollisionMesh box(scenes::build(scenes::makeBox({1, 1, 1}, 3)), BuildStrategy::kSah);
  const Overlap o(box, box, at({0.75, 0.5, 0.25}));
  REQUIRE(o.regions.regions.size() == 1);
  CHECK(o.anomalies() == 0);
  CHECK(o.volume() == Approx(0.25 * 0.5 * 0.75).epsilon(1e-12));
  // A's right, back and top faces are inside B.
  CHECK(o.regions.regions[0].areaA == Approx(0.5 * 0.75 + 0.25 * 0.75 + 0.25 * 0.5).epsilon(1e-12));
  CHECK(o.push().x == Approx(-0.5 * 0.75).epsilon(1e-12));
  CHECK(o.push().y == Approx(-0.25 * 0.75).epsilon(1e-12));
  CHECK(o.push().z == Approx(-0.25 * 0.5).epsilon(1e-12));
}

TEST_CASE("aligned, touching and identical boxes have closed contours and no anomalies") {
  const CollisionMesh box(scenes::build(scenes::makeBox({1, 1, 1}, 2)), BuildStrategy::kSah);
  const CollisionMesh fine(scenes::build(scenes::makeBox({1, 1, 1}, 4)), BuildStrategy::kSah);
  for (const CollisionMesh* other : {&box, &fine}) {
    for (const double x : {0.0, 0.25, 0.5, 1.0, -1.0}) {
      for (const double y : {0.0, 0.5, -1.0}) {
        for (const double z : {0.0, 0.5, 1.0, -1.0, 0.999}) {
          const Overlap o(box, *other, at({x, y, z}));
          requireClosedContour(o.contour);
          CHECK(o.anomalies() == 0);
          const double expected = (1 - std::fabs(x)) * (1 - std::fabs(y)) * (1 - std::fabs(z));
          if (!o.regions.regions.empty()) CHECK(o.volume() == Approx(expected).margin(1e-12));
          if (expected > 0 && (x != 0 || y != 0 || z != 0)) CHECK_FALSE(o.regions.regions.empty());
        }
      }
    }
  }
}

TEST_CASE("a large region is measured as exactly as a small one") {
  // So fine that the region is described by cells; then the same overlap with few triangles.
  const CollisionMesh fine(scenes::build(scenes::makeBox({1, 1, 1}, 40)), BuildStrategy::kSah);
  const CollisionMesh coarse(scenes::build(scenes::makeBox({1, 1, 1}, 1)), BuildStrategy::kSah);
  const Overlap o(fine, fine, at({0.61, 0.47, 0.23})), reference(coarse, coarse, at({0.61, 0.47, 0.23}));
  REQUIRE(o.regions.regions.size() == 1);
  const Region &large = o.regions.regions[0], &small = reference.regions.regions[0];
  REQUIRE(large.cellEnd > large.cellBegin);
  REQUIRE(small.cellEnd == small.cellBegin);
  CHECK(o.anomalies() == 0);
  CHECK(large.volume == Approx(small.volume).epsilon(1e-6));  // the meshes' own coordinates are floats
  CHECK(large.areaA == Approx(small.areaA).epsilon(1e-6));
  CHECK(large.areaB == Approx(small.areaB).epsilon(1e-6));
  CHECK(norm(otgSub(large.push, small.push)) < 1e-6);
  // The cells' sums are the region's.
  Vec3d sum[2] = {{0, 0, 0}, {0, 0, 0}};
  double area[2] = {0, 0}, moment = 0;
  for (std::uint32_t i = large.pieceBegin; i < large.pieceEnd; ++i) {
    const Piece& p = o.regions.pieces[i];
    sum[p.mesh] = otgAdd(sum[p.mesh], p.vector);
    area[p.mesh] += p.area;
    moment += p.offset * norm(p.vector);
  }
  CHECK(norm(otgAdd(sum[0], sum[1])) < 1e-12);
  CHECK(norm(otgSub(otgScale(otgSub(sum[1], sum[0]), 0.5), large.push)) < 1e-12);
  CHECK(area[0] == Approx(large.areaA).epsilon(1e-12));
  CHECK(area[1] == Approx(large.areaB).epsilon(1e-12));
  CHECK(moment / 3 == Approx(large.volume).epsilon(1e-6));
  CHECK(large.pieceEnd - large.pieceBegin < 2000);
}

TEST_CASE("the description of a large region does not depend on the order in which its surface was found") {
  std::mt19937 random(3);
  const CollisionMesh a(scenes::build(scenes::makeLump(1, 5, 0.3, 8)), BuildStrategy::kSah);
  const CollisionMesh b(scenes::build(scenes::makeBox({1, 1, 1}, 30)), BuildStrategy::kSah);
  for (int i = 0; i < 6; ++i) {
    Overlap o(a, b, randomPose(random, 0.7));
    bool isLarge = false;
    for (const Region& r : o.regions.regions) isLarge = isLarge || r.cellEnd > r.cellBegin;
    REQUIRE(isLarge);
    InsideFlags& shuffled = o.inside;
    for (int m = 0; m < 2; ++m) {
      const auto vertices = shuffled.vertices[m];
      const auto positions = shuffled.positions[m];
      for (const InsideFlags::Patch& patch : shuffled.patches[m]) {
        std::vector<std::uint32_t> order(patch.vertexEnd - patch.vertexBegin);
        for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = patch.vertexBegin + k;
        std::shuffle(order.begin(), order.end(), random);
        for (std::uint32_t k = 0; k < order.size(); ++k) {
          shuffled.vertices[m][patch.vertexBegin + k] = vertices[order[k]];
          shuffled.positions[m][patch.vertexBegin + k] = positions[order[k]];
        }
        std::shuffle(shuffled.clusters[m].begin() + patch.clusterBegin, shuffled.clusters[m].begin() + patch.clusterEnd,
                     random);
      }
    }
    OverlapRegions again;
    RegionBuilder().build(PlacedMeshes(o.query), o.contour, shuffled, again);
    const auto same = [](const Vec3d& x, const Vec3d& y) { return x.x == y.x && x.y == y.y && x.z == y.z; };
    REQUIRE(again.regions.size() == o.regions.regions.size());
    REQUIRE(again.pieces.size() == o.regions.pieces.size());
    REQUIRE(again.points.size() == o.regions.points.size());
    for (std::size_t r = 0; r < again.regions.size(); ++r) {
      const Region &x = again.regions[r], &y = o.regions.regions[r];
      REQUIRE((same(x.push, y.push) && same(x.lo, y.lo) && same(x.hi, y.hi) && x.volume == y.volume));
      REQUIRE((x.areaA == y.areaA && x.areaB == y.areaB && x.coherence == y.coherence));
    }
    for (std::size_t k = 0; k < again.pieces.size(); ++k) {
      const Piece &x = again.pieces[k], &y = o.regions.pieces[k];
      REQUIRE((x.triangle == y.triangle && same(x.vector, y.vector) && x.offset == y.offset && same(x.lo, y.lo)));
    }
    for (std::size_t k = 0; k < again.points.size(); ++k) {
      const SupportPoint &x = again.points[k], &y = o.regions.points[k];
      REQUIRE((x.feature == y.feature && x.ordinal == y.ordinal && same(x.position, y.position)));
    }
  }
}

TEST_CASE("the extent of a large region is exact in every direction") {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const CollisionMesh a(scenes::build(scenes::makeLump(1, 5, 0.3, 8)), BuildStrategy::kSah);
  for (const Vec3d& t : {Vec3d{1.2, 0.1, 0}, Vec3d{0.2, 0.9, 0.4}}) {
    const Overlap o(a, a, at(t));
    int large = 0;
    for (std::uint32_t r = 0; r < o.regions.regions.size(); ++r) {
      const Region& region = o.regions.regions[r];
      if (region.cellEnd == region.cellBegin) continue;
      ++large;
      REQUIRE(o.regions.regions.size() == 1);  // so that every crossing and vertex is the region's
      RegionExtent extent(o.regions, region);
      for (int i = 0; i < 100; ++i) {
        const Vec3d d = unit({normal(random), normal(random), normal(random)});
        double lo = 1e9, hi = -1e9;
        const auto include = [&](const Vec3d& p) {
          const double x = otgDot(otgSub(p, o.regions.origin), d);
          lo = std::min(lo, x);
          hi = std::max(hi, x);
        };
        for (const Crossing& c : o.contour.crossings) include(c.point);
        const PlacedMeshes meshes(o.query);
        for (int m = 0; m < 2; ++m) {
          for (std::uint32_t v = 0; v < a.mesh().vertices().size(); ++v) {
            if (o.inside.isInside(m, v)) include(meshes.vertex(m, v));
          }
        }
        REQUIRE(extent.along(d) == Approx(hi - lo).epsilon(1e-13));
      }
    }
    CHECK(large == 1);
  }
}

TEST_CASE("two spheres overlap in a lens") {
  const CollisionMesh sphere(scenes::build(scenes::makeSphere(1, 5)), BuildStrategy::kSah);
  for (const double d : {1.9, 1.5, 1.0}) {
    const Overlap o(sphere, sphere, at({0, 0, d}));
    const double h = 1 - d / 2;
    REQUIRE(o.regions.regions.size() == 1);
    CHECK(o.volume() == Approx(2 * std::numbers::pi * h * h * (3 - h) / 3).epsilon(0.02));
    const double area = std::numbers::pi * (1 - d * d / 4);
    CHECK(o.push().z == Approx(-area).epsilon(0.01));
  }
}

TEST_CASE("the push is minus the gradient of the overlap's volume") {
  std::mt19937 random(5);
  const CollisionMesh a(scenes::build(scenes::makeTorus(1, 0.4, 40, 20)), BuildStrategy::kSah);
  const CollisionMesh b(scenes::build(scenes::makeLump(0.8, 3, 0.2, 3)), BuildStrategy::kSah);
  int tried = 0;
  for (int i = 0; i < 60; ++i) {
    const Transformd pose = randomPose(random, 1.2);
    const Overlap o(a, b, pose);
    requireClosedContour(o.contour);
    CHECK(o.anomalies() == 0);
    if (o.regions.regions.empty() || !o.inside.contained[0].empty() || !o.inside.contained[1].empty()) continue;
    ++tried;
    const double h = 1e-5;
    double gradient[3];
    for (int k = 0; k < 3; ++k) {
      Transformd forward = pose, back = pose;
      (&forward.t.x)[k] += h;
      (&back.t.x)[k] -= h;
      gradient[k] = (Overlap(a, b, forward).volume() - Overlap(a, b, back).volume()) / (2 * h);
    }
    // Moving B by +t changes the volume by gradient . t; the push moves A.
    const Vec3d push = o.push();
    CHECK(push.x == Approx(gradient[0]).margin(1e-4));
    CHECK(push.y == Approx(gradient[1]).margin(1e-4));
    CHECK(push.z == Approx(gradient[2]).margin(1e-4));
  }
  CHECK(tried > 20);
}

TEST_CASE("corners of a face that are in different posts are regions of their own") {
  // Between the posts the plate's lower face is outside, though all corners of its two triangles are inside.
  const CollisionMesh table(scenes::build(test::makePosts(0)), BuildStrategy::kSah);
  const CollisionMesh plate(scenes::build(test::makePlate()), BuildStrategy::kSah);
  const Overlap o(table, plate, at({0, 0, -0.01}));
  requireClosedContour(o.contour);
  CHECK(o.anomalies() == 0);
  REQUIRE(o.regions.regions.size() == 4);
  for (const Region& r : o.regions.regions) {
    CHECK(r.volume == Approx(0.9 * 0.9 * 0.01).epsilon(1e-6));
  }
}

TEST_CASE("a body wholly inside another is found, one in its cavity is not") {
  const scenes::MeshArrays outer = scenes::makeBox({4, 4, 4}, 1);
  const CollisionMesh solid(scenes::build(outer), BuildStrategy::kSah);
  scenes::MeshArrays cavity = scenes::makeBox({2, 2, 2}, 1);
  for (Triangle& t : cavity.triangles) std::swap(t.v[1], t.v[2]);
  const CollisionMesh hollow(scenes::build(scenes::merge({outer, cavity})), BuildStrategy::kSah);
  REQUIRE(hollow.mesh().meshClass() == MeshClass::kSolid);
  const CollisionMesh small(scenes::build(scenes::makeBox({1, 1, 1}, 1)), BuildStrategy::kSah);
  CHECK(Overlap(solid, small, at({0.3, 0.2, 0.1})).inside.contained[1].size() == 1);
  CHECK(Overlap(small, solid, at({0.3, 0.2, 0.1})).inside.contained[0].size() == 1);
  CHECK(Overlap(hollow, small, at({0.3, 0.2, 0.1})).inside.contained[1].empty());
  CHECK(Overlap(solid, small, at({3, 0, 0})).inside.contained[1].empty());
  // Touching from outside, on each side and in either role.
  for (const double d : {2.5, -2.5}) {
    for (const Vec3d& t : {Vec3d{d, 0.1, 0.2}, Vec3d{0.1, d, 0.2}, Vec3d{0.1, 0.2, d}}) {
      CHECK(Overlap(solid, small, at(t)).inside.contained[1].empty());
      CHECK(Overlap(small, solid, at(t)).inside.contained[0].empty());
    }
  }
}

TEST_CASE("contacts of bodies of another size are the same contacts in that size") {
  const scenes::MeshArrays first = scenes::makeLump(1, 3, 0.4, 5), second = scenes::makeGear(11, 0.8, 0.2, 0.4, 0.2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.9, 0.9);
  std::size_t compared = 0;
  for (int pose = 0; pose < 20; ++pose) {
    const double angle = 3 * place(random), c = std::cos(angle), s = std::sin(angle);
    const Transformd bInA{{c, -s, 0, s, c, 0, 0, 0, 1}, {place(random), place(random), place(random)}};
    std::vector<Contact> found[2];
    for (const int small : {0, 1}) {
      const double factor = small == 0 ? 1 : 0x1p-10;
      const Transformd scale{{factor, 0, 0, 0, factor, 0, 0, 0, factor}, {0, 0, 0}};
      const CollisionMesh a(scenes::build(scenes::transformed(first, scale)), BuildStrategy::kSah);
      const CollisionMesh b(scenes::build(scenes::transformed(second, scale)), BuildStrategy::kSah);
      Query query;
      query.a = &a;
      query.b = &b;
      query.bInA = {{c, -s, 0, s, c, 0, 0, 0, 1}, otgScale(bInA.t, factor)};
      query.options.contacts = ContactModel::kSolid;
      Workspace workspace;
      collide(query, workspace);
      found[small] = workspace.reduced;
    }
    CAPTURE(pose);
    REQUIRE(found[0].size() == found[1].size());
    for (std::size_t i = 0; i < found[0].size(); ++i) {
      const Contact &large = found[0][i], &small = found[1][i];
      CHECK(large.element == small.element);
      CHECK(norm(large.position - small.position * 0x1p10) < 1e-9);
      CHECK(std::fabs(large.depth - small.depth * 0x1p10) < 1e-9);
      CHECK(norm(large.normal - small.normal) < 1e-9);
      ++compared;
    }
  }
  CHECK(compared > 100);
}

TEST_CASE("a box upon two triangles leaves the one that rises beside the other") {
  test::Draw draw(5);
  for (int i = 0; i < 1000; ++i) {
    const double height = draw.uniform(0.01, 0.2), depth = height * draw.uniform(0.02, 0.5);
    const Vec3d half{draw.uniform(0.2, 0.69), draw.uniform(0.2, 0.69), draw.uniform(0.2, 0.5)};
    const CollisionMesh block(scenes::build(test::makeRaisedCorner(static_cast<float>(height))), BuildStrategy::kSah);
    const CollisionMesh box(scenes::build(scenes::makeBox(half * 2.0)), BuildStrategy::kSah);
    Query query = test::makeQuery(block, box, test::drawBoxPose(draw, half, depth));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 64;
    Workspace workspace;
    collide(query, workspace);
    ShortestTranslation way;
    for (const Contact& c : workspace.reduced) REQUIRE(way.add(c.normal, c.depth));
    double deepest = 0, left = 0;
    for (const double x : {-half.x, half.x}) {
      for (const double y : {-half.y, half.y}) {
        const Vec3d corner = otgTransform(query.bInA, {x, y, -half.z}), after = otgSub(corner, way.value());
        deepest = std::max(deepest, test::heightOfTop(corner.x, corner.y, height) - corner.z);
        left = std::max(left, test::heightOfTop(after.x, after.y, height) - after.z);
      }
    }
    CAPTURE(i, height, depth, deepest, left);
    CHECK(left < 0.02 * deepest);
    CHECK(norm(way.value()) < 1.1 * deepest);
  }
}

TEST_CASE("ridges across each other are as deep as they are where they pass, also where they count as flat") {
  const auto ridge = [](double height) {  // along a diagonal of the upper side, whose other corners are at 0
    const auto h = static_cast<float>(height);
    scenes::MeshArrays block;
    block.vertices = {{-1, -1, -0.4f}, {1, -1, -0.4f}, {1, 1, -0.4f}, {-1, 1, -0.4f},
                      {-1, -1, h},     {1, -1, 0},     {1, 1, h},     {-1, 1, 0}};
    block.triangles = {{{0, 2, 1}}, {{0, 3, 2}}, {{4, 5, 6}}, {{4, 6, 7}}, {{0, 1, 5}}, {{0, 5, 4}},
                       {{1, 2, 6}}, {{1, 6, 5}}, {{2, 3, 7}}, {{2, 7, 6}}, {{3, 0, 4}}, {{3, 4, 7}}};
    return scenes::build(block);
  };
  test::Draw draw(9);
  for (int i = 0; i < 400; ++i) {
    // Normals of the two sides of a ridge of 1e-3 are 0.08 degrees apart.
    const double height = i % 2 == 0 ? draw.uniform(1e-4, 1e-3) : draw.uniform(0.01, 0.1);
    const double depth = height * draw.uniform(0.02, 0.5), angle = draw.uniform(-1, 1);
    const CollisionMesh block(ridge(height), BuildStrategy::kSah);
    const double c = std::cos(angle), s = std::sin(angle);
    // Upside down, turned about the vertical, and so high that the ridges overlap by that depth.
    Query query = test::makeQuery(block, block, {{c, s, 0, s, -c, 0, 0, 0, -1}, {0, 0, 2 * height - depth}});
    query.bInA.t.x = draw.uniform(-0.2, 0.2);
    query.bInA.t.y = draw.uniform(-0.2, 0.2);
    query.options.contacts = ContactModel::kSolid;
    query.options.solid.convexPath = false;
    Workspace workspace;
    collide(query, workspace);
    double deepest = 0;
    for (const Contact& contact : workspace.reduced) deepest = std::max(deepest, contact.depth);
    CAPTURE(i, height, depth, angle, deepest / depth);
    CHECK(deepest > 0.95 * depth);
    CHECK(deepest < 1.05 * depth);
  }
}
