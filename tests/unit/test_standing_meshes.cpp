// SPDX-License-Identifier: BSD-3-Clause
// Meshes of any form that stand on one face of a convex mesh, or on flat ground: they are as deep as their lowest
// vertex, and the way out is along the face's normal. Where another way may be shorter, or the ground is not flat or
// ends, it is left to the stages for any solids.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/vectors.h"
#include "collide/inside_test.h"
#include "collide/stages.h"
#include "collide/surface/surface_contacts.h"
#include "scenes/concave_meshes.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/hills.h"
#include "support/make_query.h"

using namespace otg;
using namespace otg::test;

namespace {

using Mesh = std::shared_ptr<const CollisionMesh>;

std::vector<Mesh> standing() {
  return {meshOf(scenes::makeLump(0.8, 3, 0.5, 3)),     meshOf(scenes::makeLump(0.5, 4, 0.9, 8)),
          meshOf(scenes::makeTorus(0.7, 0.3, 36, 24)),  meshOf(scenes::makeGear(16, 0.8, 0.2, 0.4, 0.2)),
          meshOf(scenes::makeBowl(0.8, 0.2, 24, 12)),   meshOf(scenes::makeBolt(0.4, 0.2, 1.5, 24)),
          meshOf(scenes::makeTray({1, 0.8, 0.4}, 0.05))};
}

/// Bodies with a flat top at z = 1 that is 6 wide.
std::vector<Mesh> floors() {
  return {meshOf(scenes::makeBox({6, 6, 2})), meshOf(scenes::makeBox({6, 6, 2}, 3)),
          meshOf(scenes::makeCylinder(3, 2, 40)),
          meshOf(scenes::makeProfile({{-3, -1}, {3, -1}, {4, 0}, {3, 1}, {-3, 1}}, 6))};
}

/// Blocks that reach into each other: two slabs side by side, flush at z = 1, and walls that begin in them; or a pile
/// with walls inside.
Mesh blockGround() {
  const auto block = [](Vec3d size, Vec3d at) { return scenes::transformed(scenes::makeBox(size), makeMove(at)); };
  return meshOf(scenes::merge({block({10, 12, 3}, {7, 0, -0.5}), block({14, 12, 2}, {-4.5, 0, 0}),
                               block({0.5, 12, 4}, {-11, 0, 1.5}), block({12, 0.5, 4}, {0, 5.5, 1.5})}));
}
Mesh blockPile() {
  const auto block = [](Vec3d size, Vec3d at) { return scenes::transformed(scenes::makeBox(size), makeMove(at)); };
  return meshOf(
      scenes::merge({block({8, 8, 8}, {0, 0, 0}), block({6, 6, 8}, {1, 1, 3}), block({9, 5, 5}, {3, 0, -1})}));
}

/// Meshes that are not convex, with a flat face at z = 1 that is at least 6 wide.
std::vector<Mesh> grounds() {
  const auto at = [](const scenes::MeshArrays& mesh, double z) {
    return meshOf(scenes::transformed(mesh, makeMove({0, 0, z})));
  };
  return {at(hills(12, 0), 1),
          at(hills(40, 0), 1),
          at(scenes::makeTray({6, 6, 4}, 2), 1),
          at(scenes::makeRoom({7, 6, 5}, 2), 3.5),
          meshOf(scenes::makeProfile({{-8, -1}, {8, -1}, {8, 3}, {7, 3}, {7, 1}, {-8, 1}}, 12)),
          blockGround()};
}

Query queryOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  Query query = makeQuery(a, b, bInA);
  query.options.contacts = ContactModel::kSolid;
  query.options.solid.convexPath = true;
  return query;
}

double lowestOf(const CollisionMesh& mesh, const Transformd& pose) {
  double lowest = INFINITY;
  for (const Vec3f& v : mesh.mesh().vertices()) lowest = std::min(lowest, otgTransform(pose, asDouble(v)).z);
  return lowest;
}

