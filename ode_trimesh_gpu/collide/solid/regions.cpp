// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/regions.h"

#include <algorithm>
#include <limits>

#include "base/vectors.h"
#include "collide/solid/edge_pieces.h"
#include "collide/solid/region_cells.h"
#include "collide/solid/support_point.h"

namespace otg {
namespace {

struct Loop {  // what bounds the part of one triangle in one region
  std::uint32_t region;
  Vec3d sum{0, 0, 0};
  Vec3d lo, hi;
};

/// What is taken off the star of an inside vertex because one of its triangles is clipped.
struct Correction {
  std::uint32_t region, vertex, triangle;
  std::uint8_t mesh;
  Vec3d position;  ///< of the vertex, relative to the origin
  Vec3d vector;    ///< vector area
  double area;
};

struct Insider {  // a vertex inside the other mesh
  std::uint32_t vertex;
  std::uint8_t mesh;
  Vec3d position;  ///< relative to the origin
};

struct PatchRef {
  std::uint32_t region, patch;
  std::uint8_t mesh;
};

/// Stable counting sort by `region`. begin[r] .. begin[r + 1] are the items of region r.
template <class T>
void groupByRegion(std::vector<T>& items, std::size_t regions, std::vector<T>& sorted,
                   std::vector<std::uint32_t>& begin) {
  begin.assign(regions + 2, 0);
  for (const T& item : items) ++begin[item.region + 2];
  for (std::size_t r = 2; r < begin.size(); ++r) begin[r] += begin[r - 1];
  sorted.resize(items.size());
  for (const T& item : items) sorted[begin[item.region + 1]++] = item;
  items.swap(sorted);
}

}  // namespace

struct RegionBuilder::Scratch {
  std::vector<std::uint32_t> parent, regionOf, load;
  EpochArray boundary[2];  ///< triangle -> index into boundaryTriangles, or kInterior once it has been taken
  std::vector<std::uint32_t> boundaryTriangles[2], chordHead[2], chordNext[2];
  std::vector<Loop> loops;
  std::vector<Piece> pieces, sortedPieces;
  std::vector<Correction> corrections, sortedCorrections;
  std::vector<PointSeed> seeds, sortedSeeds;
  std::vector<PatchRef> patches, sortedPatches;
  std::vector<Insider> insiders;
  std::vector<std::uint32_t> pieceBegin, correctionBegin, seedBegin, patchBegin, cellScratch;
  std::vector<RegionSums> sums;
  std::vector<double> largest;  ///< by region: an area that none of its terms exceeds, or hardly
  std::vector<Vec3d> positions;
  EdgePieces::Storage edges;
  PieceCells pieceCells;
  PointCells pointCells;
};

namespace {

constexpr std::uint32_t kInterior = 0xfffffffeu;
/// How many items ahead memory is asked for.
constexpr std::uint32_t kAhead = 8;

template <class Scratch>
class Builder {
 public:
  Builder(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, Scratch& scratch,
          OverlapRegions& out)
      : meshes_(meshes),
        contour_(contour),
        inside_(inside),
        s_(scratch),
        out_(out),
        edges_(meshes, contour, inside, out.origin, scratch.edges) {}

  void run() {
    out_.extents.query = &meshes_.query();
    out_.regions.clear();
    out_.pieces.clear();
    out_.points.clear();
    out_.extents.cells.clear();
    out_.extents.positions.clear();
    out_.anomalies = edges_.anomalies();
    if (contour_.crossings.empty()) return;
    unite();
    numberRegions();
    findBoundary();
    bound();
    clip();
    seedContourPoints();
    for (std::uint32_t r = 0; r < out_.regions.size(); ++r) {
      isLarge(r) ? describeLarge(r) : describeSmall(r);
      measure(r);
    }
  }

 private:
  Vec3d relative(const Vec3d& p) const { return edges_.relative(p); }
  Vec3d crossing(std::uint32_t c) const { return edges_.crossing(c); }
  Vec3d vertex(int m, std::uint32_t v) const { return edges_.vertex(m, v); }
  bool isLarge(std::uint32_t region) const { return s_.load[region] > kLargeRegion; }

