/* SPDX-License-Identifier: BSD-3-Clause */
/* Cooked meshes: mesh data with their tree, topology and report as bytes or as a file, read much faster than built. */
#ifndef ODE_TRIMESH_GPU_COOK_H
#define ODE_TRIMESH_GPU_COOK_H

#include <ode/common.h>

#include "export.h"
#include "trimesh_data.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Writes a built mesh as bytes: vertices, triangles, topology, tree, mass and report. What is loaded from them
 *        collides with the same contacts, byte for byte.
 *
 * The bytes are the same on every machine, little end first. They carry a version, their length and a checksum; a
 * library reads its own version alone. Flags of dGpuTriMeshDataSet() are not among them.
 * @param g         the object, built before
 * @param buffer    receives the bytes; may be NULL when capacity is 0
 * @param capacity  its size in bytes
 * @returns The number of bytes that are needed; they were written if that is no more than the capacity, else nothing
 *          was. 0 after an error (see dGpuTriMeshGetError()): dGPUTRIMESH_ERROR_ARGUMENT for NULL or an object that was
 *          not built, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks May be called from a near callback, and from several threads for one object.
 * @ingroup gputrimesh
 */
OTG_API dsizeint dGpuTriMeshDataCook(dGpuTriMeshDataID g, void* buffer, dsizeint capacity);

/**
 * @brief Fills an object from bytes of dGpuTriMeshDataCook(), in place of building it.
 *
 * Bytes that are something else, of another version, cut off, changed, or whose numbers do not fit each other are
 * refused; dGpuTriMeshDataGetErrorString() says which. That holds for bytes from strangers, too, with a checksum that
 * is right (docs/cooking.md). Geoms that use the object have the new mesh from now on, as after a Build; after an error
 * it keeps the mesh that it had. Reading takes a third to an eighth of the time of a build.
 * @param g       the object
 * @param buffer  the bytes; they need not outlive the call, nor be aligned
 * @param size    how many
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_ARGUMENT for NULL; dGPUTRIMESH_ERROR_COOKED if the bytes are refused;
 *          dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not from a near callback when geoms use the object.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUncook(dGpuTriMeshDataID g, const void* buffer, dsizeint size);

/**
 * @brief dGpuTriMeshDataCook() into a file. It is written beside (with ".partial" after the name) and then put in place
 *        of one that is there, so that no reader finds half of it.
 * @param g     the object, built before
 * @param path  in the encoding of fopen()
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_ARGUMENT; dGPUTRIMESH_ERROR_FILE if it cannot be written: errno says why;
 *          dGPUTRIMESH_ERROR_MEMORY.
 * @remarks May be called from a near callback, and from several threads for one object and different files.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataSave(dGpuTriMeshDataID g, const char* path);

/**
 * @brief dGpuTriMeshDataUncook() from a file. It is read, not mapped: what happens to it afterwards does not matter.
 * @param g     the object
 * @param path  in the encoding of fopen()
 * @returns As dGpuTriMeshDataUncook(); dGPUTRIMESH_ERROR_FILE if the file cannot be read: errno says why.
 * @remarks Not from a near callback when geoms use the object.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataLoad(dGpuTriMeshDataID g, const char* path);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_COOK_H */
