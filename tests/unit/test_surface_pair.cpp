// SPDX-License-Identifier: BSD-3-Clause
// Convex meshes on the surfaces of others: the same contacts in both orders of the two, that take the body out and no
// farther, by exact intersection of triangles; none where nothing meets; and which pairs are such.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/vectors.h"
#include "collide/shortest_translation.h"
#include "collide/stages.h"
#include "collide/surface/surface_contacts.h"
#include "primitives/convex_shape.h"
#include "queries/closest_point.h"
#include "scenes/concave_meshes.h"
#include "scenes/generated_meshes.h"
#include "shared/contacts/solid_model.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/hills.h"
#include "support/make_query.h"

using namespace otg;
using namespace otg::test;

namespace {

std::vector<std::shared_ptr<const CollisionMesh>> grounds() {
  return {meshOf(hills(24, 0.3)), meshOf(hills(12, 0)), meshOf(scenes::makeLump(2, 4, 0.2, 7)),
          meshOf(scenes::makeTorus(2, 0.8, 48, 24)), meshOf(scenes::makeTorus(0.5, 0.2, 24, 12))};
}

std::vector<std::shared_ptr<const CollisionMesh>> bodies() {
  std::vector<std::shared_ptr<const CollisionMesh>> all{
      meshOf(scenes::makeBox({0.5, 0.4, 0.3})),   meshOf(scenes::makeBox({0.6, 0.6, 0.05}, 4)),
      meshOf(scenes::makeCylinder(0.2, 0.5, 40)), meshOf(scenes::makeCapsule(0.15, 0.4, 13, 4)),
      meshOf(scenes::makeSphere(0.3, 1)),         meshOf(scenes::makeBox({4, 4, 1})),
  };
  Draw draw(8);
  std::vector<Vec3d> points;
  for (int k = 0; k < 16; ++k) points.push_back(draw.direction() * 0.3 + Vec3d{1, 2, -1});
  all.push_back(polyhedronShape(points)->mesh);
  return all;
}

Query queryOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  Query query = makeQuery(a, b, bInA);
  query.options.contacts = ContactModel::kSolid;
  query.options.solid.convexPath = true;
  return query;
}

bool areMeeting(const CollisionMesh& mesh, const CollisionMesh& body, Transformd pose, const Vec3d& move) {
  static Workspace workspace;
  pose.t = pose.t + move;
  findIntersectingPairs(queryOf(mesh, body, pose), workspace);
  return !workspace.intersecting.empty();
}

double radiusOf(const CollisionMesh& mesh) {
  return double{mesh.mesh().radius()};
}
Vec3d middleOf(const CollisionMesh& mesh) {
  return {mesh.mesh().center().x, mesh.mesh().center().y, mesh.mesh().center().z};
}

/// The body over a random triangle, as far along its normal as it first meets nothing, and then back by `share` of the
/// smaller radius.
Transformd drawPose(Draw& draw, const CollisionMesh& mesh, const CollisionMesh& body, double share) {
  const TriMesh& triangles = mesh.mesh();
  for (;;) {
    const std::uint32_t t = draw.below(static_cast<std::uint32_t>(triangles.triangleCount()));
    const Vec3f& corner = triangles.vertices()[triangles.triangles()[t].v[0]];
    const Vec3d normal = mesh.adjacency().normal[t], on{corner.x, corner.y, corner.z};
    if (std::max({std::fabs(on.x), std::fabs(on.y)}) > 3) continue;  // by a sheet's rim
    const Vec3d axis = draw.direction();
    const double angle = draw.below(2) == 0 ? draw.uniform(-3, 3) : draw.uniform(-0.1, 0.1);
    Transformd pose = makePose(axis, angle, on);
    pose.t = on - otgRotate(pose, middleOf(body));
    double in = 0, out = 2.5 * radiusOf(body);
    if (areMeeting(mesh, body, pose, normal * out) || !areMeeting(mesh, body, pose, normal * in)) continue;
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (in + out);
      (areMeeting(mesh, body, pose, normal * middle) ? in : out) = middle;
    }
    pose.t = pose.t + normal * (out - share * std::min(radiusOf(body), radiusOf(mesh)));
    return pose;
  }
}

double distanceToTriangle(const CollisionMesh& mesh, std::uint32_t triangle, const Vec3d& p) {
  const TriMesh& own = mesh.mesh();
  std::vector<Vec3f> corners;
  for (const std::uint32_t v : own.triangles()[own.triangleOfCaller(triangle)].v) corners.push_back(own.vertices()[v]);
  scenes::MeshArrays alone;
  alone.vertices = corners;
  alone.triangles = {{{0, 1, 2}}};
  return closestPoint(*meshOf(alone), p).distance;
}

