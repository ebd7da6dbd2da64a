/* SPDX-License-Identifier: BSD-3-Clause */
/* What all examples share: a mesh to work with, and the end of the program when something is not as its text says. */
#ifndef EXAMPLE_H
#define EXAMPLE_H

#include <math.h>
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>
#include <stdio.h>
#include <stdlib.h>

#define EXPECT(fact)                                                     \
  do {                                                                   \
    if (!(fact)) {                                                       \
      fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #fact); \
      exit(1);                                                           \
    }                                                                    \
  } while (0)

/* A box with edges of length 1 about the origin: corner k has x, y, z by the bits of k. */
static const float kBoxVertices[8][3] = {{-0.5f, -0.5f, -0.5f}, {0.5f, -0.5f, -0.5f}, {-0.5f, 0.5f, -0.5f},
                                         {0.5f, 0.5f, -0.5f},   {-0.5f, -0.5f, 0.5f}, {0.5f, -0.5f, 0.5f},
                                         {-0.5f, 0.5f, 0.5f},   {0.5f, 0.5f, 0.5f}};
static const unsigned kBoxTriangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                              {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
enum { kBoxVertexCount = 8, kBoxIndexCount = 36 };

/* Yours until dGpuTriMeshDataDestroy(). */
static inline dGpuTriMeshDataID makeBox(void) {
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  EXPECT(data != 0);
  EXPECT(dGpuTriMeshDataBuildSingle(data, kBoxVertices, 0, kBoxVertexCount, kBoxTriangles, kBoxIndexCount, 0) ==
         dGPUTRIMESH_OK);
  return data;
}

static inline int isNear(double a, double b) {
  return fabs(a - b) < 1e-6;
}

#endif
