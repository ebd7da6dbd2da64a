// SPDX-License-Identifier: BSD-3-Clause
// Connectivity of a triangle mesh whose vertices are welded by position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/array.h"
#include "base/shared_array.h"
#include "base/triangle.h"
#include "shared/math/vec3.h"

namespace otg {

inline constexpr std::uint32_t kNone = 0xffffffffu;
inline constexpr std::size_t kMaxVertices = std::size_t{1} << 28;
inline constexpr std::size_t kMaxTriangles = std::size_t{1} << 28;

/// Half-edge 3 t + k runs from corner k to corner (k + 1) % 3 of triangle t. All but the volumes depends only on which
/// vertices are one point. Meshes that differ in the places of their vertices alone share it.
struct Topology {
  /// Two vertices are one point of the surface exactly if their entries are equal. For each vertex this is the smallest
  /// one with the same position (-0 equals +0). In a mesh that touches itself it is each vertex (own_topology.h), or
  /// the smallest of the same surface (touching_edges.h).
  SharedArray<std::uint32_t> weld;
  /// For each half-edge its undirected edge, numbered from 0 in the order of first appearance.
  SharedArray<std::uint32_t> edgeOf;
  /// For each half-edge the oppositely directed half-edge of the neighbouring triangle. kNone where the edge is used
  /// once, more than twice, or twice in the same direction.
  SharedArray<std::uint32_t> twin;
  /// For each edge its two welded end points: first the one that has the vertex with the smallest caller's number.
  struct Edge {
    std::uint32_t a, b;
  };
  SharedArray<Edge> edges;
  /// For each triangle its connected component (through edges, however many triangles use them), numbered from 0 in the
  /// order of first appearance; kNone for a triangle that takes part in no edge.
  SharedArray<std::uint32_t> componentOf;
  /// For each component: closed and consistently wound (every half-edge has a twin).
  SharedArray<std::uint8_t> componentClosed;
  /// Signed volume of each component about the mesh's centre, in units cubed.
  Array<double> componentVolume;
  std::size_t edgeCount() const { return edges.size(); }
  std::size_t componentCount() const { return componentClosed.size(); }
};

/// Triangles whose corners are not all distinct points take part in no edge and no component (their half-edges get
/// edgeOf = kNone). Linear time, except for vertices with many edges, whose edges are sorted.
Topology buildTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles);
/// The same where other vertices are one point: as Topology::weld.
Topology buildTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                       std::vector<std::uint32_t>&& weld);
/// The same where each half-edge has a neighbour, `twin`. Edges are then pairs of these: two may have the same ends.
Topology buildTopology(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                       std::vector<std::uint32_t>&& weld, std::vector<std::uint32_t>&& twin);

/// Of the same triangles turned round, corners (a, b, c) to (a, c, b), with vertices in places that are equal where
/// they were equal: as buildTopology() makes it, but for the volumes, which are left empty.
Topology turnedTopology(const Topology& topology);

/// Turns edges as Topology::edges has them, where numbers are not the caller's: `callerVertex` of each vertex.
void orientEdges(Topology& topology, std::span<const std::uint32_t> callerVertex);

/// Mixes the bits of a position; equal positions (-0 equals +0) get equal hashes.
std::uint64_t hashPosition(const Vec3f& p);

/// Topology::weld alone.
std::vector<std::uint32_t> weldByPosition(std::span<const Vec3f> vertices);

/// Topology::componentVolume alone, about the given centre: for each component a BlockSum of the volumes between the
/// centre and its triangles, in their order.
std::vector<double> componentVolumes(const Topology& topology, std::span<const Vec3f> vertices,
                                     std::span<const Triangle> triangles, const Vec3f& center);

/// Six times the signed volume of the tetrahedron between a triangle and a point.
double volume6(std::span<const Vec3f> vertices, const Triangle& triangle, const Vec3f& center);

}  // namespace otg
