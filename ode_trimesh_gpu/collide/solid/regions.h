// SPDX-License-Identifier: BSD-3-Clause
// Connected overlap regions of two solids, with the clipped surface of either mesh inside the other: vector areas,
// volume, extent, and the places where a contact may sit.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/solid/contour.h"
#include "collide/solid/inside.h"

namespace otg {

/// The part of one triangle that lies inside the other mesh, within one region.
struct Piece {
  std::uint32_t region, triangle;
  std::uint8_t mesh;
  Vec3d normal;  ///< of the triangle, unit, outward
  double area;
  double offset;  ///< normal . x on the triangle's plane, relative to OverlapRegions::origin
  Vec3d lo, hi;   ///< bounds of the piece, relative to the origin
};

enum class PointKind : std::uint8_t { kVertex, kCrossing, kMiddle, kMiddleOfContour };

/// A place where a contact may sit.
struct SupportPoint {
  Vec3d position;       ///< relative to the origin
  Vec3d along;          ///< crossings: unit direction of the edge into the other mesh; else zero
  double reach;         ///< crossings: length of the inside stretch of the edge that starts here
  Vec3d surfaceNormal;  ///< mean outward normal of the faces at the vertex or edge, unit or zero
  std::uint32_t region;
  std::uint8_t mesh;  ///< whose vertex or edge it is
  PointKind kind;
  std::uint32_t feature;               ///< vertex or edge of that mesh
  std::uint32_t ordinal;               ///< as Contact::ordinal
  std::uint32_t triangleA, triangleB;  ///< triangles that it belongs to or kNone
};

struct Region {
  Vec3d push;  ///< sum over B's pieces minus sum over A's of their vector areas, halved: points out of B
  double areaA = 0, areaB = 0;  ///< sums of the pieces' areas
  double volume = 0;
  Vec3d lo, hi;  ///< bounds of its points, relative to the origin
  std::uint32_t pieceBegin = 0, pieceEnd = 0;
  std::uint32_t pointBegin = 0, pointEnd = 0;
  double coherence = 0;    ///< 1 for a flat patch, 0 when the pieces' areas cancel
  double diagonal = 0;     ///< of its bounds
  double thickness = 0;    ///< 2 volume / (areaA + areaB)
  bool bad = false;        ///< its surface does not close, or its volume is negative
  bool contained = false;  ///< a whole component inside the other mesh
};

struct OverlapRegions {
  Vec3d origin;  ///< in A's frame: keeps products of coordinates small
  std::vector<Region> regions;
  std::vector<Piece> pieces;         ///< grouped by region
  std::vector<SupportPoint> points;  ///< grouped by region
  std::size_t anomalies = 0;

  // Scratch.
  std::vector<std::uint32_t> parent, regionOf, chordNext[2];
  std::vector<std::uint32_t> active[2];
  FlatMap activeIndex[2];
  std::vector<std::uint32_t> chordHead[2];
};

void buildRegions(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, OverlapRegions& out);

}  // namespace otg