/// Over the middle of a floor, `depth` in it.
Transformd drawPose(Draw& draw, const CollisionMesh& mesh, double depth) {
  Transformd pose = makePose(draw.direction(), draw.uniform(-3, 3), {0, 0, 0});
  pose.t = {draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), 1 - depth - lowestOf(mesh, pose)};
  return pose;
}

/// Turned anyhow, a little behind the plane of one of the ground's triangles; whether that is there or not.
Transformd drawBeside(Draw& draw, const CollisionMesh& ground, const CollisionMesh& mesh) {
  const std::uint32_t t = draw.below(static_cast<std::uint32_t>(ground.mesh().triangleCount()));
  const Vec3d normal = ground.adjacency().normal[t];
  const Vec3d corner = asDouble(ground.mesh().vertices()[ground.mesh().triangles()[t].v[0]]);
  const Vec3d on = corner + draw.inBox(6);
  Transformd pose = makePose(draw.direction(), draw.uniform(-3, 3), on);
  double lowest = INFINITY;
  for (const Vec3f& v : mesh.mesh().vertices()) {
    lowest = std::min(lowest, otgDot(normal, otgTransform(pose, asDouble(v)) - on));
  }
  const double height = otgDot(normal, on - corner) + lowest;
  pose.t = pose.t - normal * (height + draw.uniform(-0.01, 0.03));
  return pose;
}

bool areMeeting(const Query& query, const Vec3d& move) {
  static Workspace workspace;
  Query moved = query;
  moved.bInA.t = query.bInA.t + move;
  findIntersectingPairs(moved, workspace);
  return !workspace.intersecting.empty();
}

/// Each mesh on each of these, in both orders.
void standOn(const std::vector<Mesh>& bases) {
  Draw draw(17);
  Workspace workspace;
  int all = 0, found = 0;
  for (const Mesh& floor : bases) {
    for (const Mesh& mesh : standing()) {
      for (int i = 0; i < 20; ++i) {
        const double depth = std::pow(10.0, draw.uniform(-5, -2));
        const Transformd pose = drawPose(draw, *mesh, depth);
        for (const bool isLast : {true, false}) {
          const Query query = isLast ? queryOf(*floor, *mesh, pose) : queryOf(*mesh, *floor, inverseOf(pose));
          INFO("triangles " << mesh->mesh().triangleCount() << ", depth " << depth << ", " << i << ", " << isLast);
          ++all;
          if (!collideSurfacePair(query, workspace)) continue;
          ++found;
          REQUIRE_FALSE(workspace.reduced.empty());
          double deepest = 0;
          for (const Contact& c : workspace.reduced) {
            deepest = std::max(deepest, c.depth);
            const Vec3d normal = isLast ? c.normal : otgRotate(pose, c.normal);
            const Vec3d at = isLast ? c.position : otgTransform(pose, c.position);
            CHECK(norm(normal - Vec3d{0, 0, isLast ? -1.0 : 1.0}) < 1e-6);
            CHECK(std::fabs(at.z + 0.5 * c.depth - 1) < 1e-6);
            const bool isVertex = std::ranges::any_of(mesh->mesh().vertices(), [&](const Vec3f& v) {
              return norm(otgTransform(pose, asDouble(v)) - (at - Vec3d{0, 0, 0.5 * c.depth})) < 1e-6;
            });
            CHECK(isVertex);
          }
          CHECK(std::fabs(deepest - depth) < 1e-6);
          const Vec3d out = isLast ? Vec3d{0, 0, 1} : otgRotateBack(pose, {0, 0, -1});
          CHECK_FALSE(areMeeting(query, out * (depth + 2e-6)));
        }
      }
    }
  }
  CHECK(found > 0.9 * all);
}

}  // namespace

TEST_CASE("a mesh on one face of a convex mesh is as deep as its lowest vertex") {
  standOn(floors());
}

TEST_CASE("a mesh on flat ground is as deep as its lowest vertex") {
  standOn(grounds());
}

