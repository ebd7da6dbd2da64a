// SPDX-License-Identifier: BSD-3-Clause
// Every triangle that a ray meets, by the tree, in double.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "base/vectors.h"
#include "bvh/wide_search.h"
#include "shared/tests/point_test.h"

namespace otg {

/// A ray in the frame of the mesh.
struct MeshRay {
  Vec3d origin, direction;
};

/// One that ends.
struct LongRay {
  MeshRay ray;
  double length = 0;  ///< in lengths of the direction; may be infinite
};

/// Calls visit(triangle) for every triangle that the ray may meet, however far away it is.
template <class Visit>
void forEachOnRay(const CollisionMesh& tree, const MeshRay& ray, const Visit& visit) {
  const std::vector<WideNode>& nodes = tree.wide().nodes;
  const RayQuery query(tree, ray.origin, ray.direction);
  if (nodes.empty() || !query.meets()) return;
  std::int32_t stack[kWideArity * (kMaxTreeDepth + 1)];
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const WideNode& node = nodes[static_cast<std::size_t>(stack[--top])];
    float near[kWideArity];
    for (unsigned bits = query.children(node, std::numeric_limits<double>::infinity(), near); bits != 0;
         bits &= bits - 1) {
      const int k = __builtin_ctz(bits);
      if (node.child[k] < 0) {
        visit(static_cast<std::uint32_t>(~node.child[k]));
      } else {
        stack[top++] = node.child[k];
      }
    }
  }
}

/// Calls hit(triangle, distance, leaving) for every triangle that the ray hits at most `limit` away, near parts of the
/// tree first; `limit` may be lowered meanwhile. `leaving`: the triangle faces along the ray. Distances are in lengths
/// of the direction. Degenerate triangles are passed over. Which triangles count, and where, depends on the ray and the
/// triangle alone (otgRayHitsTriangle). So every tree, and every order, finds the same nearest one.
template <class Hit>
void forEachRayHit(const CollisionMesh& tree, const MeshRay& ray, double& limit, const Hit& hit) {
  const std::vector<WideNode>& nodes = tree.wide().nodes;
  if (nodes.empty()) return;
  const TriMesh& mesh = tree.mesh();
  const RayQuery query(tree, ray.origin, ray.direction);
  if (!query.meets()) return;
  const Vec3d middle{mesh.origin().x, mesh.origin().y, mesh.origin().z};
  const Vec3d along = otgRayAlong(ray.direction), inverse{1 / along.x, 1 / along.y, 1 / along.z};
  const double reach = otgRayReach(double{mesh.radius()}, ray.origin - middle, middle);
  const auto test = [&](std::uint32_t t) {
    if (mesh.isDegenerate(t)) return;
    Vec3d p[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3f& v = mesh.vertices()[mesh.triangles()[t].v[k]];
      p[k] = {v.x, v.y, v.z};
    }
    double distance = 0;
    const int meets = otgRayHitsTriangle(ray.origin, ray.direction, along, inverse, p[0], p[1], p[2], reach, &distance);
    if (meets != 0 && distance <= limit) hit(t, distance, meets == 2);
  };
  struct Item {
    std::int32_t node;
    float near;
  };
  Item stack[kWideArity * (kMaxTreeDepth + 1)];
  std::size_t top = 0;
  stack[top++] = {0, 0};
  while (top > 0 && limit >= 0) {
    const Item item = stack[--top];
    if (!query.isBefore(item.near, limit)) continue;
    const WideNode& node = nodes[static_cast<std::size_t>(item.node)];
    float near[kWideArity];
    const std::size_t first = top;
    for (unsigned bits = query.children(node, limit, near); bits != 0; bits &= bits - 1) {
      const int k = __builtin_ctz(bits);
      if (node.child[k] < 0) {
        test(static_cast<std::uint32_t>(~node.child[k]));
        continue;
      }
      std::size_t place = top++;
      for (; place > first && stack[place - 1].near < near[k]; --place) stack[place] = stack[place - 1];
      stack[place] = {node.child[k], near[k]};
    }
  }
}

}  // namespace otg
