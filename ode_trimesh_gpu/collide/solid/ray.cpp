// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/ray.h"

#include <cmath>
#include <limits>

namespace otg {
namespace {

/// A ray in the frame of the mesh.
struct LocalRay {
  Vec3d origin, direction;
};

/// Slab test against a node's box, generous by the rounding of the float boxes' own construction (they enclose).
bool hitsBox(const LocalRay& ray, const BvhNode& node, double limit) {
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

/// Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997. Edges count as inside, by a
/// hair more than rounding, so that a ray through an edge cannot slip between two triangles.
template <class Hit>
void forEachHit(const CollisionMesh& tree, const LocalRay& ray, double& limit, const Hit& hit) {
  if (tree.tree().nodes.empty()) return;
  const TriMesh& mesh = tree.mesh();
  LocalRay centred = ray;
  centred.origin = otgSub(ray.origin, Vec3d{mesh.center().x, mesh.center().y, mesh.center().z});
  std::uint32_t stack[kMaxTreeDepth + 2];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const BvhNode& node = tree.tree().nodes[stack[--top]];
    if (!hitsBox(centred, node, limit)) continue;
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

}  // namespace

double exitDistance(const PlacedMeshes& meshes, int mesh, const Vec3d& origin, const Vec3d& direction, double limit,
                    double skin, std::uint32_t* triangle) {
  const LocalRay ray{meshes.toLocal(mesh, origin), meshes.directionToLocal(mesh, direction)};
  double nearest = limit;
  bool found = false, leaves = false;
  forEachHit(meshes.tree(mesh), ray, nearest, [&](std::uint32_t t, double distance, bool leaving) {
    if (!leaving && distance <= skin) return;
    if (found && distance > nearest) return;
    if (found && distance == nearest && leaves) return;  // an edge that both sides share: leaving wins
    found = true;
    leaves = leaving;
    nearest = distance;
    if (triangle) *triangle = t;
  });
  if (!found) return -1;
  return leaves ? nearest : 0;
}

bool pointInside(const PlacedMeshes& meshes, int mesh, const Vec3d& point) {
  // No rational directions: rays along axes run through edges and vertices of real meshes.
  static constexpr Vec3d kDirections[3] = {
      {0.5391643, 0.6713921, 0.5083117}, {-0.7231847, 0.2790419, 0.6317723}, {0.1874319, -0.8310647, 0.5236533}};
  int votes = 0;
  for (int k = 0; k < 3; ++k) {
    const LocalRay ray{meshes.toLocal(mesh, point), kDirections[k]};
    int balance = 0;
    double limit = std::numeric_limits<double>::infinity();
    forEachHit(meshes.tree(mesh), ray, limit,
               [&](std::uint32_t, double, bool leaving) { balance += leaving ? 1 : -1; });
    votes += balance > 0 ? 1 : -1;
    if (votes == 2 || votes == -2) break;
  }
  return votes > 0;
}

}  // namespace otg
