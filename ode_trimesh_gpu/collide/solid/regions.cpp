// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/regions.h"

#include <algorithm>
#include <limits>

#include "base/vectors.h"
#include "collide/solid/extent.h"
#include "collide/solid/region_cells_build.h"
#include "collide/solid/region_clip.h"
#include "collide/solid/region_work.h"

namespace otg {
namespace {

class Builder {
 public:
  Builder(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, RegionScratch& scratch,
          OverlapRegions& out)
      : w_{meshes, contour, inside, scratch, out, EdgePieces(meshes, contour, inside, out.origin, scratch.edges)},
        s_(scratch) {}

  void run() {
    w_.out.extents.query = &w_.meshes.query();
    w_.out.regions.clear();
    w_.out.pieces.clear();
    w_.out.points.clear();
    w_.out.extents.cells.clear();
    w_.out.extents.positions.clear();
    w_.out.anomalies = w_.edges.anomalies();
    if (w_.contour.crossings.empty()) return;
    unite();
    numberRegions();
    findBoundary();
    bound();
    clipBoundary(w_);
    seedContourPoints();
    for (std::uint32_t r = 0; r < w_.out.regions.size(); ++r) {
      if (!w_.isLarge(r)) {
        describeSmall(r);
        measure(r);
      } else {
        describeLarge(r);
      }
    }
  }

 private:
  void unite() {
    s_.sets.reset(w_.edges.count());
    for (const Chord& chord : w_.contour.chords) s_.sets.unite(chord.start, chord.end);
    for (int m = 0; m < 2; ++m) {
      for (const std::uint32_t edge : w_.contour.crossedEdges[m]) {
        for (const EdgePiece& p : w_.edges.on(m, edge)) s_.sets.unite(p.fromElement, p.toElement);
      }
    }
    uniteWithCorners();
  }

  /// A contour that stays within one triangle whose corners are all inside hangs together with them. One that reaches
  /// an edge of the triangle may cut corners off; it hangs together with what is inside along the edge.
  void uniteWithCorners() {
    s_.chordFrom.assign(w_.contour.crossings.size(), kNone);
    s_.leaves.assign(w_.contour.crossings.size(), 0);
    for (std::uint32_t c = 0; c < w_.contour.chords.size(); ++c) s_.chordFrom[w_.contour.chords[c].start] = c;
    for (int m = 0; m < 2; ++m) {
      const TriMesh& mesh = w_.meshes.mesh(m);
      for (const Chord& chord : w_.contour.chords) {
        const Triangle& t = mesh.triangles()[m == 0 ? chord.triangleA : chord.triangleB];
        std::uint32_t corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = w_.edges.vertexElement(m, mesh.topology().weld[t.v[k]]);
        if (corner[0] == kNone || corner[1] == kNone || corner[2] == kNone) continue;
        if (s_.sets.find(chord.start) != s_.sets.find(corner[0]) && staysWithin(m, chord)) {
          s_.sets.unite(chord.start, corner[0]);
        }
      }
    }
  }

  /// Whether the contour comes back to a chord without leaving its triangle of mesh m.
  bool staysWithin(int m, const Chord& chord) {
    const auto isWithin = [&](std::uint32_t c) {
      return w_.contour.crossings[c].mesh != m && s_.leaves[c] == 0 && s_.chordFrom[c] != kNone;
    };
    const auto next = [&](std::uint32_t c) { return w_.contour.chords[s_.chordFrom[c]].end; };
    std::size_t steps = 0;
    for (std::uint32_t c = chord.end; isWithin(c); c = next(c)) {
      if (c == chord.start) return true;
      if (++steps > w_.contour.chords.size()) break;  // chords contradict each other
    }
    for (std::uint32_t c = chord.end; isWithin(c); c = next(c)) s_.leaves[c] = 1;
    return false;
  }

  /// How many vertices.
  std::uint32_t countOf(int m, const InsideFlags::Patch& patch) const {
    const Adjacency& adjacency = w_.meshes.adjacency(m);
    std::uint32_t count = patch.vertexEnd - patch.vertexBegin;
    for (std::uint32_t i = patch.clusterBegin; i < patch.clusterEnd; ++i) {
      const std::uint32_t c = w_.inside.clusters[m][i];
      count += adjacency.clusters[c + 1].first - adjacency.clusters[c].first;
    }
    return count;
  }

