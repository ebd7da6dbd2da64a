// SPDX-License-Identifier: BSD-3-Clause
// What the steps share by which the regions of one overlap are made. For regions.cpp and what it is made of.
#pragma once

#include <cstdint>
#include <vector>

#include "base/union_find.h"
#include "collide/solid/contour.h"
#include "collide/solid/edge_pieces.h"
#include "collide/solid/inside.h"
#include "collide/solid/region_cells.h"
#include "collide/solid/support_point.h"

namespace otg {

/// What is taken off the star of an inside vertex because one of its triangles is clipped.
struct RegionCorrection {
  std::uint32_t region, vertex, triangle;
  std::uint8_t mesh;
  Vec3d position;  ///< of the vertex, relative to the origin
  Vec3d vector;    ///< vector area
  double area;
};

struct RegionInsider {  // a vertex inside the other mesh
  std::uint32_t vertex;
  std::uint8_t mesh;
  Vec3d position;  ///< relative to the origin
};

struct RegionPatch {
  std::uint32_t region, patch;
  std::uint8_t mesh;
};

/// What bounds the part of one triangle in one region.
struct RegionLoop {
  std::uint32_t region;
  Vec3d sum{0, 0, 0};
  Vec3d lo, hi;
};

/// Memory that is kept from one overlap to the next.
struct RegionScratch {
  UnionFind sets;  ///< of elements
  std::vector<std::uint32_t> regionOf, load;
  std::vector<std::uint32_t> chordFrom;  ///< by crossing: the chord that starts there
  std::vector<std::uint8_t> leaves;      ///< by crossing: from there the contour leaves the triangle that is crossed
  EpochArray boundary[2];  ///< triangle -> index into boundaryTriangles, or kInterior once it has been taken
  std::vector<std::uint32_t> boundaryTriangles[2], chordHead[2], chordNext[2];
  std::vector<RegionLoop> loops;
  std::vector<Piece> pieces, sortedPieces;
  std::vector<RegionCorrection> corrections, sortedCorrections;
  std::vector<PointSeed> seeds, sortedSeeds;
  std::vector<RegionPatch> patches, sortedPatches;
  std::vector<RegionInsider> insiders;
  std::vector<std::uint32_t> pieceBegin, correctionBegin, seedBegin, patchBegin, cellScratch;
  std::vector<RegionSums> sums;
  std::vector<double> largest;  ///< by region: an area that none of its terms exceeds, or hardly
  std::vector<Vec3d> positions;
  EdgePieces::Storage edges;
  PieceCells pieceCells;
  PointCells pointCells;
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

/// In RegionScratch::boundary.
inline constexpr std::uint32_t kInterior = 0xfffffffeu;
/// How many items ahead memory is prefetched.
inline constexpr std::uint32_t kAhead = 8;

/// One overlap under work.
struct RegionWork {
  const PlacedMeshes& meshes;
  const Contour& contour;
  const InsideFlags& inside;
  RegionScratch& scratch;
  OverlapRegions& out;
  EdgePieces edges;

  Vec3d relative(const Vec3d& p) const { return edges.relative(p); }
  Vec3d crossing(std::uint32_t c) const { return edges.crossing(c); }
  Vec3d vertex(int m, std::uint32_t v) const { return edges.vertex(m, v); }
  bool isLarge(std::uint32_t region) const { return scratch.load[region] > kLargeRegion; }

  /// Calls fn(vertex, position relative to the origin) for every vertex of a patch.
  template <class Fn>
  void forEachVertex(int m, const InsideFlags::Patch& patch, const Fn& fn) const {
    for (std::uint32_t i = patch.vertexBegin; i < patch.vertexEnd; ++i) {
      fn(inside.vertices[m][i], relative(inside.positions[m][i]));
    }
    const Adjacency& adjacency = meshes.adjacency(m);
    for (std::uint32_t i = patch.clusterBegin; i < patch.clusterEnd; ++i) {
      const std::uint32_t c = inside.clusters[m][i];
      for (std::uint32_t k = adjacency.clusters[c].first; k < adjacency.clusters[c + 1].first; ++k) {
        fn(adjacency.clusterVertices[k], vertex(m, adjacency.clusterVertices[k]));
      }
    }
  }

  PartBox boxOf(int m, const Adjacency::Cluster& cluster) const { return boxOfCluster(meshes, m, cluster, out.origin); }

  bool isFlat(int m, std::uint32_t v) const { return meshes.adjacency(m).flatVertex[v] != 0; }

  PointSeed vertexSeed(std::uint32_t region, int m, std::uint32_t v, const Vec3d& x) const {
    return {x, {0, 0, 0}, region, v, 0, kNone, static_cast<std::uint8_t>(m), PointKind::kVertex, isFlat(m, v)};
  }
  SupportPoint pointOf(const PointSeed& seed) const { return supportPoint(meshes, contour, seed); }
};

}  // namespace otg
