/* SPDX-License-Identifier: BSD-3-Clause */
/* A user's program in C, with the lines that README.md gives: two overlapping tetrahedra have contacts that ODE can
 * use. */
#include "readme_snippet.h"

#include <stdio.h>

int main(void) {
  static const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const unsigned triangles[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  dContactGeom contacts[8];
  dGeomID a, b;
  dSpaceID space;
  int i, count;
  if (!dInitODE2(0) || !dGpuTriMeshInit()) return 1;
  space = dHashSpaceCreate(0);
  a = addMesh(space, 0, corners, 4, triangles, 4);
  b = addMesh(space, 0, corners, 4, triangles, 4);
  if (!a || !b || addMesh(space, 0, corners, 3, triangles, 4)) return 2; /* the third one has an index out of range */
  dGeomSetPosition(b, 0.1, 0.15, 0.6);
  count = dCollide(a, b, 8, contacts, sizeof contacts[0]);
  for (i = 0; i < count; ++i) {
    const dReal* n = contacts[i].normal;
    const dReal length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (!(length > 0.999 && length < 1.001 && contacts[i].depth >= 0)) return 3;
  }
  printf("%d contacts\n", count);
  dSpaceDestroy(space);
  dGpuTriMeshClose();
  dCloseODE();
  return count > 0 ? 0 : 4;
}
