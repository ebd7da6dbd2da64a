/* SPDX-License-Identifier: BSD-3-Clause */
/* A mesh with a geom of each of ODE's classes, and with another mesh: every pair of docs/primitives.md, by dCollide()
   and nothing else. The mesh is a box with edges of length 1, and each geom is 0.1 deep in its top. */
#include "example.h"

/* ODE marks its geom transforms as old. */
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

/* An octahedron with corners 0.5 from its middle, for dConvex: planes are normal and distance, polygons count and
 * corners. */
static dReal octahedronPoints[6 * 3] = {0.5, 0, 0, -0.5, 0, 0, 0, 0.5, 0, 0, -0.5, 0, 0, 0, 0.5, 0, 0, -0.5};
static dReal octahedronPlanes[8 * 4];
static unsigned octahedronFaces[8 * 4] = {3, 0, 2, 4, 3, 2, 1, 4, 3, 1, 3, 4, 3, 3, 0, 4,
                                          3, 2, 0, 5, 3, 1, 2, 5, 3, 3, 1, 5, 3, 0, 3, 5};

static dGeomID makeOctahedron(void) {
  static const dReal signs[8][3] = {{1, 1, 1},  {-1, 1, 1},  {-1, -1, 1},  {1, -1, 1},
                                    {1, 1, -1}, {-1, 1, -1}, {-1, -1, -1}, {1, -1, -1}};
  int i, k;
  for (i = 0; i < 8; ++i) {
    for (k = 0; k < 3; ++k) octahedronPlanes[4 * i + k] = signs[i][k] / sqrt(3);
    octahedronPlanes[4 * i + 3] = 0.5 / sqrt(3);
  }
  return dCreateConvex(0, octahedronPlanes, 8, octahedronPoints, 6, octahedronFaces);
}

/* A heightfield of 5 x 5 samples of height 0, 4 x 4 in size, whose up is y until it is turned. Its data are built
   through this library, which has to know the heights. */
static dGeomID makeField(dHeightfieldDataID data) {
  static const float heights[25] = {0};
  dGeomID field;
  dMatrix3 upright;
  dGpuTriMeshHeightfieldDataBuildSingle(data, heights, 1, 4, 4, 5, 5, 1, 0, 1, 0);
  field = dCreateHeightfield(0, data, 1);
  dRFromAxisAndAngle(upright, 1, 0, 0, 1.5707963267948966);
  dGeomSetRotation(field, upright);
  return field;
}

/* The deepest contact pushes the first geom along `up` (1 or -1 of z) by `depth`. Destroys the geom. */
static void expect(const char* name, dGeomID mesh, dGeomID other, double up, double depth) {
  dContactGeom contacts[32];
  const int count = dCollide(mesh, other, 32, contacts, sizeof contacts[0]);
  int i, deepest = 0;
  for (i = 1; i < count; ++i) deepest = contacts[i].depth > contacts[deepest].depth ? i : deepest;
  EXPECT(count > 0);
  printf("%-12s %2d contacts, the deepest %.3f along (%.2f, %.2f, %.2f)\n", name, count,
         (double)contacts[deepest].depth, (double)contacts[deepest].normal[0], (double)contacts[deepest].normal[1],
         (double)contacts[deepest].normal[2]);
  EXPECT(fabs(contacts[deepest].normal[2] - up) < 1e-3 && fabs(contacts[deepest].depth - depth) < 1e-3);
  dGeomDestroy(other);
}

static dGeomID at(dGeomID geom, dReal z) {
  dGeomSetPosition(geom, 0, 0, z);
  return geom;
}

int main(void) {
  dGpuTriMeshDataID data;
  dTriMeshDataID trimesh;
  dHeightfieldDataID heights;
  dGeomID mesh, ray, transform;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  mesh = dCreateGpuTriMesh(0, data);

  expect("sphere", mesh, at(dCreateSphere(0, 0.3), 0.7), -1, 0.1);
  expect("box", mesh, at(dCreateBox(0, 0.4, 0.4, 0.4), 0.6), -1, 0.1);
  expect("capsule", mesh, at(dCreateCapsule(0, 0.1, 0.4), 0.7), -1, 0.1);
  expect("cylinder", mesh, at(dCreateCylinder(0, 0.2, 0.4), 0.6), -1, 0.1);
  expect("convex", mesh, at(makeOctahedron(), 0.9), -1, 0.1);
  expect("mesh", mesh, at(dCreateGpuTriMesh(0, data), 0.9), -1, 0.1);
  expect("plane", mesh, dCreatePlane(0, 0, 0, 1, -0.4), 1, 0.1); /* all below z = -0.4 is solid */

  ray = dCreateRay(0, 2);
  dGeomRaySet(ray, 0, 0, 1.5, 0, 0, -1);
  dGeomRaySetClosestHit(ray, 1);
  expect("ray", ray, mesh, 1, 1); /* of a ray: the distance from its start, and the surface's normal */
  mesh = dCreateGpuTriMesh(0, data);
  dGeomDestroy(ray);

  heights = dGeomHeightfieldDataCreate();
  expect("heightfield", mesh, at(makeField(heights), -0.4), 1, 0.1);
  dGeomHeightfieldDataDestroy(heights);

  trimesh = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(trimesh, kBoxVertices, 3 * sizeof(float), kBoxVertexCount, kBoxTriangles, kBoxIndexCount,
                              3 * sizeof(unsigned));
  expect("dTriMesh", mesh, at(dCreateTriMesh(0, trimesh, 0, 0, 0), 0.9), -1, 0.1);
  dGeomTriMeshDataDestroy(trimesh);

  transform = dCreateGeomTransform(0); /* the older way to an offset: contacts name the transform */
  dGeomTransformSetGeom(transform, at(dCreateSphere(0, 0.3), 0.2));
  dGeomTransformSetCleanup(transform, 1);
  expect("transform", mesh, at(transform, 0.5), -1, 0.1);

  dGeomDestroy(mesh);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
