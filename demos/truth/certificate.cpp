// SPDX-License-Identifier: BSD-3-Clause
#include "truth/certificate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truth/triangle_distance.h"

namespace otg::truth {
namespace {

constexpr double kTooDeep = 3;      ///< times the distance to the surface to leave
constexpr double kFacing = 0.5;     ///< cosine between the way out and normals of the surface to leave
constexpr double kNormal = 1e-9;

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

/// Distance of a point from the triangles that face a direction, of a mesh; all in the world.
double distanceToFacing(const PairBody& body, const Vec3d& point, const Vec3d& way) {
  // In the body's frame: far from the origin the world's coordinates have fewer digits.
  const Vec3d p = otgRotateBack(body.pose, otgSub(point, body.pose.t)), d = otgRotateBack(body.pose, way);
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : body.mesh.triangles) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = body.mesh.vertices[t.v[k]];
      corners[k] = {v.x, v.y, v.z};
    }
    const Vec3d n = otgCross(otgSub(corners[1], corners[0]), otgSub(corners[2], corners[0]));
    if (otgDot(n, d) < kFacing * norm(n)) continue;
    least = std::min(least, distanceToTriangle(p, corners));
  }
  return least;
}

/// How much farther along the same way the bodies come apart, as a part of it; at most 1.
double growthUntilApart(PairOracle& oracle, const Vec3d& translation) {
  double inside = 0, outside = 1;
  if (oracle.overlapped(otgScale(translation, 2.0))) return 1;
  while (outside - inside > 1e-3) {
    const double middle = 0.5 * (inside + outside);
    (oracle.overlapped(otgScale(translation, 1 + middle)) ? inside : outside) = middle;
  }
  return outside;
}

bool same(const JudgedContact& x, const JudgedContact& y, double tolerance) {
  return norm(otgSub(x.position, y.position)) <= tolerance && std::fabs(x.depth - y.depth) <= tolerance &&
         norm(otgSub(x.normal, y.normal)) <= kNormal;
}

}  // namespace

Certificate certify(PairOracle& oracle, const std::vector<JudgedContact>& contacts) {
  Certificate result;
  result.none = contacts.empty();
  if (result.none) return result;
  std::vector<HalfSpace> halfSpaces;
  for (const JudgedContact& c : contacts) halfSpaces.push_back({c.normal, c.depth});
  const std::optional<Vec3d> t = shortestTranslation(halfSpaces);
  result.infeasible = !t;
  if (!t) return result;
  result.asked = *t;
  result.length = norm(*t);
  if (!oracle.overlapped(*t)) {
    result.left = 0;
    return result;
  }
  const std::optional<double> before = oracle.volume({0, 0, 0});
  result.left = before ? *oracle.volume(*t) / *before : growthUntilApart(oracle, *t);
  return result;
}

std::vector<std::size_t> tooDeep(const PairBody& a, const PairBody& b, const std::vector<JudgedContact>& contacts,
                                 double grain) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const JudgedContact& c = contacts[i];
    if (c.exempt || c.depth <= grain) continue;
    const Vec3d half = otgScale(c.normal, c.depth / 2);
    double distance = std::numeric_limits<double>::infinity();
    // A shape's surface has no triangles of its own; its partner's tells enough.
    if (!b.shape) distance = std::min(distance, distanceToFacing(b, otgSub(c.position, half), c.normal));
    if (!a.shape) {
      distance = std::min(distance, distanceToFacing(a, otgAdd(c.position, half), otgScale(c.normal, -1.0)));
    }
    if (c.depth > kTooDeep * (distance + grain)) found.push_back(i);
  }
  return found;
}

int unmatched(const std::vector<JudgedContact>& x, const std::vector<JudgedContact>& y, double tolerance) {
  int count = 0;
  std::vector<bool> taken(y.size(), false);
  for (const JudgedContact& c : x) {
    std::size_t k = 0;
    while (k < y.size() && (taken[k] || !same(c, y[k], tolerance))) ++k;
    if (k < y.size()) {
      taken[k] = true;
    } else {
      ++count;
    }
  }
  return count + static_cast<int>(std::count(taken.begin(), taken.end(), false));
}

}  // namespace otg::truth
