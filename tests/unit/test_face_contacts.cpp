// SPDX-License-Identifier: BSD-3-Clause
// Convex shapes on faces of a mesh that no outer edge interrupts: against half spaces, and where they decline.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/vectors.h"
#include "collide/solid/look_ahead.h"
#include "collide/stages.h"
#include "collide/surface/face_contacts.h"
#include "primitives/convex_contacts.h"
#include "scenes/concave_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/make_query.h"

using namespace otg;
using namespace otg::test;

namespace {

std::unique_ptr<const CollisionMesh> meshOf(const scenes::MeshArrays& arrays) {
  return std::make_unique<const CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
}

struct Plane {
  Vec3d normal;
  double offset;
};

/// What is in front of all planes is free; elsewhere nothing is near.
struct Place {
  std::string name;
  scenes::MeshArrays mesh;
  std::vector<Plane> planes;
};

scenes::MeshArrays openFloor(int cells) {
  scenes::MeshArrays mesh;
  const int n = cells + 1;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto at = [&](int k) { return static_cast<float>(8.0 * k / cells - 4); };
      mesh.vertices.push_back({at(i), at(j), 0.25f});
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const auto v = static_cast<std::uint32_t>(j * n + i), above = v + static_cast<std::uint32_t>(n);
      mesh.triangles.push_back({{v, v + 1, above + 1}});
      mesh.triangles.push_back({{v, above + 1, above}});
    }
  }
  return mesh;
}

std::vector<Plane> wallsOf(const Vec3d& half, bool hasTop) {
  std::vector<Plane> planes;
  for (const double side : {1.0, -1.0}) {
    planes.push_back({{-side, 0, 0}, -half.x});
    planes.push_back({{0, -side, 0}, -half.y});
  }
  planes.push_back({{0, 0, 1}, -half.z});
  if (hasTop) planes.push_back({{0, 0, -1}, -half.z});
  return planes;
}

std::vector<Place> places() {
  std::vector<Place> all;
  for (const int cells : {1, 2, 5}) {
    all.push_back({"floor of " + std::to_string(2 * cells * cells), openFloor(cells), {{{0, 0, 1}, 0.25}}});
  }
  for (const int levels : {0, 1}) {
    const std::string fine = levels > 0 ? ", fine" : "";
    all.push_back(
        {"room" + fine, scenes::subdivided(scenes::makeRoom({4, 6, 3}, 0.5), levels), wallsOf({2, 3, 1.5}, true)});
    Place tray{"tray" + fine, scenes::subdivided(scenes::makeTray({4, 4, 2}, 0.25), levels), wallsOf({2, 2, 0}, false)};
    tray.planes.back().offset = 0;
    all.push_back(tray);
    all.push_back({"corner" + fine,
                   scenes::subdivided(scenes::makeCorner(6, 0.5, 8), levels),
                   {{{1, 0, 0}, 0.5}, {{0, 0, 1}, 0.5}}});
  }
  return all;
}

std::vector<std::shared_ptr<const ConvexShape>> shapes(Draw& draw) {
  std::vector<Vec3d> points(24);
  for (Vec3d& p : points) {
    const Vec3d d = draw.direction();
    p = {static_cast<float>(0.4 * d.x), static_cast<float>(0.3 * d.y), static_cast<float>(0.2 * d.z)};
  }
  return {boxShape({0.25, 0.25, 0.25}), boxShape({0.5, 0.25, 0.125}), boxShape({0.5, 0.5, 0.015625}),
          cylinderShape(0.25, 0.25),    cylinderShape(0.5, 0.0625),   cylinderShape(0.0625, 0.5),
          polyhedronShape(points)};
}

double deepestIn(const Plane& plane, const ConvexShape& shape, const Transformd& pose) {
  const Vec3d rear = otgTransform(pose, shape.support(otgRotateBack(pose, plane.normal) * -1.0));
  return plane.offset - otgDot(plane.normal, rear);
}

