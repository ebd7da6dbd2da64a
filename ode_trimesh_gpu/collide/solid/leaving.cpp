// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/leaving.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/vectors.h"
#include "collide/shortest_translation.h"
#include "shared/contacts/uneven_model.h"

namespace otg {
namespace {

constexpr std::size_t kEdgesPassed = 8;  ///< by most stretches at most

struct Way {
  Vec3d at, normal;
  double depth;
  std::uint32_t face;  ///< RegionTriangles::Exit::face; kNone across an edge
};

/// A vertex or a stretch with its ways out. The first `together` hold it all at once; each other one holds it by
/// itself. Most parts never need the others, and few need more than those by which they are out.
struct Part {
  const SupportPoint* point;
  std::pmr::vector<Way> ways;
  std::size_t together = 1;
  double soonest = 0;                ///< depth of the way that is tried first
  Moved lookedFor{{0, 0, 0}, -1.0};  ///< others have been looked for of which no more is missing after that move

  std::span<const Way> all() const { return std::span(ways).first(together); }
};

/// Finds the ways of a region's parts.
class WaysOut {
 public:
  WaysOut(RegionTriangles& triangles, std::pmr::memory_resource* memory) : triangles_(triangles), memory_(memory) {}

  Part soonest(const SupportPoint& p) const {
    return p.kind == PointKind::kVertex ? soonestOfVertex(p) : soonestOfStretch(p);
  }

  /// The others of which no more than `missing` is missing when A has been moved by t, and few more.
  std::span<const Way> others(Part& part, const Vec3d& t, double missing) const {
    const SupportPoint& p = *part.point;
    const Moved moved{otgScale(t, side(p)), missing};
    if (!isCovered(moved, part.lookedFor)) {
      part.ways.resize(part.together);
      addOthers(part, p.kind == PointKind::kVertex ? allOfVertex(p, moved) : allOfStretch(p, moved));
      part.lookedFor = moved;
    }
    return std::span(part.ways).subspan(part.together);
  }

  bool isCurved(const SupportPoint& p, const Way& way) const {
    return way.face != kNone && triangles_.isCurved(1 - p.mesh, way.face);
  }

 private:
  struct Ends {
    Vec3d from, to;
  };
  static Ends endsOf(const SupportPoint& p) {
    const Vec3d half = otgScale(p.along, p.reach);
    return {otgSub(p.position, half), otgAdd(p.position, half)};
  }
  static bool isCovered(const Moved& moved, const Moved& by) {
    return moved.missing <= by.missing && moved.by.x == by.by.x && moved.by.y == by.by.y && moved.by.z == by.by.z;
  }
  static double side(const SupportPoint& p) { return p.mesh == 0 ? 1.0 : -1.0; }
  static bool isSooner(const Way& x, const Way& y) { return x.depth < y.depth; }
  static Way wayOf(const SupportPoint& p, const Ends& ends, const RegionTriangles::StretchExit& e) {
    return {e.byEnd ? ends.to : ends.from, otgScale(e.exit.normal, side(p)), e.exit.depth, e.exit.face};
  }

  Part soonestOfVertex(const SupportPoint& p) const {
    Part part{&p, std::pmr::vector<Way>(memory_), 0};
    for (const RegionTriangles::Exit& e : triangles_.exitsOf(1 - p.mesh, p.position)) {
      part.ways.push_back({p.position, otgScale(e.normal, side(p)), e.depth, e.face});
    }
    part.together = part.ways.size();
    if (!part.ways.empty()) part.soonest = part.ways.front().depth;
    return part;
  }

  std::pmr::vector<Way> allOfVertex(const SupportPoint& p, const Moved& moved) const {
    std::pmr::vector<Way> ways(memory_);
    const Ends ends{p.position, p.position};
    const auto& faces = triangles_.facesOver(1 - p.mesh, p.position, p.position, moved);
    ways.reserve(faces.size());
    for (const RegionTriangles::StretchExit& e : faces) ways.push_back(wayOf(p, ends, e));
    return ways;
  }

  /// Those that are no half-space of the first ones.
  static void addOthers(Part& part, const std::pmr::vector<Way>& others) {
    part.ways.reserve(part.ways.size() + others.size());
    for (const Way& other : others) {
      const bool isKnown = std::ranges::any_of(
          part.all(), [&](const Way& way) { return otgDot(way.normal, other.normal) > OTG_UNEVEN_SAME_NORMAL; });
      if (!isKnown) part.ways.push_back(other);
    }
  }

  Part soonestOfStretch(const SupportPoint& p) const {
    Part part{&p, std::pmr::vector<Way>(memory_), 1};
    const Ends ends = endsOf(p);
    Way soonest = wayOf(p, ends, triangles_.soonestOver(1 - p.mesh, ends.from, ends.to));
    forEachEdgePassed(p, {{0, 0, 0}, soonest.depth}, [&](const Way& way) {
      if (isSooner(way, soonest)) soonest = way;
    });
    if (std::isfinite(soonest.depth)) {
      part.ways.push_back(soonest);
      part.soonest = soonest.depth;
    }
    leaveByMiddle(part);
    return part;
  }

