// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_cells_build.h"

#include <algorithm>

#include "base/vectors.h"

namespace otg {
namespace {

class CellsBuilder {
 public:
  explicit CellsBuilder(RegionWork& work) : w_(work), s_(work.scratch) {}

  void run(std::uint32_t r) {
    Region& region = w_.out.regions[r];
    region.pieceBegin = static_cast<std::uint32_t>(w_.out.pieces.size());
    region.pointBegin = static_cast<std::uint32_t>(w_.out.points.size());
    addSurface(r);
    region.pieceEnd = static_cast<std::uint32_t>(w_.out.pieces.size());
    addPoints(r);
    region.pointEnd = static_cast<std::uint32_t>(w_.out.points.size());
    addExtentCells(region, s_.positions, s_.cellScratch, w_.out.extents);
  }

 private:
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

  /// The interior of one patch: its vertices, or whole clusters where these are flat.
  void addStars(const RegionPatch& ref, PieceCells& cells) const {
    const int m = ref.mesh;
    const Adjacency& adjacency = w_.meshes.adjacency(m);
    const InsideFlags::Patch& patch = w_.inside.patches[m][ref.patch];
    const auto addVertex = [&](std::uint32_t v, const Vec3d& x) {
      const Vec3d vector = w_.meshes.directionFromLocal(m, adjacency.star[v].vector);
      cells.add(m, x, vector, PieceCells::ofVertex(v), vector, adjacency.star[v].area, otgDot(vector, x), x, x);
    };
    for (std::uint32_t k = patch.vertexBegin; k < patch.vertexEnd; ++k) {
      if (k + kAhead < patch.vertexEnd) __builtin_prefetch(&adjacency.star[w_.inside.vertices[m][k + kAhead]]);
      addVertex(w_.inside.vertices[m][k], w_.relative(w_.inside.positions[m][k]));
    }
    const Vec3d shift = w_.relative(w_.meshes.fromLocal(m, {0, 0, 0}));
    for (std::uint32_t k = patch.clusterBegin; k < patch.clusterEnd; ++k) {
      const std::uint32_t c = w_.inside.clusters[m][k];
      const Adjacency::Cluster& cluster = adjacency.clusters[c];
      if (k + 1 < patch.clusterEnd) prefetchStars(adjacency, adjacency.clusters[w_.inside.clusters[m][k + 1]]);
      if (!isFlat(cluster)) {
        for (std::uint32_t j = cluster.first; j < adjacency.clusters[c + 1].first; ++j) {
          addVertex(adjacency.clusterVertices[j], w_.vertex(m, adjacency.clusterVertices[j]));
        }
        continue;
      }
      const Vec3d vector = w_.meshes.directionFromLocal(m, cluster.sum.vector);
      const PartBox box = w_.boxOf(m, cluster);
      cells.add(m, (box.lo + box.hi) * 0.5, vector, PieceCells::ofVertex(adjacency.clusterVertices[cluster.first]),
                vector, cluster.sum.area, cluster.moment + otgDot(vector, shift), box.lo, box.hi);
    }
  }

  void addSurface(std::uint32_t r) {
    const Region& region = w_.out.regions[r];
    const SurfaceUnits units = surfaceUnits(s_.load[r], s_.largest[r], region);
    PieceCells& cells = s_.pieceCells;
    cells.begin(region, units);
    for (std::uint32_t i = s_.pieceBegin[r]; i < s_.pieceBegin[r + 1]; ++i) {
      const Piece& p = s_.pieces[i];
      cells.add(p.mesh, (p.lo + p.hi) * 0.5, p.normal, PieceCells::ofTriangle(p.triangle), p.vector, p.area,
                p.offset * p.area, p.lo, p.hi);
    }
    for (std::uint32_t i = s_.patchBegin[r]; i < s_.patchBegin[r + 1]; ++i) addStars(s_.patches[i], cells);
    for (std::uint32_t i = s_.correctionBegin[r]; i < s_.correctionBegin[r + 1]; ++i) {
      const RegionCorrection& c = s_.corrections[i];
      const Adjacency& adjacency = w_.meshes.adjacency(c.mesh);
      const Vec3d& x = c.position;
      cells.add(c.mesh, x, w_.meshes.directionFromLocal(c.mesh, adjacency.star[c.vertex].vector),
                PieceCells::ofTriangle(c.triangle), c.vector, c.area, otgDot(c.vector, x), x, x);
    }
    for (const PieceCells::Cell& cell : cells.cells()) {
      s_.sums[r].add(cell, units);
      addPieceOfCell(w_.meshes, cell, r, units, w_.out.pieces);
    }
  }

  void offerVertices(std::uint32_t r, const RegionPatch& ref, PointCells& points) {
    const int m = ref.mesh;
    const Adjacency& adjacency = w_.meshes.adjacency(m);
    const InsideFlags::Patch& patch = w_.inside.patches[m][ref.patch];
    for (std::uint32_t k = patch.vertexBegin; k < patch.vertexEnd; ++k) {
      const Vec3d x = w_.relative(w_.inside.positions[m][k]);
      points.offer(w_.vertexSeed(r, m, w_.inside.vertices[m][k], x));
      s_.positions.push_back(x);
    }
    for (std::uint32_t k = patch.clusterBegin; k < patch.clusterEnd; ++k) {
      const std::uint32_t c = w_.inside.clusters[m][k];
      const std::uint32_t begin = adjacency.clusters[c].first, end = adjacency.clusters[c + 1].first;
      const PartBox box = w_.boxOf(m, adjacency.clusters[c]);
      w_.out.extents.cells.push_back({box.lo, box.hi, begin, end, m});
      points.offerDeepest(
          m, box.lo, box.hi, adjacency.clusters[c], end,
          [&](std::uint32_t j) { return w_.vertex(m, adjacency.clusterVertices[j]); },
          [&](std::uint32_t j) { return adjacency.clusterVertices[j]; },
          [&](std::uint32_t j) { return w_.isFlat(m, adjacency.clusterVertices[j]); },
          [&](std::uint32_t j) {
            return w_.vertexSeed(r, m, adjacency.clusterVertices[j], w_.vertex(m, adjacency.clusterVertices[j]));
          });
    }
  }

  void addPoints(std::uint32_t r) {
    Region& region = w_.out.regions[r];
    PointCells& points = s_.pointCells;
    points.begin(region, unit(s_.sums[r].vector(1) - s_.sums[r].vector(0)));
    region.cellBegin = static_cast<std::uint32_t>(w_.out.extents.cells.size());
    s_.positions.clear();
    for (std::uint32_t i = s_.patchBegin[r]; i < s_.patchBegin[r + 1]; ++i) offerVertices(r, s_.patches[i], points);
    for (std::uint32_t i = s_.seedBegin[r]; i < s_.seedBegin[r + 1]; ++i) {
      points.offer(s_.seeds[i]);
      if (s_.seeds[i].kind == PointKind::kCrossing) s_.positions.push_back(s_.seeds[i].position);
    }
    for (const PointCells::Chosen& c : points.chosen()) w_.out.points.push_back(w_.pointOf(c.seed));
  }

  RegionWork& w_;
  RegionScratch& s_;
};

}  // namespace

void describeByCells(RegionWork& work, std::uint32_t region) {
  CellsBuilder(work).run(region);
}

}  // namespace otg
