// SPDX-License-Identifier: BSD-3-Clause
// ODE's convex against meshes of convex bodies, its own mesh among them: the least way out by all separating axes, the
// longest chord of the overlap, ODE's own pair of convexes, and two meshes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "base/vectors.h"
#include "ode/shapes/convex_collider.h"
#include "scenes/convex_geom.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/hull_mesh.h"
#include "support/ode_world.h"
#include "truth/tessellated_bodies.h"

using namespace otg;
using namespace otg::test;

namespace {

/// A convex body: its mesh, ODE's convex of the same faces, and its formula.
struct Body {
  Body(std::string label, const std::vector<Vec3d>& points)
      : name(std::move(label)), mesh(hullOf(points)), convex(mesh), formula(truth::polyhedronBody(mesh)) {}
  std::string name;
  scenes::MeshArrays mesh;
  scenes::ConvexData convex;
  truth::ConvexBody formula;
};

std::vector<std::unique_ptr<Body>> makeBodies() {
  std::vector<std::unique_ptr<Body>> bodies;
  const auto add = [&](const char* name, const std::vector<Vec3d>& points) {
    bodies.push_back(std::make_unique<Body>(name, points));
  };
  add("tetrahedron", {{-0.4, -0.3, -0.25}, {0.5, -0.3, -0.25}, {0, 0.5, -0.25}, {0.05, 0, 0.5}});
  add("octahedron", {{0.5, 0, 0}, {-0.5, 0, 0}, {0, 0.4, 0}, {0, -0.4, 0}, {0, 0, 0.6}, {0, 0, -0.6}});
  std::vector<Vec3d> prism;
  for (int k = 0; k < 7; ++k) {
    const double angle = 2 * M_PI * k / 7;
    for (const double z : {-0.3, 0.3}) prism.push_back({0.4 * std::cos(angle), 0.4 * std::sin(angle), z});
  }
  add("prism", prism);
  Draw draw(4);
  std::vector<Vec3d> stone;
  for (int k = 0; k < 24; ++k) {
    const Vec3d d = draw.direction();
    stone.push_back({0.5 * d.x, 0.4 * d.y, 0.3 * d.z});
  }
  add("stone", stone);
  return bodies;
}

/// A body at a geom's pose, with what is asked of it in the world's frame.
struct Placed {
  truth::ConvexBody body;
  std::vector<Vec3d> normals, corners;
  std::vector<double> offsets;
  std::vector<std::pair<Vec3d, Vec3d>> edges;

  Placed(const Body& of, dGeomID geom) : body(of.formula) {
    const dReal* r = dGeomGetRotation(geom);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) body.pose.r[3 * row + column] = r[4 * row + column];
    }
    body.pose.t = toVec(dGeomGetPosition(geom));
    for (const Vec3d& n : body.normals) normals.push_back(otgRotate(body.pose, n));
    for (const Vec3d& v : body.vertices) corners.push_back(otgTransform(body.pose, v));
    for (std::size_t i = 0; i < of.mesh.triangles.size(); ++i) {
      const auto& t = of.mesh.triangles[i].v;
      offsets.push_back(otgDot(normals[i], corners[t[0]]));
      for (int k = 0; k < 3; ++k) {
        if (t[k] < t[(k + 1) % 3]) edges.emplace_back(corners[t[k]], corners[t[(k + 1) % 3]]);
      }
    }
  }

  /// How far a point is in front of the face that it is most in front of; negative inside.
  double outside(const Vec3d& p) const {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < normals.size(); ++i) most = std::max(most, otgDot(normals[i], p) - offsets[i]);
    return most;
  }
  bool holds(const Vec3d& p) const { return outside(p) <= 1e-9; }
  /// How far a point inside is from the surface along d.
  double exit(const Vec3d& p, const Vec3d& d) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const double speed = otgDot(normals[i], d);
      if (speed > 1e-12) least = std::min(least, std::max(0.0, offsets[i] - otgDot(normals[i], p)) / speed);
    }
    return least;
  }
};

/// How far b has to go along d, a unit vector, until it is clear of a.
double wayAlong(const Placed& a, const Placed& b, const Vec3d& d) {
  return truth::separation(a.body, b.body, d);
}

