/* SPDX-License-Identifier: BSD-3-Clause */
/* What a geom has to set and to read: triangles, parameters, scale, where it was a step ago, coherence, statistics. */
#include "example.h"

int main(void) {
  dGpuTriMeshDataID data;
  dGeomID a, b;
  dVector3 v0, v1, v2, point, scale;
  dGpuTriMeshParams params, now;
  dGpuTriMeshStats stats;
  dContactGeom contacts[16];
  dReal last[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1}; /* columns of the rotation, position */
  int count;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  a = dCreateGpuTriMesh(0, data);
  b = dCreateGpuTriMesh(0, data);
  dGeomSetPosition(b, 0, 0, 0.9);

  /* Triangles have the numbers of your array, corners are in the world. */
  EXPECT(dGeomGpuTriMeshGetTriangleCount(b) == 12);
  EXPECT(dGeomGpuTriMeshGetTriangle(b, 0, &v0, &v1, &v2) == dGPUTRIMESH_OK);
  EXPECT(isNear(v0[2], 0.4) && isNear(v1[1], 0.5) && isNear(v2[0], 0.5));
  EXPECT(dGeomGpuTriMeshGetPoint(b, 0, 0.5, 0.5, point) == dGPUTRIMESH_OK);
  EXPECT(isNear(point[0], 0) && isNear(point[1], 0) && isNear(point[2], 0.4));
  EXPECT(dGeomGpuTriMeshGetTriangle(b, 12, &v0, &v1, &v2) == dGPUTRIMESH_ERROR_ARGUMENT);

  dGpuTriMeshParamsInit(&params);
  params.contacts_per_region = 4;
  EXPECT(dGeomGpuTriMeshSetParams(b, &params) == dGPUTRIMESH_OK);
  dGpuTriMeshParamsInit(&now);
  EXPECT(dGeomGpuTriMeshGetParams(b, &now) == dGPUTRIMESH_OK && now.contacts_per_region == 4);
  EXPECT(dGeomGpuTriMeshPrepare(b) == dGPUTRIMESH_OK); /* before the simulation starts, so that no step waits for it */
  count = dCollide(a, b, 16, contacts, sizeof contacts[0]);
  EXPECT(count == 4);

  EXPECT(dGeomGpuTriMeshSetScale(b, 2, 1, -1) == dGPUTRIMESH_OK); /* twice as long, and mirrored: faces outward still */
  EXPECT(dGeomGpuTriMeshGetScale(b, scale) == dGPUTRIMESH_OK && scale[0] == 2 && scale[2] == -1);
  EXPECT(dCollide(a, b, 16, contacts, sizeof contacts[0]) == 4 && isNear(contacts[0].depth, 0.1));

  /* For geoms that are moved by hand: the direction from which this one came. */
  EXPECT(dGeomGpuTriMeshSetLastTransform(b, last) == dGPUTRIMESH_OK);
  EXPECT(dGeomGpuTriMeshGetLastTransform(b)[14] == 2);

  EXPECT(dGeomGpuTriMeshEnableTC(b, dGpuTriMeshGetClass(), 1) == dGPUTRIMESH_OK);
  EXPECT(dGeomGpuTriMeshIsTCEnabled(b, dGpuTriMeshGetClass()) == 1);
  EXPECT(dGeomGpuTriMeshClearTCCache(b) == dGPUTRIMESH_OK); /* after it was put somewhere else */

  dGpuTriMeshStatsInit(&stats);
  EXPECT(dGeomGpuTriMeshGetStats(b, &stats) == dGPUTRIMESH_OK && stats.queries == 2 && stats.contacts == 8);
  printf("%u pairs of triangles intersect\n", (unsigned)stats.intersecting_pairs);
  EXPECT(dGeomGpuTriMeshResetStats(b) == dGPUTRIMESH_OK);

  dGeomDestroy(a);
  dGeomDestroy(b);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