  /// A stretch deep in a narrow inner corner lies over neither of its walls. The way found may lead far past the
  /// surface at its middle. Then it leaves by the faces there, all at once, if each of these ways is shorter.
  void leaveByMiddle(Part& part) const {
    const SupportPoint& p = *part.point;
    const double soonest = part.ways.empty() ? std::numeric_limits<double>::infinity() : part.soonest;
    const auto& exits = triangles_.exitsOf(1 - p.mesh, p.position, soonest / OTG_SOLID_NEIGHBOURHOOD);
    if (exits.empty()) return;
    const Ends ends = endsOf(p);
    std::pmr::vector<Way> ways(memory_);
    double deepest = 0;
    for (const RegionTriangles::Exit& e : exits) {
      const double first = e.offset - otgDot(e.normal, ends.from), last = e.offset - otgDot(e.normal, ends.to);
      ways.push_back(wayOf(p, ends, {{e.normal, e.offset, otgDeeperEnd(first, last), e.face}, last > first}));
      deepest = std::max(deepest, ways.back().depth);
    }
    if (!(deepest < soonest)) return;
    part.together = ways.size();
    part.soonest = ways.front().depth;
    part.ways = std::move(ways);
  }

  std::pmr::vector<Way> allOfStretch(const SupportPoint& p, const Moved& moved) const {
    std::pmr::vector<Way> ways(memory_);
    const Ends ends = endsOf(p);
    const auto& faces = triangles_.facesOver(1 - p.mesh, ends.from, ends.to, moved);
    ways.reserve(faces.size() + kEdgesPassed);
    for (const RegionTriangles::StretchExit& e : faces) ways.push_back(wayOf(p, ends, e));
    forEachEdgePassed(p, moved, [&](const Way& way) { ways.push_back(way); });
    return ways;
  }

  template <class Visit>
  void forEachEdgePassed(const SupportPoint& p, const Moved& moved, Visit visit) const {
    triangles_.forEachEdgePassed(1 - p.mesh, p.position, p.along, p.reach, moved, [&](const RegionEdge& edge) {
      const Vec3d across = unit(otgCross(p.along, edge.along));
      for (const double sign : {-1.0, 1.0}) {
        const Vec3d out = otgScale(across, sign);  // of the other mesh
        if (!otgIsBetween(edge.faces[0], edge.faces[1], out)) continue;
        const StretchPass<double> pass =
            otgPassOfStretches(otgSub(edge.middle, p.position), p.along, p.reach, edge.along, edge.reach, out);
        if (!(pass.way > 0)) continue;
        visit(Way{otgAdd(p.position, otgScale(p.along, pass.at)), otgScale(out, side(p)), pass.way, kNone});
      }
    });
  }

  RegionTriangles& triangles_;
  std::pmr::memory_resource* memory_;
};

}  // namespace

std::pmr::vector<Leave> leavesOf(RegionTriangles& triangles, const OverlapRegions& all,
                                 const std::pmr::vector<std::uint32_t>& points) {
  const WaysOut waysOut(triangles, all.memory);
  std::pmr::vector<Part> parts(all.memory);
  parts.reserve(points.size());
  for (const std::uint32_t i : points) {
    const SupportPoint& p = all.points[i];
    // A stretch no longer than what counts as on the surface is held by its ends.
    if (p.kind == PointKind::kCrossing || (p.kind != PointKind::kVertex && p.reach <= triangles.behind())) continue;
    Part part = waysOut.soonest(p);
    if (part.soonest > 0) parts.push_back(std::move(part));
  }
  std::pmr::vector<Part*> order(all.memory);
  for (Part& part : parts) order.push_back(&part);
  std::sort(order.begin(), order.end(),
            [](const Part* x, const Part* y) { return x->soonest != y->soonest ? x->soonest > y->soonest : x < y; });
  const double longest = order.empty() ? 0 : OTG_UNEVEN_LONGEST * order.front()->soonest;
  ShortestTranslation t(all.memory);
  const auto missing = [&](const Way& way) { return way.depth - otgDot(way.normal, t.value()); };
  const auto satisfied = [&](const Way& way) { return t.satisfies(way.normal, way.depth); };
  const auto holdAll = [&](const Part& part) { return std::ranges::all_of(part.all(), satisfied); };
  for (Part* part : order) {
    if (holdAll(*part)) continue;
    if (std::ranges::any_of(waysOut.others(*part, t.value(), 0), satisfied)) continue;
    double together = 0;
    for (const Way& way : part->all()) together = std::max(together, missing(way));
    const std::span<const Way> others = waysOut.others(*part, t.value(), together);
    const auto soonest = std::ranges::min_element(others, [&](const Way& x, const Way& y) {
      const double a = missing(x), b = missing(y);
      return a != b ? a < b : x.depth < y.depth;
    });
    const bool isOther =
        soonest != others.end() && missing(*soonest) < together && t.add(soonest->normal, soonest->depth, longest);
    if (isOther) continue;
    for (const Way& way : part->all()) t.add(way.normal, way.depth, longest);
  }
  std::pmr::vector<Leave> leaves(all.memory);
  for (Part& part : parts) {
    const auto take = [&](const Way& way) {
      leaves.push_back({part.point, way.at, way.normal, way.depth, waysOut.isCurved(*part.point, way)});
    };
    const Way* other = nullptr;
    if (!holdAll(part)) {
      for (const Way& way : waysOut.others(part, t.value(), 0)) {
        if ((other == nullptr || way.depth < other->depth) && satisfied(way)) other = &way;
      }
    }
    if (other != nullptr) {
      take(*other);
    } else {
      std::ranges::for_each(part.all(), take);
    }
  }
  return leaves;
}

}  // namespace otg
