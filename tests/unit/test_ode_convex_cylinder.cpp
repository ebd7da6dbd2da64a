// SPDX-License-Identifier: BSD-3-Clause
// ODE's cylinder with meshes of convex bodies: the least way out by a search of its own, places, exchanged geoms, other
// scales, and worlds.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "base/vectors.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/hull_mesh.h"
#include "support/ode_world.h"
#include "support/step_world.h"
#include "truth/tessellated_bodies.h"

using namespace otg;
using namespace otg::test;

namespace {

scenes::MeshArrays stone(std::size_t points, std::uint32_t seed) {
  Draw draw(seed);
  std::vector<Vec3d> all;
  for (std::size_t k = 0; k < points; ++k) {
    const Vec3d d = draw.direction();
    all.push_back({0.5 * d.x, 0.4 * d.y, 0.3 * d.z});
  }
  return hullOf(all);
}

struct Body {
  std::string name;
  scenes::MeshArrays mesh;
};

std::vector<Body> bodies() {
  std::vector<Body> all{{"box", scenes::makeBox({1, 0.7, 0.4}, 2)},
                        {"plate", scenes::makeBox({1, 0.9, 0.05})},
                        {"prism", scenes::makeCylinder(0.4, 0.6, 7)},
                        {"ball", scenes::makeSphere(0.45, 2)}};
  for (const std::size_t n : {8, 20, 60, 200}) {
    all.push_back({"hull of " + std::to_string(n), stone(n, static_cast<std::uint32_t>(n))});
  }
  return all;
}

scenes::MeshArrays scaled(scenes::MeshArrays mesh, double scale) {
  for (Vec3f& v : mesh.vertices) {
    v = {static_cast<float>(scale * v.x), static_cast<float>(scale * v.y), static_cast<float>(scale * v.z)};
  }
  return mesh;
}

const dContactGeom* deepest(const std::vector<dContactGeom>& contacts) {
  const auto found = std::max_element(contacts.begin(), contacts.end(),
                                      [](const dContactGeom& a, const dContactGeom& b) { return a.depth < b.depth; });
  return found == contacts.end() ? nullptr : &*found;
}

/// How far a point is outside of the bounds of a body along some directions.
double outside(const truth::ConvexBody& body, const Vec3d& p) {
  double most = 0;
  for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
    for (const double sign : {1.0, -1.0}) {
      const Vec3d d = otgRotate(body.pose, n * sign);
      most = std::max(most, otgDot(d, p) - body.reach(d));
    }
  }
  return most;
}

/// Whether a direction separates the two that a search of random steps finds, each of them smaller.
bool separates(const truth::ConvexBody& a, const truth::ConvexBody& b) {
  Draw draw(3);
  Vec3d d = truth::waysApart(a, b, 20).direction;
  double least = truth::separation(a, b, d), step = 0.01;
  for (int i = 0; i < 3000 && least >= 0; ++i, step *= 0.995) {
    const Vec3d e = unit(d + draw.direction() * step);
    const double length = truth::separation(a, b, e);
    if (!(length < least)) continue;
    least = length;
    d = e;
  }
  return least < 1e-7;
}

struct Cylinder {
  double radius, half;
};
constexpr Cylinder kCylinders[] = {{0.2, 0.3}, {0.35, 0.02}, {0.04, 0.6}, {0.3, 0.12}, {1.5, 0.8}};

/// Poses with overlaps up to some depth, and such that are nearly apart.
Transformd drawPose(Draw& draw, const truth::ConvexBody& body, truth::ConvexBody& cylinder, double deep) {
  const Vec3d axis = draw.below(4) == 0 ? Vec3d{1, 0, 0} : draw.direction();
  const double angle = draw.below(4) == 0 ? 0.5 * M_PI * draw.below(4) : draw.uniform(-3, 3);
  cylinder.pose = makePose(axis, angle, {0, 0, 0});
  const Vec3d d = draw.direction();
  // Where the two are clear of each other along d; then nearer, until they overlap by about as much as is wanted.
  double far = truth::separation(body, cylinder, d), near = 0;
  const double wanted = draw.uniform(-0.2, 1) * deep;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (near + far);
    cylinder.pose.t = d * middle;
    (truth::roughSeparation(body, cylinder) > wanted ? near : far) = middle;
  }
  cylinder.pose.t = d * far + draw.inBox(1e-3);
  return cylinder.pose;
}

