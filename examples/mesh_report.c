/* SPDX-License-Identifier: BSD-3-Clause */
/* What validation says of a mesh, and repair: a box with a hole, a triangle without area and a vertex too many. */
#include <string.h>

#include "example.h"

int main(void) {
  float vertices[10][3];
  unsigned triangles[12][3];
  dGpuTriMeshReport report;
  dGpuTriMeshProblem problem;
  dGpuTriMeshBuildParams params;
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  int i;
  memcpy(vertices, kBoxVertices, sizeof kBoxVertices);
  memcpy(vertices[8], kBoxVertices[0], sizeof vertices[8]); /* the same place as vertex 0 */
  memcpy(vertices[9], kBoxVertices[1], sizeof vertices[9]);
  memcpy(triangles, kBoxTriangles, sizeof triangles);
  triangles[0][0] = 8;
  triangles[11][0] = 1, triangles[11][1] = 9, triangles[11][2] = 5; /* two corners at one place */

  EXPECT(dGpuTriMeshDataBuildSingle(data, vertices, 0, 10, triangles, 36, 0) == dGPUTRIMESH_OK);
  dGpuTriMeshReportInit(&report);
  EXPECT(dGpuTriMeshDataGetReport(data, &report) == dGPUTRIMESH_OK);
  EXPECT(report.accepted && !report.solid && report.degenerate_triangles == 1 && report.boundary_edges == 3);
  EXPECT(report.problem_count == dGpuTriMeshDataGetProblemCount(data));
  for (i = 0; i < report.problem_count; ++i) {
    dGpuTriMeshProblemInit(&problem);
    EXPECT(dGpuTriMeshDataGetProblem(data, i, &problem) == dGPUTRIMESH_OK);
    printf("%s, first at %d: %s\n", dGpuTriMeshProblemName(problem.kind),
           problem.element_count > 0 ? problem.elements[0] : -1, problem.message);
  }
  EXPECT(strlen(dGpuTriMeshDataGetErrorString(data)) == 0); /* accepted */

  dGpuTriMeshBuildParamsInit(&params);
  params.vertices = vertices;
  params.vertex_count = 10;
  params.indices = triangles;
  params.index_count = 36;
  params.repair = dGPUTRIMESH_REPAIR_WELD | dGPUTRIMESH_REPAIR_DROP_DEGENERATE;
  EXPECT(dGpuTriMeshDataBuild(data, &params) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataGetRepairCount(data) >= 1);
  for (i = 0; i < dGpuTriMeshDataGetRepairCount(data); ++i) printf("%s\n", dGpuTriMeshDataGetRepair(data, i));
  EXPECT(dGpuTriMeshDataGetReport(data, &report) == dGPUTRIMESH_OK);
  EXPECT(report.welded_vertices == 2 && report.triangles == 11);
  dGpuTriMeshDataDestroy(data);
  return 0;
}
