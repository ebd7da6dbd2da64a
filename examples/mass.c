/* SPDX-License-Identifier: BSD-3-Clause */
/* Mass of a mesh: by density or in all, of data or of a geom, and a body that carries it. */
#include "example.h"

/* A box with edges of length 1 whose lowest corner is the mesh's origin. */
static dGpuTriMeshDataID makeBoxBesideOrigin(void) {
  float vertices[8][3];
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  int i, k;
  for (i = 0; i < 8; ++i) {
    for (k = 0; k < 3; ++k) vertices[i][k] = kBoxVertices[i][k] + 0.5f;
  }
  EXPECT(dGpuTriMeshDataBuildSingle(data, vertices, 0, 8, kBoxTriangles, kBoxIndexCount, 0) == dGPUTRIMESH_OK);
  return data;
}

int main(void) {
  dWorldID world;
  dBodyID body;
  dGpuTriMeshDataID data;
  dGeomID geom;
  dMass mass, box;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBoxBesideOrigin();
  geom = dCreateGpuTriMesh(0, data);
  dMassSetBox(&box, 1000, 1, 1, 1);

  EXPECT(dMassSetGpuTriMeshData(&mass, 1000, data) == dGPUTRIMESH_OK);
  EXPECT(fabs((double)(mass.mass - box.mass)) < 1e-3 && isNear(mass.c[0], 0.5) && isNear(mass.c[2], 0.5));
  EXPECT(dMassSetGpuTriMeshDataTotal(&mass, 5, data) == dGPUTRIMESH_OK && isNear(mass.mass, 5));
  EXPECT(dMassSetGpuTriMesh(&mass, 1000, geom) == dGPUTRIMESH_OK);
  EXPECT(dMassSetGpuTriMeshTotal(&mass, 5, geom) == dGPUTRIMESH_OK && isNear(mass.mass, 5));

  /* Bodies turn about their origin, so the centre of mass has to lie there: of the geom and of the dMass. */
  world = dWorldCreate();
  body = dBodyCreate(world);
  dGeomSetBody(geom, body);
  dGeomSetOffsetPosition(geom, -mass.c[0], -mass.c[1], -mass.c[2]);
  dMassTranslate(&mass, -mass.c[0], -mass.c[1], -mass.c[2]);
  dBodySetMass(body, &mass);
  EXPECT(isNear(mass.I[0], 5.0 / 6)); /* of a cube of 5 kg about its middle */

  /* From now on the geom gives the mass in the frame of its body. */
  EXPECT(dMassSetGpuTriMeshTotal(&mass, 5, geom) == dGPUTRIMESH_OK && isNear(mass.c[0], 0) && isNear(mass.c[2], 0));
  printf("%g kg\n", (double)mass.mass);

  dGeomDestroy(geom);
  dGpuTriMeshDataDestroy(data);
  dWorldDestroy(world);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
