/* SPDX-License-Identifier: BSD-3-Clause */
/* The geom: creation, data, parameters, triangles. */
#ifndef ODE_TRIMESH_GPU_GEOM_H
#define ODE_TRIMESH_GPU_GEOM_H

#include <ode/common.h>

#include "export.h"
#include "params.h"
#include "trimesh_data.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Creates a triangle-mesh geom and adds it to a space.
 *
 * The geom is placeable: it takes bodies, positions, rotations and offsets as any other. It may be put in any space or
 * in a dGeomTransform. dGeomDestroy() destroys it, or its space does. Two geoms of this class collide in dCollide():
 * - contacts point as ODE's do: moving the body of `g1` along `normal` by `depth` separates the pair;
 * - `side1` and `side2` are the numbers of the triangles of `g1` and `g2`;
 * - dCollide(a, b) and dCollide(b, a) give the same contacts in the same order with sides exchanged and normals
 * negated;
 * - when there are more contacts than places, the deepest of every separate region of contact are kept, then those most
 *   spread out; with CONTACTS_UNIMPORTANT the first ones found, without reduction.
 *
 * The geom's box is that of its mesh. With a mesh that is no solid it reaches up to 5 % of the mesh's radius beyond
 * that, unless dGpuTriMeshParams::contact_model is PAIRWISE. Bodies that lie on a shell are then queried before and
 * while they touch.
 *
 * It collides with ODE's own classes as well: spheres, boxes, capsules, cylinders, planes, rays, convex geoms,
 * heightfields and dTriMesh, bare or inside a dGeomTransform; docs/primitives.md has the method of each pair.
 *
 * Its pose has to be rigid: R^T R may differ from the identity by at most 1e-3 (root of the sum of the squares of all
 * nine differences). R may not mirror. ODE's own rotations, in single precision too, and long products of them are far
 * within. Up to there the matrix is used as it is; beyond, and with a pose that is not finite, dCollide() finds no
 * contacts. It counts a failed query for both geoms (dGpuTriMeshStats), and dGpuTriMeshGetError() is
 * dGPUTRIMESH_ERROR_POSE. For a mesh of another size or hand see dGeomGpuTriMeshSetScale().
 *
 * @param space  the space to contain the geom; may be NULL
 * @param data   the mesh; may be NULL or not built yet: such a geom is a point that touches nothing. The geom shares
 * the object, see dGpuTriMeshDataDestroy()
 * @returns The geom, or NULL: see dGpuTriMeshGetError().
 * @remarks Calls dGpuTriMeshInit() if the class is not registered (the thread rule of that function then holds for this
 *          one). Not from a near callback of that space.
 * @remarks The order in which geoms are created decides which mesh of a pair the computation is done in. A program that
 *          creates its geoms in the same order gets the same bytes.
 * @ingroup gputrimesh
 */
OTG_API dGeomID dCreateGpuTriMesh(dSpaceID space, dGpuTriMeshDataID data);

