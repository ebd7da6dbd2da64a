/* SPDX-License-Identifier: BSD-3-Clause */
/* Saving: a mesh with its tree as bytes and as a file, and what pairs of geoms remember from step to step. */
#include <string.h>

#include "example.h"

int main(int argc, char** argv) {
  const char* const path = argc > 1 ? argv[1] : "example_saving.otg";
  dContactGeom contacts[16];
  dGpuTriMeshDataID data, other;
  dGeomID geoms[2];
  dsizeint size;
  void* bytes;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  other = dGpuTriMeshDataCreate();

  size = dGpuTriMeshDataCook(data, 0, 0); /* how many bytes are needed */
  bytes = malloc(size);
  EXPECT(size > 0 && bytes != 0 && dGpuTriMeshDataCook(data, bytes, size) == size);
  EXPECT(dGpuTriMeshDataUncook(other, bytes, size) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataUncook(other, bytes, size - 1) == dGPUTRIMESH_ERROR_COOKED); /* keeps the mesh it had */
  printf("%s\n", dGpuTriMeshDataGetErrorString(other));
  free(bytes);
  EXPECT(dGpuTriMeshDataSave(data, path) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataLoad(other, path) == dGPUTRIMESH_OK);
  remove(path);

  geoms[0] = dCreateGpuTriMesh(0, data);
  geoms[1] = dCreateGpuTriMesh(0, other);
  dGeomSetPosition(geoms[1], 0.3, 0.2, 0.1); /* deep inside: which way out it takes is remembered */
  EXPECT(dCollide(geoms[0], geoms[1], 16, contacts, sizeof contacts[0]) > 0);
  size = dGpuTriMeshHistorySave(geoms, 2, 0, 0);
  bytes = malloc(size);
  EXPECT(size > 0 && bytes != 0 && dGpuTriMeshHistorySave(geoms, 2, bytes, size) == size);
  EXPECT(dGeomGpuTriMeshForgetHistory(geoms[0]) == dGPUTRIMESH_OK);
  EXPECT(dGeomGpuTriMeshForgetHistory(geoms[1]) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshHistoryLoad(geoms, 2, bytes, size) == dGPUTRIMESH_OK);
  free(bytes);

  dGeomDestroy(geoms[0]);
  dGeomDestroy(geoms[1]);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshDataDestroy(other);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
