/* SPDX-License-Identifier: BSD-3-Clause */
/* Starting and ending, building meshes from arrays of every kind, making geoms of them, colliding two. */
#include <string.h>

#include "example.h"

static void buildInEveryWay(void) {
  double doubles[8][3];
  dVector3 simple[8];
  float strided[8][5]; /* x, y, z and two numbers that are not the mesh's */
  dTriIndex indices[36];
  dGpuTriMeshBuildParams params;
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  int i, k;
  for (i = 0; i < 8; ++i) {
    for (k = 0; k < 3; ++k) {
      doubles[i][k] = (double)kBoxVertices[i][k];
      simple[i][k] = (dReal)kBoxVertices[i][k];
      strided[i][k] = kBoxVertices[i][k];
    }
    simple[i][3] = 0;
    strided[i][3] = strided[i][4] = 7;
  }
  for (i = 0; i < 36; ++i) indices[i] = (dTriIndex)kBoxTriangles[i / 3][i % 3];

  /* Argument for argument ODE's own functions. Each call gives the object another mesh; arrays are copied. */
  EXPECT(dGpuTriMeshDataBuildSingle(data, strided, sizeof strided[0], 8, kBoxTriangles, 36, 0) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataBuildDouble(data, doubles, 0, 8, kBoxTriangles, 36, 0) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataBuildSimple(data, simple[0], 8, indices, 36) == dGPUTRIMESH_OK);
  /* With an argument for normals, which are not read. */
  EXPECT(dGpuTriMeshDataBuildSingle1(data, kBoxVertices, 0, 8, kBoxTriangles, 36, 0, 0) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataBuildDouble1(data, doubles, 0, 8, kBoxTriangles, 36, 0, 0) == dGPUTRIMESH_OK);
  EXPECT(dGpuTriMeshDataBuildSimple1(data, simple[0], 8, indices, 36, 0) == dGPUTRIMESH_OK);

  /* All of it in one structure, with repairs and a choice of tree. */
  dGpuTriMeshBuildParamsInit(&params);
  params.vertices = kBoxVertices;
  params.vertex_count = 8;
  params.indices = kBoxTriangles;
  params.index_count = 36;
  params.repair = dGPUTRIMESH_REPAIR_ALL;
  params.tree = dGPUTRIMESH_TREE_MEAN_SPLIT;
  EXPECT(dGpuTriMeshDataBuild(data, &params) == dGPUTRIMESH_OK);
  dGpuTriMeshDataDestroy(data);
}

static void readAnError(void) {
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  unsigned wrong[3] = {0, 1, 99};
  EXPECT(dGpuTriMeshDataBuildSingle(data, kBoxVertices, 0, 8, wrong, 3, 0) == dGPUTRIMESH_ERROR_MESH);
  EXPECT(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_MESH); /* of the calling thread; reading it resets it */
  EXPECT(dGpuTriMeshGetError() == dGPUTRIMESH_OK);
  printf("%s: %s\n", dGpuTriMeshErrorString(dGPUTRIMESH_ERROR_MESH), dGpuTriMeshDataGetErrorString(data));
  dGpuTriMeshDataDestroy(data);
}

int main(void) {
  dGpuTriMeshDataID data;
  dGeomID a, b;
  dContactGeom contacts[16];
  int count, major, minor;
  /* The library that is loaded and the headers may differ where programs are not built again. */
  EXPECT(sscanf(dGpuTriMeshGetVersion(), "%d.%d", &major, &minor) == 2);
  EXPECT(major == dGPUTRIMESH_VERSION_MAJOR && minor == dGPUTRIMESH_VERSION_MINOR);
  EXPECT(strstr(dGpuTriMeshGetConfiguration(), "ode_trimesh_gpu") != 0);
  EXPECT(dGpuTriMeshCheckConfiguration(sizeof(dReal) == 8 ? "double_precision" : "single_precision"));
  EXPECT(dInitODE2(0));
  EXPECT(dGpuTriMeshInit());

  buildInEveryWay();
  readAnError();

  data = makeBox();
  a = dCreateGpuTriMesh(0, data);
  b = dCreateGpuTriMesh(0, 0); /* without a mesh it touches nothing */
  EXPECT(dGeomGetClass(a) == dGpuTriMeshGetClass());
  EXPECT(dGeomGpuTriMeshSetData(b, data) == dGPUTRIMESH_OK);
  EXPECT(dGeomGpuTriMeshGetData(b) == data && dGeomGpuTriMeshGetTriMeshDataID(b) == data);
  dGeomSetPosition(b, 0, 0, 0.9);
  count = dCollide(a, b, 16, contacts, sizeof contacts[0]);
  EXPECT(count >= 4);
  EXPECT(isNear(contacts[0].depth, 0.1) && isNear(contacts[0].normal[2], -1)); /* moves a away from b */
  printf("%d contacts, %g deep\n", count, (double)contacts[0].depth);

  dGpuTriMeshDataDestroy(data); /* the geoms keep the mesh */
  EXPECT(dGeomGpuTriMeshGetData(a) == 0);
  EXPECT(dCollide(a, b, 16, contacts, sizeof contacts[0]) == count);
  dGeomDestroy(a);
  dGeomDestroy(b);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