  std::uint32_t find(std::uint32_t e) {
    while (s_.parent[e] != e) {
      s_.parent[e] = s_.parent[s_.parent[e]];
      e = s_.parent[e];
    }
    return e;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) s_.parent[std::max(a, b)] = std::min(a, b);  // the smallest element names the set
  }
  void unite() {
    s_.parent.resize(edges_.count());
    for (std::uint32_t e = 0; e < edges_.count(); ++e) s_.parent[e] = e;
    for (const Chord& chord : contour_.chords) join(chord.start, chord.end);
    for (int m = 0; m < 2; ++m) {
      for (const std::uint32_t edge : contour_.crossedEdges[m]) {
        for (const EdgePiece& p : edges_.on(m, edge)) join(p.fromElement, p.toElement);
      }
      // A contour that stays within one triangle whose corners are all inside hangs together with them.
      const TriMesh& mesh = meshes_.mesh(m);
      for (const Chord& chord : contour_.chords) {
        const Triangle& t = mesh.triangles()[m == 0 ? chord.triangleA : chord.triangleB];
        std::uint32_t corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = edges_.vertexElement(m, mesh.topology().weld[t.v[k]]);
        if (corner[0] != kNone && corner[1] != kNone && corner[2] != kNone) join(chord.start, corner[0]);
      }
    }
  }

  /// How many vertices.
  std::uint32_t countOf(int m, const InsideFlags::Patch& patch) const {
    const Adjacency& adjacency = meshes_.adjacency(m);
    std::uint32_t count = patch.vertexEnd - patch.vertexBegin;
    for (std::uint32_t i = patch.clusterBegin; i < patch.clusterEnd; ++i) {
      const std::uint32_t c = inside_.clusters[m][i];
      count += adjacency.clusters[c + 1].first - adjacency.clusters[c].first;
    }
    return count;
  }

  /// Calls fn(vertex, position relative to the origin) for every vertex of a patch.
  template <class Fn>
  void forEachVertex(int m, const InsideFlags::Patch& patch, const Fn& fn) const {
    for (std::uint32_t i = patch.vertexBegin; i < patch.vertexEnd; ++i) {
      fn(inside_.vertices[m][i], relative(inside_.positions[m][i]));
    }
    const Adjacency& adjacency = meshes_.adjacency(m);
    for (std::uint32_t i = patch.clusterBegin; i < patch.clusterEnd; ++i) {
      const std::uint32_t c = inside_.clusters[m][i];
      for (std::uint32_t k = adjacency.clusters[c].first; k < adjacency.clusters[c + 1].first; ++k) {
        fn(adjacency.clusterVertices[k], vertex(m, adjacency.clusterVertices[k]));
      }
    }
  }

  PartBox boxOf(int m, const Adjacency::Cluster& cluster) const {
    return boxOfCluster(meshes_, m, cluster, out_.origin);
  }

  void numberRegions() {
    s_.regionOf.assign(edges_.count(), kNone);
    std::uint32_t count = 0;
    for (std::uint32_t e = 0; e < edges_.count(); ++e) {
      const std::uint32_t root = find(e);
      if (s_.regionOf[root] == kNone) s_.regionOf[root] = count++;
      s_.regionOf[e] = s_.regionOf[root];
    }
    out_.regions.assign(count, Region{});
    s_.sums.assign(count, RegionSums{});
    s_.load.assign(count, 0);
    s_.largest.assign(count, 0);
    s_.patches.clear();
    for (int m = 0; m < 2; ++m) {
      for (std::uint32_t p = 0; p < inside_.patches[m].size(); ++p) {
        const std::uint32_t region = s_.regionOf[edges_.patchElement(m, p)];
        s_.patches.push_back({region, p, static_cast<std::uint8_t>(m)});
        s_.load[region] += countOf(m, inside_.patches[m][p]);
      }
    }
    groupByRegion(s_.patches, count, s_.sortedPatches, s_.patchBegin);
    for (const Chord& chord : contour_.chords) {
      const std::uint32_t region = s_.regionOf[chord.start];
      ++s_.load[region];
      s_.largest[region] = std::max(
          {s_.largest[region], meshes_.adjacency(0).area[chord.triangleA], meshes_.adjacency(1).area[chord.triangleB]});
    }
  }

