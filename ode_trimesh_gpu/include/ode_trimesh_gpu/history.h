/* SPDX-License-Identifier: BSD-3-Clause */
/* What pairs of geoms remember from step to step, to be saved with a simulation and put back. */
#ifndef ODE_TRIMESH_GPU_HISTORY_H
#define ODE_TRIMESH_GPU_HISTORY_H

#include <ode/common.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Writes what the pairs among some geoms remember of their last queries (see dGPUTRIMESH_HISTORY_ON).
 *
 * A program that saves the states of its bodies and this, and puts both back, continues with the same bytes. The geoms
 * are known by their places in the array: list them in an order of your own that you can repeat, such as that of their
 * creation. The order in a space changes as geoms move. What a pair remembers with a geom that is not listed is left
 * out. The bytes are the same on every machine and carry a version and a checksum.
 *
 * @param geoms     geoms in your order: meshes, of this class or dTriMesh geoms that collide through this library, and
 * the geoms of ODE's own (inside a dGeomTransform: the inner ones) that they meet. NULL is passed over
 * @param count     how many
 * @param buffer    receives the bytes; may be NULL when capacity is 0
 * @param capacity  its size in bytes
 * @returns The number of bytes that are needed; they were written if that is no more than the capacity, else nothing
 *          was. 0 after an error (see dGpuTriMeshGetError()): dGPUTRIMESH_ERROR_ARGUMENT for a negative count, a null
 *          array or a geom that is listed twice, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Between two steps: not while another thread collides the geoms.
 * @remarks Not saved because ODE has no way to put it back: the order of geoms in a space, which decides in which order
 *          dSpaceCollide() finds the pairs and thereby in which order contact joints are made; the solvers depend on
 *          that. A reloaded world that shall continue with the same bytes must collide its pairs in the same order. And
 *          dBodySetQuaternion() normalises what it is given: set the states of the running world from the saved ones,
 *          too, or save after that.
 * @ingroup gputrimesh
 */
OTG_API dsizeint dGpuTriMeshHistorySave(const dGeomID* geoms, int count, void* buffer, dsizeint capacity);

/**
 * @brief Puts back what dGpuTriMeshHistorySave() wrote. What the listed geoms remember now is forgotten.
 * @param geoms   the geoms that stand for the saved ones, in the same order, with the same meshes. Of two that were
 *                saved as a pair, the one created first must be the same one: see dCreateGpuTriMesh()
 * @param count   as many as were saved
 * @param buffer  the bytes
 * @param size    how many
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_ARGUMENT if the bytes are not what was saved (length, version, checksum,
 *          values), or do not fit the geoms (count, class, order of creation); dGPUTRIMESH_ERROR_MEMORY. After an error
 *          nothing has changed.
 * @remarks Between two steps: not while another thread collides the geoms.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshHistoryLoad(const dGeomID* geoms, int count, const void* buffer, dsizeint size);

/**
 * @brief Makes a geom forget all pairs that it remembers: as if none of them had been queried before. Call it for
 *        geoms that are put somewhere else at will (a reset of the scene); poses far from the last ones are noticed
 *        without it.
 * @param g  a geom of this class, or a dTriMesh that dGpuTriMeshOverrideTriMesh() has collide through this library
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_CLASS.
 * @remarks Not while another thread collides the geom. A pair of meshes is remembered by the geom created second: to
 *          make sure of a pair, call it for both. One with a geom of ODE's own is remembered by the mesh.
 * @sa dGeomGpuTriMeshClearTCCache(), which reaches what the other meshes remember of the geom, too
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshForgetHistory(dGeomID g);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_HISTORY_H */
