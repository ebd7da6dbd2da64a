/* SPDX-License-Identifier: BSD-3-Clause */
/* A road of slabs that are laid side by side: joined, they collide as one, and a ball rolls over the seams. */
#include "example.h"

enum { kSlabs = 4, kPlaces = 8 };

int main(void) {
  dContactGeom contacts[kPlaces];
  dGeomID slabs[kSlabs], box;
  dGpuTriMeshDataID data;
  int i, found = 0;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  for (i = 0; i < kSlabs; ++i) {
    slabs[i] = dCreateGpuTriMesh(0, data);
    dGeomSetPosition(slabs[i], i, 0, 0);
  }
  EXPECT(dGpuTriMeshJoin(slabs, kSlabs) == kSlabs); /* once they are where they stay */

  box = dCreateBox(0, 0.5, 0.5, 0.5); /* over the first seam */
  dGeomSetPosition(box, 0.5, 0, 0.74);
  for (i = 0; i < kSlabs; ++i) {
    const int count = dCollide(slabs[i], box, kPlaces, contacts, sizeof contacts[0]);
    printf("slab %d: %d contacts\n", i, count);
    found += count;
  }
  EXPECT(found == 4); /* the corners of the box, and none of the seam's edge */

  EXPECT(dGpuTriMeshUnjoin(slabs[0]) == dGPUTRIMESH_OK); /* each by itself again */
  dGeomDestroy(box);
  for (i = 0; i < kSlabs; ++i) dGeomDestroy(slabs[i]);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
