// SPDX-License-Identifier: BSD-3-Clause
// The stretches of edges that lie inside the other mesh, and the elements that they join.
#pragma once

#include <span>
#include <vector>

#include "base/vectors.h"
#include "collide/solid/contour.h"
#include "collide/solid/inside.h"

namespace otg {

/// The inside stretch of an edge, in the direction from Topology::Edge::a to b.
struct EdgePiece {
  Vec3d from, to;                        ///< relative to the origin
  std::uint32_t fromElement, toElement;  ///< elements at the ends
  bool fromVertex, toVertex;
};

/// Elements are numbered: crossings first, then the inside patches of A, then those of B.
class EdgePieces {
 public:
  struct Storage {
    std::vector<EdgePiece> pieces;
    std::vector<std::uint32_t> first, last;  ///< into pieces, by the edge's place in Contour::alongEdge
  };
  /// Collects the stretches of every crossed edge.
  EdgePieces(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, const Vec3d& origin,
             Storage& storage)
      : meshes_(meshes), contour_(contour), inside_(inside), origin_(origin), storage_(storage) {
    patchBase_[0] = static_cast<std::uint32_t>(contour.crossings.size());
    patchBase_[1] = patchBase_[0] + static_cast<std::uint32_t>(inside.patches[0].size());
    count_ = patchBase_[1] + static_cast<std::uint32_t>(inside.patches[1].size());
    storage.pieces.clear();
    storage.first.resize(contour.alongEdge.size());
    storage.last.resize(contour.alongEdge.size());
    for (int m = 0; m < 2; ++m) {
      for (const std::uint32_t edge : contour.crossedEdges[m]) {
        const Contour::Range range = contour.on(m, edge);
        storage.first[range.begin] = static_cast<std::uint32_t>(storage.pieces.size());
        collect(m, edge, range);
        storage.last[range.begin] = static_cast<std::uint32_t>(storage.pieces.size());
      }
    }
  }
  std::uint32_t count() const { return count_; }
  std::uint32_t patchElement(int m, std::uint32_t patch) const { return patchBase_[m] + patch; }
  /// kNone for a vertex outside.
  std::uint32_t vertexElement(int m, std::uint32_t v) const {
    const std::uint32_t patch = inside_.patchOf(m, v);
    return patch == kNone ? kNone : patchElement(m, patch);
  }

  Vec3d relative(const Vec3d& p) const { return p - origin_; }
  Vec3d crossing(std::uint32_t c) const { return relative(contour_.crossings[c].point); }
  Vec3d vertex(int m, std::uint32_t v) const { return relative(meshes_.vertex(m, v)); }
  /// Stretches that were left out because their ends contradict the vertices' flags.
  std::size_t anomalies() const { return anomalies_; }

  /// The inside stretches of a crossed edge, from Topology::Edge::a to b.
  std::span<const EdgePiece> on(int m, std::uint32_t edge) const {
    const std::uint32_t at = contour_.firstOn[m].find(edge);
    return {storage_.pieces.data() + storage_.first[at], storage_.pieces.data() + storage_.last[at]};
  }

 private:
  void collect(int m, std::uint32_t edge, const Contour::Range& range) {
    const Topology::Edge& ends = meshes_.mesh(m).topology().edges[edge];
    const std::uint32_t a = vertexElement(m, ends.a), b = vertexElement(m, ends.b);
    std::uint32_t open = a;
    bool openVertex = true, isOpen = a != kNone;
    const auto from = [&] { return openVertex ? vertex(m, ends.a) : crossing(open); };
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const std::uint32_t c = contour_.alongEdge[i];
      const bool exits = contour_.crossings[c].exits;
      if (exits != isOpen) ++anomalies_;
      if (exits && isOpen) storage_.pieces.push_back({from(), crossing(c), open, c, openVertex, false});
      isOpen = !exits;
      if (exits) continue;
      open = c;
      openVertex = false;
    }
    if (isOpen != (b != kNone)) ++anomalies_;
    if (isOpen && b != kNone) storage_.pieces.push_back({from(), vertex(m, ends.b), open, b, openVertex, true});
  }

  const PlacedMeshes& meshes_;
  const Contour& contour_;
  const InsideFlags& inside_;
  Vec3d origin_;
  Storage& storage_;
  std::uint32_t patchBase_[2], count_;
  std::size_t anomalies_ = 0;
};

}  // namespace otg
