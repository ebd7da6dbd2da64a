// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/sphere_contacts.h"

#include <algorithm>
#include <cstddef>
#include <memory_resource>

#include "base/vectors.h"
#include "collide/surface/same_direction.h"
#include "primitives/round_ahead.h"
#include "queries/local_minimum.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

constexpr std::size_t kPointsAtHand = 128;  // on the stack; more are rare

Contact makeContact(const SurfacePoint& at, const Vec3d& normal, double depth, std::uint32_t region) {
  Contact contact{at.point, normal, depth, at.triangle, kNone, region, ContactFeature::kFaceA};
  contact.coherence = 1;
  return contact;
}

void addTouched(const CollisionMesh& tree, const Vec3d& center, double radius, RoundMemory& before,
                std::vector<Contact>& out) {
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
    out.push_back(makeContact(nearest, unit(center - nearest.point), radius + nearest.distance, 0));
    return;
  }
  const double rounding = 1e-12 * (static_cast<double>(mesh.radius()) + norm(center) + radius);
  if (nearest.distance <= rounding) {  // the centre is on the surface
    out.push_back(makeContact(nearest, outwardNormal(tree, nearest) * -1.0, radius, 0));
    return;
  }
  const auto isFromBehind = [&](const SurfacePoint& p) {
    return kind == SurfaceKind::kSheet && before.isFromBehind(p.point, unit(p.point - center), p.distance);
  };
  if (isInside(tree, center, nearest) && !isFromBehind(nearest)) {
    out.push_back(makeContact(nearest, unit(center - nearest.point), radius + nearest.distance, 0));
    return;
  }
  std::erase_if(points, [&](const SurfacePoint& p) { return !isMinimum(tree, p, center, rounding); });
  std::sort(points.begin(), points.end(), isNearer);
  const std::size_t first = out.size();
  for (const SurfacePoint& p : points) {
    const Vec3d away = p.point - center;
    if (kind != SurfaceKind::kShell && otgDot(away, outwardNormal(tree, p)) > 0 && !isFromBehind(p)) continue;
    const Vec3d normal = unit(away);
    const bool known = std::any_of(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                                   [&](const Contact& c) { return otgDot(c.normal, normal) > kSameDirection; });
    if (!known) {
      out.push_back(makeContact(p, normal, radius - p.distance, static_cast<std::uint32_t>(out.size() - first)));
    }
  }
}

}  // namespace

void sphereContacts(const CollisionMesh& tree, const Vec3d& center, double radius, RoundMemory& before,
                    std::vector<Contact>& out) {
  const std::size_t first = out.size();
  addTouched(tree, center, radius, before, out);
  addWallsAhead(tree, 0, out, first, [&](const Vec3d& way) { addTouched(tree, center - way, radius, before, out); });
}

}  // namespace otg