  /// Triangles with a chord or a crossed edge, and their chords.
  void findBoundary() {
    for (int m = 0; m < 2; ++m) {
      const TriMesh& mesh = meshes_.mesh(m);
      const Adjacency& adjacency = meshes_.adjacency(m);
      s_.boundary[m].reset(mesh.triangles().size());
      s_.boundaryTriangles[m].clear();
      s_.chordHead[m].clear();
      s_.chordNext[m].assign(contour_.chords.size(), kNone);
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
      for (std::uint32_t c = 0; c < contour_.chords.size(); ++c) {
        const std::uint32_t i = mark(m == 0 ? contour_.chords[c].triangleA : contour_.chords[c].triangleB);
        s_.chordNext[m][c] = s_.chordHead[m][i];
        s_.chordHead[m][i] = c;
      }
      // Both triangles at a crossed edge have chords, unless the contour is broken there.
      for (const std::uint32_t edge : contour_.crossedEdges[m]) {
        const std::uint32_t half = adjacency.halfEdgeOf[edge], twin = mesh.topology().twin[half];
        mark(half / 3);
        if (twin != kNone) mark(twin / 3);
      }
    }
  }

  void bound() {
    const double inf = std::numeric_limits<double>::infinity();
    for (Region& region : out_.regions) {
      region.lo = {inf, inf, inf};
      region.hi = {-inf, -inf, -inf};
    }
    const auto include = [&](Region& region, const Vec3d& p) {
      region.lo = minimum(region.lo, p);
      region.hi = maximum(region.hi, p);
    };
    for (std::uint32_t c = 0; c < contour_.crossings.size(); ++c) include(out_.regions[s_.regionOf[c]], crossing(c));
    for (const PatchRef& ref : s_.patches) {
      Region& region = out_.regions[ref.region];
      const InsideFlags::Patch& patch = inside_.patches[ref.mesh][ref.patch];
      const Adjacency& adjacency = meshes_.adjacency(ref.mesh);
      double& largest = s_.largest[ref.region];
      for (std::uint32_t i = patch.vertexBegin; i < patch.vertexEnd; ++i) {
        if (i + kAhead < patch.vertexEnd) __builtin_prefetch(&adjacency.star[inside_.vertices[ref.mesh][i + kAhead]]);
        include(region, relative(inside_.positions[ref.mesh][i]));
        largest = std::max(largest, adjacency.star[inside_.vertices[ref.mesh][i]].area);
      }
      for (std::uint32_t i = patch.clusterBegin; i < patch.clusterEnd; ++i) {
        const std::uint32_t c = inside_.clusters[ref.mesh][i];
        largest = std::max(largest, adjacency.clusters[c].sum.area);
        const PartBox box = boxOf(ref.mesh, adjacency.clusters[c]);
        if (minimum(box.lo, region.lo) == region.lo && maximum(box.hi, region.hi) == region.hi) continue;
        for (std::uint32_t k = adjacency.clusters[c].first; k < adjacency.clusters[c + 1].first; ++k) {
          include(region, vertex(ref.mesh, adjacency.clusterVertices[k]));
        }
      }
    }
    const Vec3d zero{0, 0, 0};  // -0 and 0 are one bound
    for (Region& region : out_.regions) {
      region.lo = otgAdd(region.lo, zero);
      region.hi = otgAdd(region.hi, zero);
      region.diagonal = norm(otgSub(region.hi, region.lo));
    }
  }