double heightOver(const CollisionMesh& mesh, std::uint32_t triangle, const Vec3d& p) {
  const std::uint32_t t = mesh.mesh().triangleOfCaller(triangle);
  const Vec3f& corner = mesh.mesh().vertices()[mesh.mesh().triangles()[t].v[0]];
  return otgDot(mesh.adjacency().normal[t], p - Vec3d{corner.x, corner.y, corner.z});
}

}  // namespace

TEST_CASE("convex meshes on surfaces have the same contacts in both orders, which take them out and no farther") {
  Draw draw(21);
  Workspace workspace, turned, staged;
  int all = 0, found = 0, alone = 0;
  for (const auto& mesh : grounds()) {
    for (const auto& body : bodies()) {
      for (int i = 0; i < 25; ++i) {
        const Transformd pose = drawPose(draw, *mesh, *body, std::pow(10.0, draw.uniform(-4, -1)));
        const Query query = queryOf(*mesh, *body, pose), back = queryOf(*body, *mesh, inverseOf(pose));
        REQUIRE(isSurfacePair(query));
        REQUIRE(isSurfacePair(back));
        ++all;
        if (!collideSurfacePair(query, workspace)) continue;
        REQUIRE(collideSurfacePair(back, turned));
        ++found;
        INFO("triangles " << mesh->mesh().triangleCount() << " and " << body->mesh().triangleCount() << ", " << i);
        REQUIRE_FALSE(workspace.reduced.empty());
        REQUIRE(workspace.reduced.size() == turned.reduced.size());
        CHECK(workspace.stats.candidatePairs == 0);

        collide(query, workspace);
        findIntersectingPairs(query, staged);
        collideIntersecting(query, staged);
        numberAsCaller(query, staged);
        REQUIRE(staged.reduced.size() == workspace.reduced.size());
        for (std::size_t k = 0; k < staged.reduced.size(); ++k) {
          const Contact &x = staged.reduced[k], &y = workspace.reduced[k];
          CHECK((x.position.x == y.position.x && x.depth == y.depth && x.normal.z == y.normal.z));
          CHECK((x.triangleA == y.triangleA && x.triangleB == y.triangleB && x.element == y.element));
        }

        collide(back, turned);
        ShortestTranslation way;
        double deepest = 0;
        std::uint32_t regions = 0;
        for (const Contact& c : workspace.reduced) {
          REQUIRE(way.add(c.normal * -1.0, c.depth));
          deepest = std::max(deepest, c.depth);
          regions = std::max(regions, c.region + 1);
          const Vec3d half = c.normal * (0.5 * c.depth);
          const double slack = 2e-6 + OTG_SOLID_RANK_STEP * c.depth;
          // In an inner corner a face may hold what is beyond its edge.
          CHECK(std::fabs(heightOver(*mesh, c.triangleA, c.position - half)) < slack);
          const Vec3d onBody = otgRotateBack(pose, c.position + half - pose.t);
          CHECK(distanceToTriangle(*body, c.triangleB, onBody) < slack);
          const bool isThere = std::any_of(turned.reduced.begin(), turned.reduced.end(), [&](const Contact& x) {
            return norm(otgTransform(pose, x.position) - c.position) < 1e-9 &&
                   norm(otgRotate(pose, x.normal) + c.normal) < 1e-9 && std::fabs(x.depth - c.depth) < 1e-9 &&
                   x.element == c.element && isOfA(x.feature) != isOfA(c.feature) && x.region == c.region;
          });
          CHECK(isThere);
        }
        const double rounding = 6e-7;  // of meshes
        CHECK_FALSE(areMeeting(*mesh, *body, pose, way.value() * (1 + 1e-5 + rounding / norm(way.value()))));
        if (regions > 1) continue;
        ++alone;
        const double less = 1e-3 * deepest + 1e-6;
        if (less < deepest) CHECK(areMeeting(*mesh, *body, pose, way.value() * (1 - less / deepest)));
      }
    }
  }
  CHECK(found > 0.7 * all);
  CHECK(alone > 0.5 * all);
}

TEST_CASE("convex meshes that meet no surface have no contacts, but inside a solid they have") {
  Draw draw(5);
  Workspace workspace;
  for (const auto& mesh : grounds()) {
    for (const auto& body : bodies()) {
      for (int i = 0; i < 10; ++i) {
        Transformd pose = drawPose(draw, *mesh, *body, -std::pow(10.0, draw.uniform(-4, -1)));
        if (areMeeting(*mesh, *body, pose, {0, 0, 0})) continue;
        for (const bool isLast : {true, false}) {
          const Query query = isLast ? queryOf(*mesh, *body, pose) : queryOf(*body, *mesh, inverseOf(pose));
          CHECK(collideSurfacePair(query, workspace));
          CHECK(workspace.reduced.empty());
        }
      }
    }
  }
  const auto lump = meshOf(scenes::makeLump(2, 4, 0.2, 7)), box = meshOf(scenes::makeBox({0.2, 0.2, 0.2}));
  for (const bool isLast : {true, false}) {
    const Query query = isLast ? queryOf(*lump, *box, makeMove({0, 0, 0})) : queryOf(*box, *lump, makeMove({0, 0, 0}));
    REQUIRE(isSurfacePair(query));
    CHECK_FALSE(collideSurfacePair(query, workspace));
    collide(query, workspace);
    CHECK_FALSE(workspace.reduced.empty());
  }
}

