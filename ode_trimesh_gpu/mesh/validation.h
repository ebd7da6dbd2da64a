// SPDX-License-Identifier: BSD-3-Clause
// What is right and wrong with a mesh, in numbers and in words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace otg {

enum class ProblemKind {
  kNullArray,            ///< refused
  kBadStride,            ///< refused: smaller than one element
  kVertexCountMismatch,  ///< refused by moveVertices: not as many vertices as the mesh was built from
  kTooManyVertices,      ///< refused: above kMaxVertices (topology.h)
  kTooManyTriangles,     ///< refused: above kMaxTriangles
  kIndexOutOfRange,      ///< refused; elements are triangles
  kNonFiniteVertex,      ///< refused (NaN, infinity, or a double beyond float); elements are vertices
  kEmpty,                ///< no triangles
  kDegenerateTriangle,   ///< all vertices exactly on a line; elements are triangles
  kDuplicateTriangle,    ///< the same three points as an earlier triangle, in any order; triangles
  kBoundaryEdge,         ///< used once; elements are triangles
  kNonManifoldEdge,      ///< used more than twice; elements are triangles
  kNonManifoldVertex,    ///< its triangles form more than one fan; elements are vertices
  kInconsistentWinding,  ///< two triangles use an edge in the same direction; elements are triangles
  kInwardWinding,        ///< a closed component that faces inward (a cavity: outward) or encloses nothing; components
  kEulerMismatch,        ///< E != 3F/2
  kUnusedVertex,         ///< no triangle uses it; elements are vertices; harmless
};

const char* problemName(ProblemKind kind);

struct Problem {
  static constexpr std::size_t kMaxElements = 8;
  ProblemKind kind;
  std::size_t count = 0;                ///< how many edges, triangles, ... have it; 1 for the mesh as a whole
  std::vector<std::uint32_t> elements;  ///< the first few, ascending
  std::string message;                  ///< one sentence with the numbers in it
};

/// What a repair changed, in the order in which it was done.
struct RepairReport {
  std::size_t weldedVertices = 0;
  std::size_t splitDegenerate = 0;  ///< replaced by splitting the neighbour over the longest edge: no hole is torn
  std::size_t droppedDegenerate = 0;
  std::size_t droppedDuplicates = 0;
  std::size_t flippedTriangles = 0;
  std::vector<std::string> messages;  ///< one sentence for each that did something
};

struct ValidationReport {
  bool accepted = false;  ///< a mesh was built
  std::string error;      ///< why not, empty when accepted
  std::size_t vertices = 0, triangles = 0, edges = 0, components = 0;
  bool closed = false;    ///< there are edges and every one of them is used exactly twice
  bool manifold = false;  ///< no edge used more than twice, one fan at every vertex
  bool oriented = false;  ///< neighbours wound the same way
  bool outward = false;   ///< there are closed components and all of them face outward (cavities inward)
  /// Has an inside: closed, oriented and outward, with a triangle at least. Also where edges are used more than twice,
  /// but surfaces that touch each other there can be taken apart (touching_edges.h). The rest tells of positions.
  bool solid = false;
  std::size_t degenerateTriangles = 0, duplicateTriangles = 0, nonfiniteVertices = 0;
  std::size_t boundaryEdges = 0, nonManifoldEdges = 0, nonManifoldVertices = 0, inconsistentEdges = 0;
  std::vector<Problem> problems;
  RepairReport repair;
  /// Accepted and nothing wrong with it (unused vertices aside).
  bool valid() const;
  /// No other edges than those of more than two triangles keep the mesh from being closed (touching_edges.h).
  bool mayTouchAlongEdges() const;
};

/// Appends a problem with `count` elements. `isElement(i)` says whether number i < size is one of them; the first few
/// that are get listed.
void addProblem(ValidationReport& report, ProblemKind kind, std::size_t count, std::string message,
                std::size_t size = 0, const std::function<bool(std::uint32_t)>& isElement = {});

}  // namespace otg
