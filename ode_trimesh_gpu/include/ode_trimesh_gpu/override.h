/* SPDX-License-Identifier: BSD-3-Clause */
/* ODE's own triangle meshes collide through this library, in programs that go on using dTriMesh. */
#ifndef ODE_TRIMESH_GPU_OVERRIDE_H
#define ODE_TRIMESH_GPU_OVERRIDE_H

#include <ode/common.h>
/* In this order: ODE's header of triangle meshes does not include what it needs. */
#include <ode/collision_trimesh.h>

#include "export.h"
#include "params.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief From here on, two geoms of ODE's class dTriMesh collide through this library.
 *
 *     dInitODE2(0);
 *     dGpuTriMeshOverrideTriMesh();
 *     ... the program as it is, with dCreateTriMesh() and its dTriMeshDataIDs ...
 *
 * Contacts are those of two geoms of this library's class with the same triangles (see dCreateGpuTriMesh()); sides are
 * ODE's numbers of triangles. dTriCallback, dTriArrayCallback and dTriTriMergeCallback of the geoms are called (see
 * callbacks.h), which ODE itself does not do for two meshes. Last transforms (dGeomTriMeshSetLastTransform()) give the
 * direction of motion of geoms that have no body. Pairs with other classes stay ODE's, unless
 * dGpuTriMeshOverrideTriMeshWith() takes them over, too; so do the boxes of the geoms.
 *
 * Triangles are read through dGeomTriMeshGetTriangle(), once for each dTriMeshDataID, when one of its geoms collides
 * first. ODE does not report changes. Each time that a geom collides, the number of triangles and 32 of the triangles
 * are compared with those that were read. The next time it is 32 others. A change that reaches every triangle is
 * noticed at once, and so is every change to meshes of up to 32 triangles. A change to a single triangle of F is
 * noticed after F collisions at the latest. After a change that is smaller, call dGpuTriMeshOverrideDataChanged().
 * Vertices that moved are refitted; other triangles are built anew. What is kept of destroyed data is freed when they
 * are forgotten (dGpuTriMeshOverrideForgetData()), or when their dTriMeshDataID is used again. Of many the oldest are
 * freed in time. A geom that is created where another one was destroyed goes on with that one's parameters and
 * statistics, unless dGpuTriMeshOverrideForgetGeom() was called.
 *
 * ODE keeps no way back: the pair collides through this library until dCloseODE(). After the next dInitODE2() call this
 * function again. Of colliders that others have set for the pair the last one holds.
 *
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ODE, dGPUTRIMESH_ERROR_PRECISION, dGPUTRIMESH_ERROR_MEMORY. It may be
 * called any number of times.
 * @remarks The thread rule of dGpuTriMeshInit(), which need not be called: no class of ODE's is taken.
 * @remarks Any number of threads may collide afterwards. Which mesh of a pair the computation is done in depends on
 *          which of the two was seen first: threads that collide geoms for the first time at once may take turns in
 *          that. dGpuTriMeshOverridePrepare() settles it.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverrideTriMesh(void);

/**
 * @brief All pairs that dGpuTriMeshOverrideTriMeshWith() knows.
 * @ingroup gputrimesh
 */
enum { dGPUTRIMESH_OVERRIDE_ALL = -1 };

