// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/validation.h"

#include <algorithm>
#include <utility>

namespace otg {

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

bool ValidationReport::mayTouchAlongEdges() const {
  return nonManifoldEdges > 0 && boundaryEdges == 0 && inconsistentEdges == 0;
}

void addProblem(ValidationReport& report, ProblemKind kind, std::size_t count, std::string message, std::size_t size,
                const std::function<bool(std::uint32_t)>& isElement) {
  if (count == 0) return;
  Problem problem{kind, count, {}, std::move(message)};
  for (std::uint32_t i = 0; i < size && problem.elements.size() < Problem::kMaxElements; ++i)
    if (isElement(i)) problem.elements.push_back(i);
  report.problems.push_back(std::move(problem));
}

}  // namespace otg
