/* SPDX-License-Identifier: BSD-3-Clause */
/* Callbacks by which a program has its say about single triangles while geoms collide. */
#ifndef ODE_TRIMESH_GPU_CALLBACKS_H
#define ODE_TRIMESH_GPU_CALLBACKS_H

#include <ode/common.h>
/* In this order: ODE's header of triangle meshes does not include what it needs. */
#include <ode/collision_trimesh.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Says for two triangles that intersect whether they may collide.
 *
 * All callbacks of this header are called by the thread that collides the pair, with ODE's space locked as in a near
 * callback. The call comes from inside dCollide(), dGpuTriMeshCollidePairs() or dGpuTriMeshBatchSubmit(). They may read
 * geoms and collide other pairs; they must not change geoms, throw or jump out. They are called for pairs of meshes
 * too, which ODE's own never are. They get the triangles that intersect, and those that a contact names besides (of a
 * vertex inside the other mesh), each once in a query. Numbers of triangles are those of your arrays. Pairs with
 * callbacks are not prefetched, and their contacts are made by the CPU.
 *
 * Where a callback rejects something, the contacts of the query come from the remaining pairs of triangles, as with
 * dGPUTRIMESH_CONTACTS_PAIRWISE: what is left of a surface bounds no solid.
 *
 * With ODE's own geoms they get the triangles that have a point inside the other geom; with a heightfield, those that
 * intersect its ground. ODE calls them for these geoms, too, but with more triangles, near ones as well as touched
 * ones, and never for planes. Where a callback rejects something, the other geom meets an open mesh of the touched
 * triangles that remain: a ball falls through a hole made in this way, and one that is too large rests on the rim.
 *
 * @param own             the geom that has the callback
 * @param other           the geom that it collides with
 * @param own_triangle    number of the triangle of `own`
 * @param other_triangle  number of the triangle of `other`
 * @returns 0 if these two may not collide; else they may. Where both geoms have such a callback both have to agree.
 * @ingroup gputrimesh
 */
typedef int dGpuTriMeshPairCallback(dGeomID own, dGeomID other, int own_triangle, int other_triangle);

/**
 * @brief Sets the callback for pairs of triangles. ODE has no counterpart. With geoms of ODE's own it is not called.
 * @param g         a geom of this class, or a dTriMesh that dGpuTriMeshOverrideTriMesh() has collide through this
 * library
 * @param Callback  NULL for none
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_CLASS.
 * @remarks Not while another thread collides the geom. This holds for the other functions of this header as well.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetPairCallback(dGeomID g, dGpuTriMeshPairCallback* Callback);
/**
 * @brief The callback for pairs of triangles.
 * @param g  as in dGeomGpuTriMeshSetPairCallback()
 * @returns What was set; NULL for none and for geoms of other classes. This holds for the other Get functions as well.
 * @remarks May be called from a near callback. So may the other Get functions of this header.
 * @ingroup gputrimesh
 */
OTG_API dGpuTriMeshPairCallback* dGeomGpuTriMeshGetPairCallback(dGeomID g);

/**
 * @brief Sets ODE's callback for single triangles: it gets the geom, the other geom and a triangle of the geom, and
 *        returns 0 if that triangle may not collide. The counterpart of dGeomTriMeshSetCallback().
 * @param g         a geom of this class
 * @param Callback  NULL for none
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_CLASS.
 * @remarks Not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetCallback(dGeomID g, dTriCallback* Callback);
/**
 * @brief The callback for single triangles; the counterpart of dGeomTriMeshGetCallback().
 * @param g  a geom of this class
 * @returns What was set; NULL for none and for geoms of other classes.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API dTriCallback* dGeomGpuTriMeshGetCallback(dGeomID g);

/**
 * @brief Sets ODE's callback for all triangles at once: it gets the geom, the other geom, and the triangles of the geom
 *        that intersect the other one in ascending order, before the callback for any one of them. It is not called
 *        when there are none. The counterpart of dGeomTriMeshSetArrayCallback().
 * @param g              a geom of this class
 * @param ArrayCallback  NULL for none. The array that it gets lives until it returns
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_CLASS.
 * @remarks Not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetArrayCallback(dGeomID g, dTriArrayCallback* ArrayCallback);
/**
 * @brief The callback for all triangles at once; the counterpart of dGeomTriMeshGetArrayCallback().
 * @param g  a geom of this class
 * @returns What was set; NULL for none and for geoms of other classes.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API dTriArrayCallback* dGeomGpuTriMeshGetArrayCallback(dGeomID g);

/**
 * @brief Sets ODE's callback for rays: it gets the geom, the ray, a triangle that the ray meets and the barycentric
 *        coordinates of the point, u of the second corner and v of the third, and returns 0 if the ray passes there.
 * The counterpart of dGeomTriMeshSetRayCallback(). Pairs of meshes do not use it.
 * @param g         a geom of this class
 * @param Callback  NULL for none
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_CLASS.
 * @remarks Not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetRayCallback(dGeomID g, dTriRayCallback* Callback);
/**
 * @brief The callback for rays; the counterpart of dGeomTriMeshGetRayCallback().
 * @param g  a geom of this class
 * @returns What was set; NULL for none and for geoms of other classes.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API dTriRayCallback* dGeomGpuTriMeshGetRayCallback(dGeomID g);

/**
 * @brief Sets ODE's callback for merged triangles: it gets the geom and two numbers and returns the number that shall
 *        stand for both. The counterpart of dGeomTriMeshSetTriMergeCallback().
 *
 * The library moves no contacts together, but it leaves contacts out (dGpuTriMeshParams::reduction,
 * contacts_per_region, the size of the caller's array). One that is left out is stood for by the nearest one that is
 * kept in its region. The kept one's `side1` or `side2` is its own triangle, merged with the triangles of those that it
 * stands for in ascending order.
 * @param g         a geom of this class
 * @param Callback  NULL for none: contacts have their own triangles
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_CLASS.
 * @remarks Not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetTriMergeCallback(dGeomID g, dTriTriMergeCallback* Callback);
/**
 * @brief The callback for merged triangles; the counterpart of dGeomTriMeshGetTriMergeCallback().
 * @param g  a geom of this class
 * @returns What was set; NULL for none and for geoms of other classes.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API dTriTriMergeCallback* dGeomGpuTriMeshGetTriMergeCallback(dGeomID g);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_CALLBACKS_H */
