// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/topology_check.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace otg {
namespace {

/// How often an edge is used in its direction and against it: more than twice counts as twice.
struct EdgeUses {
  std::uint32_t triangle = kNone;  ///< the first one
  std::uint8_t along = 0, against = 0;
  bool isPair() const { return along == 1 && against == 1; }
  unsigned count() const { return unsigned{along} + against; }
};

class TopologyWalk {
 public:
  TopologyWalk(const Topology& topology, std::span<const Triangle> triangles)
      : topology_(topology),
        triangles_(triangles),
        uses_(topology.edgeCount()),
        pieces_(triangles.size()),
        closed_(topology.componentCount(), 1) {
    std::iota(pieces_.begin(), pieces_.end(), 0u);
  }

  TopologyFindings run() {
    TopologyFindings found;
    for (std::uint32_t t = 0; t < triangles_.size() && good_; ++t) visit(t);
    good_ = good_ && nextEdge_ == uses_.size() && nextComponent_ == closed_.size();
    if (!good_) {
      found.fault = "edges or components that do not match";
      return found;
    }
    if (!twinsMatch()) {
      found.fault = "neighbours that do not match";
      return found;
    }
    // Each piece that hangs together has one component. There are as many, so each component is one piece.
    if (pieceCount_ != closed_.size() || !std::ranges::equal(closed_, topology_.componentClosed)) {
      found.fault = "edges or components that do not match";
    }
    for (const EdgeUses& uses : uses_) {
      found.boundaryEdges += uses.count() == 1;
      found.nonManifoldEdges += uses.count() > 2;
      found.inconsistentEdges += uses.count() == 2 && !uses.isPair();
    }
    return found;
  }

 private:
  /// Edges and components are numbered in the order of first appearance.
  void visit(std::uint32_t t) {
    const std::uint32_t(&v)[3] = triangles_[t].v;
    const std::uint32_t points[3] = {topology_.weld[v[0]], topology_.weld[v[1]], topology_.weld[v[2]]};
    const std::uint32_t component = topology_.componentOf[t];
    if (points[0] == points[1] || points[1] == points[2] || points[2] == points[0]) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        good_ &= topology_.edgeOf[h] == kNone && topology_.twin[h] == kNone;
      }
      good_ &= component == kNone;
      return;
    }
    good_ &= component <= nextComponent_ && component < closed_.size();
    nextComponent_ += component == nextComponent_;
    ++pieceCount_;
    for (std::uint32_t k = 0; k < 3 && good_; ++k) visit(t, k, points[k], points[k == 2 ? 0 : k + 1]);
  }

  void visit(std::uint32_t t, std::uint32_t k, std::uint32_t from, std::uint32_t to) {
    const std::uint32_t edge = topology_.edgeOf[3 * t + k];
    good_ = edge <= nextEdge_ && edge < uses_.size();
    if (!good_) return;
    nextEdge_ += edge == nextEdge_;
    const Topology::Edge& ends = topology_.edges[edge];
    EdgeUses& uses = uses_[edge];
    const bool along = ends.a == from && ends.b == to;
    good_ = along || (ends.a == to && ends.b == from);
    std::uint8_t& count = along ? uses.along : uses.against;
    count = static_cast<std::uint8_t>(std::min(count + 1, 3));
    if (uses.triangle == kNone) {
      uses.triangle = t;
      return;
    }
    good_ &= topology_.componentOf[uses.triangle] == topology_.componentOf[t];
    join(uses.triangle, t);
  }

  /// UnionFind, with a short way for two triangles that have met before.
  void join(std::uint32_t a, std::uint32_t b) {
    if (pieces_[a] == pieces_[b]) return;
    a = root(a);
    b = root(b);
    pieceCount_ -= a != b;
    pieces_[std::max(a, b)] = std::min(a, b);
  }
  std::uint32_t root(std::uint32_t t) {
    while (pieces_[t] != t) {
      pieces_[t] = pieces_[pieces_[t]];
      t = pieces_[t];
    }
    return t;
  }

  /// A half-edge has a twin exactly if its edge is used twice, in both directions: the other use is then the twin.
  bool twinsMatch() {
    bool match = true;
    for (std::uint32_t h = 0; h < topology_.edgeOf.size(); ++h) {
      const std::uint32_t edge = topology_.edgeOf[h];
      if (edge == kNone) continue;
      const bool pair = uses_[edge].isPair();
      match &= pair == (topology_.twin[h] != kNone);
      if (!pair) closed_[topology_.componentOf[h / 3]] = 0;
    }
    return match;
  }

  const Topology& topology_;
  const std::span<const Triangle> triangles_;
  std::vector<EdgeUses> uses_;
  std::vector<std::uint32_t> pieces_;  ///< of each triangle one of the same piece, no later than itself
  std::vector<std::uint8_t> closed_;
  std::uint32_t nextEdge_ = 0, nextComponent_ = 0;
  std::size_t pieceCount_ = 0;
  bool good_ = true;
};

}  // namespace

TopologyFindings checkTopology(const Topology& topology, std::span<const Vec3f> vertices,
                               std::span<const Triangle> triangles) {
  bool samePlaces = true;
  for (std::size_t v = 0; v < vertices.size(); ++v) samePlaces &= vertices[v] == vertices[topology.weld[v]];
  if (!samePlaces) return {"points that do not match"};
  return TopologyWalk(topology, triangles).run();
}

}  // namespace otg
