/* SPDX-License-Identifier: BSD-3-Clause */
/* Everything that the library offers to C and C++ programs. It reads as ODE's own headers do and needs nothing but
 * them.
 *
 *     dInitODE2(0);
 *     dGpuTriMeshInit();
 *     dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
 *     dGpuTriMeshDataBuildSingle(data, vertices, 12, vertexCount, indices, 3 * triangleCount, 12);
 *     dGeomID geom = dCreateGpuTriMesh(space, data);
 *     dGeomSetBody(geom, body);
 *
 * From here on the geom takes part in dSpaceCollide() and dCollide() as any other. */
#ifndef ODE_TRIMESH_GPU_H
#define ODE_TRIMESH_GPU_H

#include "backend.h"
#include "batch.h"
#include "callbacks.h"
#include "contact_data.h"
#include "cook.h"
#include "export.h"
#include "geom.h"
#include "heightfield.h"
#include "history.h"
#include "join.h"
#include "library.h"
#include "mass.h"
#include "override.h"
#include "params.h"
#include "queries.h"
#include "report.h"
#include "stats.h"
#include "trimesh_data.h"
#include "version.h"

#endif /* ODE_TRIMESH_GPU_H */