  /// Clips every boundary triangle, and notes what its inside corners' stars hold of it.
  void clip() {
    s_.pieces.clear();
    s_.corrections.clear();
    for (int m = 0; m < 2; ++m) {
      const TriMesh& mesh = meshes_.mesh(m);
      for (std::uint32_t i = 0; i < s_.boundaryTriangles[m].size(); ++i) {
        const std::uint32_t t = s_.boundaryTriangles[m][i];
        Corner corners[3];
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t v = mesh.topology().weld[mesh.triangles()[t].v[k]];
          corners[k] = {v, edges_.vertexElement(m, v), vertex(m, v)};
        }
        const Vec3d normal = meshes_.normal(m, t);
        clipTriangle(m, t, corners, normal, s_.chordHead[m][i]);
        for (const Corner& c : corners) {
          if (c.element == kNone || !isLarge(s_.regionOf[c.element])) continue;
          const double area = -meshes_.adjacency(m).area[t] / 3;
          s_.corrections.push_back({s_.regionOf[c.element], c.vertex, t, static_cast<std::uint8_t>(m), c.position,
                                    otgScale(normal, area), area});
        }
      }
    }
    groupByRegion(s_.pieces, out_.regions.size(), s_.sortedPieces, s_.pieceBegin);
    groupByRegion(s_.corrections, out_.regions.size(), s_.sortedCorrections, s_.correctionBegin);
  }

  struct Corner {
    std::uint32_t vertex, element;  ///< welded; kNone if outside
    Vec3d position;
  };

