// SPDX-License-Identifier: BSD-3-Clause
#include "truth/overlap_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace otg::truth {
namespace {

using Real = long double;

/// Heights that differ by less than this part of their terms, some dozen roundings, are equal.
constexpr Real kOnePlane = 1e-18L;

struct Point {
  Real x, y, z;
};

Real component(const Point& p, int k) {
  return k == 0 ? p.x : k == 1 ? p.y : p.z;
}

/// A triangle by its projection, counter-clockwise, and the plane of its heights: z = z0 + gx (x - x0) + gy (y - y0).
struct Sheet {
  std::array<Point, 3> corner;
  Real gx, gy;
  Real loX, hiX, loY, hiY;
  int sign;  ///< +1 where the triangle faces upward
  Real height(Real x, Real y) const { return corner[0].z + gx * (x - corner[0].x) + gy * (y - corner[0].y); }
  /// What its rounding error is a part of.
  Real heightTerms(Real x, Real y) const {
    return std::fabs(corner[0].z) + std::fabs(gx * (x - corner[0].x)) + std::fabs(gy * (y - corner[0].y));
  }
};

struct Box {
  Real lo[3], hi[3];
};

Box boundsOf(const std::vector<Point>& points) {
  const Real inf = std::numeric_limits<Real>::infinity();
  Box box{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (const Point& p : points) {
    for (int k = 0; k < 3; ++k) {
      box.lo[k] = std::min(box.lo[k], component(p, k));
      box.hi[k] = std::max(box.hi[k], component(p, k));
    }
  }
  return box;
}

/// Axes permuted so that the heights run along the longest side of the common box: the projections overlap least then.
struct View {
  int axis[3];
  Point origin;  ///< in unpermuted coordinates; numbers stay small around it
  Real loX, hiX, loY, hiY;
  Point of(const Point& p) const {
    const Point q{p.x - origin.x, p.y - origin.y, p.z - origin.z};
    return {component(q, axis[0]), component(q, axis[1]), component(q, axis[2])};
  }
};

std::vector<Sheet> sheetsOf(const TriMesh& mesh, const std::vector<Point>& points, const View& view) {
  std::vector<Sheet> sheets;
  for (const Triangle& t : mesh.triangles()) {
    Sheet s;
    for (std::size_t k = 0; k < 3; ++k) s.corner[k] = view.of(points[t.v[k]]);
    const auto [lowX, highX] = std::minmax({s.corner[0].x, s.corner[1].x, s.corner[2].x});
    const auto [lowY, highY] = std::minmax({s.corner[0].y, s.corner[1].y, s.corner[2].y});
    s.loX = lowX, s.hiX = highX, s.loY = lowY, s.hiY = highY;
    if (s.hiX <= view.loX || s.loX >= view.hiX || s.hiY <= view.loY || s.loY >= view.hiY) continue;
    const auto& c = s.corner;
    const Real ux = c[1].x - c[0].x, uy = c[1].y - c[0].y, uz = c[1].z - c[0].z;
    const Real vx = c[2].x - c[0].x, vy = c[2].y - c[0].y, vz = c[2].z - c[0].z;
    const Real twice = ux * vy - uy * vx;
    if (twice == 0) continue;  // upright: nothing lies below it
    s.gx = (uz * vy - uy * vz) / twice;
    s.gy = (ux * vz - uz * vx) / twice;
    s.sign = twice > 0 ? 1 : -1;
    if (s.sign < 0) std::swap(s.corner[1], s.corner[2]);
    sheets.push_back(s);
  }
  return sheets;
}

struct Polygon {
  struct Corner {
    Real x, y;
  };
  std::array<Corner, 12> corner;
  int count = 0;
  void add(Real x, Real y) { corner[static_cast<std::size_t>(count++)] = {x, y}; }
};

/// Keeps the part where side(corner) >= 0; `side` is linear.
template <class Side>
Polygon clip(const Polygon& in, const Side& side) {
  Polygon out;
  for (int i = 0; i < in.count; ++i) {
    const auto &p = in.corner[static_cast<std::size_t>(i)],
               &q = in.corner[static_cast<std::size_t>((i + 1) % in.count)];
    const Real sp = side(p), sq = side(q);
    if (sp >= 0) out.add(p.x, p.y);
    if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) {
      const Real t = sp / (sp - sq);
      out.add(p.x + t * (q.x - p.x), p.y + t * (q.y - p.y));
    }
  }
  return out;
}

/// Integrals of z below a sheet over a polygon: 1, x, y, z.
struct Sums {
  Real volume = 0, x = 0, y = 0, z = 0;
};

void integrate(const Polygon& polygon, const Sheet& sheet, int sign, bool moments, Sums& sums) {
  for (int i = 2; i < polygon.count; ++i) {
    const auto &a = polygon.corner[0], &b = polygon.corner[static_cast<std::size_t>(i - 1)],
               &c = polygon.corner[static_cast<std::size_t>(i)];
    const Real area = sign * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    if (!moments) {
      sums.volume += area * sheet.height((a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3);
      continue;
    }
    // The middles of the sides are exact for polynomials of second degree.
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      const Real x = (p.x + q.x) / 2, y = (p.y + q.y) / 2, z = sheet.height(x, y);
      sums.volume += area / 3 * z;
      sums.x += area / 3 * x * z;
      sums.y += area / 3 * y * z;
      sums.z += area / 3 * z * z / 2;
    }
  }
}

void addPair(const Sheet& a, const Sheet& b, bool moments, Sums& sums) {
  Polygon common;
  for (const Point& p : a.corner) common.add(p.x, p.y);
  for (std::size_t k = 0; k < 3 && common.count > 0; ++k) {
    const Point &p = b.corner[k], &q = b.corner[(k + 1) % 3];
    common =
        clip(common, [&](const Polygon::Corner& c) { return (q.x - p.x) * (c.y - p.y) - (q.y - p.y) * (c.x - p.x); });
  }
  if (common.count < 3) return;
  const int sign = a.sign * b.sign;
  const auto aAboveB = [&](const Polygon::Corner& c) { return a.height(c.x, c.y) - b.height(c.x, c.y); };
  // Where both lie in one plane, rounding has no two corners agree on which is the higher: either is right.
  const bool onePlane =
      std::all_of(common.corner.begin(), common.corner.begin() + common.count, [&](const Polygon::Corner& c) {
        return std::fabs(aAboveB(c)) <= kOnePlane * (a.heightTerms(c.x, c.y) + b.heightTerms(c.x, c.y));
      });
  if (onePlane) {
    integrate(common, a, sign, moments, sums);
    return;
  }
  integrate(clip(common, [&](const Polygon::Corner& c) { return -aAboveB(c); }), a, sign, moments, sums);
  integrate(clip(common, aAboveB), b, sign, moments, sums);
}

/// A's sheets by the cells of a square grid that they touch.
class Grid {
 public:
  Grid(const std::vector<Sheet>& sheets, const View& view) : view_(view) {
    count_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(sheets.size()) / 2)), 1, 256);
    cells_.resize(static_cast<std::size_t>(count_) * static_cast<std::size_t>(count_));
    for (std::uint32_t i = 0; i < sheets.size(); ++i) {
      forEachCell(sheets[i], [&](std::vector<std::uint32_t>& cell) { cell.push_back(i); });
    }
    seen_.assign(sheets.size(), 0);
  }
  template <class Visit>
  void near(const Sheet& sheet, const Visit& visit) {
    ++stamp_;
    forEachCell(sheet, [&](const std::vector<std::uint32_t>& cell) {
      for (const std::uint32_t i : cell) {
        if (seen_[i] == stamp_) continue;
        seen_[i] = stamp_;
        visit(i);
      }
    });
  }

 private:
  int cellAt(Real x, Real lo, Real hi) const {
    return std::clamp(static_cast<int>((x - lo) / (hi - lo) * static_cast<Real>(count_)), 0, count_ - 1);
  }
  template <class Visit>
  void forEachCell(const Sheet& s, const Visit& visit) {
    const int x0 = cellAt(std::max(s.loX, view_.loX), view_.loX, view_.hiX);
    const int x1 = cellAt(std::min(s.hiX, view_.hiX), view_.loX, view_.hiX);
    const int y0 = cellAt(std::max(s.loY, view_.loY), view_.loY, view_.hiY);
    const int y1 = cellAt(std::min(s.hiY, view_.hiY), view_.loY, view_.hiY);
    for (int y = y0; y <= y1; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(count_);
      for (int x = x0; x <= x1; ++x) visit(cells_[row + static_cast<std::size_t>(x)]);
    }
  }

  const View& view_;
  int count_;
  std::vector<std::vector<std::uint32_t>> cells_;
  std::vector<std::uint64_t> seen_;
  std::uint64_t stamp_ = 0;
};