  void numberRegions() {
    s_.regionOf.assign(w_.edges.count(), kNone);
    std::uint32_t count = 0;
    for (std::uint32_t e = 0; e < w_.edges.count(); ++e) {
      const std::uint32_t root = s_.sets.find(e);
      if (s_.regionOf[root] == kNone) s_.regionOf[root] = count++;
      s_.regionOf[e] = s_.regionOf[root];
    }
    w_.out.regions.assign(count, Region{});
    s_.sums.assign(count, RegionSums{});
    s_.load.assign(count, 0);
    s_.largest.assign(count, 0);
    s_.patches.clear();
    for (int m = 0; m < 2; ++m) {
      for (std::uint32_t p = 0; p < w_.inside.patches[m].size(); ++p) {
        const std::uint32_t region = s_.regionOf[w_.edges.patchElement(m, p)];
        s_.patches.push_back({region, p, static_cast<std::uint8_t>(m)});
        s_.load[region] += countOf(m, w_.inside.patches[m][p]);
      }
    }
    groupByRegion(s_.patches, count, s_.sortedPatches, s_.patchBegin);
    for (const Chord& chord : w_.contour.chords) {
      const std::uint32_t region = s_.regionOf[chord.start];
      ++s_.load[region];
      std::uint64_t& first = w_.out.regions[region].first;
      first = std::min(first, std::uint64_t{chord.triangleA} << 32 | chord.triangleB);
      s_.largest[region] = std::max({s_.largest[region], w_.meshes.adjacency(0).area[chord.triangleA],
                                     w_.meshes.adjacency(1).area[chord.triangleB]});
    }
  }

  /// Triangles with a chord or a crossed edge, and their chords.
  void findBoundary() {
    for (int m = 0; m < 2; ++m) {
      const TriMesh& mesh = w_.meshes.mesh(m);
      const Adjacency& adjacency = w_.meshes.adjacency(m);
      s_.boundary[m].reset(mesh.triangles().size());
      s_.boundaryTriangles[m].clear();
      s_.chordHead[m].clear();
      s_.chordNext[m].assign(w_.contour.chords.size(), kNone);
      const auto mark = [&](std::uint32_t t) {
        std::uint32_t i = s_.boundary[m].find(t);
        if (i != EpochArray::kMissing) return i;
        i = static_cast<std::uint32_t>(s_.boundaryTriangles[m].size());
        s_.boundary[m].set(t, i);
        s_.boundaryTriangles[m].push_back(t);
        __builtin_prefetch(&adjacency.normal[t]);  // for clip()
        __builtin_prefetch(&adjacency.area[t]);
        s_.chordHead[m].push_back(kNone);
        return i;
      };
      for (std::uint32_t c = 0; c < w_.contour.chords.size(); ++c) {
        const std::uint32_t i = mark(m == 0 ? w_.contour.chords[c].triangleA : w_.contour.chords[c].triangleB);
        s_.chordNext[m][c] = s_.chordHead[m][i];
        s_.chordHead[m][i] = c;
      }
      // Both triangles at a crossed edge have chords, unless the contour is broken there.
      for (const std::uint32_t edge : w_.contour.crossedEdges[m]) {
        const std::uint32_t half = adjacency.halfEdgeOf[edge], twin = mesh.topology().twin[half];
        mark(half / 3);
        if (twin != kNone) mark(twin / 3);
      }
    }
  }