TEST_CASE("contacts on a ground of blocks have the names that all solids give them") {
  Draw draw(31);
  Workspace workspace;
  const Mesh ground = blockGround();
  REQUIRE(ground->parts() != nullptr);
  int same = 0;
  for (const Mesh& mesh : standing()) {
    for (int i = 0; i < 20; ++i) {
      Query query = queryOf(*ground, *mesh, drawPose(draw, *mesh, 0.003));
      if (!collideSurfacePair(query, workspace)) continue;
      numberAsCaller(query, workspace);
      const std::vector<Contact> found = workspace.reduced;
      query.options.solid.convexPath = false;
      collide(query, workspace);
      for (const Contact& c : found) {
        for (const Contact& other : workspace.reduced) {
          if (c.feature != other.feature || c.element != other.element) continue;
          ++same;
          CHECK(c.ordinal == other.ordinal);
          CHECK(c.triangleA == other.triangleA);
        }
      }
    }
  }
  CHECK(same > 100);
}

TEST_CASE("ground is flat where all of it around a mesh lies in one plane and has no rim") {
  const Mesh mesh = meshOf(scenes::makeLump(0.8, 3, 0.5, 3)), sheet = meshOf(hills(12, 0));
  const double top = -lowestOf(*mesh, makeMove({0, 0, 0})) - 1e-3;
  const auto asks = [&](const Mesh& ground, const Vec3d& at) {
    const bool isFirst = isSurfacePair(queryOf(*ground, *mesh, makeMove(at)));
    CHECK(isSurfacePair(queryOf(*mesh, *ground, makeMove(at * -1.0))) == isFirst);
    return isFirst;
  };
  CHECK(asks(sheet, {0, 0, top}));
  CHECK_FALSE(asks(sheet, {3.5, 0, top}));    // over the rim
  CHECK_FALSE(asks(sheet, {0, 0, top + 3}));  // nothing is near
  CHECK_FALSE(asks(meshOf(hills(12, 0.3)), {0, 0, top}));
  // A step of the ground, near the mesh and farther away; and a ceiling.
  const Mesh step = meshOf(scenes::makeProfile({{-8, -1}, {8, -1}, {8, 0.5}, {0, 0.5}, {0, 0}, {-8, 0}}, 12));
  CHECK_FALSE(asks(step, {-0.9, 0, top}));
  CHECK(asks(step, {-3, 0, top}));
  CHECK_FALSE(asks(meshOf(scenes::makeRoom({6, 6, 1}, 0.2)), {0, 0, top - 0.5}));
}

TEST_CASE("meshes about grounds of few and large triangles have contacts exactly where they meet") {
  Draw draw(77);
  Workspace workspace;
  const std::vector<Mesh> around{
      meshOf(scenes::makeProfile({{-6, -6}, {6, -6}, {-5, 1}, {-6, 6}}, 5)),
      meshOf(scenes::makeProfile({{-6, -2}, {6, -2}, {6, 4}, {4, -1}, {2, 4}, {0, -1}, {-2, 4}, {-4, -1}, {-6, 4}}, 6)),
      meshOf(scenes::makeProfile({{-8, -1}, {8, -1}, {8, 0.5}, {0, 0.5}, {0, 0}, {-8, 0}}, 12)),
      meshOf(scenes::makeTray({5, 6, 3}, 1)),
      blockGround(),
      blockPile()};
  int found = 0, touching = 0;
  for (const Mesh& ground : around) {
    for (const Mesh& mesh : standing()) {
      for (int i = 0; i < 1000; ++i) {
        const Query query = queryOf(*ground, *mesh, drawBeside(draw, *ground, *mesh));
        if (!collideSurfacePair(query, workspace)) continue;
        ++found;
        INFO("triangles " << ground->mesh().triangleCount() << " and " << mesh->mesh().triangleCount() << ", " << i);
        CHECK(workspace.reduced.empty() != areMeeting(query, {0, 0, 0}));
        touching += !workspace.reduced.empty();
        if (ground->parts() == nullptr) continue;
        // The walls inside are no ground: what stands on one has its middle in a block.
        const Vec3d low = asDouble(mesh->mesh().boundsMin()), high = asDouble(mesh->mesh().boundsMax());
        const Vec3d middle = otgTransform(query.bInA, (low + high) * 0.5);
        for (const auto& part : ground->parts()->meshes) CHECK_FALSE(pointInMesh(*part, middle));
      }
    }
  }
  CHECK(found > 600);
  CHECK(touching > 300);
}

