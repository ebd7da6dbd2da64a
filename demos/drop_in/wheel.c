/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that knows nothing of this library: one of ODE's own shapes rolls or slides over a flat road that is a
   dTriMesh. The program says how straight and how level it went. Run it as it is, and with the preloadable library
   before it and the shape switched on:

       demo_drop_in_wheel cylinder 400 2
       OTG_PRELOAD_PRIMITIVES=cylinder LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so demo_drop_in_wheel cylinder
   400 2

   Arguments: sphere, capsule, cylinder (a wheel on its side), drum (one that stands) or box; the side of the road in
   metres; the side of its squares in metres, 0 for ODE's dPlane, to compare with; steps of 1/240 s. */
#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { kPlaces = 32 };

static dWorldID world;
static dJointGroupID joints;
static long contactCount;
static double collideSeconds; /* of one step */

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void onPair(void* data, dGeomID o1, dGeomID o2) {
  dContact contact[kPlaces];
  const double before = seconds();
  const int count = dCollide(o1, o2, kPlaces, &contact[0].geom, sizeof(dContact));
  int i;
  (void)data;
  collideSeconds += seconds() - before;
  contactCount += count;
  for (i = 0; i < count; ++i) {
    contact[i].surface.mode = dContactSoftCFM | dContactSoftERP | dContactApprox1;
    contact[i].surface.mu = 0.7;
    contact[i].surface.soft_erp = 0.2;
    contact[i].surface.soft_cfm = 1e-6;
    dJointAttach(dJointCreateContact(world, joints, &contact[i]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

/* A flat square of n x n squares, its middle at the origin, facing up. */
static dTriMeshDataID makeRoad(double side, int n, float** vertices, unsigned** triangles) {
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  float* v = *vertices = malloc(sizeof(float) * 3 * (size_t)(n + 1) * (size_t)(n + 1));
  unsigned* t = *triangles = malloc(sizeof(unsigned) * 6 * (size_t)n * (size_t)n);
  int i, j;
  for (j = 0; j <= n; ++j) {
    for (i = 0; i <= n; ++i) {
      *v++ = (float)(side * ((double)i / n - 0.5));
      *v++ = (float)(side * ((double)j / n - 0.5));
      *v++ = 0;
    }
  }
  for (j = 0; j < n; ++j) {
    for (i = 0; i < n; ++i) {
      const unsigned a = (unsigned)(j * (n + 1) + i), b = a + 1, c = b + (unsigned)(n + 1), d = a + (unsigned)(n + 1);
      t[0] = a, t[1] = b, t[2] = c, t[3] = a, t[4] = c, t[5] = d;
      t += 6;
    }
  }
  dGeomTriMeshDataBuildSingle(data, *vertices, 3 * sizeof(float), (n + 1) * (n + 1), *triangles, 6 * n * n,
                              3 * sizeof(unsigned));
  return data;
}

static int bySize(const void* a, const void* b) {
  const double x = *(const double*)a, y = *(const double*)b;
  return x < y ? -1 : x > y;
}

int main(int argc, char** argv) {
  const char* const shape = argc > 1 ? argv[1] : "cylinder";
  const double side = argc > 2 ? atof(argv[2]) : 400, square = argc > 3 ? atof(argv[3]) : 2, radius = 0.4;
  const int steps = argc > 4 ? atoi(argv[4]) : 1200;
  const int squares = square > 0 ? (int)(side / square + 0.5) : 0;
  float* vertices = NULL;
  unsigned* triangles = NULL;
  dSpaceID space;
  dGeomID geom;
  dBodyID body;
  dMass mass;
  dMatrix3 onSide;
  dTriMeshDataID road = NULL;
  const int rolls = strcmp(shape, "box") != 0 && strcmp(shape, "drum") != 0;
  double *collideTimes, first, low = 1e9, high = -1e9, aside = 0;
  const dReal* p;
  int step;
  if (side <= 0 || squares < 0 || squares > 2000 || steps < 1) {
    fprintf(stderr,
            "usage: %s sphere|capsule|cylinder|drum|box [side of the road, m] [side of its squares, m, 0: dPlane] "
            "[steps]\n",
            argv[0]);
    return 2;
  }
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  world = dWorldCreate();
  space = dSimpleSpaceCreate(0);
  joints = dJointGroupCreate(0);
  dWorldSetGravity(world, 0, 0, -9.81);
  if (squares > 0) {
    road = makeRoad(side, squares, &vertices, &triangles);
    dCreateTriMesh(space, road, 0, 0, 0);
  } else {
    dCreatePlane(space, 0, 0, 1, 0);
  }
  body = dBodyCreate(world);
  if (strcmp(shape, "sphere") == 0) {
    geom = dCreateSphere(space, radius);
    dMassSetSphere(&mass, 500, radius);
  } else if (strcmp(shape, "capsule") == 0) {
    geom = dCreateCapsule(space, radius, 0.6);
    dMassSetCapsule(&mass, 500, 3, radius, 0.6);
  } else if (strcmp(shape, "box") == 0) {
    geom = dCreateBox(space, 2 * radius, 2 * radius, 2 * radius);
    dMassSetBox(&mass, 500, 2 * radius, 2 * radius, 2 * radius);
  } else if (strcmp(shape, "drum") == 0) {
    geom = dCreateCylinder(space, radius, 2 * radius);
    dMassSetCylinder(&mass, 500, 3, radius, 2 * radius);
  } else {
    geom = dCreateCylinder(space, radius, 0.3);
    dMassSetCylinder(&mass, 500, 3, radius, 0.3);
  }
  dBodySetMass(body, &mass);
  dGeomSetBody(geom, body);
  /* The axis along y, which is aside; it rolls, and others slide, along x. */
  dRFromAxisAndAngle(onSide, 1, 0, 0, -1.5707963267948966);
  if (rolls) dBodySetRotation(body, onSide);
  dBodySetPosition(body, -0.3 * side, 0.31, radius);
  dBodySetLinearVel(body, 5, 0, 0);
  if (rolls) dBodySetAngularVel(body, 0, 5 / radius, 0);
  collideTimes = malloc(sizeof(double) * (size_t)steps);
  for (step = 0; step < steps; ++step) {
    collideSeconds = 0;
    dSpaceCollide(space, 0, &onPair);
    collideTimes[step] = collideSeconds;
    dWorldStep(world, 1.0 / 240);
    dJointGroupEmpty(joints);
    p = dBodyGetPosition(body);
    if (step >= 60) low = fmin(low, p[2]), high = fmax(high, p[2]);
    aside = fmax(aside, fabs(p[1] - 0.31));
  }
  first = collideTimes[0];
  qsort(collideTimes, (size_t)steps, sizeof(double), &bySize);
  p = dBodyGetPosition(body);
  printf(
      "{\"shape\": \"%s\", \"triangles\": %d, \"steps\": %d, \"way_m\": %.6g, \"aside_m\": %.4g, \"bumps_m\": %.4g, "
      "\"contacts_per_step\": %.4g, \"first_ms\": %.4g, \"collide_ms\": %.4g}\n",
      shape, 2 * squares * squares, steps, p[0] + 0.3 * side, aside, high - low, (double)contactCount / steps,
      1e3 * first, 1e3 * collideTimes[steps / 2]);
  dJointGroupDestroy(joints);
  dSpaceDestroy(space);
  dWorldDestroy(world);
  if (road != NULL) dGeomTriMeshDataDestroy(road);
  free(collideTimes);
  free(vertices);
  free(triangles);
  dCloseODE();
  return 0;
}
