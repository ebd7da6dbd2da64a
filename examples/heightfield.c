/* SPDX-License-Identifier: BSD-3-Clause */
/* Meshes on ODE's heightfields: data of each kind of sample, and data that other code has built. */
#include "example.h"

enum { kSamples = 5 };
static dReal flat(void* data, int x, int z) {
  (void)data, (void)x, (void)z;
  return 0;
}

/* How deep a box that lies 0.1 in the ground is found to be. */
static double depthIn(dHeightfieldDataID ground, dGeomID box) {
  dContactGeom contacts[16];
  double deepest = 0;
  const dGeomID field = dCreateHeightfield(0, ground, 0);
  int i;
  const int count = dCollide(box, field, 16, contacts, sizeof contacts[0]);
  for (i = 0; i < count; ++i) {
    if ((double)contacts[i].depth > deepest) deepest = (double)contacts[i].depth;
  }
  dGeomDestroy(field);
  return deepest;
}

int main(void) {
  static unsigned char bytes[kSamples * kSamples];
  static short shorts[kSamples * kSamples];
  static float floats[kSamples * kSamples];
  static double doubles[kSamples * kSamples];
  dGpuTriMeshHeightfield field;
  dGpuTriMeshDataID data;
  dHeightfieldDataID ground;
  dGeomID box;
  int kind;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  box = dCreateGpuTriMesh(0, data);
  dGeomSetPosition(box, 0.1, 0.4, 0.2); /* heights are along y */
  for (kind = 0; kind < 5; ++kind) {
    int status = dGPUTRIMESH_ERROR_ARGUMENT;
    ground = dGeomHeightfieldDataCreate();
    switch (kind) {
      case 0:
        status = dGpuTriMeshHeightfieldDataBuildCallback(ground, 0, &flat, 4, 4, kSamples, kSamples, 1, 0, 1, 0);
        break;
      case 1:
        status = dGpuTriMeshHeightfieldDataBuildByte(ground, bytes, 1, 4, 4, kSamples, kSamples, 1, 0, 1, 0);
        break;
      case 2:
        status = dGpuTriMeshHeightfieldDataBuildShort(ground, shorts, 1, 4, 4, kSamples, kSamples, 1, 0, 1, 0);
        break;
      case 3:
        status = dGpuTriMeshHeightfieldDataBuildSingle(ground, floats, 1, 4, 4, kSamples, kSamples, 1, 0, 1, 0);
        break;
      default:
        status = dGpuTriMeshHeightfieldDataBuildDouble(ground, doubles, 1, 4, 4, kSamples, kSamples, 1, 0, 1, 0);
        break;
    }
    EXPECT(status == dGPUTRIMESH_OK);
    EXPECT(isNear(depthIn(ground, box), 0.1));
    dGpuTriMeshHeightfieldDataDestroy(ground);
  }

  /* Data that ODE's own function builds: this describes them to the library. */
  ground = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildSingle(ground, floats, 0, 4, 4, kSamples, kSamples, 1, 0, 1, 0);
  dGpuTriMeshHeightfieldInit(&field);
  field.type = dGPUTRIMESH_HEIGHTS_SINGLE;
  field.heights = floats;
  field.width = field.depth = 4;
  field.width_samples = field.depth_samples = kSamples;
  field.thickness = 1;
  EXPECT(dGpuTriMeshHeightfieldDataDescribe(ground, &field) == dGPUTRIMESH_OK);
  printf("%g deep\n", depthIn(ground, box));
  EXPECT(isNear(depthIn(ground, box), 0.1));
  dGpuTriMeshHeightfieldDataForget(ground); /* before its end */
  dGeomHeightfieldDataDestroy(ground);

  dGeomDestroy(box);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