Transformd drawTurn(Draw& draw) {
  const Vec3d axis = draw.direction();
  const std::uint32_t kind = draw.below(4);
  const double tilt = std::pow(10.0, draw.uniform(-6, -1));
  if (kind == 0) return makePose(axis, draw.uniform(-3, 3), {});
  if (kind == 1) return makeQuarterTurn(draw.below(24), {});
  return makePose(axis, kind == 2 ? tilt : 1e-9, {});
}

/// Overlapped with some walls of a place by up to `deepest` of the shape's radius, and clear of the others.
Transformd drawPose(Draw& draw, const Place& place, const ConvexShape& shape, double deepest) {
  const double radius = shape.mesh->mesh().radius();
  Transformd pose = drawTurn(draw);
  pose.t = {0, 0, 0};
  for (const Plane& plane : place.planes) {  // somewhere in front of all
    if (plane.normal.x + plane.normal.y + plane.normal.z > 0) pose.t = pose.t + plane.normal * (plane.offset + 1);
  }
  const Vec3d aside = draw.inBox(0.4);
  pose.t = pose.t + aside;
  const std::uint32_t first = draw.below(static_cast<std::uint32_t>(place.planes.size()));
  const std::uint32_t count = 1 + draw.below(3);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Plane& plane = place.planes[(first + k) % place.planes.size()];
    const double depth = deepest * radius * draw.uniform(0.01, 1);
    pose.t = pose.t + plane.normal * (deepestIn(plane, shape, pose) - depth);
  }
  return pose;
}

Query queryOf(const CollisionMesh& mesh, const ConvexShape& shape, const Transformd& pose) {
  Query query = makeQuery(mesh, *shape.mesh, pose);
  query.options.contacts = ContactModel::kSolid;
  query.options.solid.convexPath = true;
  return query;
}

bool collideFaces(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  NearSurface near(query, shape, isCornered(query.a), std::numeric_limits<double>::infinity());
  workspace.clear();
  if (!near.collect() || !addFaceContacts(near, workspace)) return false;
  finishContacts(query, workspace);
  return true;
}

}  // namespace

TEST_CASE("a shape leaves each face of an inner corner by its own way") {
  Draw draw(71);
  Workspace workspace;
  int found = 0, several = 0, all = 0;
  for (const Place& place : places()) {
    const auto mesh = meshOf(place.mesh);
    for (const auto& shape : shapes(draw)) {
      for (int i = 0; i < 60; ++i) {
        const Transformd pose = drawPose(draw, place, *shape, 0.03);
        ++all;
        if (!collideFaces(queryOf(*mesh, *shape, pose), *shape, workspace)) continue;
        ++found;
        int touched = 0;
        for (const Plane& plane : place.planes) {
          const double depth = deepestIn(plane, *shape, pose);
          double most = 0;
          for (const Contact& c : workspace.reduced) {
            if (otgDot(c.normal, plane.normal) > -0.9) continue;
            most = std::max(most, c.depth);
            CHECK(otgDot(c.normal, plane.normal) == Approx(-1));
            // Its ends are on the plane, and on the shape below it. A rim's point may stand for the deepest beside it.
            const double slack = (shape->isCurved() ? 0.01 * c.depth : 0) + 1e-7;
            const Vec3d end = c.position + c.normal * (0.5 * c.depth), other = c.position - c.normal * (0.5 * c.depth);
            CHECK(std::fabs(otgDot(plane.normal, other) - plane.offset) < slack);
            const Vec3d local = otgRotateBack(pose, end - pose.t);
            CHECK(shape->isNearSegment(local, local, slack));
            CHECK_FALSE(shape->isNearSegment(local, local, -slack));
          }
          INFO(place.name << ", shape " << static_cast<int>(shape->kind) << ", member " << i);
          CHECK(most == Approx(std::max(depth, 0.0)).margin(1e-12));
          touched += depth > 0;
        }
        several += touched > 1;
        for (const Contact& c : workspace.reduced) {
          const auto isIts = [&](const Plane& p) { return otgDot(c.normal, p.normal) < -0.9; };
          CHECK(std::any_of(place.planes.begin(), place.planes.end(), isIts));
        }
      }
    }
  }
  // Others come to lie on an outer edge of a tray's rim, or may move into a further wall.
  CHECK(found > 0.8 * all);
  CHECK(several > 0.3 * all);
}