TEST_CASE("an inner corner elsewhere on a mesh does not change contacts") {
  Draw draw(4);
  Workspace workspace, other;
  const scenes::MeshArrays arrays = hills(24, 0.3);
  scenes::MeshArrays pitted = arrays;
  for (Vec3f& v : pitted.vertices) {
    if (v.x < -2.5F && v.y < -2.5F) v.z -= 3;
  }
  const auto mesh = meshOf(arrays), withPit = meshOf(pitted);
  REQUIRE(mesh->adjacency().hollowEdges == 0);
  REQUIRE(withPit->adjacency().hollowEdges > 0);
  int found = 0;
  for (const auto& body : bodies()) {
    if (radiusOf(*body) > 1) continue;
    for (int i = 0; i < 40; ++i) {
      const Transformd pose = drawPose(draw, *mesh, *body, std::pow(10.0, draw.uniform(-2, -0.5)));
      const Vec3d middle = otgTransform(pose, middleOf(*body));
      if (middle.x < -1.5 && middle.y < -1.5) continue;
      const bool isSuch = collideSurfacePair(queryOf(*mesh, *body, pose), workspace);
      REQUIRE(collideSurfacePair(queryOf(*withPit, *body, pose), other) == isSuch);
      if (!isSuch) continue;
      ++found;
      REQUIRE(other.reduced.size() == workspace.reduced.size());
      for (std::size_t k = 0; k < other.reduced.size(); ++k) {
        CHECK(norm(other.reduced[k].position - workspace.reduced[k].position) < 1e-12);
        CHECK(std::fabs(other.reduced[k].depth - workspace.reduced[k].depth) < 1e-12);
      }
    }
  }
  CHECK(found > 60);
}

TEST_CASE("a body leaves the highest vertices of a face that rounding has bent") {
  Draw draw(12);
  Workspace workspace;
  const auto body = meshOf(scenes::makeBox({0.5, 0.4, 0.3}));
  int found = 0;
  for (int i = 0; i < 60; ++i) {
    // A plane, turned anyhow and far out, has vertices beside it by single precision.
    scenes::MeshArrays plane = hills(6, 0);
    const Transformd turn = makePose(draw.direction(), draw.uniform(-3, 3), draw.direction() * 30.0);
    for (Vec3f& v : plane.vertices) v = scenes::toFloat(otgTransform(turn, {v.x, v.y, v.z}));
    const auto mesh = meshOf(plane);
    Transformd pose = makePose(draw.direction(), draw.uniform(-3, 3), {0, 0, 0});
    pose.t = otgTransform(turn, {0.2, 0.1, 0});
    const Vec3d up = otgRotate(turn, {0, 0, 1});
    double in = 0, out = 1;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (in + out);
      (areMeeting(*mesh, *body, pose, up * middle) ? in : out) = middle;
    }
    pose.t = pose.t + up * (out - 2e-5);
    if (!collideSurfacePair(queryOf(*mesh, *body, pose), workspace) || workspace.reduced.empty()) continue;
    ++found;
    ShortestTranslation way;
    for (const Contact& c : workspace.reduced) REQUIRE(way.add(c.normal * -1.0, c.depth));
    CHECK_FALSE(areMeeting(*mesh, *body, pose, way.value() * (1 + 1e-4)));
  }
  CHECK(found > 40);
}

TEST_CASE("a convex mesh meets a surface where the options ask for it") {
  const auto lump = meshOf(scenes::makeLump(2, 3, 0.2, 7)), box = meshOf(scenes::makeBox({1, 1, 1}));
  const auto ball = meshOf(scenes::makeSphere(1, 3)), sheet = meshOf(hills(8, 0.2));
  const Transformd pose = makeMove({0, 0, 2});
  CHECK(isSurfacePair(queryOf(*lump, *box, pose)));
  CHECK(isSurfacePair(queryOf(*box, *sheet, pose)));
  CHECK_FALSE(isSurfacePair(queryOf(*box, *box, pose)));
  CHECK_FALSE(isSurfacePair(queryOf(*lump, *lump, pose)));
  CHECK_FALSE(isSurfacePair(queryOf(*lump, *ball, pose)));  // 1,280 faces
  Query query = queryOf(*lump, *box, pose);
  query.isOffSurface = true;
  CHECK_FALSE(isSurfacePair(query));
  query = queryOf(*lump, *box, pose);
  query.options.solid.convexPath = false;
  CHECK_FALSE(isSurfacePair(query));
  query = queryOf(*lump, *box, pose);
  query.options.contacts = ContactModel::kPairwise;
  CHECK_FALSE(isSurfacePair(query));
}
