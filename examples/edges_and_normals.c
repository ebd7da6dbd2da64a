/* SPDX-License-Identifier: BSD-3-Clause */
/* What ODE calls additional and preprocessed data: normals of faces, angles of edges, edges to use. */
#include <string.h>

#include "example.h"

int main(void) {
  const dGpuTriMeshDataID data = makeBox();
  const unsigned char* flags;
  unsigned char mine[12], *buffer = 0;
  int length = 0;
  const dReal* normals;
  dsizeint size = 0;
  dReal angle = 0;
  EXPECT(dGpuTriMeshDataPreprocess(data) == 1);
  EXPECT(dGpuTriMeshDataPreprocess2(data, 1u << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES, 0) == 1);
  flags = (const unsigned char*)dGpuTriMeshDataGet2(data, dTRIMESHDATA_USE_FLAGS, &size);
  EXPECT(size == 12 && (flags[0] & dMESHDATAUSE_VERTEX1) != 0);
  memset(mine, dMESHDATAUSE_EDGE1, sizeof mine);
  EXPECT(dGpuTriMeshDataSet(data, dTRIMESHDATA_USE_FLAGS, mine) == dGPUTRIMESH_OK);
  flags = (const unsigned char*)dGpuTriMeshDataGet(data, dTRIMESHDATA_USE_FLAGS);
  EXPECT(flags[11] == dMESHDATAUSE_EDGE1);
  dGpuTriMeshDataSetBuffer(data, mine); /* by ODE's older names */
  dGpuTriMeshDataGetBuffer(data, &buffer, &length);
  EXPECT(length == 12 && buffer[11] == dMESHDATAUSE_EDGE1);
  normals = (const dReal*)dGpuTriMeshDataGet(data, dTRIMESHDATA_FACE_NORMALS);
  EXPECT(isNear(normals[2], -1)); /* the first triangle is of the bottom */
  EXPECT(dGpuTriMeshDataGetEdgeAngle(data, 0, 2, &angle) == dGPUTRIMESH_OK);
  printf("the surface turns by %g radians at the third edge of triangle 0\n", (double)angle);
  EXPECT(isNear(angle, 1.5707963267948966));
  dGpuTriMeshDataDestroy(data);
  return 0;
}
