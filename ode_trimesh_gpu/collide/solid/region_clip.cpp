// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_clip.h"

#include "base/vectors.h"

namespace otg {
namespace {

class Clipper {
 public:
  explicit Clipper(RegionWork& work) : w_(work), s_(work.scratch) {}

  void run() {
    s_.pieces.clear();
    s_.corrections.clear();
    for (int m = 0; m < 2; ++m) {
      const TriMesh& mesh = w_.meshes.mesh(m);
      for (std::uint32_t i = 0; i < s_.boundaryTriangles[m].size(); ++i) {
        const std::uint32_t t = s_.boundaryTriangles[m][i];
        Corner corners[3];
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t v = mesh.topology().weld[mesh.triangles()[t].v[k]];
          corners[k] = {v, w_.edges.vertexElement(m, v), w_.vertex(m, v)};
        }
        const Vec3d normal = w_.meshes.normal(m, t);
        clipTriangle(m, t, corners, normal, s_.chordHead[m][i]);
        for (const Corner& c : corners) {
          if (c.element == kNone || !w_.isLarge(s_.regionOf[c.element])) continue;
          const double area = -w_.meshes.adjacency(m).area[t] / 3;
          s_.corrections.push_back(
              {s_.regionOf[c.element], c.vertex, t, static_cast<std::uint8_t>(m), c.position, normal * area, area});
        }
      }
    }
    groupByRegion(s_.pieces, w_.out.regions.size(), s_.sortedPieces, s_.pieceBegin);
    groupByRegion(s_.corrections, w_.out.regions.size(), s_.sortedCorrections, s_.correctionBegin);
  }

 private:
  struct Corner {
    std::uint32_t vertex, element;  ///< welded; kNone if outside
    Vec3d position;
  };

  /// Area by the boundary: half the sum of p x q over the directed boundary segments.
  void clipTriangle(int m, std::uint32_t t, const Corner* corners, const Vec3d& n, std::uint32_t chord) {
    const TriMesh& mesh = w_.meshes.mesh(m);
    const Topology& topology = mesh.topology();
    const Vec3d corner = corners[0].position;
    std::vector<RegionLoop>& loops = s_.loops;
    loops.clear();
    const auto add = [&](std::uint32_t element, const Vec3d& p, const Vec3d& q) {
      const std::uint32_t region = s_.regionOf[element];
      RegionLoop* loop = nullptr;
      for (RegionLoop& l : loops) {
        if (l.region == region) loop = &l;
      }
      if (!loop) {
        loops.push_back({region, {0, 0, 0}, p, p});
        loop = &loops.back();
      }
      loop->sum = loop->sum + otgCross(p - corner, q - corner);
      loop->lo = minimum(loop->lo, minimum(p, q));
      loop->hi = maximum(loop->hi, maximum(p, q));
    };
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t half = 3 * t + static_cast<std::uint32_t>(k);
      const std::uint32_t edge = topology.edgeOf[half];
      if (edge == kNone) continue;
      const Corner &from = corners[k], &to = corners[(k + 1) % 3];
      if (!w_.contour.isCrossed(m, edge)) {
        if (from.element != kNone && to.element != kNone) add(from.element, from.position, to.position);
        continue;
      }
      const bool forward = from.vertex == topology.edges[edge].a;
      for (const EdgePiece& p : w_.edges.on(m, edge)) {
        forward ? add(p.fromElement, p.from, p.to) : add(p.fromElement, p.to, p.from);
      }
    }
    for (; chord != kNone; chord = s_.chordNext[m][chord]) {
      const Chord& c = w_.contour.chords[chord];
      m == 0 ? add(c.start, w_.crossing(c.start), w_.crossing(c.end))
             : add(c.start, w_.crossing(c.end), w_.crossing(c.start));
    }
    for (const RegionLoop& loop : loops) {
      const double area = 0.5 * otgDot(loop.sum, n);
      if (area > 0)
        addPiece(loop.region, m, t, n, area, otgDot(n, corner), loop.lo, loop.hi);  // else a sliver turned over
    }
  }

  void addPiece(std::uint32_t region, int m, std::uint32_t t, const Vec3d& n, double area, double offset,
                const Vec3d& lo, const Vec3d& hi) {
    s_.pieces.push_back({region, t, static_cast<std::uint8_t>(m), n, n * area, area, offset, lo, hi});
  }

  RegionWork& w_;
  RegionScratch& s_;
};

}  // namespace

void clipBoundary(RegionWork& work) {
  Clipper(work).run();
}

}  // namespace otg
