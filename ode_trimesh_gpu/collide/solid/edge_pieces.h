// SPDX-License-Identifier: BSD-3-Clause
// The stretches of edges that lie inside the other mesh, and the elements that they join.
#pragma once

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
  EdgePieces(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, const Vec3d& origin)
      : meshes_(meshes), contour_(contour), inside_(inside), origin_(origin) {
    patchBase_[0] = static_cast<std::uint32_t>(contour.crossings.size());
    patchBase_[1] = patchBase_[0] + static_cast<std::uint32_t>(inside.patches[0].size());
    count_ = patchBase_[1] + static_cast<std::uint32_t>(inside.patches[1].size());
  }
  std::uint32_t count() const { return count_; }
  std::uint32_t patchElement(int m, std::uint32_t patch) const { return patchBase_[m] + patch; }
  /// kNone for a vertex outside.
  std::uint32_t vertexElement(int m, std::uint32_t v) const {
    const std::uint32_t patch = inside_.patchOf(m, v);
    return patch == kNone ? kNone : patchElement(m, patch);
  }

  Vec3d relative(const Vec3d& p) const { return otgSub(p, origin_); }
  Vec3d crossing(std::uint32_t c) const { return relative(contour_.crossings[c].point); }
  Vec3d vertex(int m, std::uint32_t v) const { return relative(meshes_.vertex(m, v)); }
  /// How many stretches were left out since the last call.
  std::size_t takeAnomalies() {
    const std::size_t n = anomalies_;
    anomalies_ = 0;
    return n;
  }

  /// Calls fn(EdgePiece) for every inside stretch of the edge. Stretches whose ends contradict the vertices' flags are
  /// left out and counted.
  template <class Fn>
  void forEachPiece(int m, std::uint32_t edge, const Fn& fn) {
    const Topology::Edge& ends = meshes_.mesh(m).topology().edges[edge];
    const std::uint32_t a = vertexElement(m, ends.a), b = vertexElement(m, ends.b);
    const Contour::Range range = contour_.on(m, edge);
    if (range.begin == range.end) {
      if (a == kNone || b == kNone) return;
      fn(EdgePiece{vertex(m, ends.a), vertex(m, ends.b), a, b, true, true});
      return;
    }
    std::uint32_t open = a;
    bool openVertex = true, isOpen = a != kNone;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const std::uint32_t c = contour_.alongEdge[i];
      if (contour_.crossings[c].exits) {
        if (isOpen) {
          fn(EdgePiece{openVertex ? vertex(m, ends.a) : crossing(open), crossing(c), open, c, openVertex, false});
        } else {
          ++anomalies_;
        }
        isOpen = false;
      } else {
        if (isOpen) ++anomalies_;
        open = c;
        openVertex = false;
        isOpen = true;
      }
    }
    if (isOpen != (b != kNone)) ++anomalies_;
    if (isOpen && b != kNone) {
      fn(EdgePiece{openVertex ? vertex(m, ends.a) : crossing(open), vertex(m, ends.b), open, b, openVertex, true});
    }
  }

 private:
  const PlacedMeshes& meshes_;
  const Contour& contour_;
  const InsideFlags& inside_;
  Vec3d origin_;
  std::uint32_t patchBase_[2], count_;
  std::size_t anomalies_ = 0;
};

}  // namespace otg
