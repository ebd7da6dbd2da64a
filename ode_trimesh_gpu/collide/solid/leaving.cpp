// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/leaving.h"

#include <algorithm>
#include <cmath>

#include "base/insertion_sort.h"
#include "base/vectors.h"
#include "collide/shortest_translation.h"
#include "shared/contacts/solid_model.h"

namespace otg {
namespace {

constexpr double kSameHalfSpace = 1 - 1e-12;

struct Way {
  Vec3d at, normal;
  double depth;
  bool curved;
};

/// A vertex or a stretch with its ways out, the soonest first. The first `together` hold it all at once.
struct Part {
  const SupportPoint* point;
  std::pmr::vector<Way> ways;
  std::size_t together = 1;
};

Part partOfVertex(RegionTriangles& triangles, const SupportPoint& p, std::pmr::memory_resource* memory) {
  Part part{&p, std::pmr::vector<Way>(memory), 0};
  const double side = p.mesh == 0 ? 1.0 : -1.0;
  for (const RegionTriangles::Exit& e : triangles.exitsOf(1 - p.mesh, p.position)) {
    part.ways.push_back({p.position, otgScale(e.normal, side), e.depth, e.curved});
  }
  part.together = part.ways.size();
  if (part.ways.empty()) return part;
  for (const RegionTriangles::StretchExit& e : triangles.facesOver(1 - p.mesh, p.position, p.position)) {
    const Vec3d normal = otgScale(e.exit.normal, side);
    if (std::any_of(part.ways.begin(), part.ways.begin() + static_cast<std::ptrdiff_t>(part.together),
                    [&](const Way& way) { return otgDot(way.normal, normal) > kSameHalfSpace; }))
      continue;
    part.ways.push_back({p.position, otgScale(e.exit.normal, side), e.exit.depth, e.exit.curved});
  }
  insertionSort(part.ways.begin() + static_cast<std::ptrdiff_t>(part.together), part.ways.end(),
                [](const Way& x, const Way& y) { return x.depth < y.depth; });
  return part;
}

Part partOfStretch(const RegionTriangles& triangles, const SupportPoint& p, std::pmr::memory_resource* memory) {
  Part part{&p, std::pmr::vector<Way>(memory), 1};
  const Vec3d half = otgScale(p.along, p.reach), from = otgSub(p.position, half), to = otgAdd(p.position, half);
  const double side = p.mesh == 0 ? 1.0 : -1.0;
  for (const RegionTriangles::StretchExit& e : triangles.facesOver(1 - p.mesh, from, to)) {
    part.ways.push_back({e.byEnd ? to : from, otgScale(e.exit.normal, side), e.exit.depth, e.exit.curved});
  }
  for (const RegionEdge& edge : triangles.edges()) {
    if (edge.mesh == p.mesh) continue;
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
  }
  insertionSort(part.ways.begin(), part.ways.end(), [](const Way& x, const Way& y) { return x.depth < y.depth; });
  return part;
}

}  // namespace

std::pmr::vector<Leave> leavesOf(RegionTriangles& triangles, const OverlapRegions& all,
                                 const std::pmr::vector<std::uint32_t>& points) {
  std::pmr::vector<Part> parts(all.memory);
  for (const std::uint32_t i : points) {
    const SupportPoint& p = all.points[i];
    if (p.kind == PointKind::kCrossing) continue;
    Part part =
        p.kind == PointKind::kVertex ? partOfVertex(triangles, p, all.memory) : partOfStretch(triangles, p, all.memory);
    if (!part.ways.empty() && part.ways.front().depth > 0) parts.push_back(std::move(part));
  }
  std::pmr::vector<const Part*> order(all.memory);
  for (const Part& part : parts) order.push_back(&part);
  std::sort(order.begin(), order.end(), [](const Part* x, const Part* y) {
    const double a = x->ways.front().depth, b = y->ways.front().depth;
    return a != b ? a > b : x < y;
  });
  ShortestTranslation t(all.memory);
  const auto missing = [&](const Way& way) { return way.depth - otgDot(way.normal, t.value()); };
  const auto isOut = [&](const Part& part) {
    const auto first = part.ways.begin(), others = first + static_cast<std::ptrdiff_t>(part.together);
    const auto satisfied = [&](const Way& way) { return t.satisfies(way.normal, way.depth); };
    return std::all_of(first, others, satisfied) || std::any_of(others, part.ways.end(), satisfied);
  };
  for (const Part* part : order) {
    if (isOut(*part)) continue;
    const auto first = part->ways.begin(), others = first + static_cast<std::ptrdiff_t>(part->together);
    double together = 0;
    for (auto way = first; way != others; ++way) together = std::max(together, missing(*way));
    const auto soonest =
        std::min_element(others, part->ways.end(), [&](const Way& x, const Way& y) { return missing(x) < missing(y); });
    if (soonest != part->ways.end() && missing(*soonest) < together) {
      t.add(soonest->normal, soonest->depth);
    } else {
      for (auto way = first; way != others; ++way) t.add(way->normal, way->depth);
    }
  }
  std::pmr::vector<Leave> leaves(all.memory);
  for (const Part& part : parts) {
    const auto take = [&](const Way& way) {
      leaves.push_back({part.point, way.at, way.normal, way.depth, way.curved});
    };
    const auto first = part.ways.begin(), others = first + static_cast<std::ptrdiff_t>(part.together);
    const auto satisfied = [&](const Way& way) { return t.satisfies(way.normal, way.depth); };
    const auto other = std::find_if(others, part.ways.end(), satisfied);
    if (other != part.ways.end() && !std::all_of(first, others, satisfied)) {
      take(*other);
    } else {
      std::for_each(first, others, take);
    }
  }
  return leaves;
}

}  // namespace otg
