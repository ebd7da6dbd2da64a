/* SPDX-License-Identifier: BSD-3-Clause */
/* Queries beside contacts: nearest points, points inside, distances, overlap, rays. */
#include "example.h"

int main(void) {
  const dVector3 points[3] = {{0, 0, 2, 0}, {0, 0, 0.1, 0}, {3, 0, 0, 0}};
  dGpuTriMeshClosestPoint nearest, several[3];
  dGpuTriMeshDistance apart, distances[2];
  dGpuTriMeshRay rays[2] = {{{0.1, 0.2, 3, 0}, {0, 0, -1, 0}, 10}, {{5, 0, 3, 0}, {0, 0, -1, 0}, 10}};
  dGpuTriMeshRayHit hits[2];
  dGpuTriMeshPair pairs[2];
  unsigned char inside[3], overlaps[2];
  dGpuTriMeshDataID data;
  dGeomID a, b, c;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  a = dCreateGpuTriMesh(0, data);
  b = dCreateGpuTriMesh(0, data);
  c = dCreateGpuTriMesh(0, data);
  dGeomSetPosition(b, 3, 0, 0);
  dGeomSetPosition(c, 0.5, 0, 0);

  EXPECT(dGeomGpuTriMeshClosestPoint(a, points[0], &nearest) == dGPUTRIMESH_OK);
  EXPECT(isNear(nearest.distance, 1.5) && isNear(nearest.pos[2], 0.5) && isNear(nearest.normal[2], 1));
  EXPECT(dGeomGpuTriMeshClosestPoints(a, points[0], sizeof points[0], 3, several) == dGPUTRIMESH_OK);
  EXPECT(isNear(several[1].distance, -0.4)); /* inside */
  EXPECT(dGeomGpuTriMeshPointsInside(a, points[0], sizeof points[0], 3, inside) == 1 && inside[1] == 1);

  EXPECT(dGpuTriMeshGetDistance(a, b, dInfinity, &apart) == dGPUTRIMESH_OK);
  EXPECT(isNear(apart.distance, 2) && isNear(apart.pos1[0], 0.5) && isNear(apart.pos2[0], 2.5));
  pairs[0].o1 = pairs[1].o1 = a;
  pairs[0].o2 = b;
  pairs[1].o2 = c;
  EXPECT(dGpuTriMeshGetDistances(pairs, 2, dInfinity, distances) == dGPUTRIMESH_OK && distances[1].distance == 0);
  EXPECT(dGpuTriMeshOverlap(a, c) == 1);
  EXPECT(dGpuTriMeshOverlaps(pairs, 2, overlaps) == 1 && !overlaps[0] && overlaps[1]);

  EXPECT(dGeomGpuTriMeshCastRays(a, rays, 2, dGPUTRIMESH_RAY_CULL_BACK, hits) == 1);
  EXPECT(isNear(hits[0].distance, 2.5) && hits[0].triangle >= 0 && hits[1].triangle == -1);
  printf("the boxes are %g apart\n", (double)apart.distance);

  dGeomDestroy(a);
  dGeomDestroy(b);
  dGeomDestroy(c);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