/// Sums in the coordinates of the view; `axisOfView` receives it for the way back.
Sums sumsOf(const TriMesh& a, const std::vector<Point>& pointsA, const TriMesh& b, const std::vector<Point>& pointsB,
            bool moments, View& view) {
  const Box boxA = boundsOf(pointsA), boxB = boundsOf(pointsB);
  Real lo[3], hi[3];
  for (int k = 0; k < 3; ++k) {
    lo[k] = std::max(boxA.lo[k], boxB.lo[k]);
    hi[k] = std::min(boxA.hi[k], boxB.hi[k]);
    if (!(lo[k] < hi[k])) return {};
  }
  int up = 0;
  for (int k = 1; k < 3; ++k) {
    if (hi[k] - lo[k] > hi[up] - lo[up]) up = k;
  }
  view.axis[0] = (up + 1) % 3;
  view.axis[1] = (up + 2) % 3;
  view.axis[2] = up;
  view.origin = {(lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2};
  view.hiX = (hi[view.axis[0]] - lo[view.axis[0]]) / 2;
  view.hiY = (hi[view.axis[1]] - lo[view.axis[1]]) / 2;
  view.loX = -view.hiX;
  view.loY = -view.hiY;
  const std::vector<Sheet> sheetsA = sheetsOf(a, pointsA, view), sheetsB = sheetsOf(b, pointsB, view);
  Grid grid(sheetsA, view);
  Sums sums;
  for (const Sheet& s : sheetsB) {
    grid.near(s, [&](std::uint32_t i) {
      const Sheet& t = sheetsA[i];
      if (t.hiX <= s.loX || t.loX >= s.hiX || t.hiY <= s.loY || t.loY >= s.hiY) return;
      addPair(t, s, moments, sums);
    });
  }
  return sums;
}

std::vector<Point> pointsOf(const TriMesh& mesh, const Transformd* pose) {
  std::vector<Point> points;
  for (const Vec3f& v : mesh.vertices()) {
    Vec3d p{v.x, v.y, v.z};
    if (pose) p = otgTransform(*pose, p);
    points.push_back({p.x, p.y, p.z});
  }
  return points;
}

Overlap overlapOf(const Sums& sums, const View& view) {
  Overlap overlap;
  overlap.volume = static_cast<double>(sums.volume);
  if (!(sums.volume > 0)) return overlap;
  const Real c[3] = {sums.x / sums.volume, sums.y / sums.volume, sums.z / sums.volume};
  Real p[3] = {view.origin.x, view.origin.y, view.origin.z};
  for (int k = 0; k < 3; ++k) p[view.axis[k]] += c[k];
  overlap.centroid = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
  return overlap;
}

}  // namespace

