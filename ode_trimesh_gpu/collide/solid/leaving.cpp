// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/leaving.h"

#include <algorithm>
#include <cmath>
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
  bool curved;
};

/// A vertex or a stretch with its ways out. The first `together` hold it all at once; each other one holds it by
/// itself.
struct Part {
  const SupportPoint* point;
  std::pmr::vector<Way> ways;
  std::size_t together = 1;
  double soonest = 0;  ///< depth of the way that is tried first

  std::span<const Way> all() const { return std::span(ways).first(together); }
  std::span<const Way> others() const { return std::span(ways).subspan(together); }
};

Part partOfVertex(RegionTriangles& triangles, const SupportPoint& p, std::pmr::memory_resource* memory) {
  Part part{&p, std::pmr::vector<Way>(memory), 0};
  const double side = p.mesh == 0 ? 1.0 : -1.0;
  for (const RegionTriangles::Exit& e : triangles.exitsOf(1 - p.mesh, p.position)) {
    part.ways.push_back({p.position, otgScale(e.normal, side), e.depth, e.curved});
  }
  part.together = part.ways.size();
  if (part.ways.empty()) return part;
  const auto& faces = triangles.facesOver(1 - p.mesh, p.position, p.position);
  part.ways.reserve(part.ways.size() + faces.size());
  for (const RegionTriangles::StretchExit& e : faces) {
    const Vec3d normal = otgScale(e.exit.normal, side);
    if (std::any_of(part.ways.begin(), part.ways.begin() + static_cast<std::ptrdiff_t>(part.together),
                    [&](const Way& way) { return otgDot(way.normal, normal) > OTG_UNEVEN_SAME_NORMAL; }))
      continue;
    part.ways.push_back({p.position, otgScale(e.exit.normal, side), e.exit.depth, e.exit.curved});
  }
  part.soonest = part.ways.front().depth;
  return part;
}

Part partOfStretch(RegionTriangles& triangles, const SupportPoint& p, std::pmr::memory_resource* memory) {
  Part part{&p, std::pmr::vector<Way>(memory), 1};
  const Vec3d half = otgScale(p.along, p.reach), from = otgSub(p.position, half), to = otgAdd(p.position, half);
  const double side = p.mesh == 0 ? 1.0 : -1.0;
  const auto& faces = triangles.facesOver(1 - p.mesh, from, to);
  part.ways.reserve(faces.size() + kEdgesPassed);
  for (const RegionTriangles::StretchExit& e : faces) {
    part.ways.push_back({e.byEnd ? to : from, otgScale(e.exit.normal, side), e.exit.depth, e.exit.curved});
  }
  triangles.forEachEdgePassed(1 - p.mesh, p.position, p.along, p.reach, [&](const RegionEdge& edge) {
    const Vec3d across = unit(otgCross(p.along, edge.along));
    for (const double sign : {-1.0, 1.0}) {
      const Vec3d out = otgScale(across, sign);  // of the other mesh
      if (!otgIsBetween(edge.faces[0], edge.faces[1], out)) continue;
      const StretchPass<double> pass =
          otgPassOfStretches(otgSub(edge.middle, p.position), p.along, p.reach, edge.along, edge.reach, out);
      if (pass.way > 0) {
        part.ways.push_back({otgAdd(p.position, otgScale(p.along, pass.at)), otgScale(out, side), pass.way, false});
      }
    }
  });
  const auto soonest = std::min_element(part.ways.begin(), part.ways.end(),
                                        [](const Way& x, const Way& y) { return x.depth < y.depth; });
  if (soonest == part.ways.end()) return part;
  std::rotate(part.ways.begin(), soonest, soonest + 1);
  part.soonest = part.ways.front().depth;
  return part;
}

}  // namespace

std::pmr::vector<Leave> leavesOf(RegionTriangles& triangles, const OverlapRegions& all,
                                 const std::pmr::vector<std::uint32_t>& points) {
  std::pmr::vector<Part> parts(all.memory);
  parts.reserve(points.size());
  for (const std::uint32_t i : points) {
    const SupportPoint& p = all.points[i];
    if (p.kind == PointKind::kCrossing) continue;
    Part part =
        p.kind == PointKind::kVertex ? partOfVertex(triangles, p, all.memory) : partOfStretch(triangles, p, all.memory);
    if (part.soonest > 0) parts.push_back(std::move(part));
  }
  std::pmr::vector<const Part*> order(all.memory);
  for (const Part& part : parts) order.push_back(&part);
  std::sort(order.begin(), order.end(),
            [](const Part* x, const Part* y) { return x->soonest != y->soonest ? x->soonest > y->soonest : x < y; });
  ShortestTranslation t(all.memory);
  const auto missing = [&](const Way& way) { return way.depth - otgDot(way.normal, t.value()); };
  const auto satisfied = [&](const Way& way) { return t.satisfies(way.normal, way.depth); };
  const auto holdAll = [&](const Part& part) { return std::ranges::all_of(part.all(), satisfied); };
  for (const Part* part : order) {
    if (holdAll(*part) || std::ranges::any_of(part->others(), satisfied)) continue;
    double together = 0;
    for (const Way& way : part->all()) together = std::max(together, missing(way));
    const auto soonest = std::ranges::min_element(part->others(), [&](const Way& x, const Way& y) {
      const double a = missing(x), b = missing(y);
      return a != b ? a < b : x.depth < y.depth;
    });
    if (soonest != part->others().end() && missing(*soonest) < together) {
      t.add(soonest->normal, soonest->depth);
    } else {
      for (const Way& way : part->all()) t.add(way.normal, way.depth);
    }
  }
  std::pmr::vector<Leave> leaves(all.memory);
  for (const Part& part : parts) {
    const auto take = [&](const Way& way) {
      leaves.push_back({part.point, way.at, way.normal, way.depth, way.curved});
    };
    const Way* other = nullptr;
    if (!holdAll(part)) {
      for (const Way& way : part.others()) {
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
