// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/touching_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/union_find.h"
#include "base/vectors.h"
#include "shared/tests/triangle_exact.h"

namespace otg {
namespace {

/// A triangle at an edge from a point to a second one.
struct AtEdge {
  std::uint32_t halfEdge;
  Vec3d corner;      ///< the one that is not on the edge
  bool endsWedge;    ///< what is behind the triangle lies at smaller angles about the edge, else at larger ones
  int half = 0;      ///< of the turn from the first triangle: 0 up to half a turn, then 1
  bool at0 = false;  ///< at the beginning of its half
};

/// Puts the triangles at an edge in the order of their angles about it.
class Fan {
 public:
  Fan(const Vec3d& from, const Vec3d& to) : from_(from), to_(to) {}

  /// False if that has no answer: a triangle without area.
  bool sort(std::vector<AtEdge>& all) const {
    const Vec3d& first = all.front().corner;
    for (AtEdge& t : all) {
      const int side = turn(first, t.corner);
      const Vec3d along = otgSub(to_, from_);
      const double alike = otgDot(otgCross(along, otgSub(first, from_)), otgCross(along, otgSub(t.corner, from_)));
      if (side == 0 && alike == 0) return false;
      t.at0 = side == 0;
      t.half = side > 0 || (side == 0 && alike > 0) ? 0 : 1;
    }
    std::stable_sort(all.begin(), all.end(), [&](const AtEdge& x, const AtEdge& y) { return isBefore(x, y); });
    return true;
  }

 private:
  /// Positive if v comes less than half a turn after u.
  int turn(const Vec3d& u, const Vec3d& v) const { return otgHostOrient3(&to_.x, &u.x, &v.x, &from_.x); }

  bool isBefore(const AtEdge& x, const AtEdge& y) const {
    if (x.half != y.half) return x.half < y.half;
    int order = 0;
    if (x.at0 != y.at0) {
      order = x.at0 ? 1 : -1;
    } else if (!x.at0) {
      order = turn(x.corner, y.corner);
    }
    return order > 0;
  }

  Vec3d from_, to_;
};

/// Finds for each half-edge its neighbour.
class Pairing {
 public:
  Pairing(std::span<const Vec3f> vertices, std::span<const Triangle> triangles, const Topology& topology)
      : vertices_(vertices), triangles_(triangles), topology_(topology), twin_(3 * triangles.size(), kNone) {}