Overlap overlapOf(const TriMesh& a, const TriMesh& b, const Transformd& bInA) {
  View view{};
  const Sums sums = sumsOf(a, pointsOf(a, nullptr), b, pointsOf(b, &bInA), true, view);
  return overlapOf(sums, view);
}

VolumeGradient volumeGradient(const TriMesh& a, const TriMesh& b, const Transformd& bInA, double step) {
  const std::vector<Point> pointsA = pointsOf(a, nullptr), pointsB = pointsOf(b, &bInA);
  View view{};
  VolumeGradient gradient;
  gradient.overlap = overlapOf(sumsOf(a, pointsA, b, pointsB, true, view), view);
  const Real radius = std::min(a.radius(), b.radius()), h = static_cast<Real>(step) * radius;
  const Vec3d& c = gradient.overlap.centroid;
  const auto volumeOf = [&](const auto& move) {
    std::vector<Point> moved = pointsA;
    for (Point& p : moved) move(p);
    View ignored{};
    return sumsOf(a, moved, b, pointsB, false, ignored).volume;
  };
  double push[3], moment[3];
  for (int k = 0; k < 3; ++k) {
    Real ahead[2], turned[2];
    for (int side = 0; side < 2; ++side) {
      const Real d = side == 0 ? h : -h;
      ahead[side] = volumeOf([&](Point& p) { (k == 0 ? p.x : k == 1 ? p.y : p.z) += d; });
      const Real angle = d / radius, cosine = std::cos(angle), sine = std::sin(angle);
      turned[side] = volumeOf([&](Point& p) {
        Real q[3] = {p.x - static_cast<Real>(c.x), p.y - static_cast<Real>(c.y), p.z - static_cast<Real>(c.z)};
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const Real u = cosine * q[i] - sine * q[j], v = sine * q[i] + cosine * q[j];
        q[i] = u;
        q[j] = v;
        p = {static_cast<Real>(c.x) + q[0], static_cast<Real>(c.y) + q[1], static_cast<Real>(c.z) + q[2]};
      });
    }
    push[k] = static_cast<double>((ahead[1] - ahead[0]) / (2 * h));
    moment[k] = static_cast<double>((turned[1] - turned[0]) / (2 * h / radius));
  }
  gradient.push = {push[0], push[1], push[2]};
  gradient.moment = {moment[0], moment[1], moment[2]};
  return gradient;
}

}  // namespace otg::truth
