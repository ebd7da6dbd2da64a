/* SPDX-License-Identifier: BSD-3-Clause */
/* A program that knows nothing of the library and gives ODE what it cannot take: indices of vertices that are not
 * there, meshes without triangles, numbers of contacts that it aborts with. Run with the preload library before it.
 * Exit status 0 if all is answered. */
#include <ode/ode.h>
#include <stdio.h>
#include <string.h>

#define MOST 66000

static const float kVertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const double kDoubles[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const dReal kReals[] = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
static const unsigned kTriangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
static dContactGeom contacts[MOST];
static int failures = 0;

static void check(int good, const char* what, unsigned number) {
  if (good) return;
  printf("FAILED: %s (%u)\n", what, number);
  ++failures;
}

static dTriMeshDataID whole(void) {
  dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildSingle(data, kVertices, 12, 4, kTriangles, 12, 12);
  return data;
}

/* With each of a geom's possible partners, both ways round. */
static int collide_with_all(dGeomID mesh) {
  dTriMeshDataID data = whole();
  dGeomID others[5];
  int i, sum = 0;
  dReal box[6];
  others[0] = dCreateTriMesh(0, data, 0, 0, 0);
  others[1] = dCreateSphere(0, 0.5);
  others[2] = dCreateBox(0, 1, 1, 1);
  others[3] = dCreatePlane(0, 0, 0, 1, 0.1);
  others[4] = dCreateRay(0, 3);
  dGeomRaySet(others[4], 0.2, 0.2, 2, 0, 0, -1);
  dGeomSetPosition(others[0], 0.2, 0.2, 0.2);
  dGeomGetAABB(mesh, box);
  for (i = 0; i < 5; ++i) {
    sum += dCollide(mesh, others[i], 20, contacts, sizeof contacts[0]);
    sum += dCollide(others[i], mesh, 20, contacts, sizeof contacts[0]);
    dGeomDestroy(others[i]);
  }
  dGeomTriMeshDataDestroy(data);
  return sum;
}

/* One bad triangle must leave exactly what is there without it: here three triangles and one without area. */
static void wrong_indices(void) {
  static const unsigned kWrong[] = {4, 5, 1000000, 0x7fffffff, 0x80000000u, 0xffffffffu};
  unsigned i, corner, kind;
  for (i = 0; i < sizeof kWrong / sizeof kWrong[0]; ++i) {
    for (corner = 0; corner < 3; ++corner) {
      for (kind = 0; kind < 4; ++kind) {
        unsigned broken[12], flat[12];
        dTriMeshDataID data = dGeomTriMeshDataCreate(), without = dGeomTriMeshDataCreate();
        dGeomID a, b;
        memcpy(broken, kTriangles, sizeof broken);
        memcpy(flat, kTriangles, sizeof flat);
        broken[6 + corner] = kWrong[i];
        memset(flat + 6, 0, 3 * sizeof flat[0]);
        if (kind == 0) dGeomTriMeshDataBuildSingle(data, kVertices, 12, 4, broken, 12, 12);
        if (kind == 1) dGeomTriMeshDataBuildDouble(data, kDoubles, 24, 4, broken, 12, 12);
        if (kind == 2) dGeomTriMeshDataBuildSimple(data, kReals, 4, broken, 12);
        if (kind == 3) dGeomTriMeshDataBuildSingle1(data, kVertices, 12, 4, broken, 12, 12, 0);
        dGeomTriMeshDataBuildSingle(without, kVertices, 12, 4, flat, 12, 12);
        a = dCreateTriMesh(0, data, 0, 0, 0);
        b = dCreateTriMesh(0, without, 0, 0, 0);
        check(dGeomTriMeshGetTriangleCount(a) == 4, "the number of triangles", kWrong[i]);
        check(collide_with_all(a) == collide_with_all(b), "a bad triangle touches something", kWrong[i]);
        dGeomTriMeshDataUpdate(data);
        check(collide_with_all(a) == collide_with_all(b), "a bad triangle touches something after an update",
              kWrong[i]);
        dGeomDestroy(a);
        dGeomDestroy(b);
        dGeomTriMeshDataDestroy(data);
        dGeomTriMeshDataDestroy(without);
      }
    }
  }
}

static void no_triangles(void) {
  unsigned kind;
  for (kind = 0; kind < 5; ++kind) {
    dTriMeshDataID data = dGeomTriMeshDataCreate();
    dGeomID mesh;
    int round;
    for (round = 0; round < 2; ++round) {
      if (kind == 0) dGeomTriMeshDataBuildSingle(data, kVertices, 12, 4, kTriangles, 0, 12);
      if (kind == 1) dGeomTriMeshDataBuildSingle(data, 0, 12, 0, 0, 0, 12);
      if (kind == 2) dGeomTriMeshDataBuildDouble(data, kDoubles, 24, 0, kTriangles, 0, 12);
      if (kind == 3) dGeomTriMeshDataBuildSimple(data, kReals, 4, kTriangles, 0);
      if (kind == 4) dGeomTriMeshDataBuildSimple1(data, 0, 0, 0, 0, 0);
      mesh = dCreateTriMesh(0, data, 0, 0, 0);
      check(dGeomTriMeshGetTriangleCount(mesh) == 0, "triangles in an empty mesh", kind);
      check(collide_with_all(mesh) == 0, "an empty mesh touches something", kind);
      dGeomTriMeshDataUpdate(data);
      check(collide_with_all(mesh) == 0, "an empty mesh touches something after an update", kind);
      dGeomDestroy(mesh);
      /* A mesh that has triangles from now on, and then none again. */
      dGeomTriMeshDataBuildSingle(data, kVertices, 12, 4, kTriangles, 12, 12);
      mesh = dCreateTriMesh(0, data, 0, 0, 0);
      check(dGeomTriMeshGetTriangleCount(mesh) == 4, "a mesh that was empty has no triangles", kind);
      check(collide_with_all(mesh) > 5, "a mesh that was empty touches nothing", kind);
      dGeomDestroy(mesh);
    }
    dGeomTriMeshDataDestroy(data);
  }
}

static void numbers_of_contacts(void) {
  dTriMeshDataID data = whole();
  dGeomID a = dCreateTriMesh(0, data, 0, 0, 0), b = dCreateTriMesh(0, data, 0, 0, 0), ball = dCreateSphere(0, 0.5);
  int most;
  dGeomSetPosition(b, 0.2, 0.2, 0.2);
  most = dCollide(a, b, 65535, contacts, sizeof contacts[0]);
  check(most > 0, "no contacts", 65535);
  check(dCollide(a, b, 0, contacts, sizeof contacts[0]) == 0, "contacts that nobody wanted", 0);
  check(dCollide(a, ball, 0, contacts, sizeof contacts[0]) == 0, "contacts with a ball that nobody wanted", 0);
  check(dCollide(a, b, (int)0x80000000u, contacts, sizeof contacts[0]) == 0, "unimportant contacts, but none", 0);
  check(dCollide(a, b, 65536, contacts, sizeof contacts[0]) == most, "more than there is room for", 65536);
  check(dCollide(b, a, 65536, contacts, sizeof contacts[0]) == most, "more than there is room for", 65536);
  check(dCollide(a, b, 1, contacts, sizeof contacts[0]) == 1, "one contact", 1);
  dGeomDestroy(a);
  dGeomDestroy(b);
  dGeomDestroy(ball);
  dGeomTriMeshDataDestroy(data);
}

int main(void) {
  dInitODE2(0);
  wrong_indices();
  no_triangles();
  numbers_of_contacts();
  dCloseODE();
  puts(failures == 0 ? "all answered" : "not all answered");
  return failures == 0 ? 0 : 1;
}