/// The least of it: over the normals of the faces and the products of the edges, every one.
double leastWay(const Placed& a, const Placed& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3d& n : a.normals) least = std::min(least, wayAlong(a, b, n));
  for (const Vec3d& n : b.normals) least = std::min(least, wayAlong(a, b, otgScale(n, -1.0)));
  for (const auto& [p, q] : a.edges) {
    for (const auto& [s, t] : b.edges) {
      const Vec3d across = otgCross(otgSub(q, p), otgSub(t, s));
      const double length = norm(across);
      if (!(length > 1e-9)) continue;
      for (const double sign : {1 / length, -1 / length}) {
        least = std::min(least, wayAlong(a, b, otgScale(across, sign)));
      }
    }
  }
  return least;
}

/// Along d, of those through a corner of the overlap.
double longestChord(const Placed& a, const Placed& b, const Vec3d& d) {
  double longest = 0;
  const Vec3d back = otgScale(d, -1.0);
  const auto through = [&](const Vec3d& p) {
    longest = std::max(longest, std::min(a.exit(p, d), b.exit(p, d)) + std::min(a.exit(p, back), b.exit(p, back)));
  };
  for (const auto& [edged, faced] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    for (const Vec3d& corner : edged->corners) {
      if (faced->holds(corner)) through(corner);
    }
    for (const auto& [p, q] : edged->edges) {
      for (std::size_t i = 0; i < faced->normals.size(); ++i) {
        const double x = otgDot(faced->normals[i], p) - faced->offsets[i];
        const double y = otgDot(faced->normals[i], q) - faced->offsets[i];
        if ((x > 0) == (y > 0)) continue;
        const Vec3d at = otgAdd(p, otgScale(otgSub(q, p), x / (x - y)));
        if (faced->holds(at)) through(at);
      }
    }
  }
  return longest;
}

const dContactGeom* deepest(const std::vector<dContactGeom>& contacts) {
  const auto found = std::max_element(contacts.begin(), contacts.end(),
                                      [](const dContactGeom& a, const dContactGeom& b) { return a.depth < b.depth; });
  return found == contacts.end() ? nullptr : &*found;
}

void copyPose(dGeomID from, dGeomID to) {
  const dReal* p = dGeomGetPosition(from);
  dGeomSetPosition(to, p[0], p[1], p[2]);
  dGeomSetRotation(to, dGeomGetRotation(from));
}

/// A mesh and the convex at one pose after the other.
template <class Visit>
void atPoses(const Body& ofMesh, const Body& ofConvex, int count, const Visit& visit) {
  const Data data(ofMesh.mesh);
  const Geom mesh(data);
  const dGeomID convex = ofConvex.convex.makeGeom(nullptr);
  std::mt19937 random(3);
  for (int i = 0; i < count; ++i) {
    setRandomPose(mesh.id, random, 0.55);
    setRandomPose(convex, random, 0.55);
    INFO("mesh of " << ofMesh.name << ", convex " << ofConvex.name << ", pose " << i);
    visit(mesh.id, convex, i);
  }
  dGeomDestroy(convex);
}

}  // namespace

