/* SPDX-License-Identifier: BSD-3-Clause */
/* The public header in a C89 program that is linked with the shared library: it compiles, and what it promises happens.
 */
#include <ode/ode.h>
#include <stdio.h>

#include "ode_trimesh_gpu/ode_trimesh_gpu.h"

static const float kVertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const int kTriangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

int main(void) {
  dGpuTriMeshDataID data;
  dGeomID a, b;
  dContactGeom contacts[8];
  dGpuTriMeshParams params;
  dMass mass;
  int count;

  if (!dInitODE2(0)) return 1;
  dAllocateODEDataForThread(dAllocateMaskAll);
  if (!dGpuTriMeshInit()) {
    fprintf(stderr, "%s\n", dGpuTriMeshErrorString(dGpuTriMeshGetError()));
    return 1;
  }
  data = dGpuTriMeshDataCreate();
  if (dGpuTriMeshDataBuildSingle(data, kVertices, 12, 4, kTriangles, 12, 12) != dGPUTRIMESH_OK) return 1;
  a = dCreateGpuTriMesh(NULL, data);
  b = dCreateGpuTriMesh(NULL, data);
  dGpuTriMeshParamsInit(&params);
  params.max_contacts = 4;
  if (dGeomGpuTriMeshSetParams(a, &params) != dGPUTRIMESH_OK) return 1;
  dGeomSetPosition(b, 0.1, 0.2, 0.3);
  count = dCollide(a, b, 8, contacts, sizeof(dContactGeom));
  if (count < 1 || count > 4 || contacts[0].g1 != a || contacts[0].g2 != b) return 1;
  if (dMassSetGpuTriMesh(&mass, 6, a) != dGPUTRIMESH_OK || mass.mass < 0.999 || mass.mass > 1.001) return 1;
  dGpuTriMeshDataDestroy(data);
  dGeomDestroy(a);
  dGeomDestroy(b);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
