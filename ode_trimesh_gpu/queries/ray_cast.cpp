// SPDX-License-Identifier: BSD-3-Clause
#include "queries/ray_cast.h"

#include <algorithm>

#include "base/flat_map.h"
#include "base/vectors.h"
#include "queries/closest_point.h"

namespace otg {
namespace {

/// Neighbours that are hit at one point are one hit. `hits`: by distance.
void mergeHits(const TriMesh& mesh, std::vector<RayHit>& hits) {
  if (hits.size() < 2) return;
  const SharedArray<std::uint32_t>& weld = mesh.topology().weld;
  const double same = 1e-9 * static_cast<double>(mesh.radius());
  FlatMap lastAt;  // of a vertex and a side: the last hit that is kept there
  std::uint32_t kept = 0;
  for (const RayHit& hit : hits) {
    std::uint64_t keys[3];
    std::uint32_t into = FlatMap::kMissing;
    for (int c = 0; c < 3; ++c) {
      keys[c] = 2 * std::uint64_t{weld[mesh.triangles()[hit.triangle].v[c]]} + (hit.back ? 1 : 0);
      const std::uint32_t last = lastAt.find(keys[c]);
      if (last == FlatMap::kMissing || hit.distance - hits[last].distance > same) continue;
      into = into == FlatMap::kMissing ? last : std::max(into, last);
    }
    if (into == FlatMap::kMissing) {
      into = kept++;
      hits[into] = hit;
    } else {
      hits[into].triangle = std::min(hits[into].triangle, hit.triangle);
    }
    for (const std::uint64_t key : keys) lastAt.insert(key, into) = into;
  }
  hits.resize(kept);
}

bool passes(const CollisionMesh& mesh, const RayCast& cast, const RayHit& hit) {
  if (!cast.filter) return false;
  Vec3d p[3];
  cornersOf(mesh.mesh(), hit.triangle, p);
  const Vec3d e1 = p[1] - p[0], e2 = p[2] - p[0], n = otgCross(e1, e2);
  const Vec3d at = cast.ray.origin + cast.ray.direction * hit.distance - p[0];
  // Of a triangle so thin that its normal is lost, the first corner stands for all of it.
  const double nn = otgDot(n, n), share = nn > 0 ? 1 / nn : 0;
  return !cast.filter(hit.triangle, otgDot(otgCross(at, e2), n) * share, otgDot(otgCross(e1, at), n) * share);
}

/// Whether single precision is enough for the boxes of a ray's search: products of lengths and inverse directions
/// neither overflow nor vanish.
bool isOfOrdinarySize(const TriMesh& mesh) {
  return mesh.radius() > 1e-18f && mesh.radius() < 1e18f;
}

/// Calls visit(triangle) for all triangles whose boxes the ray may enter up to `limit`, which visit may lower: as
/// forEachRayHit for meshes of any size, in double and without an order.
template <class Visit>
void forEachInReach(const CollisionMesh& tree, const MeshRay& ray, double& limit, const Visit& visit) {
  const Array<BvhNode>& nodes = tree.tree().nodes;
  if (nodes.empty()) return;
  const auto toDouble = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  const Vec3d middle = toDouble(tree.mesh().origin()), from = ray.origin - middle;
  const Vec3d along = otgRayAlong(ray.direction), inverse{1 / along.x, 1 / along.y, 1 / along.z};
  const double reach = 2 * otgRayReach(double{tree.mesh().radius()}, from, middle);
  std::uint32_t stack[kMaxTreeDepth + 2];
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const BvhNode& node = nodes[stack[--top]];
    const Vec3d center = toDouble(node.center), extent = toDouble(node.extent) + Vec3d{reach, reach, reach};
    double near;
    if (!otgRayEntersBox(from, along, inverse, center - extent, center + extent, &near) || near > limit) {
      continue;
    }
    if (node.isLeaf()) {
      if (!tree.mesh().isDegenerate(node.triangle())) visit(node.triangle());
      continue;
    }
    stack[top++] = static_cast<std::uint32_t>(node.child) + 1;
    stack[top++] = static_cast<std::uint32_t>(node.child);
  }
}

/// Calls visit(hit) for every hit that counts, near ones early; visit may lower `limit`.
template <class Visit>
void forEachHit(const CollisionMesh& mesh, const RayCast& cast, double& limit, const Visit& visit) {
  const TriangleRay ray(mesh.mesh(), cast.ray);
  const auto test = [&](std::uint32_t triangle) {
    RayHit hit;
    if (ray.hits(triangle, hit) && hit.distance <= limit && !(hit.back && cast.cullBack)) visit(hit);
  };
  if (isOfOrdinarySize(mesh.mesh())) {
    forEachRayHit(mesh, cast.ray, limit, [&](std::uint32_t t, double distance, bool back) {
      if (!(back && cast.cullBack)) visit(RayHit{distance, t, back});
    });
  } else {
    forEachInReach(mesh, cast.ray, limit, test);
  }
}

}  // namespace

TriangleRay::TriangleRay(const TriMesh& mesh, const MeshRay& ray)
    : mesh_(mesh), ray_(ray), along_(otgRayAlong(ray.direction)), inverse_{1 / along_.x, 1 / along_.y, 1 / along_.z} {
  const Vec3d middle{mesh.origin().x, mesh.origin().y, mesh.origin().z};
  reach_ = otgRayReach(double{mesh.radius()}, ray.origin - middle, middle);
}

bool TriangleRay::hits(std::uint32_t triangle, RayHit& hit) const {
  Vec3d p[3];
  cornersOf(mesh_, triangle, p);
  double at = 0;
  const int meets = otgRayHitsTriangle(ray_.origin, ray_.direction, along_, inverse_, p[0], p[1], p[2], reach_, &at);
  if (meets == 0) return false;
  hit = {at, triangle, meets == 2};
  return true;
}

RayHit castForOne(const CollisionMesh& mesh, const RayCast& cast) {
  double limit = cast.length;
  RayHit best;
  forEachHit(mesh, cast, limit, [&](const RayHit& hit) {
    if (hit.distance == best.distance && hit.triangle > best.triangle) return;
    if (passes(mesh, cast, hit)) return;
    best = hit;
    limit = cast.mode == RayMode::kAny ? -1.0 : hit.distance;  // nothing more is wanted
  });
  return best;
}

void castRay(const CollisionMesh& mesh, const RayCast& cast, std::vector<RayHit>& hits) {
  hits.clear();
  if (cast.mode != RayMode::kAll) {
    const RayHit hit = castForOne(mesh, cast);
    if (hit.triangle != kNone) hits.push_back(hit);
    return;
  }
  double limit = cast.length;
  forEachHit(mesh, cast, limit, [&](const RayHit& hit) {
    if (!passes(mesh, cast, hit)) hits.push_back(hit);
  });
  std::sort(hits.begin(), hits.end(), [](const RayHit& x, const RayHit& y) {
    return x.distance != y.distance ? x.distance < y.distance : x.triangle < y.triangle;
  });
  mergeHits(mesh.mesh(), hits);
}

}  // namespace otg
