// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/sphere_contacts.h"

#include <algorithm>
#include <unordered_map>

#include "collide/solid/vectors.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

constexpr double kSamePlace = 0.9986;  // cosine of 3 degrees

/// What a triangle's nearest point lies on, as a number that its other triangles give it, too. Faces have none.
std::uint64_t featureKey(const Topology& topology, const TriMesh& mesh, const SurfacePoint& p) {
  if (p.part <= TrianglePart::kEdge2) {
    const auto k = static_cast<std::uint32_t>(p.part) - static_cast<std::uint32_t>(TrianglePart::kEdge0);
    return topology.edgeOf[3 * p.triangle + k];
  }
  const auto k = static_cast<std::uint32_t>(p.part) - static_cast<std::uint32_t>(TrianglePart::kCorner0);
  return std::uint64_t{1} << 32 | topology.weld[mesh.triangles()[p.triangle].v[k]];
}

/// Only those that are local minima, each once: no triangle that shares the edge or corner is nearer.
void keepMinima(const TriMesh& mesh, double rounding, std::vector<SurfacePoint>& points) {
  const Topology& topology = mesh.topology();
  struct Nearest {
    double distance;
    std::uint32_t triangle;
  };
  std::unordered_map<std::uint64_t, Nearest> nearest;
  const auto offer = [&](std::uint64_t key, const SurfacePoint& p) {
    const auto [it, isNew] = nearest.emplace(key, Nearest{p.distance, p.triangle});
    if (!isNew && p.distance < it->second.distance - rounding) it->second = {p.distance, p.triangle};
  };
  for (const SurfacePoint& p : points) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      offer(topology.edgeOf[3 * p.triangle + k], p);
      offer(std::uint64_t{1} << 32 | topology.weld[mesh.triangles()[p.triangle].v[k]], p);
    }
  }
  std::unordered_map<std::uint64_t, bool> taken;
  std::erase_if(points, [&](const SurfacePoint& p) {
    if (p.part == TrianglePart::kFace) return false;
    const std::uint64_t key = featureKey(topology, mesh, p);
    return nearest.at(key).distance < p.distance - rounding || !taken.emplace(key, true).second;
  });
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
  SurfacePoint nearest = closestPoint(tree, center, radius);
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
  std::vector<SurfacePoint> points;
  trianglesWithin(tree, center, radius, points);
  keepMinima(mesh, rounding, points);
  std::sort(points.begin(), points.end(), [](const SurfacePoint& x, const SurfacePoint& y) {
    return x.distance != y.distance ? x.distance < y.distance : x.triangle < y.triangle;
  });
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