/// About its own origin, and moved.
Transformd turned(const Transformd& pose, const Vec3d& axis, double angle, const Vec3d& by) {
  const Transformd turn = makePose(axis, angle, {0, 0, 0});
  Transformd out{{}, pose.t + by};
  for (int column = 0; column < 3; ++column) {
    const Vec3d v = otgRotate(turn, Vec3d{pose.r[column], pose.r[3 + column], pose.r[6 + column]});
    out.r[column] = v.x;
    out.r[3 + column] = v.y;
    out.r[6 + column] = v.z;
  }
  return out;
}

}  // namespace

TEST_CASE("a cylinder leaves a convex mesh by the least way out, in places of both") {
  const OdeSession session;
  for (const Body& body : bodies()) {
    const Data data(body.mesh);
    const Geom mesh(data);
    const truth::ConvexBody still = truth::polyhedronBody(body.mesh);
    Draw draw(7);
    int touching = 0;
    for (int i = 0; i < 150; ++i) {
      const Cylinder& size = kCylinders[i % std::size(kCylinders)];
      truth::ConvexBody round = truth::cylinderBody(size.radius, size.half);
      const double deep = 0.4 * std::min({size.radius, size.half, body.name == "plate" ? 0.025 : 0.1});
      drawPose(draw, still, round, deep);
      const dGeomID cylinder = dCreateCylinder(nullptr, size.radius, 2 * size.half);
      setPose(cylinder, round.pose);
      dGeomGpuTriMeshForgetHistory(mesh.id);
      const auto contacts = test::collide(mesh.id, cylinder, 64);
      const auto exchanged = test::collide(cylinder, mesh.id, 64);
      REQUIRE(sameContacts(exchanged, mirrored(contacts)));
      dGeomDestroy(cylinder);
      const double least = truth::leastSeparation(still, round);
      INFO(body.name << " pose " << i << " radius " << size.radius << " least " << least);
      constexpr double kRounding = 2e-7;
      const dContactGeom* const most = deepest(contacts);
      if (most == nullptr) {
        REQUIRE((least < kRounding || separates(still, round)));
        continue;
      }
      REQUIRE(least > -kRounding);
      ++touching;
      REQUIRE(most->depth < least + kRounding);  // the search may end a little above the least
      const Vec3d out = toVec(most->normal) * -1.0;
      REQUIRE(std::abs(truth::separation(still, round, out) - most->depth) < kRounding);
      for (const dContactGeom& c : contacts) {
        INFO("place " << c.pos[0] << " " << c.pos[1] << " " << c.pos[2] << " depth " << c.depth << " of " << most->depth
                      << ", slope " << otgDot(otgRotateBack(round.pose, out), Vec3d{0, 0, 1}) << ", places "
                      << contacts.size());
        REQUIRE(std::abs(norm(toVec(c.normal)) - 1) < 1e-12);
        REQUIRE(c.depth > 0);
        REQUIRE(c.side1 >= 0);
        REQUIRE(c.side2 == -1);
        // A point of the rim that goes behind is beside the cylinder half a depth ahead.
        REQUIRE(std::max(outside(still, toVec(c.pos)), outside(round, toVec(c.pos))) < 0.5 * c.depth);
        // Half a depth ahead it leaves the mesh, half a depth behind the cylinder; but places are kept in both bounds.
        const Vec3d onMesh = toVec(c.pos) + out * (0.5 * c.depth), onRound = toVec(c.pos) - out * (0.5 * c.depth);
        for (const Vec3d& n : still.normals) {
          REQUIRE(otgDot(n, onMesh) < still.reach(n) + 0.1 * c.depth + kRounding);
        }
        const Vec3d local = otgRotateBack(round.pose, onRound - round.pose.t);
        REQUIRE(std::abs(local.z) < size.half + 0.1 * c.depth + kRounding);
        REQUIRE(std::hypot(local.x, local.y) < size.radius + 0.1 * c.depth + kRounding);
      }
    }
    CHECK(touching > 75);
  }
}

