/* SPDX-License-Identifier: BSD-3-Clause */
/* A whole program: a box of triangles falls onto a ground of triangles and comes to rest. */
#include "example.h"

static dWorldID world;
static dJointGroupID joints;

/* A mesh of the 8 corners of a box; corner k has x, y, z by the bits of k. The arrays may go away afterwards. */
static dGeomID addBox(dSpaceID space, dBodyID body, const float low[3], const float high[3]) {
  float vertices[8][3];
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  dGeomID geom;
  int i, k;
  for (i = 0; i < 8; ++i) {
    for (k = 0; k < 3; ++k) vertices[i][k] = (i >> k & 1) ? high[k] : low[k];
  }
  EXPECT(dGpuTriMeshDataBuildSingle(data, vertices, 0, 8, kBoxTriangles, kBoxIndexCount, 0) == dGPUTRIMESH_OK);
  geom = dCreateGpuTriMesh(space, data);
  EXPECT(geom != 0);
  dGeomSetBody(geom, body);     /* 0: it stays where it is */
  dGpuTriMeshDataDestroy(data); /* the geom keeps the mesh */
  return geom;
}

/* For a geom on a body. Bodies turn about their origin, so the centre of mass is shifted to it. */
static void giveMass(dGeomID geom, dReal density) {
  dMass mass;
  EXPECT(dMassSetGpuTriMesh(&mass, density, geom) == dGPUTRIMESH_OK);
  dGeomSetOffsetPosition(geom, -mass.c[0], -mass.c[1], -mass.c[2]);
  dMassTranslate(&mass, -mass.c[0], -mass.c[1], -mass.c[2]);
  dBodySetMass(dGeomGetBody(geom), &mass);
}

/* ODE calls it for geoms whose boxes overlap: each contact becomes a joint for one step. */
static void nearCallback(void* data, dGeomID a, dGeomID b) {
  dContact contacts[16];
  int i;
  const int count = dCollide(a, b, 16, &contacts[0].geom, sizeof contacts[0]);
  (void)data;
  for (i = 0; i < count; ++i) {
    contacts[i].surface.mode = dContactApprox1;
    contacts[i].surface.mu = 0.8;
    dJointAttach(dJointCreateContact(world, joints, &contacts[i]), dGeomGetBody(a), dGeomGetBody(b));
  }
}

int main(void) {
  static const float kGroundLow[3] = {-5, -5, -1}, kGroundHigh[3] = {5, 5, 0};
  static const float kLow[3] = {0, 0, 0}, kHigh[3] = {0.4f, 0.3f, 0.2f}; /* its corner is the mesh's origin */
  dSpaceID space;
  dBodyID body;
  const dReal* rest;
  int step;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  space = dHashSpaceCreate(0);
  joints = dJointGroupCreate(0);

  addBox(space, 0, kGroundLow, kGroundHigh);
  body = dBodyCreate(world);
  giveMass(addBox(space, body, kLow, kHigh), 1000);
  dBodySetPosition(body, 0, 0, 0.5); /* of the centre of mass */

  for (step = 0; step < 200; ++step) {
    dSpaceCollide(space, 0, &nearCallback);
    dWorldQuickStep(world, 1.0 / 120);
    dJointGroupEmpty(joints);
  }
  rest = dBodyGetPosition(body);
  printf("rests at %.3f %.3f %.3f\n", (double)rest[0], (double)rest[1], (double)rest[2]);
  EXPECT(fabs((double)rest[0]) < 0.01 && fabs((double)rest[1]) < 0.01 && fabs((double)rest[2] - 0.1) < 0.01);

  dJointGroupDestroy(joints);
  dSpaceDestroy(space); /* and its geoms */
  dWorldDestroy(world);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
