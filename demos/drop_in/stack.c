/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that knows nothing of this library: it stacks triangle meshes with ODE's own dTriMesh and says what became
   of the stack. Run it as it is, and with the preloadable library before it:

       demo_drop_in_stack 10 1000
       LD_PRELOAD=build/lib/libode_trimesh_gpu_preload.so demo_drop_in_stack 10 1000

   Arguments: how many boxes; how many steps of 1/240 s; into how many squares each edge of a side is cut, 0 for ODE's
   own dBox on a mesh of ground, to compare with; "quick" for dWorldQuickStep. */
#include <math.h>
#include <ode/ode.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { kMostBoxes = 64, kMostCuts = 32, kPlaces = 64 };

static dWorldID world;
static dSpaceID space;
static dJointGroupID joints;
static long contactCount;
static double collideSeconds;

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void onPair(void* data, dGeomID o1, dGeomID o2) {
  dContact contact[kPlaces];
  double before;
  int count, i;
  (void)data;
  before = seconds();
  count = dCollide(o1, o2, kPlaces, &contact[0].geom, sizeof(dContact));
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

/* A box whose sides are grids of n x n squares, two triangles each. */
typedef struct {
  float vertices[6 * (kMostCuts + 1) * (kMostCuts + 1)][3];
  unsigned triangles[12 * kMostCuts * kMostCuts][3];
  int vertexCount, triangleCount;
} Box;

static void makeBox(Box* box, double x, double y, double z, int n) {
  const double half[3] = {x / 2, y / 2, z / 2};
  int side, i, j;
  box->vertexCount = box->triangleCount = 0;
  for (side = 0; side < 6; ++side) {
    const int w = side % 3, u = (w + 1) % 3, v = (w + 2) % 3, positive = side < 3;
    const unsigned first = (unsigned)box->vertexCount;
    for (i = 0; i <= n; ++i) {
      for (j = 0; j <= n; ++j) {
        float* p = box->vertices[box->vertexCount++];
        p[w] = (float)(positive ? half[w] : -half[w]);
        p[u] = (float)(half[u] * (2.0 * i / n - 1));
        p[v] = (float)(half[v] * (2.0 * j / n - 1));
      }
    }
    for (i = 0; i < n; ++i) {
      for (j = 0; j < n; ++j) {
        const unsigned a = first + (unsigned)(i * (n + 1) + j), b = a + (unsigned)(n + 1), c = b + 1, d = a + 1;
        unsigned* t = box->triangles[box->triangleCount];
        box->triangleCount += 2;
        t[0] = a, t[1] = positive ? b : d, t[2] = positive ? d : b;
        t[3] = d, t[4] = positive ? b : c, t[5] = positive ? c : b;
      }
    }
  }
}

static dTriMeshDataID dataOf(const Box* box) {
  dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, box->vertices, sizeof(box->vertices[0]), box->vertexCount, box->triangles,
                              3 * box->triangleCount, sizeof(box->triangles[0]));
  return data;
}

int main(int argc, char** argv) {
  static Box ground, box;
  const int count = argc > 1 ? atoi(argv[1]) : 10, steps = argc > 2 ? atoi(argv[2]) : 1000;
  const int cuts = argc > 3 ? atoi(argv[3]) : 1, quick = argc > 4 && strcmp(argv[4], "quick") == 0;
  dBodyID bodies[kMostBoxes];
  dTriMeshDataID groundData, boxData;
  dMass mass;
  double started, spent, worstDrift = 0, worstTilt = 0, worstSink = 0;
  int i, step;
  if (count < 1 || count > kMostBoxes || steps < 1 || cuts < 0 || cuts > kMostCuts) {
    fprintf(stderr, "usage: %s [boxes 1..%d] [steps] [cuts 0..%d] [quick]\n", argv[0], kMostBoxes, kMostCuts);
    return 2;
  }
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  world = dWorldCreate();
  space = dHashSpaceCreate(0);
  joints = dJointGroupCreate(0);
  dWorldSetGravity(world, 0, 0, -9.81);
  makeBox(&ground, 8, 8, 1, 1);
  makeBox(&box, 1, 1, 1, cuts > 0 ? cuts : 1);
  groundData = dataOf(&ground);
  boxData = dataOf(&box);
  dGeomSetPosition(dCreateTriMesh(space, groundData, 0, 0, 0), 0, 0, -0.5);
  dMassSetBox(&mass, 1000, 1, 1, 1);
  for (i = 0; i < count; ++i) {
    bodies[i] = dBodyCreate(world);
    dBodySetMass(bodies[i], &mass);
    dBodySetPosition(bodies[i], 0, 0, 0.5 + i);
    dGeomSetBody(cuts > 0 ? dCreateTriMesh(space, boxData, 0, 0, 0) : dCreateBox(space, 1, 1, 1), bodies[i]);
  }
  started = seconds();
  for (step = 0; step < steps; ++step) {
    dSpaceCollide(space, 0, &onPair);
    if (quick) {
      dWorldQuickStep(world, 1.0 / 240);
    } else {
      dWorldStep(world, 1.0 / 240);
    }
    dJointGroupEmpty(joints);
  }
  spent = seconds() - started;
  for (i = 0; i < count; ++i) {
    const dReal *p = dBodyGetPosition(bodies[i]), *r = dBodyGetRotation(bodies[i]);
    const double cosine = r[10] > 1 ? 1 : r[10] < -1 ? -1 : r[10];
    worstDrift = fmax(worstDrift, sqrt(p[0] * p[0] + p[1] * p[1]));
    worstTilt = fmax(worstTilt, acos(cosine) * 57.29577951308232);
    worstSink = fmax(worstSink, fabs(p[2] - 0.5 - i));
  }
  printf(
      "{\"boxes\": %d, \"triangles_per_box\": %d, \"steps\": %d, \"drift_m\": %.6g, \"tilt_deg\": %.6g, "
      "\"height_error_m\": %.6g, \"contacts_per_step\": %.4g, \"collide_ms_per_step\": %.4g, \"ms_per_step\": %.4g}\n",
      count, cuts > 0 ? box.triangleCount : 0, steps, worstDrift, worstTilt, worstSink, (double)contactCount / steps,
      1e3 * collideSeconds / steps, 1e3 * spent / steps);
  dJointGroupDestroy(joints);
  dSpaceDestroy(space);
  dWorldDestroy(world);
  dGeomTriMeshDataDestroy(boxData);
  dGeomTriMeshDataDestroy(groundData);
  dCloseODE();
  return 0;
}
