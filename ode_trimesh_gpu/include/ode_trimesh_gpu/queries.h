/* SPDX-License-Identifier: BSD-3-Clause */
/* Queries of mesh geoms beside contacts: nearest points, distances, overlap, rays; one by one and in arrays.
 */
#ifndef ODE_TRIMESH_GPU_QUERIES_H
#define ODE_TRIMESH_GPU_QUERIES_H

#include <ode/common.h>

#include "batch.h"
#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What holds for all functions of this header: positions and directions are in the world, lengths in its unit; meshes
 * are where their geoms are at the moment of the call. They compute in double precision on the mesh's vertices, which
 * are single precision numbers in the mesh's frame. Single queries run on the CPU. Arrays of points, of rays, and of
 * pairs (overlap, distance) run where the geoms' parameters, else dGpuTriMeshSetBackend(), say; `auto` takes what is
 * expected to be faster. Results are the same there, byte for byte. The functions only read: any number of threads may
 * call them at once, from near callbacks too. Functions that take arrays share the work among the threads that
 * dGpuTriMeshSetThreadCount() allows; results do not depend on it. Structures that are filled need no preparation.
 * Triangles are numbered as in dGeomGpuTriMeshGetTriangle(). A geom without mesh has no surface. */

/**
 * @brief The point of a mesh's surface that is nearest to a given point.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshClosestPoint {
  dVector3 pos;    /**< the nearest point of the surface; pos[3] is 0 */
  dVector3 normal; /**< unit: the surface's outward normal there. On an edge the mean of its faces', at a corner the
                      mean of its faces' weighted by their angles */
  dReal distance;  /**< from the given point; negative inside of a solid and behind a sheet (see
                      dGPUTRIMESH_CONTACTS_SOLID), never negative for other meshes. Infinite without a surface */
  int triangle;    /**< that the point belongs to; -1 without a surface */
} dGpuTriMeshClosestPoint;

/**
 * @brief Nearest point of the surface and signed distance of a point. Always on the CPU.
 *
 * The search goes through the tree, nearer boxes first. The sign is the parity of crossings along rays for a solid, the
 * side of the angle-weighted normal for a sheet (Baerentzen and Aanaes, 2005); beyond a sheet's rim the distance is
 * positive.
 * @param g      a geom of this class
 * @param point  x, y, z
 * @param out    receives the result
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT (a null pointer or a point that is not finite),
 *          dGPUTRIMESH_ERROR_CLASS or dGPUTRIMESH_ERROR_POSE; after an error nothing was written.
 * @sa dGeomGpuTriMeshClosestPoints
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshClosestPoint(dGeomID g, const dVector3 point, dGpuTriMeshClosestPoint* out);

/**
 * @brief dGeomGpuTriMeshClosestPoint() for an array of points, on the CPU's threads or with an OpenCL device
 *        (dGeomGpuTriMeshSetBackend()).
 * @param g       a geom of this class
 * @param points  x, y, z of each
 * @param stride  bytes from one point to the next, at least three dReal; sizeof(dVector3) for an array of these
 * @param count   how many, 0 or more
 * @param out     receives as many results
 * @returns As dGeomGpuTriMeshClosestPoint(), and dGPUTRIMESH_ERROR_MEMORY.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshClosestPoints(dGeomID g, const dReal* points, int stride, int count,
                                         dGpuTriMeshClosestPoint* out);

/**
 * @brief Which of an array of points lie inside a solid mesh, or behind a sheet: where the distance of
 *        dGeomGpuTriMeshClosestPoint() would be negative. Points on the surface may be taken for either.
 *        Where they are computed: as with dGeomGpuTriMeshClosestPoints().
 * @param g       a geom of this class
 * @param points  x, y, z of each
 * @param stride  bytes from one point to the next, at least three dReal
 * @param count   how many, 0 or more
 * @param inside  receives 1 or 0 for each
 * @returns The number of points inside, or a negative status as dGeomGpuTriMeshClosestPoints().
 * @remarks From any number of threads at once, and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshPointsInside(dGeomID g, const dReal* points, int stride, int count, unsigned char* inside);

/**
 * @brief How far two meshes are apart, and where.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshDistance {
  dReal distance; /**< of the nearest points; 0 for meshes that overlap, a solid that holds the other one among them;
                     infinite if a geom has no surface or nothing is within the limit */
  dVector3 pos1;  /**< the nearest point of o1's surface; pos1[3] is 0. Of meshes that overlap a point that both have */
  dVector3 pos2;  /**< the nearest point of o2's surface */
  int triangle1;  /**< that pos1 belongs to; -1 inside of a solid, and without a result */
  int triangle2;  /**< that pos2 belongs to */
} dGpuTriMeshDistance;

