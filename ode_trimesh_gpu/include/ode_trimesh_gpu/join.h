/* SPDX-License-Identifier: BSD-3-Clause */
/* Terrain in pieces: geoms that collide as one surface. */
#ifndef ODE_TRIMESH_GPU_JOIN_H
#define ODE_TRIMESH_GPU_JOIN_H

#include <ode/common.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Has geoms whose surfaces continue each other collide as one surface, so that bodies do not notice the seams.
 *
 * Sheets (open meshes whose triangles agree in their winding) hang together where edges of their rims lie on each
 * other. Solids hang together where flat faces, or triangles, lie on each other, edge on edge; there they lose these
 * faces. Vertices meet if they are as near as rounding to single precision leaves them. Each pair of such a geom and
 * another one is then computed with the whole surface, and gets the contacts that lie on the geom: those of all pieces
 * together are those of the whole. `side1` and `side2` are still triangles of the geom, and the geoms of a surface do
 * not collide with each other. Geoms without a neighbour, and pieces that make neither a solid nor a sheet together,
 * stay as they are.
 *
 * @param geoms  geoms of this class, and dTriMesh geoms that collide through this library
 * @param count  how many
 * @returns How many of them are pieces of a surface now; dGPUTRIMESH_ERROR_ARGUMENT for a null array, a negative count
 *          or a geom that is listed twice; dGPUTRIMESH_ERROR_CLASS; dGPUTRIMESH_ERROR_POSE for a pose that is not
 * rigid; dGPUTRIMESH_ERROR_MEMORY. After an error nothing has changed.
 * @remarks The geoms have to stay where they are relative to each other: fixed, or all on one body. One that is
 *          destroyed, or whose mesh or scale changes, has all of its surface collide by themselves again; join them
 * anew. So does a geom that is in another call of this function.
 * @remarks Takes memory for a second copy of the meshes, and about the time of building them. Not while another thread
 *          collides the geoms, and not from a near callback.
 * @remarks Not for rays and queries (queries.h), which are about the geom alone, nor for pairs that have callbacks
 *          (callbacks.h) or have last transforms set. dGpuTriMeshPrefetch() leaves joined geoms to dCollide().
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshJoin(const dGeomID* geoms, int count);

/**
 * @brief Has the geom, and all that it is joined to, collide by themselves again.
 * @param g  a geom of this class, or a dTriMesh
 * @returns dGPUTRIMESH_OK, also for a geom that is not joined; dGPUTRIMESH_ERROR_CLASS.
 * @remarks As dGpuTriMeshJoin().
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshUnjoin(dGeomID g);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_JOIN_H */
