/* SPDX-License-Identifier: BSD-3-Clause */
/* A mesh that deforms: a sheet with a wave running over it carries a box. Whole updates, and updates of some vertices,
 * whose cost follows how many these are. */
#include <string.h>

#include "example.h"

enum { kSide = 40, kCount = kSide * kSide, kTriangles = 2 * (kSide - 1) * (kSide - 1) };
static float vertices[kCount][3];
static unsigned triangles[kTriangles][3];

static float height(int i, double time) {
  return (float)(0.05 * sin(0.5 * i - time));
}

static void makeSheet(void) {
  int i, j, n = 0;
  for (i = 0; i < kSide; ++i) {
    for (j = 0; j < kSide; ++j) {
      float* v = vertices[i * kSide + j];
      v[0] = (float)(0.1 * (i - kSide / 2)), v[1] = (float)(0.1 * (j - kSide / 2)), v[2] = height(i, 0);
      if (i + 1 == kSide || j + 1 == kSide) continue;
      triangles[n][0] = triangles[n + 1][0] = (unsigned)(i * kSide + j);
      triangles[n][1] = (unsigned)((i + 1) * kSide + j);
      triangles[n][2] = triangles[n + 1][1] = (unsigned)((i + 1) * kSide + j + 1);
      triangles[n + 1][2] = (unsigned)(i * kSide + j + 1);
      n += 2;
    }
  }
}

int main(void) {
  dContactGeom contacts[32];
  dVector3 simple[kCount];
  double doubles[kCount][3];
  dGpuTriMeshDataID sheetData, boxData;
  dGeomID sheet, box;
  int step, i, k;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  makeSheet();
  sheetData = dGpuTriMeshDataCreate();
  EXPECT(dGpuTriMeshDataBuildSingle(sheetData, vertices, 0, kCount, triangles, 3 * kTriangles, 0) == dGPUTRIMESH_OK);
  boxData = makeBox();
  sheet = dCreateGpuTriMesh(0, sheetData);
  box = dCreateGpuTriMesh(0, boxData);
  dGeomSetPosition(box, 0, 0, 0.53);

  for (step = 1; step <= 20; ++step) {
    /* A range: the rows of the middle follow the wave. Numbers are those of the arrays that were built from. */
    const int first = 10 * kSide, count = 20 * kSide;
    for (i = first; i < first + count; ++i) vertices[i][2] = height(i / kSide, 0.2 * step);
    EXPECT(dGpuTriMeshDataUpdateRangeSingle(sheetData, vertices[first], 0, first, count) == dGPUTRIMESH_OK);
    EXPECT(dCollide(sheet, box, 32, contacts, sizeof contacts[0]) > 0);
  }

  { /* A list: a dent of four vertices, wherever they are. */
    static const int numbers[4] = {820, 821, 860, 861};
    float places[4][3];
    double finer[4][3];
    for (i = 0; i < 4; ++i) {
      memcpy(places[i], vertices[numbers[i]], sizeof places[i]);
      places[i][2] -= 0.1f;
      for (k = 0; k < 3; ++k) finer[i][k] = (double)places[i][k];
    }
    EXPECT(dGpuTriMeshDataUpdateListSingle(sheetData, places, 0, numbers, 4) == dGPUTRIMESH_OK);
    EXPECT(dGpuTriMeshDataUpdateListDouble(sheetData, finer, 0, numbers, 4) == dGPUTRIMESH_OK);
    EXPECT(dGpuTriMeshDataUpdateRangeDouble(sheetData, finer, 0, numbers[0], 2) == dGPUTRIMESH_OK);
  }

  /* All vertices at once, in the types that meshes are built from. */
  for (i = 0; i < kCount; ++i) {
    vertices[i][2] = height(i / kSide, 0);
    for (k = 0; k < 3; ++k) {
      doubles[i][k] = (double)vertices[i][k];
      simple[i][k] = (dReal)vertices[i][k];
    }
    simple[i][3] = 0;
  }
  EXPECT(dGpuTriMeshDataUpdateVerticesSingle(sheetData, vertices, 0, kCount) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataUpdateVerticesDouble(sheetData, doubles, 0, kCount) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataUpdate(sheetData, simple[0], kCount) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataUpdateVerticesSingle(sheetData, vertices, 0, kCount - 1) == dGPUTRIMESH_ERROR_MESH);
  printf("the box has %d contacts with the sheet\n", dCollide(sheet, box, 32, contacts, sizeof contacts[0]));

  dGeomDestroy(sheet);
  dGeomDestroy(box);
  dGpuTriMeshDataDestroy(sheetData);
  dGpuTriMeshDataDestroy(boxData);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