  bool run() {
    std::vector<std::uint32_t> uses(topology_.edgeCount(), 0);
    for (std::uint32_t h = 0; h < twin_.size(); ++h) {
      const std::uint32_t edge = topology_.edgeOf[h];
      if (edge == kNone) return false;
      ++uses[edge];
      twin_[h] = topology_.twin[h];
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> touching;  // half-edges by edge
    for (std::uint32_t h = 0; h < twin_.size(); ++h) {
      if (twin_[h] != kNone) continue;
      const std::uint32_t edge = topology_.edgeOf[h];
      if (uses[edge] <= 2) return false;
      touching[edge].push_back(h);
    }
    return !touching.empty() &&
           std::ranges::all_of(touching, [&](const auto& of) { return pair(of.first, of.second); });
  }

  std::vector<std::uint32_t> takeTwins() { return std::move(twin_); }

 private:
  std::uint32_t point(std::uint32_t h) const { return topology_.weld[triangles_[h / 3].v[h % 3]]; }
  Vec3d place(std::uint32_t vertex) const {
    const Vec3f& p = vertices_[vertex];
    return {p.x, p.y, p.z};
  }

  bool pair(std::uint32_t edge, const std::vector<std::uint32_t>& halfEdges) {
    const Topology::Edge& ends = topology_.edges[edge];
    std::vector<AtEdge> all;
    for (const std::uint32_t h : halfEdges) {
      all.push_back({h, place(triangles_[h / 3].v[(h + 2) % 3]), point(h) == ends.a});
    }
    if (all.size() % 2 != 0 || !Fan(place(ends.a), place(ends.b)).sort(all)) return false;
    // What lies on each other, to rounding, may have come in any order. It begins after a gap, if there is one.
    const auto isGap = [&](const AtEdge& x, const AtEdge& y) { return !areOne(ends, x, y); };
    if (!isGap(all.back(), all.front())) {
      const auto gap = std::adjacent_find(all.begin(), all.end(), isGap);
      if (gap != all.end()) std::rotate(all.begin(), gap + 1, all.end());
    }
    std::vector<std::vector<AtEdge>> groups(1);
    for (const AtEdge& t : all) {
      if (!groups.back().empty() && isGap(groups.back().back(), t)) groups.emplace_back();
      groups.back().push_back(t);
    }
    all.clear();
    bool isSolid = isSolidBefore(groups);
    for (const std::vector<AtEdge>& group : groups) {
      if (!addInTurn(group, isSolid, all)) return false;
    }
    if (all.front().endsWedge) std::rotate(all.begin(), all.begin() + 1, all.end());
    for (std::size_t i = 0; i < all.size(); i += 2) {
      twin_[all[i].halfEdge] = all[i + 1].halfEdge;
      twin_[all[i + 1].halfEdge] = all[i].halfEdge;
    }
    return true;
  }

  static std::ptrdiff_t endsIn(const std::vector<AtEdge>& group) {
    return std::count_if(group.begin(), group.end(), [](const AtEdge& t) { return t.endsWedge; });
  }

  /// Whether the first of the groups of triangles that lie on each other lies in or at the end of a solid wedge. If as
  /// many wedges begin as end in every group, it does: all blocks at the edge are flush.
  static bool isSolidBefore(const std::vector<std::vector<AtEdge>>& groups) {
    for (const std::vector<AtEdge>& group : groups) {
      const std::ptrdiff_t ends = endsIn(group), begins = std::ssize(group) - ends;
      if (ends != begins) return ends > begins;
    }
    return true;
  }

  /// Adds a group so that wedges end and begin in turn. `isSolid`: before the group, and then after it. False if it
  /// has too many of one kind.
  static bool addInTurn(const std::vector<AtEdge>& group, bool& isSolid, std::vector<AtEdge>& all) {
    const std::ptrdiff_t more = 2 * endsIn(group) - std::ssize(group);  // ends than begins
    if (more != 0 && more != (isSolid ? 1 : -1)) return false;
    auto end = group.begin(), begin = group.begin();
    for (std::size_t i = 0; i < group.size(); ++i) {
      auto& next = isSolid ? end : begin;
      next = std::find_if(next, group.end(), [&](const AtEdge& t) { return t.endsWedge == isSolid; });
      all.push_back(*next++);
      isSolid = !isSolid;
    }
    return true;
  }

  /// Whether the outer corner of one lies in the other's plane, but for the rounding of coordinates.
  bool areOne(const Topology::Edge& ends, const AtEdge& x, const AtEdge& y) const {
    const Vec3d from = place(ends.a), along = otgSub(place(ends.b), from);
    const Vec3d u = otgSub(x.corner, from), v = otgSub(y.corner, from);
    const Vec3d m = otgCross(along, u), n = otgCross(along, v);
    double most = 0;
    for (const Vec3d& p : {from, place(ends.b), x.corner, y.corner}) {
      most = std::max({most, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    }
    const double slack = kUnits * std::numeric_limits<float>::epsilon() * most;
    // Of two the narrower one's plane is the less certain.
    return otgDot(m, n) > 0 &&
           (std::fabs(otgDot(m, v)) <= slack * norm(m) || std::fabs(otgDot(n, u)) <= slack * norm(n));
  }

  static constexpr double kUnits = 4;  ///< in the last place
  const std::span<const Vec3f> vertices_;
  const std::span<const Triangle> triangles_;
  const Topology& topology_;
  std::vector<std::uint32_t> twin_;
};

std::uint32_t nextInTriangle(std::uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}

}  // namespace

std::optional<SeparateSurfaces> separateSurfaces(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                                 const Topology& topology) {
  Pairing pairing(vertices, triangles, topology);
  if (!pairing.run()) return {};
  SeparateSurfaces out;
  out.twin = pairing.takeTwins();
  UnionFind points(3 * triangles.size());  // of corners; a half-edge begins at the corner with its number
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) points.unite(h, nextInTriangle(out.twin[h]));
  out.triangles.assign(triangles.begin(), triangles.end());
  out.vertexOf.resize(vertices.size());
  for (std::uint32_t v = 0; v < vertices.size(); ++v) out.vertexOf[v] = v;
  out.weld = out.vertexOf;
  std::vector<std::uint32_t> owner(vertices.size(), kNone);                 // the point that has a given vertex
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;  // by point and given vertex
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    const std::uint32_t point = points.find(h), given = triangles[h / 3].v[h % 3];
    if (owner[given] == kNone) owner[given] = point;
    std::uint32_t own = given;
    if (owner[given] != point) {
      const auto [copy, isNew] = copies.try_emplace({point, given}, static_cast<std::uint32_t>(out.vertexOf.size()));
      own = copy->second;
      if (isNew) {
        out.vertexOf.push_back(given);
        out.weld.push_back(own);
      }
    }
    out.triangles[h / 3].v[h % 3] = own;
  }
  std::vector<std::uint32_t> least(3 * triangles.size(), kNone);  // of the vertices at a point
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    std::uint32_t& of = least[points.find(h)];
    of = std::min(of, out.triangles[h / 3].v[h % 3]);
  }
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h) {
    out.weld[out.triangles[h / 3].v[h % 3]] = least[points.find(h)];
  }
  return out;
}

}  // namespace otg
