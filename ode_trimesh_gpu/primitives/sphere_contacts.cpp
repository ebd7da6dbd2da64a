// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/sphere_contacts.h"

#include <algorithm>
#include <cstddef>
#include <memory_resource>

#include "collide/solid/vectors.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

constexpr double kSamePlace = 0.9986;       // cosine of 3 degrees
constexpr std::size_t kPointsAtHand = 128;  // on the stack; more are rare

Vec3d vertexOf(const TriMesh& mesh, std::uint32_t v) {
  const Vec3f& p = mesh.vertices()[v];
  return {p.x, p.y, p.z};
}

/// Whether a surface that goes on from a point towards another one comes no nearer to the centre, by the angle with the
/// way from the point to the centre.
bool leadsAway(const Vec3d& from, const Vec3d& to, const Vec3d& toCenter, double tolerance) {
  const Vec3d along = otgSub(to, from);
  const double rise = otgDot(along, toCenter);
  return rise <= 0 || rise * rise <= tolerance * otgDot(along, along);
}

/// Whether no triangle that shares the point's edge or corner comes nearer to the centre than the point does. A
/// distance d falls along a triangle that rises by the sine s towards the centre, by s^2 d / 2 to begin with.
bool isMinimum(const CollisionMesh& tree, double rounding, const Vec3d& center, const SurfacePoint& p) {
  if (p.part == TrianglePart::kFace) return true;
  const TriMesh& mesh = tree.mesh();
  const Topology& topology = mesh.topology();
  const Adjacency& adjacency = tree.adjacency();
  const Vec3d toCenter = otgSub(center, p.point);
  const double tolerance = 2 * rounding * p.distance;
  if (p.part >= TrianglePart::kCorner0) {
    const auto k = static_cast<std::uint32_t>(p.part) - static_cast<std::uint32_t>(TrianglePart::kCorner0);
    const std::uint32_t v = topology.weld[mesh.triangles()[p.triangle].v[k]];
    for (std::uint32_t i = adjacency.first[v]; i < adjacency.first[v + 1]; ++i) {
      // Each triangle of the corner: its two edges there bound what directions it has.
      const std::uint32_t half = adjacency.halfEdges[i];
      const Triangle& t = mesh.triangles()[half / 3];
      for (const std::uint32_t step : {1u, 2u}) {
        if (!leadsAway(p.point, vertexOf(mesh, t.v[(half + step) % 3]), toCenter, tolerance)) return false;
      }
    }
    return true;
  }
  const auto k = static_cast<std::uint32_t>(p.part) - static_cast<std::uint32_t>(TrianglePart::kEdge0);
  const std::uint32_t edge = topology.edgeOf[3 * p.triangle + k], v = topology.edges[edge].a;
  for (std::uint32_t i = adjacency.first[v]; i < adjacency.first[v + 1]; ++i) {
    const std::uint32_t half = adjacency.halfEdges[i], first = half - half % 3;
    for (std::uint32_t side = 0; side < 3; ++side) {
      if (topology.edgeOf[first + side] != edge) continue;
      const Vec3d opposite = vertexOf(mesh, mesh.triangles()[half / 3].v[(side + 2) % 3]);
      if (!leadsAway(p.point, opposite, toCenter, tolerance)) return false;
    }
  }
  return true;
}

Contact makeContact(const SurfacePoint& at, const Vec3d& normal, double depth, std::uint32_t region) {
  Contact contact{at.point, normal, depth, at.triangle, kNone, region, ContactFeature::kFaceA};
  contact.coherence = 1;
  return contact;
}

}  // namespace

void sphereContacts(const CollisionMesh& tree, const Vec3d& center, double radius, std::vector<Contact>& out) {
  const TriMesh& mesh = tree.mesh();
  const SurfaceKind kind = surfaceKind(mesh);
  std::byte buffer[kPointsAtHand * sizeof(SurfacePoint)];
  std::pmr::monotonic_buffer_resource memory(buffer, sizeof buffer);
  std::pmr::vector<SurfacePoint> points(&memory);
  points.reserve(kPointsAtHand - 1);
  trianglesWithin(tree, center, radius, points);
  const auto isNearer = [](const SurfacePoint& x, const SurfacePoint& y) {
    return x.distance != y.distance ? x.distance < y.distance : x.triangle < y.triangle;
  };
  SurfacePoint nearest;
  for (const SurfacePoint& p : points) {
    if (isNearer(p, nearest)) nearest = p;
  }
  if (nearest.triangle == kNone) {
    // No surface in reach: the sphere is outside or deep within.
    if (kind != SurfaceKind::kSolid) return;
    const Vec3f &low = mesh.boundsMin(), &high = mesh.boundsMax();
    if (center.x < low.x || center.y < low.y || center.z < low.z || center.x > high.x || center.y > high.y ||
        center.z > high.z) {
      return;
    }
    nearest = closestPoint(tree, center);
    if (!isInside(tree, center, nearest)) return;
    out.push_back(makeContact(nearest, unit(otgSub(center, nearest.point)), radius + nearest.distance, 0));
    return;
  }
  const double rounding = 1e-12 * (static_cast<double>(mesh.radius()) + norm(center) + radius);
  if (nearest.distance <= rounding) {  // the centre is on the surface
    out.push_back(makeContact(nearest, otgScale(outwardNormal(tree, nearest), -1.0), radius, 0));
    return;
  }
  if (isInside(tree, center, nearest)) {
    out.push_back(makeContact(nearest, unit(otgSub(center, nearest.point)), radius + nearest.distance, 0));
    return;
  }
  std::erase_if(points, [&](const SurfacePoint& p) { return !isMinimum(tree, rounding, center, p); });
  std::sort(points.begin(), points.end(), isNearer);
  const std::size_t first = out.size();
  for (const SurfacePoint& p : points) {
    const Vec3d away = otgSub(p.point, center);
    if (kind != SurfaceKind::kShell && otgDot(away, outwardNormal(tree, p)) > 0) continue;
    const Vec3d normal = unit(away);
    const bool known = std::any_of(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                                   [&](const Contact& c) { return otgDot(c.normal, normal) > kSamePlace; });
    if (!known) {
      out.push_back(makeContact(p, normal, radius - p.distance, static_cast<std::uint32_t>(out.size() - first)));
    }
  }
}

}  // namespace otg
