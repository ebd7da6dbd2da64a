/* SPDX-License-Identifier: BSD-3-Clause */
/* How to have the contacts of a whole space computed at once: the same world is stepped with plain near callbacks and
 * with dGpuTriMeshPrefetch() before them. The near callback is the same; the motion is, too, to the last bit.
 *
 *   demo_prefetch [BODIES] [STEPS] [meshes|shapes]
 *
 * Bodies are bumpy balls that are meshes, piled on a slab. Or they are ODE's boxes, cylinders, capsules and spheres,
 * strewn over hills that are a mesh of 80,000 triangles.
 *
 * Prints milliseconds per step. Exit status 1 if the two runs differ. OTG_THREADS says how many threads prefetch (one
 * for each core without it), OTG_BACKEND=auto or opencl brings OpenCL devices in. */
#include <math.h>
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { kMostContacts = 16, kRings = 24, kSectors = 48 };

typedef struct World {
  dWorldID world;
  dSpaceID space;
  dJointGroupID joints;
  dBodyID* bodies;
  int bodyCount;
} World;

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A bumpy ball of radius 0.45 and 2 * kRings * kSectors triangles. */
static dGpuTriMeshDataID bumpyBall(void) {
  static float vertices[(kRings + 1) * kSectors][3];
  static unsigned indices[2 * kRings * kSectors][3];
  const double pi = 3.14159265358979323846;
  dGpuTriMeshBuildParams params;
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  int i, k;
  for (i = 0; i <= kRings; ++i) {
    const double theta = pi * i / kRings;
    for (k = 0; k < kSectors; ++k) {
      const double phi = 2 * pi * k / kSectors;
      const double r = 0.45 * (1 + 0.15 * sin(3 * phi) * pow(sin(theta), 3));
      float* v = vertices[i * kSectors + k];
      v[0] = (float)(r * sin(theta) * cos(phi));
      v[1] = (float)(r * sin(theta) * sin(phi));
      v[2] = (float)(r * cos(theta));
    }
  }
  for (i = 0; i < kRings; ++i) {
    for (k = 0; k < kSectors; ++k) {
      const unsigned a = (unsigned)(i * kSectors + k), b = (unsigned)(i * kSectors + (k + 1) % kSectors);
      unsigned* t = indices[2 * (i * kSectors + k)];
      t[0] = a, t[1] = a + kSectors, t[2] = b + kSectors;
      t[3] = a, t[4] = b + kSectors, t[5] = b;
    }
  }
  dGpuTriMeshBuildParamsInit(&params);
  params.vertices = vertices;
  params.vertex_count = (kRings + 1) * kSectors;
  params.indices = indices;
  params.index_count = 3 * 2 * kRings * kSectors;
  params.repair = dGPUTRIMESH_REPAIR_ALL; /* the poles */
  if (dGpuTriMeshDataBuild(data, &params) < 0) {
    fprintf(stderr, "%s\n", dGpuTriMeshDataGetErrorString(data));
    exit(1);
  }
  return data;
}