  void bound() {
    const double inf = std::numeric_limits<double>::infinity();
    for (Region& region : w_.out.regions) {
      region.lo = {inf, inf, inf};
      region.hi = {-inf, -inf, -inf};
    }
    const auto include = [&](Region& region, const Vec3d& p) {
      region.lo = minimum(region.lo, p);
      region.hi = maximum(region.hi, p);
    };
    for (std::uint32_t c = 0; c < w_.contour.crossings.size(); ++c)
      include(w_.out.regions[s_.regionOf[c]], w_.crossing(c));
    for (const RegionPatch& ref : s_.patches) {
      Region& region = w_.out.regions[ref.region];
      const InsideFlags::Patch& patch = w_.inside.patches[ref.mesh][ref.patch];
      const Adjacency& adjacency = w_.meshes.adjacency(ref.mesh);
      double& largest = s_.largest[ref.region];
      for (std::uint32_t i = patch.vertexBegin; i < patch.vertexEnd; ++i) {
        if (i + kAhead < patch.vertexEnd) __builtin_prefetch(&adjacency.star[w_.inside.vertices[ref.mesh][i + kAhead]]);
        include(region, w_.relative(w_.inside.positions[ref.mesh][i]));
        largest = std::max(largest, adjacency.star[w_.inside.vertices[ref.mesh][i]].area);
      }
      for (std::uint32_t i = patch.clusterBegin; i < patch.clusterEnd; ++i) {
        const std::uint32_t c = w_.inside.clusters[ref.mesh][i];
        largest = std::max(largest, adjacency.clusters[c].sum.area);
        const PartBox box = w_.boxOf(ref.mesh, adjacency.clusters[c]);
        if (minimum(box.lo, region.lo) == region.lo && maximum(box.hi, region.hi) == region.hi) continue;
        for (std::uint32_t k = adjacency.clusters[c].first; k < adjacency.clusters[c + 1].first; ++k) {
          include(region, w_.vertex(ref.mesh, adjacency.clusterVertices[k]));
        }
      }
    }
    const Vec3d zero{0, 0, 0};  // -0 and 0 are one bound
    for (Region& region : w_.out.regions) {
      region.lo = region.lo + zero;
      region.hi = region.hi + zero;
      region.diagonal = norm(region.hi - region.lo);
    }
  }

  /// By cells; an uneven one that is not too large is taken apart again, because each of its points needs its own face.
  void describeLarge(std::uint32_t r) {
    OverlapRegions& out = w_.out;
    const std::size_t pieces = out.pieces.size(), points = out.points.size();
    const std::size_t cells = out.extents.cells.size(), positions = out.extents.positions.size();
    describeByCells(w_, r);
    measure(r);
    if (!needsTriangles(out, out.regions[r], s_.load[r])) return;
    out.pieces.resize(pieces);
    out.points.resize(points);
    out.extents.cells.resize(cells);
    out.extents.positions.resize(positions);
    out.regions[r].cellBegin = out.regions[r].cellEnd = 0;
    s_.sums[r] = RegionSums{};
    describeSmall(r);
    measure(r);
    out.regions[r].apart = true;
  }

  /// Every piece and every point by itself.
  void describeSmall(std::uint32_t r) {
    Region& region = w_.out.regions[r];
    region.pieceBegin = static_cast<std::uint32_t>(w_.out.pieces.size());
    region.pointBegin = static_cast<std::uint32_t>(w_.out.points.size());
    for (std::uint32_t i = s_.pieceBegin[r]; i < s_.pieceBegin[r + 1]; ++i) w_.out.pieces.push_back(s_.pieces[i]);
    // Ascending, so that the order of sums does not come from the way of the flood.
    s_.insiders.clear();
    for (std::uint32_t i = s_.patchBegin[r]; i < s_.patchBegin[r + 1]; ++i) {
      const RegionPatch& ref = s_.patches[i];
      w_.forEachVertex(ref.mesh, w_.inside.patches[ref.mesh][ref.patch], [&](std::uint32_t v, const Vec3d& x) {
        s_.insiders.push_back({v, ref.mesh, x});
      });
    }
    std::sort(s_.insiders.begin(), s_.insiders.end(), [](const RegionInsider& x, const RegionInsider& y) {
      return x.mesh != y.mesh ? x.mesh < y.mesh : x.vertex < y.vertex;
    });
    for (const RegionInsider& insider : s_.insiders) {
      const int m = insider.mesh;
      const TriMesh& mesh = w_.meshes.mesh(m);
      const Adjacency& adjacency = w_.meshes.adjacency(m);
      w_.out.points.push_back(w_.pointOf(w_.vertexSeed(r, m, insider.vertex, insider.position)));
      for (std::uint32_t h = adjacency.first[insider.vertex]; h < adjacency.first[insider.vertex + 1]; ++h) {
        const std::uint32_t t = adjacency.halfEdges[h] / 3;
        if (s_.boundary[m].has(t)) continue;
        s_.boundary[m].set(t, kInterior);
        const Triangle& triangle = mesh.triangles()[t];
        const Vec3d p = w_.vertex(m, triangle.v[0]), q = w_.vertex(m, triangle.v[1]), s = w_.vertex(m, triangle.v[2]);
        const Vec3d n = w_.meshes.normal(m, t);
        const double area = adjacency.area[t];
        w_.out.pieces.push_back({r, t, insider.mesh, n, n * area, area, otgDot(n, p), minimum(p, minimum(q, s)),
                                 maximum(p, maximum(q, s))});
      }
    }
    for (std::uint32_t i = s_.seedBegin[r]; i < s_.seedBegin[r + 1]; ++i) {
      w_.out.points.push_back(w_.pointOf(s_.seeds[i]));
    }
    region.pieceEnd = static_cast<std::uint32_t>(w_.out.pieces.size());
    region.pointEnd = static_cast<std::uint32_t>(w_.out.points.size());
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
      const Piece& p = w_.out.pieces[i];
      s_.sums[r].add(p.mesh, p.vector, p.area, p.offset * p.area);
    }
  }

