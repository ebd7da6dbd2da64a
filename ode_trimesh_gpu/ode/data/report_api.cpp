// SPDX-License-Identifier: BSD-3-Clause
// The C API of validation reports.
#include "ode_trimesh_gpu/report.h"

#include <algorithm>

#include "ode/base/status.h"
#include "ode/data/mesh_data.h"

namespace otg {
namespace {

/// Counts of a mesh fit an int by its limits (edges: 3 * 2^28); those of a refused one are cut off there.
int toInt(std::size_t count) {
  return static_cast<int>(std::min<std::size_t>(count, 0x7fffffff));
}

struct KindName {
  int kind;
  ProblemKind internal;
};
/// The public numbers are fixed for ever; the internal ones need not be.
constexpr KindName kKinds[] = {
    {dGPUTRIMESH_PROBLEM_NULL_ARRAY, ProblemKind::kNullArray},
    {dGPUTRIMESH_PROBLEM_TOO_MANY_VERTICES, ProblemKind::kTooManyVertices},
    {dGPUTRIMESH_PROBLEM_TOO_MANY_TRIANGLES, ProblemKind::kTooManyTriangles},
    {dGPUTRIMESH_PROBLEM_INDEX_OUT_OF_RANGE, ProblemKind::kIndexOutOfRange},
    {dGPUTRIMESH_PROBLEM_NONFINITE_VERTEX, ProblemKind::kNonFiniteVertex},
    {dGPUTRIMESH_PROBLEM_EMPTY, ProblemKind::kEmpty},
    {dGPUTRIMESH_PROBLEM_DEGENERATE_TRIANGLE, ProblemKind::kDegenerateTriangle},
    {dGPUTRIMESH_PROBLEM_DUPLICATE_TRIANGLE, ProblemKind::kDuplicateTriangle},
    {dGPUTRIMESH_PROBLEM_BOUNDARY_EDGE, ProblemKind::kBoundaryEdge},
    {dGPUTRIMESH_PROBLEM_NON_MANIFOLD_EDGE, ProblemKind::kNonManifoldEdge},
    {dGPUTRIMESH_PROBLEM_NON_MANIFOLD_VERTEX, ProblemKind::kNonManifoldVertex},
    {dGPUTRIMESH_PROBLEM_INCONSISTENT_WINDING, ProblemKind::kInconsistentWinding},
    {dGPUTRIMESH_PROBLEM_INWARD_WINDING, ProblemKind::kInwardWinding},
    {dGPUTRIMESH_PROBLEM_EULER_MISMATCH, ProblemKind::kEulerMismatch},
    {dGPUTRIMESH_PROBLEM_UNUSED_VERTEX, ProblemKind::kUnusedVertex},
};

int publicKind(ProblemKind kind) {
  for (const KindName& name : kKinds) {
    if (name.internal == kind) return name.kind;
  }
  return -1;
}

}  // namespace
}  // namespace otg

void dGpuTriMeshReportInit(dGpuTriMeshReport* report) {
  if (report == nullptr) return;
  *report = dGpuTriMeshReport{};
  report->size = sizeof(dGpuTriMeshReport);
}

void dGpuTriMeshProblemInit(dGpuTriMeshProblem* problem) {
  if (problem == nullptr) return;
  *problem = dGpuTriMeshProblem{};
  problem->size = sizeof(dGpuTriMeshProblem);
}

const char* dGpuTriMeshProblemName(int kind) {
  for (const otg::KindName& name : otg::kKinds) {
    if (name.kind == kind) return otg::problemName(name.internal);
  }
  return "unknown problem";
}

int dGpuTriMeshDataGetReport(dGpuTriMeshDataID g, dGpuTriMeshReport* report) {
  using otg::toInt;
  if (!dxGpuTriMeshData::isLive(g) || !otg::isCurrentSize(report)) return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  const otg::ValidationReport& from = g->report();
  dGpuTriMeshReportInit(report);
  report->accepted = from.accepted;
  report->valid = from.valid();
  report->vertices = toInt(from.vertices);
  report->triangles = toInt(from.triangles);
  report->edges = toInt(from.edges);
  report->components = toInt(from.components);
  report->closed = from.closed;
  report->manifold = from.manifold;
  report->oriented = from.oriented;
  report->outward = from.outward;
  report->solid = from.solid;
  report->degenerate_triangles = toInt(from.degenerateTriangles);
  report->duplicate_triangles = toInt(from.duplicateTriangles);
  report->nonfinite_vertices = toInt(from.nonfiniteVertices);
  report->boundary_edges = toInt(from.boundaryEdges);
  report->non_manifold_edges = toInt(from.nonManifoldEdges);
  report->non_manifold_vertices = toInt(from.nonManifoldVertices);
  report->inconsistent_edges = toInt(from.inconsistentEdges);
  report->problem_count = toInt(from.problems.size());
  report->welded_vertices = toInt(from.repair.weldedVertices);
  report->dropped_degenerate = toInt(from.repair.droppedDegenerate);
  report->dropped_duplicates = toInt(from.repair.droppedDuplicates);
  report->flipped_triangles = toInt(from.repair.flippedTriangles);
  if (from.accepted && g->mesh() != nullptr) {
    report->volume = g->mesh()->mesh().massProperties().volume;
    report->area = g->mesh()->mesh().massProperties().area;
  }
  return dGPUTRIMESH_OK;
}

int dGpuTriMeshDataGetProblemCount(dGpuTriMeshDataID g) {
  return !dxGpuTriMeshData::isLive(g) ? 0 : otg::toInt(g->report().problems.size());
}

int dGpuTriMeshDataGetProblem(dGpuTriMeshDataID g, int Index, dGpuTriMeshProblem* problem) {
  if (!dxGpuTriMeshData::isLive(g) || !otg::isCurrentSize(problem) || Index < 0 ||
      Index >= dGpuTriMeshDataGetProblemCount(g)) {
    return otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
  }
  const otg::Problem& from = g->report().problems[static_cast<std::size_t>(Index)];
  static_assert(otg::Problem::kMaxElements <= dGPUTRIMESH_PROBLEM_ELEMENTS);
  dGpuTriMeshProblemInit(problem);
  problem->kind = otg::publicKind(from.kind);
  problem->count = otg::toInt(from.count);
  problem->element_count = otg::toInt(std::min<std::size_t>(from.elements.size(), dGPUTRIMESH_PROBLEM_ELEMENTS));
  for (int i = 0; i < problem->element_count; ++i) {
    problem->elements[i] = otg::toInt(from.elements[static_cast<std::size_t>(i)]);
  }
  problem->message = from.message.c_str();
  return dGPUTRIMESH_OK;
}

int dGpuTriMeshDataGetRepairCount(dGpuTriMeshDataID g) {
  return !dxGpuTriMeshData::isLive(g) ? 0 : otg::toInt(g->report().repair.messages.size());
}

const char* dGpuTriMeshDataGetRepair(dGpuTriMeshDataID g, int Index) {
  if (Index < 0 || Index >= dGpuTriMeshDataGetRepairCount(g)) {
    otg::noteStatus(dGPUTRIMESH_ERROR_ARGUMENT);
    return nullptr;
  }
  return g->report().repair.messages[static_cast<std::size_t>(Index)].c_str();
}

const char* dGpuTriMeshDataGetErrorString(dGpuTriMeshDataID g) {
  return !dxGpuTriMeshData::isLive(g) ? dGpuTriMeshErrorString(dGPUTRIMESH_ERROR_ARGUMENT) : g->report().error.c_str();
}
