// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/deepest_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/vectors.h"

namespace otg {
namespace {

/// An edge's part inside, and how far in it reaches along the normal. `way` and `at` are not set.
struct Stretch {
  EdgePass pass;
  double height;
};

/// Those of one mesh in a region: the stretches whose middles are points, those of flat edges from each of their
/// crossings, and edges between vertices inside. In the order of the points; those of a vertex lead to vertices behind
/// it, in their order.
class Stretches {
 public:
  Stretches(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region, std::uint8_t mesh,
            const Vec3d& normal)
      : adjacency_(meshes.adjacency(mesh)),
        normal_(mesh == 0 ? otgScale(normal, -1.0) : normal),
        list_(all.memory),
        ends_(all.memory) {
    const auto first = all.points.data() + region.pointBegin, last = all.points.data() + region.pointEnd;
    const auto isVertexOf = [](const SupportPoint& p, int m) { return p.kind == PointKind::kVertex && p.mesh <= m; };
    const auto begin =
        std::partition_point(first, last, [&](const SupportPoint& p) { return isVertexOf(p, mesh - 1); });
    vertexEnd_ = std::partition_point(begin, last, [&](const SupportPoint& p) { return isVertexOf(p, mesh); });
    for (const SupportPoint* p = begin; p != last; ++p) {
      if (p->mesh != mesh || (p->kind == PointKind::kCrossing && !p->flat)) continue;
      if (p->kind == PointKind::kVertex) {
        addEdges(p);
      } else if (p->kind == PointKind::kCrossing) {
        const double half = 0.5 * p->reach;
        addStretch(
            {nullptr, p->feature, p->ordinal / 2, otgAdd(p->position, otgScale(p->along, half)), p->along, half});
      } else {
        addStretch({p, p->feature, p->ordinal, p->position, p->along, p->reach});
      }
    }
  }

  const std::pmr::vector<Stretch>& list() const { return list_; }
  double highest() const { return highest_; }

 private:
  void add(const EdgePass& pass, double height) {
    list_.push_back({pass, height});
    highest_ = std::max(highest_, height);
  }
  void addStretch(const EdgePass& pass) {
    add(pass, otgDot(pass.middle, normal_) + std::fabs(otgDot(pass.along, normal_)) * pass.reach);
  }

  /// Of the edges from a vertex to those behind it.
  void addEdges(const SupportPoint* from) {
    ends_.clear();
    for (std::uint32_t k = adjacency_.first[from->feature]; k < adjacency_.first[from->feature + 1]; ++k) {
      const AdjacencyLinks::Spoke& spoke = adjacency_.spokes[k];
      if (spoke.vertex <= from->feature) continue;
      const SupportPoint* const to =
          std::partition_point(from, vertexEnd_, [&](const SupportPoint& p) { return p.feature < spoke.vertex; });
      if (to == vertexEnd_ || to->feature != spoke.vertex) continue;
      const auto isTo = [to](const std::pair<const SupportPoint*, std::uint32_t>& end) { return end.first == to; };
      if (std::none_of(ends_.begin(), ends_.end(), isTo)) ends_.emplace_back(to, spoke.edge);
    }
    std::sort(ends_.begin(), ends_.end());
    const double height = otgDot(from->position, normal_);
    for (const auto& [to, edge] : ends_) {
      const Vec3d ends = otgSub(to->position, from->position);
      add({nullptr, edge, 0, otgScale(otgAdd(from->position, to->position), 0.5), unit(ends), 0.5 * norm(ends)},
          std::max(height, otgDot(to->position, normal_)));
    }
  }

  const Adjacency& adjacency_;
  const Vec3d normal_;             ///< into the other mesh
  const SupportPoint* vertexEnd_;  ///< of the points that are vertices, which are ascending
  std::pmr::vector<Stretch> list_;
  std::pmr::vector<std::pair<const SupportPoint*, std::uint32_t>> ends_;  ///< of edges from one vertex
  double highest_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<EdgePass> deepestPass(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                                    const Vec3d& normal, double least) {
  std::optional<EdgePass> deepest;
  const auto first = all.points.begin() + region.pointBegin, last = all.points.begin() + region.pointEnd;
  const auto vertices =
      std::partition_point(first, last, [](const SupportPoint& p) { return p.kind == PointKind::kVertex; }) - first;
  if (vertices > OTG_SOLID_FEW_VERTICES) return deepest;
  const Stretches ofA(meshes, all, region, 0, normal), ofB(meshes, all, region, 1, normal);
  double most = least;
  for (const Stretch& a : ofA.list()) {
    if (!(a.height + ofB.highest() > least)) continue;
    const EdgePass& p = a.pass;
    for (const Stretch& b : ofB.list()) {
      if (!(a.height + b.height > least)) continue;
      const EdgePass& q = b.pass;
      const Vec3d apart = otgSub(q.middle, p.middle);
      if (otgAreBeside(apart, p.reach, q.reach, normal) != 0) continue;
      const StretchPass<double> pass = otgPassOfStretches(apart, p.along, p.reach, q.along, q.reach, normal);
      if (!(pass.way > most)) continue;
      most = pass.way;
      deepest = p;
      deepest->at = pass.at;
      deepest->way = pass.way;
    }
  }
  return deepest;
}

}  // namespace otg
