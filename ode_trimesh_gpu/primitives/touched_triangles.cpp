// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/touched_triangles.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/vectors.h"
#include "collide/query.h"
#include "queries/closest_point.h"

namespace otg {
namespace {

/// Calls `take` with each triangle whose box `mayTouch` (the box's middle and half extents in the mesh's frame).
template <class MayTouch, class Take>
void visit(const CollisionMesh& tree, const MayTouch& mayTouch, const Take& take) {
  const Array<BvhNode>& nodes = tree.tree().nodes;
  if (nodes.empty()) return;
  const Vec3f& c = tree.mesh().origin();
  const BoxScale<float>* const scale = tree.boxScale();
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const BvhNode& node = nodes[stack.back()];
    stack.pop_back();
    const BoxOf box = scale == nullptr ? BoxOf{node.center, node.extent} : scaledBox(*scale, node.center, node.extent);
    const Vec3d middle{double{box.center.x} + c.x, double{box.center.y} + c.y, double{box.center.z} + c.z};
    if (!mayTouch(middle, Vec3d{box.extent.x, box.extent.y, box.extent.z})) continue;
    if (!node.isLeaf()) {
      stack.push_back(static_cast<std::uint32_t>(node.child));
      stack.push_back(static_cast<std::uint32_t>(node.child + 1));
    } else if (!tree.mesh().isDegenerate(node.triangle())) {
      take(node.triangle());
    }
  }
}

std::vector<std::uint32_t> eachOnce(std::vector<std::uint32_t> triangles) {
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

/// Whether a corner of the triangle is one of the points that `holds` says.
template <class Holds>
bool anyCorner(const TriMesh& mesh, std::uint32_t triangle, const Holds& holds) {
  Vec3d corners[3];
  cornersOf(mesh, triangle, corners);
  return std::any_of(corners, corners + 3, holds);
}

}  // namespace

std::vector<std::uint32_t> trianglesTouching(const CollisionMesh& mesh, const PlaneGeom& plane) {
  const Vec3d& n = plane.normal;
  std::vector<std::uint32_t> found;
  const auto isBelow = [&](const Vec3d& p) { return otgDot(n, p) <= plane.offset; };
  visit(
      mesh,
      [&](const Vec3d& middle, const Vec3d& half) {
        const double reach = std::fabs(n.x) * half.x + std::fabs(n.y) * half.y + std::fabs(n.z) * half.z;
        return otgDot(n, middle) - reach <= plane.offset + 1e-12 * (std::fabs(plane.offset) + reach);
      },
      [&](std::uint32_t t) {
        if (anyCorner(mesh.mesh(), t, isBelow)) found.push_back(t);
      });
  return eachOnce(std::move(found));
}

std::vector<std::uint32_t> trianglesTouching(const CollisionMesh& mesh, const Vec3d& center, double radius) {
  std::pmr::vector<SurfacePoint> points;
  trianglesWithin(mesh, center, radius, points);
  std::vector<std::uint32_t> found;
  for (const SurfacePoint& p : points) found.push_back(p.triangle);
  return eachOnce(std::move(found));
}

std::vector<std::uint32_t> trianglesTouching(const CollisionMesh& mesh, const ConvexShape& shape,
                                             const Transformd& shapeInMesh, Workspace& workspace) {
  Query query;
  query.a = &mesh;
  query.b = shape.mesh.get();
  query.bInA = shapeInMesh;
  findIntersectingPairs(query, workspace);
  std::vector<std::uint32_t> found;
  for (const TrianglePair& pair : workspace.intersecting) found.push_back(pair.a);
  // The others have a corner inside if any point.
  const auto farthest = [&](const Vec3d& direction) {
    const Vec3d p = otgTransform(shapeInMesh, shape.support(otgRotateBack(shapeInMesh, direction)));
    return otgDot(p, direction);
  };
  const Vec3d high{farthest({1, 0, 0}), farthest({0, 1, 0}), farthest({0, 0, 1})};
  const Vec3d low{-farthest({-1, 0, 0}), -farthest({0, -1, 0}), -farthest({0, 0, -1})};
  const auto isInside = [&](const Vec3d& p) {
    return shape.exitDistance(otgRotateBack(shapeInMesh, p - shapeInMesh.t), {0, 0, 1}) >= 0;
  };
  visit(
      mesh,
      [&](const Vec3d& m, const Vec3d& h) {
        return m.x + h.x >= low.x && m.x - h.x <= high.x && m.y + h.y >= low.y && m.y - h.y <= high.y &&
               m.z + h.z >= low.z && m.z - h.z <= high.z;
      },
      [&](std::uint32_t t) {
        if (anyCorner(mesh.mesh(), t, isInside)) found.push_back(t);
      });
  return eachOnce(std::move(found));
}

std::shared_ptr<const CollisionMesh> meshOfTriangles(const TriMesh& mesh, std::span<const std::uint32_t> chosen) {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  std::unordered_map<std::uint32_t, std::uint32_t> numberOf;
  for (const std::uint32_t t : chosen) {
    Triangle& triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles()[t].v[k];
      const auto [it, isNew] = numberOf.try_emplace(v, static_cast<std::uint32_t>(vertices.size()));
      if (isNew) vertices.push_back(mesh.vertices()[v]);
      triangle.v[k] = it->second;
    }
  }
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  input.indices = triangles.data();
  input.triangleCount = triangles.size();
  const MeshResult built = buildTriMesh(input);
  return std::make_shared<const CollisionMesh>(built.mesh, BuildStrategy::kSah);
}

}  // namespace otg
