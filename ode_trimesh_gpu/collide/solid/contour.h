// SPDX-License-Identifier: BSD-3-Clause
// The curves in which two surfaces cross: every crossing of an edge of one with a triangle of the other, and the chords
// that join them within pairs of triangles. Combinatorially exact (shared/tests/sos.h); coordinates are in double, in
// A's frame.
#pragma once

#include <cstdint>
#include <vector>

#include "base/epoch_array.h"
#include "collide/placed_meshes.h"
#include "collide/query.h"

namespace otg {

/// An edge of mesh `mesh` (0 = A, 1 = B) passes through a triangle of the other mesh.
struct Crossing {
  std::uint32_t edge, triangle;
  std::uint8_t mesh;
  bool exits;  ///< going from Topology::Edge::a to b leaves the other mesh here (else enters it)
  double t;    ///< where along the edge, 0 at a
  Vec3d point;
  Vec3d drift;  ///< change of t per unit of the symbolic translation of A: orders crossings at the same t
};

/// The part of a triangle pair's common line that lies in both: from crossing `start` to `end` in the direction in
/// which B's inside is to the left on A's triangle (seen from A's outside).
struct Chord {
  std::uint32_t triangleA, triangleB;
  std::uint32_t start, end;
};

struct Contour {
  std::vector<Crossing> crossings;
  std::vector<Chord> chords;
  /// For mesh m, crossed edge e: firstOn[m].find(e) is the position in `alongEdge` of its crossings, in order from a to
  /// b, alternately leaving and entering.
  EpochArray firstOn[2];
  std::vector<std::uint32_t> alongEdge;
  std::vector<std::uint32_t> crossedEdges[2];  ///< in the order in which they were met
  std::size_t anomalies = 0;  ///< pairs or edges whose crossings contradict (impossible for proper meshes)

  // Scratch: the last crossing that was met on an edge, and the one before each on its edge.
  EpochArray lastOn[2];
  std::vector<std::uint32_t> previousOn;

  /// Crossings on an edge as [begin, end) into alongEdge; empty when it is not crossed.
  struct Range {
    std::uint32_t begin, end;
  };
  Range on(int mesh, std::uint32_t edge) const;
  bool isCrossed(int mesh, std::uint32_t edge) const { return firstOn[mesh].has(edge); }
};

/// From the pairs in `intersecting` (which must hold every pair that touches).
void traceContour(const PlacedMeshes& meshes, const std::vector<TrianglePair>& intersecting, Contour& contour);

}  // namespace otg
