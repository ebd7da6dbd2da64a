// SPDX-License-Identifier: BSD-3-Clause
// Containment of components by the parity of the crossings of parallel rays, all rays at once through a grid.
#include "mesh/containment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/bounds.h"
#include "base/grid_place.h"
#include "base/vectors.h"

namespace otg {
namespace {

constexpr std::uint32_t kProbes = 6;  ///< points tested for each component

/// A point in ray coordinates: the rays run towards +w.
struct RayPoint {
  double u, v, w;
};

struct RayAxes {
  int u, v, w;
  RayPoint operator()(const Vec3d& p) const {
    const double c[3] = {p.x, p.y, p.z};
    return {c[u], c[v], c[w]};
  }
  RayPoint operator()(const Vec3f& p) const { return (*this)(Vec3d{p.x, p.y, p.z}); }
};

/// Rays along the shortest extent meet the fewest other components when many lie in a row.
RayAxes chooseAxes(const Bounds& bounds) {
  const float extent[3] = {bounds.max.x - bounds.min.x, bounds.max.y - bounds.min.y, bounds.max.z - bounds.min.z};
  const int w = static_cast<int>(std::min_element(extent, extent + 3) - extent);
  return {(w + 1) % 3, (w + 2) % 3, w};
}

/// True if the ray from `p` crosses the triangle. Each edge's point at v = p.v is computed from its end points in the
/// order of their welded numbers. So both triangles of an edge see the same point, whatever its rounding: on a closed
/// surface the count can only be wrong for a `p` within rounding of the surface itself. A ray through an edge or a
/// vertex does no harm.
bool rayCrosses(const RayPoint& p, const std::array<RayPoint, 3>& corners, const std::uint32_t (&welded)[3]) {
  RayPoint cut[2];
  int cuts = 0;
  for (int k = 0; k < 3 && cuts < 2; ++k) {
    int i = k, j = (k + 1) % 3;
    if (welded[i] > welded[j]) std::swap(i, j);
    const RayPoint &a = corners[i], &b = corners[j];
    if ((a.v > p.v) == (b.v > p.v)) continue;
    const double t = (p.v - a.v) / (b.v - a.v);
    cut[cuts++] = {a.u + t * (b.u - a.u), p.v, a.w + t * (b.w - a.w)};
  }
  if (cuts < 2 || (cut[0].u > p.u) == (cut[1].u > p.u)) return false;
  const double t = (p.u - cut[0].u) / (cut[1].u - cut[0].u);
  return cut[0].w + t * (cut[1].w - cut[0].w) > p.w;
}

bool encloses(const Bounds& outer, const Bounds& inner, float slack) {
  return outer.min.x <= inner.min.x + slack && outer.min.y <= inner.min.y + slack &&
         outer.min.z <= inner.min.z + slack && outer.max.x >= inner.max.x - slack &&
         outer.max.y >= inner.max.y - slack && outer.max.z >= inner.max.z - slack;
}

struct Probe {
  RayPoint point;
  std::uint32_t component;
  std::uint32_t number;  ///< 0 ... kProbes - 1
};

/// The probes of a component are near the centroids of the triangles that reach farthest in each of the six
/// directions: inside triangles, because components may touch in vertices, and a little inside the component, because
/// its faces may lie on another one's.
std::vector<Probe> makeProbes(const Topology& topology, std::span<const Vec3f> vertices,
                              std::span<const Triangle> triangles, const RayAxes& axes,
                              const std::vector<Bounds>& bounds, double inside) {
  std::vector<std::array<std::uint32_t, kProbes>> farthest(topology.componentCount());
  for (auto& f : farthest) f.fill(kNone);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t c = topology.componentOf[t];
    if (c == kNone || !topology.componentClosed[c]) continue;
    for (const std::uint32_t index : triangles[t].v) {
      const Vec3f& p = vertices[index];
      const Bounds& b = bounds[c];
      const bool reaches[kProbes] = {p.x == b.min.x, p.y == b.min.y, p.z == b.min.z,
                                     p.x == b.max.x, p.y == b.max.y, p.z == b.max.z};
      for (std::uint32_t k = 0; k < kProbes; ++k)
        if (reaches[k] && farthest[c][k] == kNone) farthest[c][k] = t;
    }
  }
  std::vector<Probe> probes;
  for (std::uint32_t c = 0; c < farthest.size(); ++c) {
    for (std::uint32_t k = 0; k < kProbes && farthest[c][k] != kNone; ++k) {
      const std::uint32_t(&v)[3] = triangles[farthest[c][k]].v;
      const Vec3d p{vertices[v[0]].x, vertices[v[0]].y, vertices[v[0]].z};
      const Vec3d q = relativeTo(vertices[v[1]], p), r = relativeTo(vertices[v[2]], p), n = otgCross(q, r);
      const double length = norm(n), inward = topology.componentVolume[c] < 0 ? inside : -inside;
      probes.push_back({axes(p + (q + r) * (1.0 / 3) + n * (length > 0 ? inward / length : 0)), c, k});
    }
  }
  return probes;
}

/// Probes sorted into the cells of a square grid over (u, v).
class ProbeGrid {
 public:
  ProbeGrid(const std::vector<Probe>& probes, const RayPoint& min, const RayPoint& max) : min_(min) {
    side_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(probes.size()))), 1, 1024);
    const auto cellsPerLength = [&](double extent) { return extent > 0 ? static_cast<double>(side_) / extent : 0.0; };
    scaleU_ = cellsPerLength(max.u - min.u);
    scaleV_ = cellsPerLength(max.v - min.v);
    offset_.assign(side_ * side_ + 1, 0);
    for (const Probe& p : probes) ++offset_[cellOf(p.point) + 1];
    for (std::size_t i = 1; i < offset_.size(); ++i) offset_[i] += offset_[i - 1];
    probes_.resize(probes.size());
    std::vector<std::uint32_t> next(offset_.begin(), offset_.end() - 1);
    for (const Probe& p : probes) probes_[next[cellOf(p.point)]++] = p;
  }

  /// Calls visit(probe) for every probe in the cells that the rectangle touches.
  template <class Visit>
  void forEachNear(const RayPoint& min, const RayPoint& max, Visit&& visit) const {
    const std::size_t u0 = column(min.u), u1 = column(max.u), v1 = row(max.v);
    for (std::size_t v = row(min.v); v <= v1; ++v)
      for (std::uint32_t i = offset_[v * side_ + u0]; i < offset_[v * side_ + u1 + 1]; ++i) visit(probes_[i]);
  }

 private:
  // Monotonic in the coordinate, so a probe inside a rectangle lies in one of the rectangle's cells.
  std::size_t column(double u) const { return gridPlace((u - min_.u) * scaleU_, side_); }
  std::size_t row(double v) const { return gridPlace((v - min_.v) * scaleV_, side_); }
  std::size_t cellOf(const RayPoint& p) const { return row(p.v) * side_ + column(p.u); }

  std::vector<Probe> probes_;
  std::vector<std::uint32_t> offset_;
  RayPoint min_;
  std::size_t side_ = 1;
  double scaleU_ = 0, scaleV_ = 0;
};

}  // namespace