  /// The ends of the inside stretches of crossed edges that are crossings, and the stretches' middles where something
  /// can rest on them.
  void seedContourPoints() {
    s_.seeds.clear();
    for (int m = 0; m < 2; ++m) {
      const Adjacency& adjacency = w_.meshes.adjacency(m);
      for (const std::uint32_t edge : w_.contour.crossedEdges[m]) {
        std::uint32_t stretch = 0;
        for (const EdgePiece& piece : w_.edges.on(m, edge)) {
          const Vec3d d = piece.to - piece.from;
          const std::uint32_t k = stretch++;
          const auto seed = [&](const Vec3d& at, const Vec3d& span, std::uint32_t c, PointKind kind,
                                std::uint32_t ordinal) {
            s_.seeds.push_back({at, span, s_.regionOf[piece.fromElement], edge, ordinal, c,
                                static_cast<std::uint8_t>(m), kind, adjacency.isFlatEdge(edge)});
          };
          if (adjacency.edgeKind[edge] == OTG_EDGE_INNER) {
            w_.out.regions[s_.regionOf[piece.fromElement]].roundCorner = true;
          }
          if (!piece.fromVertex) seed(piece.from, d, piece.fromElement, PointKind::kCrossing, 2 * k);
          if (!piece.toVertex) seed(piece.to, d * -1.0, piece.toElement, PointKind::kCrossing, 2 * k + 1);
          if (adjacency.isFlatEdge(edge) || (piece.fromVertex && piece.toVertex)) continue;
          seed((piece.from + piece.to) * 0.5, d * 0.5, kNone,
               piece.fromVertex || piece.toVertex ? PointKind::kMiddle : PointKind::kMiddleOfContour, k);
        }
      }
    }
    groupByRegion(s_.seeds, w_.out.regions.size(), s_.sortedSeeds, s_.seedBegin);
  }

  void measure(std::uint32_t r) { s_.sums[r].measure(w_.out.regions[r]); }

  RegionWork w_;
  RegionScratch& s_;
};

}  // namespace

bool needsTriangles(const OverlapRegions& all, const Region& region, std::uint32_t load) {
  if (load > OTG_SOLID_MOST_UNEVEN) return false;
  if (region.coherence < OTG_SOLID_COHERENT) {
    return otgIsLayered(region.thickness, region.diagonal, region.areaA, region.areaB) != 0;
  }
  return region.roundCorner || otgIsUneven(RegionExtent(all, region).along(unit(region.push)), region.thickness) != 0;
}

RegionBuilder::RegionBuilder() : scratch_(std::make_unique<RegionScratch>()) {}
RegionBuilder::~RegionBuilder() = default;

void RegionBuilder::build(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside,
                          OverlapRegions& out) {
  build(meshes, contour, inside, contour.crossings.empty() ? Vec3d{0, 0, 0} : contour.crossings.front().point, out);
}

void RegionBuilder::build(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside,
                          const Vec3d& origin, OverlapRegions& out) {
  out.origin = origin;
  Builder(meshes, contour, inside, *scratch_, out).run();
}

}  // namespace otg