TEST_CASE("a dConvex leaves the mesh of a convex body, its own among them, by the least way out") {
  const OdeSession session;
  const auto bodies = makeBodies();
  for (const auto& first : bodies) {
    for (const auto& second : bodies) {
      int shallow = 0, apart = 0;
      atPoses(*first, *second, 400, [&](dGeomID mesh, dGeomID convex, int i) {
        const auto ours = test::collide(mesh, convex, 64);
        if (i % 10 == 0) REQUIRE(sameContacts(test::collide(convex, mesh, 64), mirrored(ours)));
        const Placed a(*first, mesh), b(*second, convex);
        const double least = leastWay(a, b);
        if (ours.empty()) {
          REQUIRE(least < 1e-6);
          ++apart;
          return;
        }
        REQUIRE(least > -1e-6);
        for (const dContactGeom& x : ours) {
          REQUIRE(x.side1 >= 0);
          REQUIRE(x.side1 < static_cast<int>(first->mesh.triangles.size()));
          REQUIRE(x.depth > 0);
          REQUIRE(std::abs(otgDot(toVec(x.normal), toVec(x.normal)) - 1) < 1e-12);
        }
        if (least > 0.05) return;  // bodies that go through each other: their depths are clamped
        ++shallow;
        const dContactGeom& c = *deepest(ours);
        const Vec3d out = otgScale(toVec(c.normal), -1.0);
        const double along = wayAlong(a, b, out), chord = longestChord(a, b, out);
        INFO("depth " << c.depth << " along " << along << " least " << least << " chord " << chord);
        for (const dContactGeom& x : ours) {  // in the overlap, or beside it by less than they are deep
          CHECK(std::max(a.outside(toVec(x.pos)), b.outside(toVec(x.pos))) < x.depth);
        }
        // No way is shorter, but that a pair of edges must be better than a face by a thousandth. The depth is that
        // way, which no chord of the overlap is longer than.
        CHECK(along < 1.002 * least + 1e-6);
        CHECK(std::abs(c.depth - along) < 1e-6);
        CHECK(c.depth > chord - 1e-6);
      });
      INFO("mesh of " << first->name << ", convex " << second->name);
      CHECK(shallow >= 15);
      CHECK(apart >= 70);
    }
  }
}

TEST_CASE("where ODE's own pair of convexes, and two meshes, have contacts, a mesh and a dConvex have them, too") {
  const OdeSession session;
  const auto bodies = makeBodies();
  int both = 0, longer = 0;
  for (const auto& first : bodies) {
    const dGeomID stock = first->convex.makeGeom(nullptr);
    for (const auto& second : bodies) {
      const Data otherData(second->mesh);
      const Geom otherMesh(otherData);
      atPoses(*first, *second, 200, [&](dGeomID mesh, dGeomID convex, int) {
        copyPose(mesh, stock);
        copyPose(convex, otherMesh.id);
        const auto contacts = test::collide(mesh, convex, 64), theirs = test::collide(stock, convex, 64);
        const Placed a(*first, mesh), b(*second, convex);
        const double least = leastWay(a, b);
        if (contacts.empty() != test::collide(mesh, otherMesh.id, 64).empty()) REQUIRE(std::abs(least) < 1e-6);
        // Where ODE's pair has them and ours not or the other way round, ours is right.
        if (contacts.empty() != theirs.empty()) REQUIRE((contacts.empty() ? least < 1e-6 : least > -1e-6));
        if (contacts.empty() || theirs.empty() || least > 0.05) return;
        ++both;
        const auto alongDeepest = [&](const std::vector<dContactGeom>& of) {
          return wayAlong(a, b, otgScale(toVec(deepest(of)->normal), -1.0));
        };
        longer += alongDeepest(theirs) > 1.05 * alongDeepest(contacts) + 1e-6 ? 1 : 0;
      });
    }
    dGeomDestroy(stock);
  }
  // ODE's own way out is the longer one in some, and in none the shorter one (above).
  CHECK(both > 100);
  CHECK(longer > 0);
}

TEST_CASE("a dConvex is one shape wherever it is and however it is turned") {
  const OdeSession session;
  scenes::MeshArrays odd = scenes::makeSphere(0.3, 1);
  for (Vec3f& v : odd.vertices) v.x *= 1e-2f;
  for (const scenes::MeshArrays& mesh :
       {scenes::makeBox({1, 0.3, 0.7}), scenes::makeSphere(0.3, 1), scenes::makeCylinder(0.2, 0.5, 17), odd}) {
    const scenes::ConvexData data(mesh);
    const dGeomID convex = data.makeGeom(nullptr);
    const auto shape = shapeOfGeom(convex);
    REQUIRE(shape != nullptr);
    std::mt19937 random(11);
    for (const double reach : {1.0, 100.0, 1e4}) {
      int others = 0;
      for (int i = 0; i < 200; ++i) {
        setRandomPose(convex, random, reach);
        others += shapeOfGeom(convex) == shape ? 0 : 1;
      }
      INFO("within " << reach);
      CHECK(others == 0);
    }
    dGeomDestroy(convex);
  }
}
