// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/convexity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vectors.h"
#include "shared/tests/triangle_exact.h"

namespace otg {
namespace {

/// Greater than zero where d lies above the triangle, on the side to which it faces.
int sideOfTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return otgOrient3(&a.x, &b.x, &c.x, &d.x);
}

/// The solid angle of a triangle seen from the origin; van Oosterom and Strackee, 1983.
double solidAngle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  const double below = la * lb * lc + otgDot(a, b) * lc + otgDot(b, c) * la + otgDot(c, a) * lb;
  return 2 * std::atan2(std::fabs(otgDot(a, otgCross(b, c))), below);
}

class ConvexityTest {
 public:
  explicit ConvexityTest(const TriMesh& mesh)
      : mesh_(mesh), topology_(mesh.topology()), rounding_(roundingOfVertices(mesh)) {}

  Convexity run() {
    if (mesh_.meshClass() != MeshClass::kSolid || topology_.componentCount() != 1) return Convexity::kNone;
    if (!isSeenOnce()) return Convexity::kNone;
    Convexity found = Convexity::kExact;
    for (std::uint32_t t = 0; t < mesh_.triangleCount(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t twin = topology_.twin[3 * t + k];
        if (twin / 3 <= t) continue;
        const Convexity edge = acrossEdge(t, twin);
        if (edge == Convexity::kNone) return edge;
        if (edge == Convexity::kToRounding) found = edge;
      }
    }
    return found;
  }

 private:
  Vec3d corner(std::uint32_t t, std::uint32_t k) const { return asDouble(mesh_.vertices()[mesh_.triangles()[t].v[k]]); }

  /// Whether the triangle is so low that rounding of its corners, as seen from the middle of the mesh, may turn its
  /// plane anywhere. Such a mesh may be convex; the model of solids works with it as well.
  bool isWithoutPlane(const Vec3d& a, const Vec3d& b, const Vec3d& c) const {
    constexpr double kRounding = 4 * 0x1p-24;
    const Vec3d middle = asDouble(mesh_.origin());
    double largest = 0;
    for (const Vec3d& p : {a - middle, b - middle, c - middle}) {
      largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    }
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    return norm(otgCross(b - a, c - a)) <= kRounding * largest * longest;
  }

  /// Whether the triangles cover all directions from a point inside, none twice. Together with edges that are nowhere
  /// concave this makes the surface convex.
  bool isSeenOnce() const {
    Vec3d sum{0, 0, 0};
    for (std::uint32_t t = 0; t < mesh_.triangleCount(); ++t) sum = sum + corner(t, 0) + corner(t, 1) + corner(t, 2);
    const Vec3d inside = sum * (1.0 / (3.0 * static_cast<double>(mesh_.triangleCount())));
    double angle = 0;
    for (std::uint32_t t = 0; t < mesh_.triangleCount(); ++t) {
      const Vec3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
      if (isWithoutPlane(a, b, c)) return false;
      if (sideOfTriangle(a, b, c, inside) >= 0) return false;
      angle += solidAngle(a - inside, b - inside, c - inside);
    }
    return angle < 6 * std::numbers::pi;  // 4 pi for each time
  }

  /// The triangle `t` and the one that has the half-edge `twin`.
  Convexity acrossEdge(std::uint32_t t, std::uint32_t twin) const {
    const std::uint32_t other = twin / 3;
    const Vec3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2), d = corner(other, (twin % 3 + 2) % 3);
    if (sideOfTriangle(a, b, c, d) <= 0) return Convexity::kExact;
    const Vec3d normal = otgCross(b - a, c - a);
    if (otgDot(normal, d - a) > rounding_ * norm(normal)) return Convexity::kNone;
    return Convexity::kToRounding;
  }

  const TriMesh& mesh_;
  const Topology& topology_;
  const double rounding_;
};

}  // namespace

double roundingOfVertices(const TriMesh& mesh) {
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  const float most =
      std::max({std::fabs(lo.x), std::fabs(lo.y), std::fabs(lo.z), std::fabs(hi.x), std::fabs(hi.y), std::fabs(hi.z)});
  return 4 * std::ldexp(1.0, std::ilogb(most) - 23);
}

Convexity convexityOf(const TriMesh& mesh) {
  if (mesh.triangleCount() == 0) return Convexity::kNone;
  return ConvexityTest(mesh).run();
}

}  // namespace otg