TEST_CASE("a round mesh whose vertices are all flat is as deep as its lowest vertex") {
  // The bottom of an arc, bent by 0.05 degrees at each edge, and a notch in the top: it is not convex.
  std::vector<scenes::ProfilePoint> arc;
  for (int i = -200; i <= 200; ++i) {
    const double angle = i * 0.05 * M_PI / 180;
    arc.emplace_back(3 * std::sin(angle), 3 - 3 * std::cos(angle));
  }
  arc.insert(arc.end(), {{0.5, 0.5}, {0, 0.3}, {-0.5, 0.5}});
  const Mesh mesh = meshOf(scenes::makeProfile(arc, 0.5)), floor = meshOf(scenes::makeBox({6, 6, 2}));
  REQUIRE(mesh->convex() == nullptr);
  Draw draw(2);
  Workspace workspace;
  for (int i = 0; i < 20; ++i) {
    Transformd pose = makePose({0, 1, 0}, draw.uniform(-0.1, 0.1), {0, 0, 0});
    const double depth = draw.uniform(1e-4, 1e-3);
    pose.t.z = 1 - depth - lowestOf(*mesh, pose);
    REQUIRE(collideSurfacePair(queryOf(*floor, *mesh, pose), workspace));
    double deepest = 0;
    for (const Contact& c : workspace.reduced) deepest = std::max(deepest, c.depth);
    CHECK(std::fabs(deepest - depth) < 1e-6 + 1e-3 * depth);
  }
}

TEST_CASE("a mesh is not said to stand where another way out may be shorter") {
  Workspace workspace;
  const auto asks = [&](const CollisionMesh& floor, const CollisionMesh& mesh, const Vec3d& at) {
    return collideSurfacePair(queryOf(floor, mesh, makeMove(at)), workspace) && !workspace.reduced.empty();
  };
  // Two prongs, each 0.02 wide, over a beam that is 0.2 wide.
  const Mesh fork = meshOf(
      scenes::makeProfile({{-1, 1}, {-1, 0}, {-0.98, 0}, {-0.98, 0.8}, {0.98, 0.8}, {0.98, 0}, {1, 0}, {1, 1}}, 0.1));
  const Mesh beam = meshOf(scenes::makeBox({0.2, 4, 2}));
  REQUIRE(asks(*beam, *fork, {0.99, 0, 1 - 0.04}));
  CHECK(workspace.reduced.front().normal.z == Approx(-1));
  CHECK_FALSE(asks(*beam, *fork, {0.99 + 0.08, 0, 1 - 0.04}));   // out by the side: 0.03
  CHECK_FALSE(asks(*beam, *fork, {0.99 + 0.095, 0, 1 - 0.04}));  // through the side
  // A wall of a tray reaches through the floor; and the floor's top is in a pit, all else of it in what is around that.
  const Mesh tray = meshOf(scenes::makeTray({1, 0.8, 0.4}, 0.05)), plate = meshOf(scenes::makeBox({6, 6, 0.02}));
  CHECK_FALSE(asks(*plate, *tray, {0, 0, 0}));
  const Mesh pit = meshOf(scenes::makeTray({1, 0.8, 0.4}, 2)), inside = meshOf(scenes::makeBox({3, 3, 1}));
  CHECK_FALSE(asks(*inside, *pit, {0, 0, 0.5 - 0.05}));
}
