// SPDX-License-Identifier: BSD-3-Clause
// The checks of an accepted mesh and the report about them.
#include "mesh/validation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "mesh/bounds.h"
#include "mesh/containment.h"
#include "mesh/inspection.h"
#include "mesh/union_find.h"

namespace otg {
namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// How each edge is used.
struct EdgeUse {
  std::vector<std::uint32_t> count;
  std::vector<std::uint8_t> sameDirection;  ///< used twice, both times in the same direction
};

EdgeUse countEdgeUses(const Topology& topology) {
  EdgeUse use{std::vector<std::uint32_t>(topology.edgeCount(), 0), std::vector<std::uint8_t>(topology.edgeCount(), 0)};
  for (const std::uint32_t e : topology.edgeOf)
    if (e != kNone) ++use.count[e];
  for (std::size_t h = 0; h < topology.edgeOf.size(); ++h) {
    const std::uint32_t e = topology.edgeOf[h];
    if (e != kNone && use.count[e] == 2 && topology.twin[h] == kNone) use.sameDirection[e] = 1;
  }
  return use;
}

/// One flag for each vertex that is the welded representative of a point where more than one fan of triangles meets. A
/// fan is a set of triangles around the point that hang together through edges at it, however many triangles use those.
std::vector<std::uint8_t> findNonManifoldVertices(std::span<const Triangle> triangles, const Topology& topology) {
  // Corner 3 t + k is the corner of triangle t at its k-th vertex. At each end of an edge its triangles' corners unite.
  UnionFind fans(3 * triangles.size());
  std::vector<std::uint32_t> firstUse(topology.edgeCount(), kNone);
  const auto start = [&](std::uint32_t h) { return topology.weld[triangles[h / 3].v[h % 3]]; };
  const auto nextCorner = [](std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
  for (std::uint32_t h = 0; h < topology.edgeOf.size(); ++h) {
    if (topology.edgeOf[h] == kNone) continue;
    std::uint32_t& first = firstUse[topology.edgeOf[h]];
    if (first == kNone) {
      first = h;
      continue;
    }
    const bool along = start(h) == start(first);
    fans.unite(h, along ? first : nextCorner(first));
    fans.unite(nextCorner(h), along ? nextCorner(first) : first);
  }
  std::vector<std::uint32_t> fanOf(topology.weld.size(), kNone);
  std::vector<std::uint8_t> nonManifold(topology.weld.size(), 0);
  for (std::uint32_t h = 0; h < topology.edgeOf.size(); ++h) {
    if (topology.edgeOf[h] == kNone || fans.find(h) != h) continue;
    const std::uint32_t v = start(h);
    if (fanOf[v] != kNone) nonManifold[v] = 1;
    fanOf[v] = h;
  }
  return nonManifold;
}

std::size_t countFlags(const std::vector<std::uint8_t>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

void reportEdges(const Topology& topology, std::size_t triangleCount, ValidationReport& report) {
  const EdgeUse use = countEdgeUses(topology);
  for (std::size_t e = 0; e < use.count.size(); ++e) {
    report.boundaryEdges += use.count[e] == 1;
    report.nonManifoldEdges += use.count[e] > 2;
    report.inconsistentEdges += use.sameDirection[e];
  }
  const auto anyEdge = [&](const std::function<bool(std::uint32_t)>& has) {
    return [&topology, has](std::uint32_t t) {
      for (std::uint32_t k = 0; k < 3; ++k)
        if (topology.edgeOf[3 * t + k] != kNone && has(topology.edgeOf[3 * t + k])) return true;
      return false;
    };
  };
  addProblem(
      report, ProblemKind::kBoundaryEdge, report.boundaryEdges,
      counted(report.boundaryEdges, "edge is", "edges are") + " used by one triangle only (the surface is open).",
      triangleCount, anyEdge([&](std::uint32_t e) { return use.count[e] == 1; }));
  addProblem(report, ProblemKind::kNonManifoldEdge, report.nonManifoldEdges,
             counted(report.nonManifoldEdges, "edge is", "edges are") + " used by more than two triangles.",
             triangleCount, anyEdge([&](std::uint32_t e) { return use.count[e] > 2; }));
  addProblem(report, ProblemKind::kInconsistentWinding, report.inconsistentEdges,
             counted(report.inconsistentEdges, "edge has", "edges have") +
                 " the same direction in both of its triangles (their windings disagree).",
             triangleCount, anyEdge([&](std::uint32_t e) { return use.sameDirection[e] != 0; }));
  if (2 * topology.edgeCount() != 3 * triangleCount) {
    addProblem(report, ProblemKind::kEulerMismatch, 1,
               "A closed manifold has E = 3F/2 edges; this mesh has E = " + std::to_string(topology.edgeCount()) +
                   " and F = " + std::to_string(triangleCount) + ".");
  }
}

void reportWinding(std::span<const Vec3f> vertices, std::span<const Triangle> triangles, const Topology& topology,
                   ValidationReport& report) {
  const std::size_t closedComponents = countFlags(topology.componentClosed);
  const auto well = componentsWellWound(topology, nestingDepths(topology, vertices, triangles), vertices, triangles);
  const std::size_t inward = closedComponents - countFlags(well);
  report.outward = closedComponents > 0 && inward == 0;
  addProblem(report, ProblemKind::kInwardWinding, inward,
             counted(inward, "closed component faces", "closed components face") +
                 " the wrong way (outer walls must face outward and cavities inward), or enclose no volume.",
             topology.componentCount(), [&](std::uint32_t c) { return topology.componentClosed[c] && !well[c]; });
}

}  // namespace

const char* problemName(ProblemKind kind) {
  switch (kind) {
    case ProblemKind::kNullArray:
      return "null_array";
    case ProblemKind::kBadStride:
      return "bad_stride";
    case ProblemKind::kVertexCountMismatch:
      return "vertex_count_mismatch";
    case ProblemKind::kTooManyVertices:
      return "too_many_vertices";
    case ProblemKind::kTooManyTriangles:
      return "too_many_triangles";
    case ProblemKind::kIndexOutOfRange:
      return "index_out_of_range";
    case ProblemKind::kNonFiniteVertex:
      return "nonfinite_vertex";
    case ProblemKind::kEmpty:
      return "empty";
    case ProblemKind::kDegenerateTriangle:
      return "degenerate_triangle";
    case ProblemKind::kDuplicateTriangle:
      return "duplicate_triangle";
    case ProblemKind::kBoundaryEdge:
      return "boundary_edge";
    case ProblemKind::kNonManifoldEdge:
      return "nonmanifold_edge";
    case ProblemKind::kNonManifoldVertex:
      return "nonmanifold_vertex";
    case ProblemKind::kInconsistentWinding:
      return "inconsistent_winding";
    case ProblemKind::kInwardWinding:
      return "inward_winding";
    case ProblemKind::kEulerMismatch:
      return "euler_mismatch";
    case ProblemKind::kUnusedVertex:
      return "unused_vertex";
  }
  return "unknown";
}

bool ValidationReport::valid() const {
  return accepted && std::all_of(problems.begin(), problems.end(),
                                 [](const Problem& p) { return p.kind == ProblemKind::kUnusedVertex; });
}

void addProblem(ValidationReport& report, ProblemKind kind, std::size_t count, std::string message, std::size_t size,
                const std::function<bool(std::uint32_t)>& isElement) {
  if (count == 0) return;
  Problem problem{kind, count, {}, std::move(message)};
  for (std::uint32_t i = 0; i < size && problem.elements.size() < std::min(count, Problem::kMaxElements); ++i)
    if (isElement(i)) problem.elements.push_back(i);
  report.problems.push_back(std::move(problem));
}

std::vector<std::uint8_t> findDegenerate(std::span<const Vec3f> vertices, std::span<const Triangle> triangles,
                                         const Vec3f& center) {
  constexpr double kUnit = 0x1p-24;
  const Vec3d origin{center.x, center.y, center.z};
  std::vector<std::uint8_t> degenerate(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t(&v)[3] = triangles[t].v;
    const Vec3d p[3] = {relativeTo(vertices[v[0]], origin), relativeTo(vertices[v[1]], origin),
                        relativeTo(vertices[v[2]], origin)};
    const Vec3d e[3] = {otgSub(p[1], p[0]), otgSub(p[2], p[1]), otgSub(p[0], p[2])};
    double largest = 0;
    for (const Vec3d& q : p) largest = std::max({largest, std::abs(q.x), std::abs(q.y), std::abs(q.z)});
    const double length2[3] = {otgDot(e[0], e[0]), otgDot(e[1], e[1]), otgDot(e[2], e[2])};
    // Height times longest edge. Rounding in double makes it wrong by less than 2^-48 m times the edge, so a triangle
    // that is exactly on a line stays far below the limit and needs no exact arithmetic.
    const Vec3d n = otgCross(e[0], e[1]);
    const double limit = 4 * kUnit * largest;
    degenerate[t] = vertices[v[0]] == vertices[v[1]] || vertices[v[1]] == vertices[v[2]] ||
                    vertices[v[2]] == vertices[v[0]] ||
                    otgDot(n, n) <= limit * limit * std::max({length2[0], length2[1], length2[2]});
  }
  return degenerate;
}

std::vector<std::uint8_t> findDuplicates(const std::vector<std::uint32_t>& weld, std::span<const Triangle> triangles) {
  const auto points = [&](std::uint32_t t) {
    std::array<std::uint32_t, 3> p = {weld[triangles[t].v[0]], weld[triangles[t].v[1]], weld[triangles[t].v[2]]};
    if (p[0] > p[1]) std::swap(p[0], p[1]);
    if (p[1] > p[2]) std::swap(p[1], p[2]);
    if (p[0] > p[1]) std::swap(p[0], p[1]);
    return p;
  };
  std::vector<std::uint8_t> duplicate(triangles.size(), 0);
  const std::size_t capacity = std::bit_ceil(std::max<std::size_t>(16, 2 * triangles.size()));
  std::vector<std::uint32_t> table(capacity, kNone);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto p = points(t);
    std::uint64_t h = (p[0] | (std::uint64_t{p[1]} << 32)) * 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 32) ^ p[2]) * 0xd6e8feb86659fd93ull;
    std::size_t slot = (h ^ (h >> 32)) & (capacity - 1);
    while (table[slot] != kNone && points(table[slot]) != p) slot = (slot + 1) & (capacity - 1);
    if (table[slot] == kNone)
      table[slot] = t;
    else
      duplicate[t] = 1;
  }
  return duplicate;
}

