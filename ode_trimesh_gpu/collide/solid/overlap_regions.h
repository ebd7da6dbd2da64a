// SPDX-License-Identifier: BSD-3-Clause
// Connected overlap regions of two solids, with the clipped surface of either mesh inside the other: vector areas,
// volume, extent, and the places where a contact may sit.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "collide/query.h"
#include "shared/contacts/solid_model.h"

namespace otg {

/// The part of one triangle that lies inside the other mesh, within one region; in large regions all such parts of one
/// mesh that lie in one cell and face the same way.
struct Piece {
  std::uint32_t region, triangle;  ///< of several triangles: one of them
  std::uint8_t mesh;
  Vec3d normal;   ///< unit, outward: of the triangle, or the mean
  Vec3d vector;   ///< vector area: sum of normal x area
  double area;    ///< sum of areas
  double offset;  ///< normal . x on the plane of the triangle (of several: the mean plane), relative to the origin
  Vec3d lo, hi;   ///< bounds, relative to OverlapRegions::origin
};

enum class PointKind : std::uint8_t { kVertex, kCrossing, kMiddle, kMiddleOfContour };

/// A place where a contact may sit.
struct SupportPoint {
  Vec3d position;       ///< relative to the origin
  Vec3d along;          ///< crossings: unit direction of the edge into the other mesh; middles: of the edge; else zero
  double reach;         ///< length of the inside stretch of the edge from here (middles: to either end), else 0
  Vec3d surfaceNormal;  ///< mean outward normal of the faces at the vertex or edge, unit or zero
  Vec3d faceNormal;     ///< crossings: outward normal of the other mesh's face there, unit; else zero
  std::uint32_t region;
  std::uint8_t mesh;  ///< whose vertex or edge it is
  PointKind kind;
  bool flat;                           ///< in the middle of a flat face or straight edge: due to the tessellation alone
  std::uint32_t feature;               ///< vertex or edge of that mesh
  std::uint32_t rank;                  ///< settles ties: the first half-edge at the feature, as the caller numbers them
  std::uint32_t ordinal;               ///< as Contact::ordinal
  std::uint32_t triangleA, triangleB;  ///< triangles that it belongs to or kNone
};

struct Region {
  Vec3d push;  ///< sum over B's pieces minus sum over A's of their vector areas, halved: points out of B
  double areaA = 0, areaB = 0;  ///< sums of the pieces' areas
  double volume = 0;
  Vec3d lo, hi;                             ///< bounds of its points, relative to the origin
  std::uint64_t first = ~std::uint64_t{0};  ///< its smallest chord: A's triangle << 32 | B's
  std::uint32_t pieceBegin = 0, pieceEnd = 0;
  std::uint32_t pointBegin = 0, pointEnd = 0;
  std::uint32_t cellBegin = 0, cellEnd = 0;  ///< into ExtentCells; none if the points give the extent
  double coherence = 0;                      ///< 1 for a flat patch, 0 when the pieces' areas cancel
  double diagonal = 0;                       ///< of its bounds
  double thickness = 0;                      ///< 2 volume / (areaA + areaB)
  bool bad = false;                          ///< its surface does not close, or its volume is negative
  bool contained = false;                    ///< a whole component inside the other mesh
  bool roundCorner = false;                  ///< an edge of an inner corner ends in it: it goes round that
  bool apart = false;                        ///< large, but described by its single triangles
};

/// All crossings and inside vertices of large regions, gathered in boxes: the extent along a direction is found exactly
/// without a look at most of them.
struct ExtentCells {
  struct Cell {
    Vec3d lo, hi;
    std::uint32_t begin, end;  ///< into positions, or into the mesh's Adjacency::clusterVertices
    int mesh;                  ///< of the vertices; -1: positions
  };
  std::vector<Cell> cells;
  std::vector<Vec3d> positions;  ///< relative to the origin
  const Query* query = nullptr;  ///< places the vertices
};

struct OverlapRegions {
  Vec3d origin;  ///< in A's frame: keeps products of coordinates small
  std::vector<Region> regions;
  std::vector<Piece> pieces;         ///< grouped by region
  std::vector<SupportPoint> points;  ///< grouped by region
  ExtentCells extents;
  std::size_t anomalies = 0;
  /// For what is made while one region's contacts are; reset between regions.
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
};

/// Regions of more vertices and clipped triangles than this are described by cells.
inline constexpr std::uint32_t kLargeRegion = OTG_SOLID_LARGE_REGION;

}  // namespace otg
