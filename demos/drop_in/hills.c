/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that knows nothing of this library: bodies that are dTriMeshes, or ODE's boxes to compare with, slide into
   a valley that is a dHeightfield. The program says how far and how deep. Run it as it is, and with the preloadable
   library before it and heightfields switched on:

       demo_drop_in_hills mesh single
       LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so OTG_PRELOAD_PRIMITIVES=heightfield \
         demo_drop_in_hills mesh single

   Arguments: mesh or box; how the program gives its heights to ODE: byte, short, single, double, or callback; steps of
   1/240 s. All five are the same ground. */
#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { kSamples = 33, kBodies = 5, kPlaces = 32 };
static const double kSize = 16, kSide = 0.6;

static dWorldID world;
static dJointGroupID joints;
static long contactCount;
static double collideSeconds, deepest;

/* In 64ths of a metre, so that every kind of sample holds it: a valley along z, 2 m deep. */
static int heightAt(int i) {
  return (int)floor(64 * (1 + cos(2 * 3.14159265358979 * i / (kSamples - 1))) + 0.5);
}
static dReal heightOf(void* data, int i, int j) {
  (void)data;
  (void)j;
  return (dReal)heightAt(i);
}

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
    deepest = fmax(deepest, contact[i].geom.depth);
    contact[i].surface.mode = dContactApprox1;
    contact[i].surface.mu = 0.1;
    dJointAttach(dJointCreateContact(world, joints, &contact[i]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

/* Copies the samples or keeps reading them, as each of ODE's functions has it. Returns whether it knows the kind. */
static int buildHeights(dHeightfieldDataID data, const char* kind, void* kept) {
  const dReal scale = 1.0 / 64;
  int n;
  unsigned char* const bytes = kept;
  short* const shorts = kept;
  float* const singles = kept;
  double* const doubles = kept;
  if (strcmp(kind, "callback") == 0) {
    dGeomHeightfieldDataBuildCallback(data, NULL, &heightOf, kSize, kSize, kSamples, kSamples, scale, 0, 1, 0);
    dGeomHeightfieldDataSetBounds(data, 0, 128);
    return 1;
  }
  for (n = 0; n < kSamples * kSamples; ++n) {
    const int height = heightAt(n % kSamples);
    if (strcmp(kind, "byte") == 0) bytes[n] = (unsigned char)height;
    if (strcmp(kind, "short") == 0) shorts[n] = (short)height;
    if (strcmp(kind, "single") == 0) singles[n] = (float)height;
    if (strcmp(kind, "double") == 0) doubles[n] = height;
  }
  if (strcmp(kind, "byte") == 0)
    dGeomHeightfieldDataBuildByte(data, bytes, 1, kSize, kSize, kSamples, kSamples, scale, 0, 1, 0);
  else if (strcmp(kind, "short") == 0)
    dGeomHeightfieldDataBuildShort(data, shorts, 0, kSize, kSize, kSamples, kSamples, scale, 0, 1, 0);
  else if (strcmp(kind, "single") == 0)
    dGeomHeightfieldDataBuildSingle(data, singles, 1, kSize, kSize, kSamples, kSamples, scale, 0, 1, 0);
  else if (strcmp(kind, "double") == 0)
    dGeomHeightfieldDataBuildDouble(data, doubles, 0, kSize, kSize, kSamples, kSamples, scale, 0, 1, 0);
  else
    return 0;
  return 1;
}

int main(int argc, char** argv) {
  static const float kCorners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                       {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
  static const unsigned kTriangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const char* const shape = argc > 1 ? argv[1] : "mesh";
  const char* const kind = argc > 2 ? argv[2] : "single";
  const int steps = argc > 3 ? atoi(argv[3]) : 400;
  const int isMesh = strcmp(shape, "mesh") == 0;
  float vertices[8][3];
  void* const kept = calloc(kSamples * kSamples, sizeof(double));
  dSpaceID space;
  dGeomID ground;
  dHeightfieldDataID heights;
  dTriMeshDataID mesh;
  dBodyID bodies[kBodies];
  double speed = 0, low = 1e9, high = -1e9, way = 0, aside = 0;
  int i, k, step;
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  heights = dGeomHeightfieldDataCreate();
  if ((!isMesh && strcmp(shape, "box") != 0) || steps < 1 || !buildHeights(heights, kind, kept)) {
    fprintf(stderr, "usage: %s mesh|box byte|short|single|double|callback [steps]\n", argv[0]);
    return 2;
  }
  for (i = 0; i < 8; ++i) {
    for (k = 0; k < 3; ++k) vertices[i][k] = (float)(0.5 * kSide) * kCorners[i][k];
  }
  mesh = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(mesh, vertices, sizeof vertices[0], 8, kTriangles, 36, sizeof kTriangles[0]);
  world = dWorldCreate();
  dWorldSetGravity(world, 0, -9.81, 0); /* y is up, as heightfields have it */
  space = dSimpleSpaceCreate(0);
  joints = dJointGroupCreate(0);
  ground = dCreateHeightfield(space, heights, 1);
  dGeomSetPosition(ground, 100, 10, -50);
  for (i = 0; i < kBodies; ++i) {
    const dGeomID geom = isMesh ? dCreateTriMesh(space, mesh, 0, 0, 0) : dCreateBox(space, kSide, kSide, kSide);
    dMatrix3 turn;
    dMass mass;
    bodies[i] = dBodyCreate(world);
    dMassSetBox(&mass, 500, kSide, kSide, kSide);
    dBodySetMass(bodies[i], &mass);
    dGeomSetBody(geom, bodies[i]);
    dRFromAxisAndAngle(turn, 0, 0, 1, -0.348); /* as the slope under it */
    dBodySetRotation(bodies[i], turn);
    dBodySetPosition(bodies[i], 95 + 0.32 * sin(0.348), 11.4 + 0.32 * cos(0.348), -50 + 2.5 * (i - 2));
  }
  for (step = 0; step < steps; ++step) {
    dSpaceCollide(space, 0, &onPair);
    dWorldStep(world, 1.0 / 240);
    dJointGroupEmpty(joints);
  }
  for (i = 0; i < kBodies; ++i) {
    const dReal *p = dBodyGetPosition(bodies[i]), *v = dBodyGetLinearVel(bodies[i]);
    way += (p[0] - 95) / kBodies;
    aside = fmax(aside, fabs(p[2] + 50 - 2.5 * (i - 2)));
    low = fmin(low, p[1] - 10);
    high = fmax(high, p[1] - 10);
    speed = fmax(speed, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
  }
  printf(
      "{\"shape\": \"%s\", \"heights\": \"%s\", \"steps\": %d, \"way_m\": %.6g, \"aside_m\": %.4g, \"lowest_m\": %.6g, "
      "\"highest_m\": %.6g, \"deepest_m\": %.4g, \"speed\": %.4g, \"contacts_per_step\": %.4g, \"collide_ms\": %.4g}\n",
      shape, kind, steps, way, aside, low, high, deepest, speed, (double)contactCount / steps,
      1e3 * collideSeconds / steps);
  dJointGroupDestroy(joints);
  dSpaceDestroy(space);
  dWorldDestroy(world);
  dGeomTriMeshDataDestroy(mesh);
  dGeomHeightfieldDataDestroy(heights);
  free(kept);
  dCloseODE();
  return 0;
}