/* A box of 10 x 10 x 1 under z = 0. */
static dGpuTriMeshDataID slab(void) {
  static const float v[8][3] = {{-5, -5, -1}, {5, -5, -1}, {5, 5, -1}, {-5, 5, -1},
                                {-5, -5, 0},  {5, -5, 0},  {5, 5, 0},  {-5, 5, 0}};
  static const unsigned t[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                    {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  dGpuTriMeshDataBuildSingle(data, v, 0, 8, t, 36, 0);
  return data;
}

enum { kCells = 200 };
static double heightAt(double x, double y) {
  return 0.8 * sin(0.5 * x) * cos(0.4 * y) + 0.05 * sin(3 * x + 2 * y);
}

/* Hills of 50 x 50. */
static dGpuTriMeshDataID hills(void) {
  static float v[(kCells + 1) * (kCells + 1)][3];
  static unsigned t[2 * kCells * kCells][3];
  dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  unsigned i, k;
  for (k = 0; k <= kCells; ++k) {
    for (i = 0; i <= kCells; ++i) {
      float* const at = v[k * (kCells + 1) + i];
      at[0] = 0.25f * ((float)i - kCells / 2);
      at[1] = 0.25f * ((float)k - kCells / 2);
      at[2] = (float)heightAt(at[0], at[1]);
    }
  }
  for (k = 0; k < kCells; ++k) {
    for (i = 0; i < kCells; ++i) {
      const unsigned a = k * (kCells + 1) + i;
      unsigned* const f = t[2 * (k * kCells + i)];
      f[0] = a, f[1] = a + 1, f[2] = a + kCells + 2;
      f[3] = a, f[4] = a + kCells + 2, f[5] = a + kCells + 1;
    }
  }
  dGpuTriMeshDataBuildSingle(data, v, 0, (kCells + 1) * (kCells + 1), t, 6 * kCells * kCells, 0);
  return data;
}

static dGeomID makeShape(dSpaceID space, int i, dMass* mass) {
  switch (i % 4) {
    case 0:
      dMassSetBoxTotal(mass, 1, 0.7, 0.5, 0.4);
      return dCreateBox(space, 0.7, 0.5, 0.4);
    case 1:
      dMassSetCylinderTotal(mass, 1, 3, 0.3, 0.5);
      return dCreateCylinder(space, 0.3, 0.5);
    case 2:
      dMassSetCapsuleTotal(mass, 1, 3, 0.2, 0.5);
      return dCreateCapsule(space, 0.2, 0.5);
    default:
      dMassSetSphereTotal(mass, 1, 0.3);
      return dCreateSphere(space, 0.3);
  }
}

/* A world with room for that many bodies, and a ground. The ground's geom keeps the mesh. */
static void makeGround(World* w, int bodies, dGpuTriMeshDataID ground) {
  w->world = dWorldCreate();
  w->space = dHashSpaceCreate(0);
  w->joints = dJointGroupCreate(0);
  w->bodyCount = bodies;
  w->bodies = malloc((size_t)bodies * sizeof(dBodyID));
  dWorldSetGravity(w->world, 0, 0, -9.81);
  dWorldSetContactMaxCorrectingVel(w->world, 1);
  dCreateGpuTriMesh(w->space, ground);
  dGpuTriMeshDataDestroy(ground);
}

static void makeShapeWorld(World* w, int bodies) {
  dGpuTriMeshDataID ground = hills();
  const int side = (int)ceil(sqrt(bodies));
  int i;
  makeGround(w, bodies, ground);
  for (i = 0; i < bodies; ++i) {
    dMass mass;
    dGeomID geom = makeShape(w->space, i, &mass);
    const double x = 45.0 * ((i % side + 0.5) / side - 0.5), y = 45.0 * ((i / side + 0.5) / side - 0.5);
    w->bodies[i] = dBodyCreate(w->world);
    dBodySetMass(w->bodies[i], &mass);
    dGeomSetBody(geom, w->bodies[i]);
    dBodySetPosition(w->bodies[i], x, y, heightAt(x, y) + 0.5);
    dBodySetAngularVel(w->bodies[i], 1, 0.1 * (i % 7), 0);
  }
}

static void makeWorld(World* w, int bodies) {
  dGpuTriMeshDataID ball = bumpyBall(), ground = slab();
  int i;
  makeGround(w, bodies, ground);
  for (i = 0; i < bodies; ++i) {
    dMass mass;
    dGeomID geom = dCreateGpuTriMesh(w->space, ball);
    w->bodies[i] = dBodyCreate(w->world);
    dMassSetSphereTotal(&mass, 1, 0.45);
    dBodySetMass(w->bodies[i], &mass);
    dGeomSetBody(geom, w->bodies[i]);
    dBodySetPosition(w->bodies[i], 0.87 * (i % 5 - 2) + 0.01 * (i % 7), 0.87 * (i / 5 % 5 - 2) + 0.01 * (i % 3),
                     0.5 + 0.85 * (i / 25));
  }
  dGpuTriMeshDataDestroy(ball); /* the geoms keep the mesh */
}

static void nearCallback(void* data, dGeomID o1, dGeomID o2) {
  World* w = data;
  dContact contacts[kMostContacts];
  int i, count = dCollide(o1, o2, kMostContacts, &contacts[0].geom, sizeof(dContact));
  for (i = 0; i < count; ++i) {
    memset(&contacts[i].surface, 0, sizeof contacts[i].surface);
    contacts[i].surface.mode = dContactApprox1;
    contacts[i].surface.mu = 0.6;
    dJointAttach(dJointCreateContact(w->world, w->joints, &contacts[i]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

/* Returns the seconds spent on collisions. */
static double run(World* w, int steps, int prefetch) {
  double collide = 0;
  int i;
  for (i = 0; i < steps; ++i) {
    const double start = seconds();
    if (prefetch) dGpuTriMeshPrefetch(w->space);
    dSpaceCollide(w->space, w, &nearCallback);
    collide += seconds() - start;
    dRandSetSeed((unsigned long)i); /* the quick stepper shuffles its rows */
    dWorldQuickStep(w->world, 0.005);
    dJointGroupEmpty(w->joints);
  }
  return collide;
}

static void destroyWorld(World* w) {
  dJointGroupDestroy(w->joints);
  dSpaceDestroy(w->space);
  dWorldDestroy(w->world);
  free(w->bodies);
}

int main(int argc, char** argv) {
  const int bodies = argc > 1 ? atoi(argv[1]) : 100, steps = argc > 2 ? atoi(argv[2]) : 100;
  const int shapes = argc > 3 && strcmp(argv[3], "shapes") == 0;
  World plain, ahead;
  double plainMs, aheadMs;
  int i, differ = 0;
  if (bodies <= 0 || steps <= 0 || (argc > 3 && !shapes && strcmp(argv[3], "meshes") != 0)) {
    fprintf(stderr, "demo_prefetch [BODIES] [STEPS] [meshes|shapes]\n");
    return 2;
  }
  dInitODE2(0);
  if (!dGpuTriMeshInit()) {
    fprintf(stderr, "%s\n", dGpuTriMeshErrorString(dGpuTriMeshGetError()));
    return 1;
  }
  dGpuTriMeshWaitForDevices(-1); /* what is measured is not to depend on when a device is ready */
  if (shapes) {
    makeShapeWorld(&plain, bodies);
    makeShapeWorld(&ahead, bodies);
  } else {
    makeWorld(&plain, bodies);
    makeWorld(&ahead, bodies);
  }
  plainMs = 1e3 * run(&plain, steps, 0) / steps;
  aheadMs = 1e3 * run(&ahead, steps, 1) / steps;
  for (i = 0; i < bodies; ++i) {
    differ |= memcmp(dBodyGetPosition(plain.bodies[i]), dBodyGetPosition(ahead.bodies[i]), 3 * sizeof(dReal)) != 0;
  }
  printf("%d bodies, %d steps\n", bodies, steps);
  printf("near callbacks alone            %8.3f ms per step\n", plainMs);
  printf("prefetch, %2d threads, %d devices %8.3f ms per step\n", dGpuTriMeshGetThreadCount(),
         dGpuTriMeshGetDeviceCount(), aheadMs);
  printf("%s\n", differ ? "THE RUNS DIFFER" : "both runs end in the same bytes");
  destroyWorld(&plain);
  destroyWorld(&ahead);
  dGpuTriMeshClose();
  dCloseODE();
  return differ;
}
