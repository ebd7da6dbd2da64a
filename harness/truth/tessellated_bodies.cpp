// SPDX-License-Identifier: BSD-3-Clause
#include "truth/tessellated_bodies.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "bvh/collision_mesh.h"
#include "collide/query.h"

namespace otg::truth {
namespace {

constexpr Transformd kUnmoved{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

ConvexBody roundBody(ConvexBody::Kind kind, double radius, double length) {
  ConvexBody body;
  body.pose = kUnmoved;
  body.kind = kind;
  body.radius = radius;
  body.length = length;
  return body;
}

/// 20 faces of sharp edges and no two alike: an icosahedron drawn apart.
scenes::MeshArrays makePolyhedron(double radius) {
  scenes::MeshArrays mesh = scenes::makeSphere(radius, 0);
  for (Vec3f& v : mesh.vertices) {
    v.y *= 0.8F;
    v.z *= 0.6F;
  }
  return mesh;
}

constexpr int kSphereLevel = 5, kSegments = 128, kRings = 32;

TessellatedBody sphere(double radius) {
  // Edges of the icosahedron, 63.4 degrees, are halved five times; a triangle's middle is nearer to the ball's than any
  // point of its edges. Its corners are at most 0.61 of an edge from there, drawn apart by the projection by up to 1.2.
  const double away = 1.2 * 0.61 * 63.435 / 32 * M_PI / 180;
  return {"sphere", ballBody(radius), scenes::makeSphere(radius, kSphereLevel), radius * (1 - std::cos(away))};
}
TessellatedBody box(const Vec3d& half) {
  return {"box", boxBody(half), scenes::makeBox(half * 2.0, 2), 0};
}
TessellatedBody capsule(double radius, double length) {
  return {"capsule", capsuleBody(radius, length), scenes::makeCapsule(radius, 2 * length, kSegments, kRings),
          radius * (1 - std::cos(M_PI / kSegments) * std::cos(M_PI / 4 / kRings))};
}
TessellatedBody cylinder(double radius, double length) {
  return {"cylinder", cylinderBody(radius, length), scenes::makeCylinder(radius, 2 * length, kSegments, 1),
          radius * (1 - std::cos(M_PI / kSegments))};
}
TessellatedBody convex(double radius) {
  const scenes::MeshArrays mesh = makePolyhedron(radius);
  return {"convex", polyhedronBody(mesh), mesh, 0};
}

}  // namespace

ConvexBody ballBody(double radius) {
  return roundBody(ConvexBody::Kind::kSphere, radius, 0);
}
ConvexBody boxBody(const Vec3d& half) {
  ConvexBody body;
  body.pose = kUnmoved;
  body.kind = ConvexBody::Kind::kBox;
  body.half = half;
  return body;
}
ConvexBody capsuleBody(double radius, double halfLength) {
  return roundBody(ConvexBody::Kind::kCapsule, radius, halfLength);
}
ConvexBody cylinderBody(double radius, double halfHeight) {
  return roundBody(ConvexBody::Kind::kCylinder, radius, halfHeight);
}
ConvexBody polyhedronBody(const scenes::MeshArrays& mesh) {
  ConvexBody body;
  body.pose = kUnmoved;
  body.kind = ConvexBody::Kind::kPolyhedron;
  for (const Vec3f& v : mesh.vertices) body.vertices.push_back({v.x, v.y, v.z});
  for (const Triangle& t : mesh.triangles) {
    const Vec3d &p = body.vertices[t.v[0]], &q = body.vertices[t.v[1]], &r = body.vertices[t.v[2]];
    const Vec3d n = otgCross(q - p, r - p);
    body.normals.push_back(n * (1 / norm(n)));
  }
  return body;
}

std::vector<TessellatedBody> largeBodies() {
  return {sphere(0.5), box({0.5, 0.35, 0.2}), capsule(0.25, 0.35), cylinder(0.3, 0.4), convex(0.5)};
}
std::vector<TessellatedBody> smallBodies() {
  return {sphere(0.3), box({0.25, 0.3, 0.35}), capsule(0.2, 0.3), cylinder(0.2, 0.3), convex(0.35)};
}

bool isAmbiguous(const TessellatedBody& a, const TessellatedBody& b, const WaysApart& ways) {
  return ways.other <= (1 + kAmbiguous) * ways.least + 2 * (a.sagitta + b.sagitta);
}

TessellatedPose drawPose(const TessellatedBody& a, TessellatedBody b, Random& random, double least, double most) {
  TessellatedPose pose;
  for (;;) {
    b.body.pose = random.rotation();
    const Vec3d away = random.direction();
    const double wanted = least * std::pow(most / least, random.uniform(0, 1));
    double near = 0, far = 4;
    while (far - near > 1e-3 * wanted) {
      const double middle = 0.5 * (near + far);
      b.body.pose.t = away * middle;
      (roughSeparation(a.body, b.body) > wanted ? near : far) = middle;
    }
    pose.ways = waysApart(a.body, b.body, kApartDegrees);
    if (pose.ways.least >= least && pose.ways.least <= most) break;
  }
  pose.bInA = b.body.pose;
  pose.ambiguous = isAmbiguous(a, b, pose.ways);
  return pose;
}

TessellatedErrors compareMeshes(const TessellatedBody& a, const TessellatedBody& b, const TessellatedRange& range,
                                const TessellatedLook& look) {
  const CollisionMesh meshA(scenes::build(a.mesh), BuildStrategy::kSah),
      meshB(scenes::build(b.mesh), BuildStrategy::kSah);
  TessellatedErrors errors;
  Random random(range.seed);
  Workspace workspace;
  for (; errors.poses < range.poses; ++errors.poses) {
    const TessellatedPose pose = drawPose(a, b, random, range.least, range.most);
    Query query;
    query.a = &meshA;
    query.b = &meshB;
    query.bInA = pose.bInA;
    query.options.contacts = ContactModel::kSolid;
    collide(query, workspace);
    const std::vector<Contact>& found = workspace.reduced;
    if (found.empty()) {
      if (pose.ways.least > a.sagitta + b.sagitta) ++errors.missed;
      continue;
    }
    const Contact& deepest = *std::max_element(found.begin(), found.end(),
                                               [](const Contact& x, const Contact& y) { return x.depth < y.depth; });
    const Vec3d d = deepest.normal * -1.0;  // B's way
    ConvexBody placed = b.body;
    placed.pose = pose.bInA;
    const double along = separation(a.body, placed, d);
    errors.depth.add(std::fabs(deepest.depth - pose.ways.least));
    errors.longer.add(std::max(0.0, along - pose.ways.least));
    errors.depthBeside.add(std::fabs(deepest.depth - along));
    if (pose.ambiguous) {
      ++errors.ambiguous;
    } else {
      errors.degrees.add(angleBetween(d, pose.ways.direction));
    }
    if (look) look(pose, deepest);
  }
  return errors;
}

}  // namespace otg::truth
