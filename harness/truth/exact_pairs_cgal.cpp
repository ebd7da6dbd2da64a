// SPDX-License-Identifier: BSD-3-Clause
#include "truth/exact_pairs.h"

#ifdef OTG_WITH_CGAL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#endif

#include <algorithm>
#include <stdexcept>

namespace otg::truth {

#ifdef OTG_WITH_CGAL
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct CgalTriangle {
  Kernel::Triangle_3 triangle;
  Vec3d low, high;
  std::uint32_t number;
};

bool isOnLine(const std::array<Vec3d, 3>& corners) {
  const auto& [p, q, r] = corners;
  return CGAL::collinear(Kernel::Point_3(p.x, p.y, p.z), Kernel::Point_3(q.x, q.y, q.z),
                         Kernel::Point_3(r.x, r.y, r.z));
}

/// Those that have area.
std::vector<CgalTriangle> withArea(const std::vector<ExactTriangle>& triangles) {
  std::vector<CgalTriangle> out;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (isOnLine(triangles[i].own) || isOnLine(triangles[i].placed)) continue;
    const auto& [p, q, r] = triangles[i].placed;
    const Kernel::Point_3 a(p.x, p.y, p.z), b(q.x, q.y, q.z), c(r.x, r.y, r.z);
    out.push_back({Kernel::Triangle_3(a, b, c),
                   {std::min({p.x, q.x, r.x}), std::min({p.y, q.y, r.y}), std::min({p.z, q.z, r.z})},
                   {std::max({p.x, q.x, r.x}), std::max({p.y, q.y, r.y}), std::max({p.z, q.z, r.z})},
                   i});
  }
  return out;
}

}  // namespace

std::vector<TrianglePair> pairsByCgal(const std::vector<ExactTriangle>& a, const std::vector<ExactTriangle>& b) {
  const std::vector<CgalTriangle> first = withArea(a), second = withArea(b);
  std::vector<TrianglePair> out;
  for (const CgalTriangle& s : first) {
    for (const CgalTriangle& t : second) {
      const bool boxesMeet = s.low.x <= t.high.x && t.low.x <= s.high.x && s.low.y <= t.high.y && t.low.y <= s.high.y &&
                             s.low.z <= t.high.z && t.low.z <= s.high.z;
      if (boxesMeet && CGAL::do_intersect(s.triangle, t.triangle)) out.push_back({s.number, t.number});
    }
  }
  return out;
}

bool isBuiltWithCgal() {
  return true;
}
#else
std::vector<TrianglePair> pairsByCgal(const std::vector<ExactTriangle>&, const std::vector<ExactTriangle>&) {
  throw std::logic_error("built without CGAL");
}

bool isBuiltWithCgal() {
  return false;
}
#endif

}  // namespace otg::truth