void inspectMesh(std::span<const Vec3f> vertices, std::span<const Triangle> triangles, const Topology& topology,
                 const std::vector<std::uint8_t>& degenerate, ValidationReport& report) {
  report.accepted = true;
  report.vertices = vertices.size();
  report.triangles = triangles.size();
  report.edges = topology.edgeCount();
  report.components = topology.componentCount();

  if (triangles.empty()) addProblem(report, ProblemKind::kEmpty, 1, "The mesh has no triangles.");

  report.degenerateTriangles = countFlags(degenerate);
  addProblem(report, ProblemKind::kDegenerateTriangle, report.degenerateTriangles,
             counted(report.degenerateTriangles, "triangle has", "triangles have") +
                 " no area (all vertices on a line, to within rounding).",
             triangles.size(), [&](std::uint32_t t) { return degenerate[t] != 0; });

  const auto duplicate = findDuplicates(topology.weld, triangles);
  report.duplicateTriangles = countFlags(duplicate);
  addProblem(report, ProblemKind::kDuplicateTriangle, report.duplicateTriangles,
             counted(report.duplicateTriangles, "triangle has", "triangles have") +
                 " the same three points as an earlier one.",
             triangles.size(), [&](std::uint32_t t) { return duplicate[t] != 0; });

  reportEdges(topology, triangles.size(), report);

  const auto nonManifold = findNonManifoldVertices(triangles, topology);
  report.nonManifoldVertices = countFlags(nonManifold);
  addProblem(report, ProblemKind::kNonManifoldVertex, report.nonManifoldVertices,
             counted(report.nonManifoldVertices, "vertex has", "vertices have") + " more than one fan of triangles.",
             vertices.size(), [&](std::uint32_t v) { return nonManifold[v] != 0; });

  report.closed = report.edges > 0 && report.boundaryEdges == 0 && report.nonManifoldEdges == 0;
  report.manifold = report.nonManifoldEdges == 0 && report.nonManifoldVertices == 0;
  report.oriented = report.inconsistentEdges == 0;
  reportWinding(vertices, triangles, topology, report);
  report.solid = report.closed && report.oriented && report.outward;

  std::vector<std::uint8_t> unused(vertices.size(), 1);
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t v : triangle.v) unused[v] = 0;
  const std::size_t unusedCount = countFlags(unused);
  addProblem(report, ProblemKind::kUnusedVertex, unusedCount,
             counted(unusedCount, "vertex is", "vertices are") + " used by no triangle.", vertices.size(),
             [&](std::uint32_t v) { return unused[v] != 0; });
}

}  // namespace otg
