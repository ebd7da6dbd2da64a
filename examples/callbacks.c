/* SPDX-License-Identifier: BSD-3-Clause */
/* Callbacks: a program has its say about triangles, pairs of triangles and rays while two meshes collide. */
#include "example.h"

static int asked, listed, pairs;

/* What each triangle of the box is made of: the faces are two triangles each, in the order of kBoxTriangles. */
enum { kWood, kIce };
static const int materials[12] = {kWood, kWood, kIce, kIce, kWood, kWood, kWood, kWood, kWood, kWood, kWood, kWood};
static int notIce(dGeomID own, dGeomID other, int ownTriangle, int otherTriangle) {
  (void)own, (void)other, (void)otherTriangle;
  return materials[ownTriangle] != kIce; /* 0: this pair of triangles does not collide */
}

static int oneTriangle(dGeomID mesh, dGeomID other, int triangle) {
  (void)mesh, (void)other, (void)triangle;
  ++asked;
  return 1; /* it may collide */
}
static void allTriangles(dGeomID mesh, dGeomID other, const int* triangles, int count) {
  (void)mesh, (void)other, (void)triangles;
  listed = count;
}
static int twoTriangles(dGeomID own, dGeomID other, int ownTriangle, int otherTriangle) {
  (void)own, (void)other, (void)otherTriangle;
  ++pairs;
  return ownTriangle >= 0;
}
static int pass(dGeomID mesh, dGeomID ray, int triangle, dReal u, dReal v) {
  (void)mesh, (void)ray, (void)triangle, (void)u, (void)v;
  return 0; /* rays go through: glass */
}
static int smaller(dGeomID mesh, int first, int second) {
  (void)mesh;
  return first < second ? first : second;
}

int main(void) {
  dGpuTriMeshDataID data;
  dGeomID a, b, ray;
  dContactGeom contacts[16];
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  a = dCreateGpuTriMesh(0, data);
  b = dCreateGpuTriMesh(0, data);
  dGeomSetPosition(b, 0.2, 0.1, 0.9);

  EXPECT(dGeomGpuTriMeshSetCallback(a, &oneTriangle) == dGPUTRIMESH_OK);
  EXPECT(dGeomGpuTriMeshSetArrayCallback(a, &allTriangles) == dGPUTRIMESH_OK);
  EXPECT(dGeomGpuTriMeshSetPairCallback(a, &twoTriangles) == dGPUTRIMESH_OK);
  EXPECT(dGeomGpuTriMeshSetTriMergeCallback(a, &smaller) == dGPUTRIMESH_OK);
  EXPECT(dCollide(a, b, 16, contacts, sizeof contacts[0]) > 0);
  EXPECT(asked > 0 && listed > 0 && pairs > 0);
  printf("asked about %d triangles and %d pairs\n", asked, pairs);

  /* The other box lies on the top of a, which is ice. Contacts say which triangles they are of, so that a program can
     read the friction there; a pair callback that rejects the ice leaves no contact on it. */
  {
    dGeomID lid = dCreateGpuTriMesh(0, data);
    int i, count, onIce = 0;
    dGeomSetPosition(lid, 0.2, 0.1, 0.99);
    EXPECT(dGeomGpuTriMeshSetPairCallback(a, 0) == dGPUTRIMESH_OK);
    count = dCollide(a, lid, 16, contacts, sizeof contacts[0]);
    for (i = 0; i < count; ++i) onIce += materials[contacts[i].side1] == kIce;
    printf("%d of %d contacts are on ice\n", onIce, count);
    EXPECT(onIce > 0);
    EXPECT(dGeomGpuTriMeshSetPairCallback(a, &notIce) == dGPUTRIMESH_OK);
    count = dCollide(a, lid, 16, contacts, sizeof contacts[0]);
    for (i = 0; i < count; ++i) EXPECT(materials[contacts[i].side1] != kIce);
    EXPECT(dGeomGpuTriMeshSetPairCallback(a, &twoTriangles) == dGPUTRIMESH_OK);
    dGeomDestroy(lid);
  }

  ray = dCreateRay(0, 5);
  dGeomRaySet(ray, 0, 0, 3, 0, 0, -1);
  EXPECT(dCollide(ray, a, 1, contacts, sizeof contacts[0]) == 1);
  EXPECT(dGeomGpuTriMeshSetRayCallback(a, &pass) == dGPUTRIMESH_OK);
  EXPECT(dCollide(ray, a, 1, contacts, sizeof contacts[0]) == 0);

  EXPECT(dGeomGpuTriMeshGetCallback(a) == &oneTriangle && dGeomGpuTriMeshGetArrayCallback(a) == &allTriangles);
  EXPECT(dGeomGpuTriMeshGetPairCallback(a) == &twoTriangles && dGeomGpuTriMeshGetTriMergeCallback(a) == &smaller);
  EXPECT(dGeomGpuTriMeshGetRayCallback(a) == &pass);

  dGeomDestroy(a);
  dGeomDestroy(b);
  dGeomDestroy(ray);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
