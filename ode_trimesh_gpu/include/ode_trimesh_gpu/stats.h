/* SPDX-License-Identifier: BSD-3-Clause */
/* What the collisions of a geom amounted to, in numbers. */
#ifndef ODE_TRIMESH_GPU_STATS_H
#define ODE_TRIMESH_GPU_STATS_H

#include <ode/common.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Sums over the collisions of a geom since it was created or its statistics were reset. A collision of two geoms
 * of this class counts for both. Of collisions with geoms of ODE's own only queries, failed_queries, contacts and
 * prefetched are counted.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshStats {
  dsizeint size;           /**< sizeof(dGpuTriMeshStats) of your program; set by ...Init */
  duint64 queries;         /**< times that dCollide() came to this geom, and pairs of it in arrays of pairs */
  duint64 failed_queries;  /**< of these, those that gave no contacts because a pose was not finite or not rigid, a mesh
                              was being changed, a heightfield's heights are not known or make no ground, or memory
                              was short; dGpuTriMeshGetError() of the thread says which */
  duint64 box_tests;       /**< pairs of boxes compared */
  duint64 candidate_pairs; /**< pairs of triangles whose boxes overlap */
  duint64 intersecting_pairs;        /**< of these, the ones that intersect or touch */
  duint64 decided_by_double;         /**< candidate pairs that single precision could not decide */
  duint64 decided_exactly;           /**< of these, the ones that double precision could not decide either */
  duint64 contacts_before_reduction; /**< contacts that were found */
  duint64 contacts;                  /**< handed to callers */
  duint64 prefetched; /**< queries whose contacts were ready: of dGpuTriMeshPrefetch(), dGpuTriMeshPrefetchSpaces() or
                         dGpuTriMeshCollideSpace() */
  duint64 on_device;  /**< queries that an OpenCL device computed, in whole or in part. What a device does in one batch
                         with others counts as query and contacts; the sums above do not have its other numbers */
  duint64 device_failures; /**< queries that a device was given and failed to do: the CPU did them */
} dGpuTriMeshStats;

/**
 * @brief Sets the size and zeroes the rest. NULL does nothing.
 * @param stats  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshStatsInit(dGpuTriMeshStats* stats);

/**
 * @brief Reads the statistics of a geom.
 * @param g      a geom of this class
 * @param stats  `stats->size` must be sizeof(dGpuTriMeshStats): see dGpuTriMeshStatsInit()
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT or dGPUTRIMESH_ERROR_CLASS.
 * @remarks May be called from any thread at any time, a near callback included; the numbers of a collision that is
 * under way in another thread may be there in part.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshGetStats(dGeomID g, dGpuTriMeshStats* stats);

/**
 * @brief Sets all sums of a geom to zero.
 * @param g  a geom of this class
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_CLASS.
 * @remarks May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshResetStats(dGeomID g);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_STATS_H */