/**
 * @brief The distance of two meshes with the points that have it. Always on the CPU.
 *
 * Overlap is exact. Distances of meshes apart are right to rounding (branch and bound over both trees; nearest points
 * of triangles after Ericson, 2005). Of triangles that are equally near, the result has those that come first in the
 * library's own order. Those of the one mesh come before those of the other.
 * @param o1     a geom of this class
 * @param o2     another one
 * @param limit  nothing farther apart is looked for, which is quicker; dInfinity for no limit
 * @param out    receives the result
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT (a null pointer, a negative limit or NaN),
 * dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_POSE or dGPUTRIMESH_ERROR_MEMORY; after an error nothing was written.
 * @sa dGpuTriMeshGetDistances
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetDistance(dGeomID o1, dGeomID o2, dReal limit, dGpuTriMeshDistance* out);

/**
 * @brief dGpuTriMeshGetDistance() for an array of pairs, on the CPU's threads or with an OpenCL device.
 * @param pairs  geoms of this class
 * @param count  how many pairs, 0 or more
 * @param limit  for all of them
 * @param out    receives as many results
 * @returns As dGpuTriMeshGetDistance(); after an error the results are of no use.
 * @remarks On devices: of two geoms with different choices the CPU wins over devices, and both over `auto`.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetDistances(const dGpuTriMeshPair* pairs, int count, dReal limit, dGpuTriMeshDistance* out);

/**
 * @brief Whether two meshes overlap: triangles have a point in common, exactly, or a part of one lies inside the other
 *        one if that is a solid. Ends with the first such place, so that it is quicker than contacts are.
 * @param o1  a geom of this class
 * @param o2  another one
 * @returns 1 if they do, 0 if not; dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_POSE or dGPUTRIMESH_ERROR_MEMORY.
 * @sa dGpuTriMeshOverlaps
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverlap(dGeomID o1, dGeomID o2);

/**
 * @brief dGpuTriMeshOverlap() for an array of pairs.
 * @param pairs  geoms of this class
 * @param count  how many pairs, 0 or more
 * @param out    receives 1 or 0 for each
 * @returns The number of pairs that overlap, or a negative status: as dGpuTriMeshOverlap(), and
 *          dGPUTRIMESH_ERROR_ARGUMENT. After an error the results are of no use.
 * @remarks From any number of threads at once, and from a near callback. On devices: of two geoms with different
 * choices the CPU wins over devices, and both over `auto`. Whether a part of one mesh lies inside the other one, which
 * matters where no triangles meet, is found out by the CPU's threads.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOverlaps(const dGpuTriMeshPair* pairs, int count, unsigned char* out);

/**
 * @brief A ray that is not a geom.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshRay {
  dVector3 start;     /**< where it begins */
  dVector3 direction; /**< of any length but zero */
  dReal length;       /**< how far it goes; may be dInfinity */
} dGpuTriMeshRay;

/**
 * @brief Where a ray meets a mesh first.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshRayHit {
  dVector3 pos;    /**< pos[3] is 0 */
  dVector3 normal; /**< unit normal of the triangle, on the side from which the ray comes */
  dReal distance;  /**< along the ray; infinite without a hit */
  int triangle;    /**< -1 without a hit */
  int back;        /**< 1 if the triangle was hit from behind, else 0 */
} dGpuTriMeshRayHit;

/**
 * @brief Which hits of rays count. Added up.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_RAY_CULL_BACK = 1, /**< triangles hit from behind do not count */
  dGPUTRIMESH_RAY_ANY = 2        /**< any hit will do: for questions of sight. Which one you get is open; today the
                                    closest one, as that takes hardly longer and is the same wherever it is computed */
};

/**
 * @brief Casts an array of rays at a mesh, on the CPU's threads or with an OpenCL device (dGeomGpuTriMeshSetBackend());
 *        each gets its closest hit.
 *
 * For single rays in a world use ODE's own: dCreateRay() and dCollide(). What they give with a mesh of this class:
 * contacts sorted by distance (`depth`), closest first, with the triangle in `side1` or `side2`. The normal faces the
 * ray's start if the ray is the first geom of the call. dGeomRaySetClosestHit() leaves the closest one alone,
 * dGeomRaySetFirstContact() any one, dGeomRaySetBackfaceCull() drops those from behind. A ray through an edge or a
 * corner hits one of its triangles. Arrays call no ray callback.
 * @param g      a geom of this class
 * @param rays   the rays
 * @param count  how many, 0 or more
 * @param flags  dGPUTRIMESH_RAY_... added up, or 0
 * @param hits   receives as many results
 * @returns The number of rays that hit; dGPUTRIMESH_ERROR_ARGUMENT (a null pointer, unknown flags, a ray that is not
 * finite, has no direction or a negative length); dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_POSE or
 *          dGPUTRIMESH_ERROR_MEMORY; after an error the results are of no use.
 * @remarks Source of the method: Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997. A ray
 * cannot slip between two triangles of one edge. Of triangles that are hit at the same distance the result has the one
 * that comes first in the library's own order; it does not depend on the tree. Where a ray grazes a triangle, rounding
 * may move the crossing anywhere; it counts no earlier than where the ray enters the triangle's box.
 * @remarks As dCollide(): from any number of threads at once, and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshCastRays(dGeomID g, const dGpuTriMeshRay* rays, int count, int flags,
                                    dGpuTriMeshRayHit* hits);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_QUERIES_H */