/**
 * @brief From here on, dTriMesh geoms collide through this library with geoms of one more of ODE's own classes.
 *
 * Contacts are those of a geom of this library's class with the same triangles: see docs/primitives.md for the method
 * of each pair. Callbacks of the dTriMesh are called as callbacks.h says, the ray callback for rays. What is said of
 * dGpuTriMeshOverrideTriMesh() about data, threads, and the way back holds for these pairs as well.
 * @param geomClass  dSphereClass, dBoxClass, dCapsuleClass, dCylinderClass, dPlaneClass, dRayClass, dConvexClass,
 *                   dHeightfieldClass (see heightfield.h: register its heights), dTriMeshClass (this is what
 *                   dGpuTriMeshOverrideTriMesh() does), or dGPUTRIMESH_OVERRIDE_ALL
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_ODE, dGPUTRIMESH_ERROR_PRECISION,
 *          dGPUTRIMESH_ERROR_MEMORY. It may be called any number of times.
 * @remarks The thread rule of dGpuTriMeshInit().
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverrideTriMeshWith(int geomClass);

/**
 * @brief Chooses how dTriMesh geoms collide: those that exist, and those to come.
 *
 * It replaces the choices of single geoms that were made before. After dGpuTriMeshOverrideTriMesh() a dTriMesh may also
 * have choices of its own: dGeomGpuTriMeshSetParams(), dGeomGpuTriMeshSetBackend(), dGeomGpuTriMeshEnableTC(),
 * dGeomGpuTriMeshSetLastTransform(), dGeomGpuTriMeshSetPairCallback(), the functions of stats.h and history.h take one.
 * The other callbacks of a dTriMesh are set with ODE's own functions, such as dGeomTriMeshSetCallback().
 * @param params  as in dGeomGpuTriMeshSetParams()
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT.
 * @remarks Not while another thread collides.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverrideSetParams(const dGpuTriMeshParams* params);

/**
 * @brief What dGpuTriMeshOverrideSetParams() set last; before its first call the defaults of dGpuTriMeshParamsInit().
 * @param params  `params->size` must be sizeof(dGpuTriMeshParams)
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT.
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverrideGetParams(dGpuTriMeshParams* params);

/**
 * @brief Reads the mesh of a dTriMesh now, so that its first collision does not wait for it, and gives it its place in
 *        the order of geoms.
 * @param g  a geom of dTriMeshClass
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_CLASS; dGPUTRIMESH_ERROR_MESH if it has no data, no triangles or vertices
 *          that are not finite: such a mesh touches nothing; dGPUTRIMESH_ERROR_MEMORY.
 * @remarks From any thread and from a near callback, but not while another thread changes the data of the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverridePrepare(dGeomID g);

/**
 * @brief Says that data were built anew or updated (dGeomTriMeshDataUpdate()): they are read again when one of their
 *        geoms collides next.
 * @param data  may be NULL or unknown: then nothing is done
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshOverrideDataChanged(dTriMeshDataID data);

/**
 * @brief Frees what is kept of data that are to be destroyed, or were. NULL does nothing.
 * @param data  may be NULL
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshOverrideForgetData(dTriMeshDataID data);

/**
 * @brief Frees what is kept of a dTriMesh that is to be destroyed, or was: its parameters, statistics and history. NULL
 *        does nothing.
 * @param g  of dTriMeshClass; it is not looked at, so that it may be gone already
 * @remarks From any thread and from a near callback, but not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshOverrideForgetGeom(dGeomID g);

/**
 * @brief What dTriMesh geoms have done through this library since the program began. Filled by
 *        dGpuTriMeshOverrideGetStats().
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshOverrideStats {
  dsizeint size;    /**< sizeof(dGpuTriMeshOverrideStats) of your program; set by ...Init */
  duint64 queries;  /**< pairs that collided, with one another or with other classes */
  duint64 contacts; /**< that came of it */
  duint64 builds;   /**< meshes that were read and built */
  duint64 refits;   /**< meshes whose vertices had moved, read and refitted */
  duint64 kept;     /**< dTriMeshDataIDs of which a mesh is kept now */
} dGpuTriMeshOverrideStats;

/**
 * @brief Sets the size and zeroes the rest. NULL does nothing.
 * @param stats  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshOverrideStatsInit(dGpuTriMeshOverrideStats* stats);

/**
 * @brief Reads these numbers.
 * @param stats  `stats->size` must be sizeof(dGpuTriMeshOverrideStats): see dGpuTriMeshOverrideStatsInit()
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_ARGUMENT.
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverrideGetStats(dGpuTriMeshOverrideStats* stats);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_OVERRIDE_H */
