// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/report_mesh.h"

#include <algorithm>
#include <functional>
#include <string>

#include "mesh/containment.h"
#include "mesh/inspection.h"

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

std::size_t countFlags(std::span<const std::uint8_t> flags) {
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
                 " the wrong way (outer walls must face outward and cavities inward), or " +
                 (inward == 1 ? "encloses" : "enclose") + " no volume.",
             topology.componentCount(), [&](std::uint32_t c) { return topology.componentClosed[c] && !well[c]; });
}

}  // namespace

void inspectMesh(std::span<const Vec3f> vertices, std::span<const Triangle> triangles, const Topology& topology,
                 std::span<const std::uint8_t> degenerate, ValidationReport& report) {
  report.accepted = true;
  report.vertices = vertices.size();
  report.triangles = triangles.size();
  report.edges = topology.edgeCount();
  report.components = topology.componentCount();

  if (triangles.empty()) addProblem(report, ProblemKind::kEmpty, 1, "The mesh has no triangles.");

  report.degenerateTriangles = countFlags(degenerate);
  addProblem(
      report, ProblemKind::kDegenerateTriangle, report.degenerateTriangles,
      counted(report.degenerateTriangles, "triangle has", "triangles have") + " no area (all vertices on a line).",
      triangles.size(), [&](std::uint32_t t) { return degenerate[t] != 0; });

  const auto duplicate = findDuplicates(topology, triangles);
  report.duplicateTriangles = countFlags(duplicate);
  addProblem(report, ProblemKind::kDuplicateTriangle, report.duplicateTriangles,
             counted(report.duplicateTriangles, "triangle has", "triangles have") +
                 " the same three points as an earlier one.",
             triangles.size(), [&](std::uint32_t t) { return duplicate[t] != 0; });

  reportEdges(topology, triangles.size(), report);

  const auto nonManifold = findNonManifoldVertices(topology, triangles);
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
