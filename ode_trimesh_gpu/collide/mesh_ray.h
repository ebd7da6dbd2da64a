// SPDX-License-Identifier: BSD-3-Clause
// Every triangle that a ray meets, by the tree, in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "bvh/collision_mesh.h"

namespace otg {

/// A ray in the frame of the mesh.
struct MeshRay {
  Vec3d origin, direction;
};

/// Slab test against a node's box (both in the centred frame), generous by the rounding of the float boxes' own
/// construction (they enclose).
inline bool rayHitsBox(const MeshRay& ray, const BvhNode& node, double limit) {
  const double o[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const double c[3] = {node.center.x, node.center.y, node.center.z};
  const double e[3] = {node.extent.x, node.extent.y, node.extent.z};
  double near = 0, far = limit;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (std::fabs(o[k] - c[k]) > e[k]) return false;
      continue;
    }
    const double inverse = 1 / d[k];
    double t0 = (c[k] - e[k] - o[k]) * inverse, t1 = (c[k] + e[k] - o[k]) * inverse;
    if (t0 > t1) std::swap(t0, t1);
    near = std::max(near, t0 - 1e-12 * std::fabs(t0));
    far = std::min(far, t1 + 1e-12 * std::fabs(t1));
    if (near > far) return false;
  }
  return true;
}

/// Calls hit(triangle, distance, leaving) for every triangle that the ray meets at most `limit` away, in the order of
/// the tree; `limit` may be lowered meanwhile. `leaving`: the triangle faces along the ray. Distances are in lengths of
/// the direction. Degenerate triangles are passed over.
///
/// Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997. Edges count as inside, by a
/// hair more than rounding, so that a ray through an edge cannot slip between two triangles.
template <class Hit>
void forEachRayHit(const CollisionMesh& tree, const MeshRay& ray, double& limit, const Hit& hit) {
  if (tree.tree().nodes.empty()) return;
  const TriMesh& mesh = tree.mesh();
  MeshRay centred = ray;
  centred.origin = otgSub(ray.origin, Vec3d{mesh.center().x, mesh.center().y, mesh.center().z});
  std::uint32_t stack[kMaxTreeDepth + 2];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const BvhNode& node = tree.tree().nodes[stack[--top]];
    if (!rayHitsBox(centred, node, limit)) continue;
    if (!node.isLeaf()) {
      stack[top++] = static_cast<std::uint32_t>(node.child);
      stack[top++] = static_cast<std::uint32_t>(node.child + 1);
      continue;
    }
    const std::uint32_t t = node.triangle();
    if (mesh.isDegenerate(t)) continue;
    Vec3d p[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3f& v = mesh.vertices()[mesh.triangles()[t].v[k]];
      p[k] = {v.x, v.y, v.z};
    }
    const Vec3d e1 = otgSub(p[1], p[0]), e2 = otgSub(p[2], p[0]);
    const Vec3d h = otgCross(ray.direction, e2);
    const double det = otgDot(e1, h);
    if (det == 0) continue;
    const Vec3d s = otgSub(ray.origin, p[0]);
    const double u = otgDot(s, h) / det;
    const Vec3d q = otgCross(s, e1);
    const double v = otgDot(ray.direction, q) / det;
    constexpr double kHair = 1e-9;
    if (u < -kHair || v < -kHair || u + v > 1 + kHair) continue;
    const double distance = otgDot(e2, q) / det;
    // det = -(direction . normal): negative when the triangle faces along the ray.
    if (distance >= 0 && distance <= limit) hit(t, distance, det < 0);
  }
}

}  // namespace otg
