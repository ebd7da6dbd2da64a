// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/deepest_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

/// The stretches of one mesh in a region: those of crossed edges, which are points, and edges between vertices inside.
class Stretches {
 public:
  /// A point, and how far in its stretches reach, along the normal.
  struct Place {
    double height;
    const SupportPoint* point;
  };

  Stretches(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region, std::uint8_t mesh,
            const Vec3d& normal)
      : adjacency_(meshes.adjacency(mesh)), places_(all.memory) {
    const auto first = all.points.data() + region.pointBegin, last = all.points.data() + region.pointEnd;
    const auto isVertexOf = [](const SupportPoint& p, int m) { return p.kind == PointKind::kVertex && p.mesh <= m; };
    vertexBegin_ = std::partition_point(first, last, [&](const SupportPoint& p) { return isVertexOf(p, mesh - 1); });
    vertexEnd_ = std::partition_point(vertexBegin_, last, [&](const SupportPoint& p) { return isVertexOf(p, mesh); });
    for (const SupportPoint* p = first; p != last; ++p) {
      if (p->mesh != mesh || p->kind == PointKind::kCrossing) continue;
      const double at = otgDot(p->position, normal), reach = std::fabs(otgDot(p->along, normal)) * p->reach;
      places_.push_back({(mesh == 0 ? -at : at) + reach, p});
      highest_ = std::max(highest_, places_.back().height);
    }
  }

  const std::pmr::vector<Place>& places() const { return places_; }
  double highest() const { return highest_; }

  /// Calls fn with the stretch that a place is the middle of; of a vertex with the edges to others. `way` and `at` are
  /// not set.
  template <class Fn>
  void forEachAt(const Place& place, const Fn& fn) const {
    const SupportPoint& p = *place.point;
    if (p.kind != PointKind::kVertex) {
      fn(EdgePass{&p, p.feature, p.position, p.along, p.reach, 0, 0});
      return;
    }
    for (std::uint32_t k = adjacency_.first[p.feature]; k < adjacency_.first[p.feature + 1]; ++k) {
      const AdjacencyLinks::Spoke& spoke = adjacency_.spokes[k];
      const SupportPoint* const q = adjacency_.isFlatEdge(spoke.edge) ? nullptr : find(spoke.vertex);
      if (q == nullptr) continue;
      const Vec3d ends = otgSub(q->position, p.position);
      fn(EdgePass{nullptr, spoke.edge, otgScale(otgAdd(p.position, q->position), 0.5), unit(ends), 0.5 * norm(ends), 0,
                  0});
    }
  }

 private:
  /// The point of a vertex, or null where that is not in the region.
  const SupportPoint* find(std::uint32_t vertex) const {
    const SupportPoint* const at =
        std::partition_point(vertexBegin_, vertexEnd_, [vertex](const SupportPoint& p) { return p.feature < vertex; });
    return at != vertexEnd_ && at->feature == vertex ? at : nullptr;
  }

  const Adjacency& adjacency_;
  const SupportPoint *vertexBegin_, *vertexEnd_;  ///< ascending
  std::pmr::vector<Place> places_;
  double highest_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<EdgePass> deepestPass(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                                    const Vec3d& normal, double least) {
  const Stretches ofA(meshes, all, region, 0, normal), ofB(meshes, all, region, 1, normal);
  std::optional<EdgePass> deepest;
  double most = least;
  for (const Stretches::Place& a : ofA.places()) {
    if (!(a.height + ofB.highest() > least)) continue;
    ofA.forEachAt(a, [&](const EdgePass& p) {
      for (const Stretches::Place& b : ofB.places()) {
        if (!(a.height + b.height > least)) continue;
        ofB.forEachAt(b, [&](const EdgePass& q) {
          const StretchPass<double> pass =
              otgPassOfStretches(otgSub(q.middle, p.middle), p.along, p.reach, q.along, q.reach, normal);
          if (!(pass.way > most)) return;
          most = pass.way;
          deepest = p;
          deepest->at = pass.at;
          deepest->way = pass.way;
        });
      }
    });
  }
  return deepest;
}

}  // namespace otg