std::vector<Nesting> nestingsOf(const Topology& topology, std::span<const Vec3f> vertices,
                                std::span<const Triangle> triangles) {
  std::vector<Nesting> nestings;
  if (std::count(topology.componentClosed.begin(), topology.componentClosed.end(), 1) < 2) return nestings;

  Bounds all;
  std::vector<Bounds> bounds(topology.componentCount());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (topology.componentOf[t] == kNone) continue;
    for (const std::uint32_t v : triangles[t].v) {
      all.add(vertices[v]);
      bounds[topology.componentOf[t]].add(vertices[v]);
    }
  }
  const RayAxes axes = chooseAxes(all);
  // Coordinates of faces that lie on each other differ by a few units in the last place.
  const double most = std::max({std::fabs(all.min.x), std::fabs(all.min.y), std::fabs(all.min.z), std::fabs(all.max.x),
                                std::fabs(all.max.y), std::fabs(all.max.z)});
  const double inside = 32.0 * std::numeric_limits<float>::epsilon() * most;
  const ProbeGrid grid(makeProbes(topology, vertices, triangles, axes, bounds, inside), axes(all.min), axes(all.max));

  struct Crossing {
    std::uint32_t inner, outer, probe;
    auto operator<=>(const Crossing&) const = default;
  };
  std::vector<Crossing> crossings;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t outer = topology.componentOf[t];
    if (outer == kNone || !topology.componentClosed[outer]) continue;
    const std::uint32_t(&v)[3] = triangles[t].v;
    const std::uint32_t welded[3] = {topology.weld[v[0]], topology.weld[v[1]], topology.weld[v[2]]};
    const std::array<RayPoint, 3> p = {axes(vertices[v[0]]), axes(vertices[v[1]]), axes(vertices[v[2]])};
    const RayPoint min{std::min({p[0].u, p[1].u, p[2].u}), std::min({p[0].v, p[1].v, p[2].v}), 0};
    const RayPoint max{std::max({p[0].u, p[1].u, p[2].u}), std::max({p[0].v, p[1].v, p[2].v}), 0};
    grid.forEachNear(min, max, [&](const Probe& probe) {
      if (probe.component != outer && encloses(bounds[outer], bounds[probe.component], static_cast<float>(inside)) &&
          rayCrosses(probe.point, p, welded))
        crossings.push_back({probe.component, outer, probe.number});
    });
  }

  // Inside is where all probes of the inner component have an odd number of crossings with the outer one.
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i < crossings.size();) {
    std::uint32_t oddProbes = 0;
    const std::size_t begin = i;
    while (i < crossings.size() && crossings[i].inner == crossings[begin].inner &&
           crossings[i].outer == crossings[begin].outer) {
      const std::size_t run = i;
      while (i < crossings.size() && crossings[i] == crossings[run]) ++i;
      oddProbes += (i - run) % 2;
    }
    if (oddProbes == kProbes) nestings.push_back({crossings[begin].inner, crossings[begin].outer});
  }
  // Two that lie on each other are each inside the other one. Then the one that is wound as a cavity is outside.
  const auto isInOther = [&](const Nesting& n) {
    return std::ranges::any_of(nestings, [&](const Nesting& m) { return m.inner == n.outer && m.outer == n.inner; });
  };
  std::vector<Nesting> kept;
  for (const Nesting& n : nestings) {
    if (topology.componentVolume[n.outer] < 0 || !isInOther(n)) kept.push_back(n);
  }
  return kept;
}

