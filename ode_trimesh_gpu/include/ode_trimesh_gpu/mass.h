/* SPDX-License-Identifier: BSD-3-Clause */
/* Mass, centre of mass and inertia of the solid that a mesh bounds. */
#ifndef ODE_TRIMESH_GPU_MASS_H
#define ODE_TRIMESH_GPU_MASS_H

#include <ode/common.h>
#include <ode/mass.h>

#include "export.h"
#include "trimesh_data.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Fills a dMass from a mesh of uniform density, in the mesh's own frame: centre of mass `c` and inertia `I`
 * about the origin of that frame, as all dMassSet functions have it. Exact for the polyhedron.
 *
 * A body's frame must have its origin in the centre of mass: either translate the mesh beforehand, or give the geom the
 * offset -c and the mass dMassTranslate(m, -c).
 *
 * @param m        receives the mass; untouched after an error
 * @param density  mass per cubic unit, positive
 * @param data     the mesh
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_NOT_SOLID when m was filled from a mesh that is open or wound inconsistently;
 *          dGPUTRIMESH_ERROR_MASS when volume or inertia is not positive (open, flat, wound inward, without triangles)
 *          or not finite; dGPUTRIMESH_ERROR_ARGUMENT. Build a mesh that is wound inward with dGPUTRIMESH_REPAIR_ORIENT,
 *          which turns it.
 * @remarks May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dMassSetGpuTriMeshData(dMass* m, dReal density, dGpuTriMeshDataID data);

/**
 * @brief The same for a total mass instead of a density.
 * @param m           receives the mass; untouched after an error
 * @param total_mass  positive
 * @param data        the mesh
 * @returns As dMassSetGpuTriMeshData().
 * @ingroup gputrimesh
 */
OTG_API int dMassSetGpuTriMeshDataTotal(dMass* m, dReal total_mass, dGpuTriMeshDataID data);

/**
 * @brief The same from a geom, argument for argument dMassSetTrimesh(). For a geom on a body: in the body's frame, that
 * is the mesh's own frame placed by the geom's offset if it has one. For a geom without a body: in world coordinates,
 *        as dMassSetTrimesh() has it, so that a geom that was not moved yet gives the mesh's own frame.
 *
 * dMassSetTrimesh() of ODE 0.16 counts the distance of the centre of mass from the origin twice in the inertia. This
 * function counts it once, as dMassSetBox() and dMassTranslate() do.
 *
 * @param m        receives the mass; untouched after an error
 * @param density  mass per cubic unit, positive
 * @param g        a geom of this class
 * @returns As dMassSetGpuTriMeshData(), or dGPUTRIMESH_ERROR_CLASS. dGPUTRIMESH_ERROR_MASS also when the offset, or the
 *          pose of a geom without a body, is not finite.
 * @ingroup gputrimesh
 */
OTG_API int dMassSetGpuTriMesh(dMass* m, dReal density, dGeomID g);

/**
 * @brief The same from a geom for a total mass, argument for argument dMassSetTrimeshTotal().
 * @param m           receives the mass; untouched after an error
 * @param total_mass  positive
 * @param g           a geom of this class
 * @returns As dMassSetGpuTriMesh().
 * @ingroup gputrimesh
 */
OTG_API int dMassSetGpuTriMeshTotal(dMass* m, dReal total_mass, dGeomID g);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_MASS_H */
