// SPDX-License-Identifier: BSD-3-Clause
#include "queries/closest_point.h"

#include <algorithm>
#include <cmath>

#include "bvh/wide_search.h"
#include "collide/solid/vectors.h"

namespace otg {
namespace {

/// The squared distance of a point (centred frame) from a node's box, made smaller by more than its rounding.
double boxDistance2(const BvhNode& node, const Vec3d& p) {
  const double x = std::max(0.0, std::fabs(p.x - node.center.x) - node.extent.x);
  const double y = std::max(0.0, std::fabs(p.y - node.center.y) - node.extent.y);
  const double z = std::max(0.0, std::fabs(p.z - node.center.z) - node.extent.z);
  return (x * x + y * y + z * z) * (1 - 1e-14);
}

SurfacePoint pointOn(const Vec3d& on, const Vec3d& p, TrianglePart part) {
  const Vec3d d = otgSub(p, on);
  return {on, std::sqrt(otgDot(d, d)), kNone, part};
}

/// Calls visit(triangle point) for all that are not farther than limit, which visit may lower; near ones early.
template <class Visit>
void searchNear(const CollisionMesh& tree, const Vec3d& point, double& limit, const Visit& visit) {
  const Array<BvhNode>& nodes = tree.tree().nodes;
  if (nodes.empty()) return;
  const TriMesh& mesh = tree.mesh();
  const Vec3d centred = otgSub(point, Vec3d{mesh.origin().x, mesh.origin().y, mesh.origin().z});
  struct Item {
    std::uint32_t node;
    double distance2;
  };
  Item stack[kMaxTreeDepth + 2];
  int top = 0;
  stack[top++] = {0, boxDistance2(nodes[0], centred)};
  while (top > 0) {
    const Item item = stack[--top];
    if (item.distance2 > limit * limit) continue;
    const BvhNode& node = nodes[item.node];
    if (node.isLeaf()) {
      const std::uint32_t t = node.triangle();
      if (mesh.isDegenerate(t)) continue;
      Vec3d corners[3];
      cornersOf(mesh, t, corners);
      SurfacePoint found = closestOnTriangle(corners, point);
      found.triangle = t;
      if (found.distance <= limit) visit(found);
      continue;
    }
    const auto child = static_cast<std::uint32_t>(node.child);
    Item first{child, boxDistance2(nodes[child], centred)}, second{child + 1, boxDistance2(nodes[child + 1], centred)};
    if (second.distance2 < first.distance2) std::swap(first, second);
    stack[top++] = second;
    stack[top++] = first;
  }
}

}  // namespace

void cornersOf(const TriMesh& mesh, std::uint32_t triangle, Vec3d out[3]) {
  for (int k = 0; k < 3; ++k) {
    const Vec3f& v = mesh.vertices()[mesh.triangles()[triangle].v[k]];
    out[k] = {v.x, v.y, v.z};
  }
}

Vec3d faceNormal(const TriMesh& mesh, std::uint32_t triangle) {
  if (mesh.isDegenerate(triangle)) return {0, 0, 0};
  Vec3d p[3];
  cornersOf(mesh, triangle, p);
  return unit(otgCross(otgSub(p[1], p[0]), otgSub(p[2], p[0])));
}

SurfacePoint closestOnTriangle(const Vec3d corners[3], const Vec3d& p) {
  const Vec3d &a = corners[0], &b = corners[1], &c = corners[2];
  const Vec3d ab = otgSub(b, a), ac = otgSub(c, a), ap = otgSub(p, a);
  const double d1 = otgDot(ab, ap), d2 = otgDot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return pointOn(a, p, TrianglePart::kCorner0);
  const Vec3d bp = otgSub(p, b);
  const double d3 = otgDot(ab, bp), d4 = otgDot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return pointOn(b, p, TrianglePart::kCorner1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    return pointOn(otgAdd(a, otgScale(ab, d1 / (d1 - d3))), p, TrianglePart::kEdge0);
  }
  const Vec3d cp = otgSub(p, c);
  const double d5 = otgDot(ab, cp), d6 = otgDot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return pointOn(c, p, TrianglePart::kCorner2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    return pointOn(otgAdd(a, otgScale(ac, d2 / (d2 - d6))), p, TrianglePart::kEdge2);
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return pointOn(otgAdd(b, otgScale(otgSub(c, b), w)), p, TrianglePart::kEdge1);
  }
  // Inside: along the normal, which keeps the point in the plane where the barycentric form loses it by cancellation.
  const Vec3d n = otgCross(ab, ac);
  const double height = otgDot(ap, n) / otgDot(n, n);
  return pointOn(otgSub(p, otgScale(n, height)), p, TrianglePart::kFace);
}

SurfacePoint closestPoint(const CollisionMesh& mesh, const Vec3d& point, double limit) {
  SurfacePoint best;
  searchNear(mesh, point, limit, [&](const SurfacePoint& found) {
    if (found.distance < best.distance || (found.distance == best.distance && found.triangle < best.triangle)) {
      best = found;
      limit = found.distance;
    }
  });
  return best;
}

void trianglesWithin(const CollisionMesh& mesh, const Vec3d& point, double radius,
                     std::pmr::vector<SurfacePoint>& out) {
  out.clear();
  searchWide(mesh.wide(), BallQuery(mesh.mesh(), point, radius), [&](std::uint32_t t) {
    if (mesh.mesh().isDegenerate(t)) return;
    Vec3d corners[3];
    cornersOf(mesh.mesh(), t, corners);
    SurfacePoint found = closestOnTriangle(corners, point);
    found.triangle = t;
    if (found.distance <= radius) out.push_back(found);
  });
}

}  // namespace otg