TEST_CASE("places with outer edges, rims and thin walls are left to the stages for any solids") {
  Workspace workspace;
  const auto box = boxShape({0.25, 0.25, 0.25});
  const auto asks = [&](const CollisionMesh& mesh, const Vec3d& at, double tilt = 0) {
    const Query query = queryOf(mesh, *box, makePose({0, 1, 0}, tilt, at));
    return collideFaces(query, *box, workspace);
  };
  const auto floor = meshOf(openFloor(2));
  CHECK(asks(*floor, {1, 1, 0.49}));
  CHECK(asks(*floor, {3.7, 1, 0.49}));
  CHECK_FALSE(asks(*floor, {3.9, 1, 0.49}));  // over the rim
  CHECK_FALSE(asks(*floor, {4.3, 1, 0.49}));  // beside it, where only the plane goes on
  CHECK_FALSE(asks(*floor, {1, 1, 0.51}));    // apart
  CHECK_FALSE(asks(*floor, {1, 1, 0.2}));     // more than half below
  CHECK_FALSE(asks(*floor, {1, 1, 0.5}));     // touching to the last bit

  // Two steps, the outer edge at x = 2, the inner one at x = 1, in profile.
  const auto steps = meshOf(scenes::makeProfile({{0, 0}, {4, 0}, {4, 0.5}, {2, 0.5}, {1, 0.5}, {1, 1}, {0, 1}}, 4));
  CHECK(asks(*steps, {1.24, 0, 0.745}));         // in the inner corner
  CHECK(asks(*steps, {0.5, 0, 1.245}));          // on the upper step
  CHECK_FALSE(asks(*steps, {0.9, 0, 1.245}));    // over its outer edge
  CHECK_FALSE(asks(*steps, {3.9, 0, 0.745}));    // over the end
  CHECK_FALSE(asks(*steps, {0.5, 1.9, 1.245}));  // over the side
  // Where the way out of the floor would lead into the wall, which leans over it.
  const auto wedge = meshOf(scenes::makeProfile({{0, 0}, {4, 0}, {4, 0.5}, {1, 0.5}, {1.5, 1.5}, {0, 1.5}}, 4));
  CHECK(asks(*wedge, {2.5, 0, 0.745}));
  CHECK_FALSE(asks(*wedge, {1.5 - 0.0005, 0, 0.745}));
  // Through a thin plate the face behind is another way out.
  const auto plate = meshOf(scenes::makeTray({4, 4, 1}, 0.01));
  CHECK(asks(*plate, {0, 0, 0.245}));
  CHECK_FALSE(asks(*plate, {0, 0, 0.235}));
}

TEST_CASE("a ridge has the contacts of the stages for any solids, and a groove does not need them") {
  Workspace workspace;
  const auto box = boxShape({0.25, 0.25, 0.25});
  for (const double height : {0.1, -0.1}) {  // of the middle: a ridge, a groove
    const auto mesh = meshOf(scenes::makeProfile({{-2, -1}, {2, -1}, {2, 0}, {0, height}, {-2, 0}}, 4));
    const double at = height > 0 ? height + 0.248 : 0.25 * 0.05 + height + 0.248;
    const Query query = queryOf(*mesh, *box, makeMove({0, 0, at}));
    CHECK(collideFaces(query, *box, workspace) == (height < 0));
    convexContacts(query, *box, workspace);
    REQUIRE_FALSE(workspace.reduced.empty());
  }
}