/**
 * @brief Gives the geom another mesh and marks it as moved.
 * @param g     a geom of this class
 * @param data  the mesh; may be NULL, as in dCreateGpuTriMesh()
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_CLASS; dGPUTRIMESH_ERROR_ARGUMENT if the data were destroyed;
 *          dGPUTRIMESH_ERROR_MESH if the geom has a scale that the mesh cannot take; dGPUTRIMESH_ERROR_MEMORY. After an
 *          error the geom has the mesh that it had.
 * @remarks Not from a near callback of the geom's space.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetData(dGeomID g, dGpuTriMeshDataID data);

/**
 * @brief The mesh of the geom.
 * @param g  a geom
 * @returns What was set; NULL if that was NULL or is destroyed by now, or if g is not of this class.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API dGpuTriMeshDataID dGeomGpuTriMeshGetData(dGeomID g);

/**
 * @brief Chooses how the geom collides.
 * @param g       a geom of this class
 * @param params  start from dGpuTriMeshParamsInit() or dGeomGpuTriMeshGetParams()
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT for a value or a size that this version does not know,
 *          dGPUTRIMESH_ERROR_CLASS. After an error the geom
 *          collides as before.
 * @remarks May be called from a near callback, but not while another thread collides the geom.
 * @remarks ODE keeps the geom's box until that moves. Where `contact_model` of a mesh that is no solid becomes another
 * one, set the geom's position again: the box has another margin then (dCreateGpuTriMesh()).
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetParams(dGeomID g, const dGpuTriMeshParams* params);

/**
 * @brief Reads what dGeomGpuTriMeshSetParams() set.
 * @param g       a geom of this class
 * @param params  `params->size` must be sizeof(dGpuTriMeshParams): see dGpuTriMeshParamsInit()
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT or dGPUTRIMESH_ERROR_CLASS.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshGetParams(dGeomID g, dGpuTriMeshParams* params);

/**
 * @brief The number of triangles of the geom's mesh.
 * @param g  a geom of this class
 * @returns 0 for a geom without mesh and for a geom that is not of this class.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshGetTriangleCount(dGeomID g);

/**
 * @brief The corners of one triangle, in world coordinates; the fourth number of each is set to 0.
 * @param g      a geom of this class
 * @param Index  0 to dGeomGpuTriMeshGetTriangleCount() - 1, such as `side1` of a contact
 * @param v0     receives the first corner; each of the three may be NULL
 * @param v1     the second
 * @param v2     the third
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT or dGPUTRIMESH_ERROR_CLASS; after an error nothing was written.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshGetTriangle(dGeomID g, int Index, dVector3* v0, dVector3* v1, dVector3* v2);

/**
 * @brief A point of one triangle, in world coordinates: (1 - u - v) v0 + u v1 + v v2. The fourth number is set to 0.
 * @param g      a geom of this class
 * @param Index  0 to dGeomGpuTriMeshGetTriangleCount() - 1
 * @param u      barycentric coordinate of the second corner
 * @param v      barycentric coordinate of the third corner
 * @param Out    receives the point
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT or dGPUTRIMESH_ERROR_CLASS; after an error nothing was written.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshGetPoint(dGeomID g, int Index, dReal u, dReal v, dVector3 Out);

/**
 * @brief The mesh of the geom, by ODE's other name for it: dGeomGpuTriMeshGetData().
 * @param g  a geom of this class
 * @returns As there.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API dGpuTriMeshDataID dGeomGpuTriMeshGetTriMeshDataID(dGeomID g);

/**
 * @brief Switches temporal coherence for pairs with geoms of one class; the counterpart of dGeomTriMeshEnableTC().
 *
 * For this library's own class that is dGpuTriMeshParams::history, which is on at first; while it is off nothing is
 * remembered of any pair. Each of ODE's classes has a switch beside it, also on at first. It says whether the geom
 * remembers its pairs with geoms of that class. It guides how deep boxes, capsules, cylinders, convex geoms,
 * heightfields and dTriMesh leave (see dGPUTRIMESH_HISTORY_ON). Spheres and all others that come to an open surface
 * from behind are held there. With planes and rays there is nothing to remember.
 * @param g          a geom of this class, or a dTriMesh that collides through this library
 * @param geomClass  dGpuTriMeshGetClass(), or a class of ODE's (dSphereClass, ...)
 * @param enable     0 or not
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT for a number that is no class, dGPUTRIMESH_ERROR_CLASS,
 *          dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshEnableTC(dGeomID g, int geomClass, int enable);

/**
 * @brief Whether temporal coherence is on for pairs with geoms of one class; the counterpart of
 *        dGeomTriMeshIsTCEnabled().
 * @param g          a geom of this class, or a dTriMesh that collides through this library
 * @param geomClass  as in dGeomGpuTriMeshEnableTC()
 * @returns 1 or 0 (with every class, while dGpuTriMeshParams::history is off); dGPUTRIMESH_ERROR_ARGUMENT,
 *          dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshIsTCEnabled(dGeomID g, int geomClass);

/**
 * @brief Forgets what is remembered of all pairs of the geom; the counterpart of dGeomTriMeshClearTCCache(). For a geom
 *        that was put somewhere else. What is remembered is bounded, so that this is never needed to save memory.
 *
 * It reaches what the other meshes remember of their pairs with this geom, too. dGeomGpuTriMeshForgetHistory() reaches
 * what this geom remembers alone, and also drops the contacts that it keeps of pairs that do not move.
 * @param g  a geom of this class, or a dTriMesh that collides through this library
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshClearTCCache(dGeomID g);

/**
 * @brief Scales the geom's mesh along the axes of the mesh's frame, and marks the geom as moved.
 *
 * Vertices and normals are made anew, once for all geoms that have the same data and scale. The last of these geoms
 * frees them. All else is shared with the data: the tree, too, as long as no factor is more than 16 times another.
 * Beyond that, and near the ends of single precision, the mesh gets a tree of its own. It takes longer to make and less
 * to search. A negative factor mirrors; with one or three of them triangles are turned round, so that they face outward
 * as before: dGeomGpuTriMeshGetTriangle() and dGeomGpuTriMeshGetPoint() then have second and third corner exchanged.
 * Box, mass, queries and contacts are those of the scaled mesh; numbers of triangles and vertices stay. The scale stays
 * when the geom gets other data, or its data other vertices.
 * @param g  a geom of this class
 * @param x  factor along x, finite and not 0, as y and z; rounded to single precision
 * @param y  along y
 * @param z  along z
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_ARGUMENT; dGPUTRIMESH_ERROR_CLASS; dGPUTRIMESH_ERROR_MESH if a vertex
 * would not be a finite number of single precision; dGPUTRIMESH_ERROR_MEMORY.
 * @remarks The first time takes less than an update of all vertices; with a tree of its own, as long as building that
 * takes on top. Not from a near callback of the geom's space.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetScale(dGeomID g, dReal x, dReal y, dReal z);

/**
 * @brief The scale of the geom's mesh; 1, 1, 1 at first.
 * @param g      a geom of this class
 * @param scale  receives the factors along x, y and z of the mesh's frame; the fourth number is set to 0
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT or dGPUTRIMESH_ERROR_CLASS.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshGetScale(dGeomID g, dVector3 scale);

/**
 * @brief Makes now what the geom's first collision would make, so that no step of the program waits for it.
 *
 * Its cost and its memory are those that the first collision of the mesh would have; see docs/tuning.md. It is made
 * once for all geoms with the same data and the same scale. A dTriMesh has dGpuTriMeshOverridePrepare().
 * @param g  a geom of this class
 * @returns dGPUTRIMESH_OK, also if it was made before; dGPUTRIMESH_ERROR_CLASS; dGPUTRIMESH_ERROR_MESH if the geom has
 *          no data or its data no mesh; dGPUTRIMESH_ERROR_BUSY, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks From any thread and from a near callback. For the geom's present data, scale and contact model: after a
 * Build, an update of all vertices or dGeomGpuTriMeshSetScale() the next collision makes it anew.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshPrepare(dGeomID g);

/**
 * @brief Says where the geom was a step ago; the counterpart of dGeomTriMeshSetLastTransform().
 *
 * For geoms that the program moves by hand, without a body: deep and contained bodies leave in the direction from which
 * they came, and this gives it. Used for a pair of which each geom has either a last transform or no body; the geoms of
 * other pairs move as their bodies do. Only the direction of motion matters, not the length of the step.
 * @param g           a geom of this class, or a dTriMesh that collides through this library: ODE 0.16 itself forgets
 * the position in what dGeomTriMeshSetLastTransform() is given
 * @param last_trans  sixteen numbers as ODE has them: the columns of the rotation, each as three numbers and a 0, then
 *                    the position and a 1. NULL: the geom's motion is unknown again
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_ARGUMENT if a number is not finite or the last one is 0;
 *          dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetLastTransform(dGeomID g, const dReal* last_trans);

/**
 * @brief What dGeomGpuTriMeshSetLastTransform() was given.
 * @param g  as in that function
 * @returns Sixteen numbers that live until the next call of that function for the geom, or its end; zeros before the
 *          first one. NULL for a geom of another class.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API const dReal* dGeomGpuTriMeshGetLastTransform(dGeomID g);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_GEOM_H */
