/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that keeps ODE's own dTriMesh: one line has its pairs collide through this library. */
#include "example.h"

int main(void) {
  dGpuTriMeshOverrideStats stats;
  dGpuTriMeshParams params;
  dContactGeom contacts[16];
  dTriMeshDataID data;
  dGeomID a, b, ball;
  EXPECT(dInitODE2(0));
  EXPECT(dGpuTriMeshOverrideTriMesh() == dGPUTRIMESH_OK);                 /* the line */
  EXPECT(dGpuTriMeshOverrideTriMeshWith(dSphereClass) == dGPUTRIMESH_OK); /* and one for pairs with dSphere */

  data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, kBoxVertices, sizeof kBoxVertices[0], 8, kBoxTriangles, 36,
                              sizeof kBoxTriangles[0]);
  a = dCreateTriMesh(0, data, 0, 0, 0);
  b = dCreateTriMesh(0, data, 0, 0, 0);
  dGeomSetPosition(b, 0, 0, 0.9);

  dGpuTriMeshParamsInit(&params);
  EXPECT(dGpuTriMeshOverrideGetParams(&params) == dGPUTRIMESH_OK);
  params.contacts_per_region = 4;
  EXPECT(dGpuTriMeshOverrideSetParams(&params) == dGPUTRIMESH_OK); /* of all dTriMesh geoms */
  EXPECT(dGpuTriMeshOverridePrepare(a) == dGPUTRIMESH_OK);         /* reads the mesh now, not at the first collision */
  EXPECT(dCollide(a, b, 16, contacts, sizeof contacts[0]) == 4 && isNear(contacts[0].depth, 0.1));

  dGpuTriMeshOverrideDataChanged(data); /* after dGeomTriMeshDataUpdate() with few vertices moved */
  dGpuTriMeshOverrideStatsInit(&stats);
  EXPECT(dGpuTriMeshOverrideGetStats(&stats) == dGPUTRIMESH_OK && stats.builds == 1 && stats.queries == 1);
  printf("%u contacts of dTriMesh geoms\n", (unsigned)stats.contacts);

  ball = dCreateSphere(0, 0.5);
  dGeomSetPosition(ball, 0, 0, -0.9);
  EXPECT(dCollide(a, ball, 16, contacts, sizeof contacts[0]) == 1 && isNear(contacts[0].depth, 0.1));
  dGeomDestroy(ball);

  dGpuTriMeshOverrideForgetGeom(a); /* frees what is kept, before their end */
  dGpuTriMeshOverrideForgetGeom(b);
  dGpuTriMeshOverrideForgetData(data);
  dGeomDestroy(a);
  dGeomDestroy(b);
  dGeomTriMeshDataDestroy(data);
  dCloseODE();
  return 0;
}
