// SPDX-License-Identifier: BSD-3-Clause
#include "queries/closest_point.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "bvh/wide_search.h"
#include "mesh/triangle_area.h"
#include "shared/tests/point_test.h"

namespace otg {
namespace {

static_assert(static_cast<int>(TrianglePart::kFace) == OTG_PART_FACE &&
              static_cast<int>(TrianglePart::kEdge0) == OTG_PART_EDGE &&
              static_cast<int>(TrianglePart::kCorner0) == OTG_PART_CORNER);

/// Calls visit(triangle point, search distance) for all whose search distance is not above limit, which visit may
/// lower; near ones early.
template <class Boxes, class Visit>
void searchNear(const CollisionMesh& tree, const Boxes& boxes, const Vec3d& point, double& limit, const Visit& visit) {
  const Array<BvhNode>& nodes = tree.tree().nodes;
  if (nodes.empty()) return;
  const TriMesh& mesh = tree.mesh();
  const Vec3d centred = point - asDouble(mesh.origin());
  const auto& root = boxes(nodes[0]);
  const double slack = otgSearchSlack(centred, asDouble(root.center), asDouble(root.extent));
  const auto boxDistance2 = [&](const BvhNode& node) {
    const auto& box = boxes(node);
    return otgBoxDistance2(asDouble(box.center), asDouble(box.extent), centred, slack);
  };
  struct Item {
    std::uint32_t node;
    double distance2;
  };
  Item stack[kMaxTreeDepth + 2];
  int top = 0;
  stack[top++] = {0, boxDistance2(nodes[0])};
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
      if (!(found.distance <= limit)) continue;
      const double search = otgSearchDistance(corners[0], corners[1], corners[2], point, found.distance);
      if (search <= limit) visit(found, search);
      continue;
    }
    const auto child = static_cast<std::uint32_t>(node.child);
    Item first{child, boxDistance2(nodes[child])}, second{child + 1, boxDistance2(nodes[child + 1])};
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
  return unit(areaVector2(mesh, triangle));
}

SurfacePoint closestOnTriangle(const Vec3d corners[3], const Vec3d& p) {
  SurfacePoint found;
  found.part = static_cast<TrianglePart>(otgNearestOnTriangle(corners[0], corners[1], corners[2], p, &found.point));
  found.distance = otgDistance(p, found.point);
  return found;
}

SurfacePoint pointOnTriangle(const TriMesh& mesh, std::uint32_t triangle, const Vec3d& point) {
  Vec3d corners[3];
  cornersOf(mesh, triangle, corners);
  SurfacePoint found = closestOnTriangle(corners, point);
  found.triangle = triangle;
  return found;
}

SurfacePoint closestPoint(const CollisionMesh& mesh, const Vec3d& point, double limit) {
  SurfacePoint best;
  double least = std::numeric_limits<double>::infinity();
  const auto take = [&](const SurfacePoint& found, double search) {
    if (search < least || (search == least && found.triangle < best.triangle)) {
      best = found;
      limit = least = search;
    }
  };
  withBoxes(mesh.boxScale(), [&](const auto& boxes) { searchNear(mesh, boxes, point, limit, take); });
  return best;
}

void trianglesWithin(const CollisionMesh& mesh, const Vec3d& point, double radius,
                     std::pmr::vector<SurfacePoint>& out) {
  out.clear();
  searchWide(mesh.wide(), BallQuery(mesh, point, radius), [&](std::uint32_t t) {
    if (mesh.mesh().isDegenerate(t)) return;
    const SurfacePoint found = pointOnTriangle(mesh.mesh(), t, point);
    if (found.distance <= radius) out.push_back(found);
  });
}

}  // namespace otg