std::vector<std::uint32_t> nestingDepths(const Topology& topology, std::span<const Vec3f> vertices,
                                         std::span<const Triangle> triangles) {
  std::vector<std::uint32_t> depths(topology.componentCount(), 0);
  for (const Nesting& nesting : nestingsOf(topology, vertices, triangles)) ++depths[nesting.inner];
  return depths;
}

std::vector<std::uint8_t> componentsWellWound(const Topology& topology, const std::vector<std::uint32_t>& depths,
                                              std::span<const Vec3f> vertices, std::span<const Triangle> triangles) {
  // The rounding of a component's volume is relative to the sum of the magnitudes of its terms, |area vector|
  // |distance|. That sum is at most 4 r^3 per triangle, which is enough to know for any component of ordinary
  // thickness.
  constexpr double kRelativeRounding = 1e-14;
  const Bounds bounds = boundsOf(vertices, triangles);
  const Vec3d center = bounds.middle();
  const Vec3d corner = bounds.empty() ? Vec3d{0, 0, 0} : relativeTo(bounds.max, center);
  const double radius2 = otgDot(corner, corner);
  const double most = 4 * radius2 * std::sqrt(radius2) * static_cast<double>(triangles.size());
  std::vector<double> magnitude(topology.componentCount(), most);
  const bool anyThin = std::any_of(topology.componentVolume.begin(), topology.componentVolume.end(),
                                   [&](double v) { return std::abs(v) <= kRelativeRounding * most; });
  if (anyThin) {
    std::fill(magnitude.begin(), magnitude.end(), 0.0);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      if (topology.componentOf[t] == kNone) continue;
      const Vec3d a = relativeTo(vertices[triangles[t].v[0]], center);
      const Vec3d b = relativeTo(vertices[triangles[t].v[1]], center);
      const Vec3d c = relativeTo(vertices[triangles[t].v[2]], center);
      const Vec3d n = otgCross(b - a, c - a);
      magnitude[topology.componentOf[t]] += std::sqrt(otgDot(n, n) * otgDot(a, a));
    }
  }
  std::vector<std::uint8_t> well(topology.componentCount(), 0);
  for (std::size_t c = 0; c < well.size(); ++c)
    well[c] = topology.componentClosed[c] &&
              expectedVolumeSign(depths[c]) * topology.componentVolume[c] > kRelativeRounding * magnitude[c];
  return well;
}

}  // namespace otg