TEST_CASE("a cylinder and a convex mesh of other sizes have the same contacts, scaled") {
  const OdeSession session;
  for (const Body& body : bodies()) {
    const truth::ConvexBody still = truth::polyhedronBody(body.mesh);
    for (const double scale : {1.0 / 128, 128.0}) {  // without rounding
      const Data data(body.mesh), other(scaled(body.mesh, scale));
      const Geom mesh(data), image(other);
      Draw draw(9);
      int touching = 0;
      for (int i = 0; i < 100; ++i) {
        const Cylinder& size = kCylinders[i % std::size(kCylinders)];
        truth::ConvexBody round = truth::cylinderBody(size.radius, size.half);
        drawPose(draw, still, round, 0.03 * std::min(1.0, 4 * size.half));
        const dGeomID first = dCreateCylinder(nullptr, size.radius, 2 * size.half);
        const dGeomID second = dCreateCylinder(nullptr, scale * size.radius, 2 * scale * size.half);
        setPose(first, round.pose);
        Transformd moved = round.pose;
        moved.t = moved.t * scale;
        setPose(second, moved);
        for (const dGeomID g : {mesh.id, image.id}) dGeomGpuTriMeshForgetHistory(g);
        const auto contacts = test::collide(mesh.id, first), images = test::collide(image.id, second);
        dGeomDestroy(first);
        dGeomDestroy(second);
        INFO(body.name << " pose " << i << " scale " << scale);
        REQUIRE(contacts.size() == images.size());
        for (std::size_t k = 0; k < contacts.size(); ++k) {
          REQUIRE(std::abs(scale * contacts[k].depth - images[k].depth) < 1e-9 * scale);
          REQUIRE(norm(toVec(contacts[k].pos) * scale - toVec(images[k].pos)) < 1e-9 * scale);
          REQUIRE(contacts[k].side1 == images[k].side1);
        }
        touching += contacts.empty() ? 0 : 1;
      }
      CHECK(touching > 40);
    }
  }
}

TEST_CASE("what a pair remembers changes no contact of a cylinder with a convex mesh") {
  const OdeSession session;
  Draw draw(12);
  for (const Body& body : bodies()) {
    const Data data(body.mesh);
    const Geom walked(data), fresh(data);
    const truth::ConvexBody still = truth::polyhedronBody(body.mesh);
    int touching = 0;
    for (int walk = 0; walk < 12; ++walk) {
      const Cylinder& size = kCylinders[walk % std::size(kCylinders)];
      truth::ConvexBody round = truth::cylinderBody(size.radius, size.half);
      drawPose(draw, still, round, 0.02 * std::min(1.0, 4 * size.half));
      const dGeomID cylinder = dCreateCylinder(nullptr, size.radius, 2 * size.half);
      const Vec3d step = draw.direction() * draw.uniform(1e-7, 2e-3), axis = draw.direction();
      const double turn = draw.uniform(0, 2e-3);
      for (int i = 0; i < 40; ++i) {
        setPose(cylinder, turned(round.pose, axis, turn * i, step * double(i)));
        dGeomGpuTriMeshForgetHistory(fresh.id);
        INFO(body.name << " walk " << walk << " step " << i);
        const auto contacts = test::collide(walked.id, cylinder), others = test::collide(fresh.id, cylinder);
        REQUIRE(contacts.size() == others.size());
        for (std::size_t k = 0; k < contacts.size(); ++k) {
          REQUIRE(contacts[k].depth == others[k].depth);
          REQUIRE(std::equal(contacts[k].pos, contacts[k].pos + 3, others[k].pos));
          REQUIRE(std::equal(contacts[k].normal, contacts[k].normal + 3, others[k].normal));
          REQUIRE(contacts[k].side1 == others[k].side1);
        }
        touching += contacts.empty() ? 0 : 1;
      }
      dGeomDestroy(cylinder);
    }
    CHECK(touching > 100);
  }
}
