/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that knows nothing of this library: a ball rolls along a road of slabs that are dTriMeshes, laid side by
   side. The program says how much of its speed is left. Run it as it is, and with the preloadable library before it:

       demo_drop_in_road 8
       LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so OTG_PRELOAD_PRIMITIVES=sphere demo_drop_in_road 8

   Arguments: how many slabs the road of 10.4 m is made of; "moving": one of them is put elsewhere half way. */
#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kMost = 64, kPlaces = 16 };
static const double kLength = 10.4, kRadius = 0.3, kSpeed = 2;
static dWorldID world;
static dJointGroupID joints;

static void onPair(void* data, dGeomID o1, dGeomID o2) {
  dContact contact[kPlaces];
  const int count = dCollide(o1, o2, kPlaces, &contact[0].geom, sizeof(dContact));
  int i;
  (void)data;
  for (i = 0; i < count; ++i) {
    contact[i].surface.mode = dContactApprox1;
    contact[i].surface.mu = 1;
    dJointAttach(dJointCreateContact(world, joints, &contact[i]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

static const unsigned kBox[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

int main(int argc, char** argv) {
  const int slabs = argc > 1 ? atoi(argv[1]) : 8;
  const int moves = argc > 2 && strcmp(argv[2], "moving") == 0;
  const double length = kLength / slabs;
  float corners[8][3];
  dGeomID geoms[kMost], ball;
  dTriMeshDataID data;
  dSpaceID space;
  dBodyID body;
  dMass mass;
  int i;
  if (slabs < 1 || slabs > kMost) return 1;
  for (i = 0; i < 8; ++i) {
    corners[i][0] = (float)((i & 1 ? 0.5 : -0.5) * length);
    corners[i][1] = i & 2 ? 2.f : -2.f;
    corners[i][2] = i & 4 ? 0.f : -1.f;
  }
  dInitODE2(0);
  world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetERP(world, 0.2);
  dWorldSetCFM(world, 1e-5);
  joints = dJointGroupCreate(0);
  space = dHashSpaceCreate(NULL);
  data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, corners, sizeof corners[0], 8, kBox, 36, 3 * sizeof kBox[0]);
  for (i = 0; i < slabs; ++i) {
    geoms[i] = dCreateTriMesh(space, data, NULL, NULL, NULL);
    dGeomSetPosition(geoms[i], (i + 0.5) * length, 0, 0);
  }
  ball = dCreateSphere(space, kRadius);
  body = dBodyCreate(world);
  dMassSetSphereTotal(&mass, 1, kRadius);
  dBodySetMass(body, &mass);
  dGeomSetBody(ball, body);
  dBodySetPosition(body, 0.4, 0, kRadius);
  dBodySetLinearVel(body, kSpeed, 0, 0);
  dBodySetAngularVel(body, 0, kSpeed / kRadius, 0);
  for (i = 0; i < 2000 && dBodyGetPosition(body)[0] < kLength - 0.4; ++i) {
    if (moves && i == 300) dGeomSetPosition(geoms[slabs - 1], kLength - 0.5 * length, 0, -0.2);
    dSpaceCollide(space, NULL, &onPair);
    dWorldStep(world, 0.005);
    dJointGroupEmpty(joints);
  }
  printf("{\"speed\": %.9f, \"height\": %.6f}\n", dBodyGetLinearVel(body)[0] / kSpeed,
         dBodyGetPosition(body)[2] - kRadius);
  dJointGroupDestroy(joints);
  dSpaceDestroy(space);
  dGeomTriMeshDataDestroy(data);
  dWorldDestroy(world);
  dCloseODE();
  return 0;
}
