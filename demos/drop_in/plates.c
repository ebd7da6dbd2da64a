/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that knows nothing of this library: flat plates that are dTriMeshes fall on a flat dTriMesh, and the
   program says how many lie there after 3 s. ODE's boxes of flat meshes have no margin, so that a plate that lies still
   is not reported any more and falls through. Run it as it is, and with the preloadable library before it:

       demo_drop_in_plates
       LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so demo_drop_in_plates

   Arguments: seed; "subspace": the plates are in a space of their own. */
#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kPlates = 12, kPlaces = 32 };
static dWorldID world;
static dJointGroupID joints;

static void onPair(void* data, dGeomID o1, dGeomID o2) {
  dContact contact[kPlaces];
  int i, count;
  if (dGeomIsSpace(o1) || dGeomIsSpace(o2)) {
    dSpaceCollide2(o1, o2, data, &onPair);
    return;
  }
  count = dCollide(o1, o2, kPlaces, &contact[0].geom, sizeof(dContact));
  for (i = 0; i < count; ++i) {
    contact[i].surface.mode = dContactApprox1;
    contact[i].surface.mu = 1;
    dJointAttach(dJointCreateContact(world, joints, &contact[i]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

static const float kGround[4][3] = {{-20, -20, 0}, {20, -20, 0}, {20, 20, 0}, {-20, 20, 0}};
static const float kPlate[4][3] = {{-0.5f, -0.4f, 0}, {0.5f, -0.4f, 0}, {0.5f, 0.4f, 0}, {-0.5f, 0.4f, 0}};
static const unsigned kQuad[6] = {0, 1, 2, 0, 2, 3};

static dTriMeshDataID quad(const float (*corners)[3]) {
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, corners, sizeof corners[0], 4, kQuad, 6, 3 * sizeof kQuad[0]);
  return data;
}

int main(int argc, char** argv) {
  dTriMeshDataID ground, plate;
  dSpaceID space, plates;
  dBodyID bodies[kPlates];
  int i, lying = 0;
  dInitODE2(0);
  dRandSetSeed(argc > 1 ? strtoul(argv[1], NULL, 10) : 1);
  world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetERP(world, 0.2);
  dWorldSetCFM(world, 1e-5);
  joints = dJointGroupCreate(0);
  space = dHashSpaceCreate(NULL);
  plates = argc > 2 && strcmp(argv[2], "subspace") == 0 ? dSimpleSpaceCreate(space) : space;
  ground = quad(kGround);
  plate = quad(kPlate);
  dCreateTriMesh(space, ground, NULL, NULL, NULL);
  for (i = 0; i < kPlates; ++i) {
    const dGeomID geom = dCreateTriMesh(plates, plate, NULL, NULL, NULL);
    dMass mass;
    dMatrix3 r;
    bodies[i] = dBodyCreate(world);
    dMassSetBoxTotal(&mass, 1, 1, 0.8, 0.05);
    dBodySetMass(bodies[i], &mass);
    dGeomSetBody(geom, bodies[i]);
    dBodySetPosition(bodies[i], 2.5 * (i % 4) - 4, 2.5 * (i / 4) - 3, 0.8);
    dRFromAxisAndAngle(r, dRandReal() - 0.5, dRandReal() - 0.5, 0.1, dRandReal());
    dBodySetRotation(bodies[i], r);
  }
  for (i = 0; i < 600; ++i) {
    dSpaceCollide(space, NULL, &onPair);
    dWorldStep(world, 0.005);
    dJointGroupEmpty(joints);
  }
  for (i = 0; i < kPlates; ++i) {
    if (fabs(dBodyGetPosition(bodies[i])[2]) < 0.01) ++lying;
  }
  printf("{\"lying\": %d, \"of\": %d}\n", lying, kPlates);
  dJointGroupDestroy(joints);
  dSpaceDestroy(space);
  dGeomTriMeshDataDestroy(plate);
  dGeomTriMeshDataDestroy(ground);
  dWorldDestroy(world);
  dCloseODE();
  return 0;
}