  /// Area by the boundary: half the sum of p x q over the directed boundary segments.
  void clipTriangle(int m, std::uint32_t t, const Corner* corners, const Vec3d& n, std::uint32_t chord) {
    const TriMesh& mesh = meshes_.mesh(m);
    const Topology& topology = mesh.topology();
    const Vec3d corner = corners[0].position;
    std::vector<Loop>& loops = s_.loops;
    loops.clear();
    const auto add = [&](std::uint32_t element, const Vec3d& p, const Vec3d& q) {
      const std::uint32_t region = s_.regionOf[element];
      Loop* loop = nullptr;
      for (Loop& l : loops) {
        if (l.region == region) loop = &l;
      }
      if (!loop) {
        loops.push_back({region, {0, 0, 0}, p, p});
        loop = &loops.back();
      }
      loop->sum = otgAdd(loop->sum, otgCross(otgSub(p, corner), otgSub(q, corner)));
      loop->lo = minimum(loop->lo, minimum(p, q));
      loop->hi = maximum(loop->hi, maximum(p, q));
    };
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t half = 3 * t + static_cast<std::uint32_t>(k);
      const std::uint32_t edge = topology.edgeOf[half];
      if (edge == kNone) continue;
      const Corner &from = corners[k], &to = corners[(k + 1) % 3];
      if (!contour_.isCrossed(m, edge)) {
        if (from.element != kNone && to.element != kNone) add(from.element, from.position, to.position);
        continue;
      }
      const bool forward = from.vertex == topology.edges[edge].a;
      for (const EdgePiece& p : edges_.on(m, edge)) {
        forward ? add(p.fromElement, p.from, p.to) : add(p.fromElement, p.to, p.from);
      }
    }
    for (; chord != kNone; chord = s_.chordNext[m][chord]) {
      const Chord& c = contour_.chords[chord];
      m == 0 ? add(c.start, crossing(c.start), crossing(c.end)) : add(c.start, crossing(c.end), crossing(c.start));
    }
    for (const Loop& loop : loops) {
      const double area = 0.5 * otgDot(loop.sum, n);
      if (area > 0)
        addPiece(loop.region, m, t, n, area, otgDot(n, corner), loop.lo, loop.hi);  // else a sliver turned over
    }
  }

  void addPiece(std::uint32_t region, int m, std::uint32_t t, const Vec3d& n, double area, double offset,
                const Vec3d& lo, const Vec3d& hi) {
    s_.pieces.push_back({region, t, static_cast<std::uint8_t>(m), n, otgScale(n, area), area, offset, lo, hi});
  }

  /// Every piece and every point by itself.
  void describeSmall(std::uint32_t r) {
    Region& region = out_.regions[r];
    region.pieceBegin = static_cast<std::uint32_t>(out_.pieces.size());
    region.pointBegin = static_cast<std::uint32_t>(out_.points.size());
    for (std::uint32_t i = s_.pieceBegin[r]; i < s_.pieceBegin[r + 1]; ++i) out_.pieces.push_back(s_.pieces[i]);
    // Ascending, so that the order of sums does not come from the way of the flood.
    s_.insiders.clear();
    for (std::uint32_t i = s_.patchBegin[r]; i < s_.patchBegin[r + 1]; ++i) {
      const PatchRef& ref = s_.patches[i];
      forEachVertex(ref.mesh, inside_.patches[ref.mesh][ref.patch], [&](std::uint32_t v, const Vec3d& x) {
        s_.insiders.push_back({v, ref.mesh, x});
      });
    }
    std::sort(s_.insiders.begin(), s_.insiders.end(), [](const Insider& x, const Insider& y) {
      return x.mesh != y.mesh ? x.mesh < y.mesh : x.vertex < y.vertex;
    });
    for (const Insider& insider : s_.insiders) {
      const int m = insider.mesh;
      const TriMesh& mesh = meshes_.mesh(m);
      const Adjacency& adjacency = meshes_.adjacency(m);
      out_.points.push_back(supportPoint(vertexSeed(r, m, insider.vertex, insider.position)));
      for (std::uint32_t h = adjacency.first[insider.vertex]; h < adjacency.first[insider.vertex + 1]; ++h) {
        const std::uint32_t t = adjacency.halfEdges[h] / 3;
        if (s_.boundary[m].has(t)) continue;
        s_.boundary[m].set(t, kInterior);
        const Triangle& triangle = mesh.triangles()[t];
        const Vec3d p = vertex(m, triangle.v[0]), q = vertex(m, triangle.v[1]), s = vertex(m, triangle.v[2]);
        const Vec3d n = meshes_.normal(m, t);
        const double area = adjacency.area[t];
        out_.pieces.push_back({r, t, insider.mesh, n, otgScale(n, area), area, otgDot(n, p), minimum(p, minimum(q, s)),
                               maximum(p, maximum(q, s))});
      }
    }
    for (std::uint32_t i = s_.seedBegin[r]; i < s_.seedBegin[r + 1]; ++i) {
      out_.points.push_back(supportPoint(s_.seeds[i]));
    }
    region.pieceEnd = static_cast<std::uint32_t>(out_.pieces.size());
    region.pointEnd = static_cast<std::uint32_t>(out_.points.size());
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
      const Piece& p = out_.pieces[i];
      s_.sums[r].add(p.mesh, p.vector, p.area, p.offset * p.area);
    }
  }

  static bool isFlat(const Adjacency::Cluster& c) {
    return otgDot(c.sum.vector, c.sum.vector) >= OTG_FLAT_CLUSTER * c.sum.area * c.sum.area;
  }

  /// Of a cluster that will be looked at vertex by vertex; they lie next to each other, or nearly so.
  static void prefetchStars(const Adjacency& adjacency, const Adjacency::Cluster& cluster) {
    if (isFlat(cluster)) return;
    const std::size_t first = adjacency.clusterVertices[cluster.first];
    const std::size_t end = std::min(first + Adjacency::kClusterSize, adjacency.star.size());
    for (std::size_t v = first; v < end; v += 2) __builtin_prefetch(&adjacency.star[v]);
  }

  /// The interior by the stars of its vertices, everything gathered in cells.
  void describeLarge(std::uint32_t r) {
    Region& region = out_.regions[r];
    region.pieceBegin = static_cast<std::uint32_t>(out_.pieces.size());
    region.pointBegin = static_cast<std::uint32_t>(out_.points.size());
    const SurfaceUnits units = surfaceUnits(s_.load[r], s_.largest[r], region);
    PieceCells& cells = s_.pieceCells;
    cells.begin(region, units);
    for (std::uint32_t i = s_.pieceBegin[r]; i < s_.pieceBegin[r + 1]; ++i) {
      const Piece& p = s_.pieces[i];
      cells.add(p.mesh, otgScale(otgAdd(p.lo, p.hi), 0.5), p.normal, PieceCells::ofTriangle(p.triangle), p.vector,
                p.area, p.offset * p.area, p.lo, p.hi);
    }
    for (std::uint32_t i = s_.patchBegin[r]; i < s_.patchBegin[r + 1]; ++i) {
      const int m = s_.patches[i].mesh;
      const Adjacency& adjacency = meshes_.adjacency(m);
      const InsideFlags::Patch& patch = inside_.patches[m][s_.patches[i].patch];
      const auto addVertex = [&](std::uint32_t v, const Vec3d& x) {
        const Vec3d vector = meshes_.directionFromLocal(m, adjacency.star[v].vector);
        cells.add(m, x, vector, PieceCells::ofVertex(v), vector, adjacency.star[v].area, otgDot(vector, x), x, x);
      };
      for (std::uint32_t k = patch.vertexBegin; k < patch.vertexEnd; ++k) {
        if (k + kAhead < patch.vertexEnd) __builtin_prefetch(&adjacency.star[inside_.vertices[m][k + kAhead]]);
        addVertex(inside_.vertices[m][k], relative(inside_.positions[m][k]));
      }
      const Vec3d shift = relative(meshes_.fromLocal(m, {0, 0, 0}));
      for (std::uint32_t k = patch.clusterBegin; k < patch.clusterEnd; ++k) {
        const std::uint32_t c = inside_.clusters[m][k];
        const Adjacency::Cluster& cluster = adjacency.clusters[c];
        if (k + 1 < patch.clusterEnd) prefetchStars(adjacency, adjacency.clusters[inside_.clusters[m][k + 1]]);
        if (!isFlat(cluster)) {
          for (std::uint32_t j = cluster.first; j < adjacency.clusters[c + 1].first; ++j) {
            addVertex(adjacency.clusterVertices[j], vertex(m, adjacency.clusterVertices[j]));
          }
          continue;
        }
        const Vec3d vector = meshes_.directionFromLocal(m, cluster.sum.vector);
        const PartBox box = boxOf(m, cluster);
        cells.add(m, otgScale(otgAdd(box.lo, box.hi), 0.5), vector,
                  PieceCells::ofVertex(adjacency.clusterVertices[cluster.first]), vector, cluster.sum.area,
                  cluster.moment + otgDot(vector, shift), box.lo, box.hi);
      }
    }
    for (std::uint32_t i = s_.correctionBegin[r]; i < s_.correctionBegin[r + 1]; ++i) {
      const Correction& c = s_.corrections[i];
      const Adjacency& adjacency = meshes_.adjacency(c.mesh);
      const Vec3d& x = c.position;
      cells.add(c.mesh, x, meshes_.directionFromLocal(c.mesh, adjacency.star[c.vertex].vector),
                PieceCells::ofTriangle(c.triangle), c.vector, c.area, otgDot(c.vector, x), x, x);
    }
    for (const PieceCells::Cell& cell : cells.cells()) {
      s_.sums[r].add(cell, units);
      addPieceOfCell(meshes_, cell, r, units, out_.pieces);
    }
    region.pieceEnd = static_cast<std::uint32_t>(out_.pieces.size());

    PointCells& points = s_.pointCells;
    points.begin(region, unit(otgSub(s_.sums[r].vector(1), s_.sums[r].vector(0))));
    region.cellBegin = static_cast<std::uint32_t>(out_.extents.cells.size());
    s_.positions.clear();
    for (std::uint32_t i = s_.patchBegin[r]; i < s_.patchBegin[r + 1]; ++i) {
      const int m = s_.patches[i].mesh;
      const Adjacency& adjacency = meshes_.adjacency(m);
      const InsideFlags::Patch& patch = inside_.patches[m][s_.patches[i].patch];
      for (std::uint32_t k = patch.vertexBegin; k < patch.vertexEnd; ++k) {
        const Vec3d x = relative(inside_.positions[m][k]);
        points.offer(vertexSeed(r, m, inside_.vertices[m][k], x));
        s_.positions.push_back(x);
      }
      for (std::uint32_t k = patch.clusterBegin; k < patch.clusterEnd; ++k) {
        const std::uint32_t c = inside_.clusters[m][k];
        const std::uint32_t begin = adjacency.clusters[c].first, end = adjacency.clusters[c + 1].first;
        const PartBox box = boxOf(m, adjacency.clusters[c]);
        out_.extents.cells.push_back({box.lo, box.hi, begin, end, m});
        points.offerDeepest(
            m, box.lo, box.hi, adjacency.clusters[c], end,
            [&](std::uint32_t j) { return vertex(m, adjacency.clusterVertices[j]); },
            [&](std::uint32_t j) { return adjacency.clusterVertices[j]; },
            [&](std::uint32_t j) { return isFlat(m, adjacency.clusterVertices[j]); },
            [&](std::uint32_t j) {
              return vertexSeed(r, m, adjacency.clusterVertices[j], vertex(m, adjacency.clusterVertices[j]));
            });
      }
    }
    for (std::uint32_t i = s_.seedBegin[r]; i < s_.seedBegin[r + 1]; ++i) {
      points.offer(s_.seeds[i]);
      if (s_.seeds[i].kind == PointKind::kCrossing) s_.positions.push_back(s_.seeds[i].position);
    }
    for (const PointCells::Chosen& c : points.chosen()) out_.points.push_back(supportPoint(c.seed));
    region.pointEnd = static_cast<std::uint32_t>(out_.points.size());
    addExtentCells(region, s_.positions, s_.cellScratch, out_.extents);
  }

  bool isFlat(int m, std::uint32_t v) const { return meshes_.adjacency(m).flatVertex[v] != 0; }

  PointSeed vertexSeed(std::uint32_t region, int m, std::uint32_t v, const Vec3d& x) const {
    return {x, {0, 0, 0}, region, v, 0, kNone, static_cast<std::uint8_t>(m), PointKind::kVertex, isFlat(m, v)};
  }

  /// The ends of the inside stretches of crossed edges that are crossings, and the stretches' middles where something
  /// can rest on them.
  void seedContourPoints() {
    s_.seeds.clear();
    for (int m = 0; m < 2; ++m) {
      const Adjacency& adjacency = meshes_.adjacency(m);
      for (const std::uint32_t edge : contour_.crossedEdges[m]) {
        std::uint32_t stretch = 0;
        for (const EdgePiece& piece : edges_.on(m, edge)) {
          const Vec3d d = otgSub(piece.to, piece.from);
          const std::uint32_t k = stretch++;
          const auto seed = [&](const Vec3d& at, const Vec3d& span, std::uint32_t c, PointKind kind,
                                std::uint32_t ordinal) {
            s_.seeds.push_back({at, span, s_.regionOf[piece.fromElement], edge, ordinal, c,
                                static_cast<std::uint8_t>(m), kind, adjacency.flatEdge[edge] != 0});
          };
          if (!piece.fromVertex) seed(piece.from, d, piece.fromElement, PointKind::kCrossing, 2 * k);
          if (!piece.toVertex) seed(piece.to, otgScale(d, -1.0), piece.toElement, PointKind::kCrossing, 2 * k + 1);
          if (adjacency.flatEdge[edge] || (piece.fromVertex && piece.toVertex)) continue;
          seed(otgScale(otgAdd(piece.from, piece.to), 0.5), otgScale(d, 0.5), kNone,
               piece.fromVertex || piece.toVertex ? PointKind::kMiddle : PointKind::kMiddleOfContour, k);
        }
      }
    }
    groupByRegion(s_.seeds, out_.regions.size(), s_.sortedSeeds, s_.seedBegin);
  }

  SupportPoint supportPoint(const PointSeed& seed) const { return otg::supportPoint(meshes_, contour_, seed); }

  void measure(std::uint32_t r) { s_.sums[r].measure(out_.regions[r]); }

  const PlacedMeshes& meshes_;
  const Contour& contour_;
  const InsideFlags& inside_;
  Scratch& s_;
  OverlapRegions& out_;
  EdgePieces edges_;
};

}  // namespace

RegionBuilder::RegionBuilder() : scratch_(std::make_unique<Scratch>()) {}
RegionBuilder::~RegionBuilder() = default;

void RegionBuilder::build(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside,
                          OverlapRegions& out) {
  build(meshes, contour, inside, contour.crossings.empty() ? Vec3d{0, 0, 0} : contour.crossings.front().point, out);
}

void RegionBuilder::build(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside,
                          const Vec3d& origin, OverlapRegions& out) {
  out.origin = origin;
  Builder<Scratch>(meshes, contour, inside, *scratch_, out).run();
}

}  // namespace otg
