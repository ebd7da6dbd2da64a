/* SPDX-License-Identifier: BSD-3-Clause */
/* Mass of a mesh: by density or in all, of data or of a geom, and a body that carries it. */
#include "example.h"

int main(void) {
  dWorldID world;
  dBodyID body;
  dGpuTriMeshDataID data;
  dGeomID geom;
  dMass mass, box;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  geom = dCreateGpuTriMesh(0, data);
  dMassSetBox(&box, 1000, 1, 1, 1);

  EXPECT(dMassSetGpuTriMeshData(&mass, 1000, data) == dGPUTRIMESH_OK);
  EXPECT(fabs((double)(mass.mass - box.mass)) < 1e-3 && fabs((double)(mass.I[0] - box.I[0])) < 1e-3);
  EXPECT(dMassSetGpuTriMeshDataTotal(&mass, 5, data) == dGPUTRIMESH_OK && isNear(mass.mass, 5));
  EXPECT(dMassSetGpuTriMesh(&mass, 1000, geom) == dGPUTRIMESH_OK);
  EXPECT(dMassSetGpuTriMeshTotal(&mass, 5, geom) == dGPUTRIMESH_OK && isNear(mass.mass, 5));

  world = dWorldCreate();
  body = dBodyCreate(world);
  dMassTranslate(&mass, -mass.c[0], -mass.c[1], -mass.c[2]); /* bodies turn about their origin */
  dBodySetMass(body, &mass);
  dGeomSetBody(geom, body);
  printf("%g kg\n", (double)mass.mass);

  dGeomDestroy(geom);
  dGpuTriMeshDataDestroy(data);
  dWorldDestroy(world);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