TEST_CASE("a shape that meets no triangle has no contacts of faces") {
  Draw draw(9);
  Workspace workspace;
  scenes::MeshArrays hollow = scenes::makeProfile({{-2, -1}, {2, -1}, {2, 0}, {1, -0.05}, {-1, -0.05}, {-2, 0}}, 4);
  int apart = 0, found = 0;
  for (const scenes::MeshArrays& arrays : {openFloor(2), hollow, scenes::makeTray({4, 4, 1}, 0.2)}) {
    const auto mesh = meshOf(arrays);
    std::shared_ptr<const ConvexShape> shape;
    for (int i = 0; i < 6000; ++i) {
      if (i % 200 == 0) {
        // Corners of boxes: the middle of their bounds is outside of them.
        const Vec3d sides{draw.uniform(0.1, 1), draw.uniform(0.1, 1), draw.uniform(0.1, 1)};
        std::vector<Vec3d> points(4, Vec3d{0, 0, 0});
        points[1].x = static_cast<float>(sides.x);
        points[2].y = static_cast<float>(sides.y);
        points[3].z = static_cast<float>(sides.z);
        shape = polyhedronShape(points);
      }
      const Vec3d axis = draw.direction();
      Transformd pose = makePose(axis, draw.uniform(-3, 3), {});
      const Vec3d aside = draw.inBox(0.4);
      const std::uint32_t where = draw.below(4);
      pose.t = aside + Vec3d{where == 0 ? 4.0 : where == 1 ? 2.0 : where == 2 ? -2.0 : 0.0, 0, 0};
      const Query query = queryOf(*mesh, *shape, pose);
      findIntersectingPairs(query, workspace);
      const bool isApart = workspace.intersecting.empty();
      const bool isOnFaces = collideFaces(query, *shape, workspace);
      apart += isApart;
      found += isOnFaces;
      CHECK_FALSE((isApart && isOnFaces));
    }
  }
  CHECK(apart > 1000);
  CHECK(found > 100);
}

TEST_CASE("a tilted cylinder is held by all of its end that is below the floor") {
  Workspace workspace;
  const auto floor = meshOf(openFloor(2));
  const auto coin = cylinderShape(0.1, 0.02);
  for (const double tilt : {0.1, 0.3, 0.6}) {
    const Transformd pose = makePose({0, 1, 0}, tilt, {1, 1, 0.25});
    const Query query = queryOf(*floor, *coin, makePose({0, 1, 0}, tilt, {1, 1, 0.27}));
    INFO("tilt " << tilt << ", deepest " << deepestIn({{0, 0, 1}, 0.25}, *coin, pose));
    REQUIRE(collideFaces(query, *coin, workspace));
    CHECK(workspace.reduced.size() >= 3);
  }
}

TEST_CASE("what a pair remembers changes no contact on faces") {
  Draw draw(5);
  Workspace workspace;
  for (const Place& place : places()) {
    const auto mesh = meshOf(place.mesh);
    for (const auto& shape : shapes(draw)) {
      SolidHistory history;
      Transformd pose = drawPose(draw, place, *shape, 0.02);
      for (int step = 0; step < 20; ++step) {
        const Vec3d by = draw.inBox(1e-3);
        pose.t = pose.t + by;
        Query query = queryOf(*mesh, *shape, pose);
        const bool isHere = collideFaces(query, *shape, workspace);
        const std::vector<Contact> forgets = workspace.reduced;
        query.history = &history;
        convexContacts(query, *shape, workspace);
        if (!isHere) continue;
        REQUIRE(workspace.reduced.size() == forgets.size());
        for (std::size_t i = 0; i < forgets.size(); ++i) {
          CHECK(workspace.reduced[i].depth == Approx(forgets[i].depth).margin(1e-12));
          CHECK(workspace.reduced[i].position == forgets[i].position);
        }
      }
    }
  }
}
