/* SPDX-License-Identifier: BSD-3-Clause */
/* Contacts with what dContactGeom has no room for: region, features, names that stay from step to step. */
#ifndef ODE_TRIMESH_GPU_CONTACT_DATA_H
#define ODE_TRIMESH_GPU_CONTACT_DATA_H

#include <ode/common.h>
#include <ode/contact.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief What a contact was made from.
 *
 * The contact model SOLID (see dGPUTRIMESH_CONTACTS_SOLID) has VERTEX, CROSSING and MIDDLE, and REGION where an overlap
 * has none of these. PAIRWISE has FACE and COPLANAR.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_FEATURE_REGION = 0,   /**< the middle of a region of overlap */
  dGPUTRIMESH_FEATURE_VERTEX = 1,   /**< a vertex of one mesh, inside the other solid */
  dGPUTRIMESH_FEATURE_CROSSING = 2, /**< where an edge of one mesh goes through a triangle of the other */
  dGPUTRIMESH_FEATURE_MIDDLE = 3,   /**< the middle of a stretch of an edge that lies inside the other solid */
  dGPUTRIMESH_FEATURE_FACE = 4,     /**< two triangles that intersect; the plane of one gave the normal */
  dGPUTRIMESH_FEATURE_COPLANAR = 5  /**< two triangles that overlap in one plane */
};

/**
 * @brief Facts about a contact, added up in dGpuTriMeshContactData::flags.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_CONTACT_INSIDE = 1,    /**< the feature's point lies inside the other solid, not on its surface */
  dGPUTRIMESH_CONTACT_CONTAINED = 2, /**< a whole closed part of one mesh lies inside the other */
  dGPUTRIMESH_CONTACT_CLAMPED = 4    /**< the depth was cut so as not to throw bodies: entangled, jammed, or too deep
                                          for what the two have moved */
};

/**
 * @brief What is known of one contact beyond dContactGeom. Filled by dGpuTriMeshCollideEx() and
 *        dGpuTriMeshBatchCollect().
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshContactData {
  /** The contact's name: never 0. No two contacts of one query share it, but for two at one crossing of a deep region.
   * It is made of the features that the contact comes from. A contact keeps it from step to step while these touch: use
   * it to carry impulses over (warm starting). Vertices and edges keep their contact's name whatever they touch on the
   * other mesh, so that it also survives sliding over a tessellated surface.
   *
   * The same for both orders of the geoms in a call. Whether the feature belongs to the geom created first or second is
   * part of it. So names can be compared within one pair of geoms only. A name is a number without order or meaning;
   * the data of another mesh, or repair, give other names. */
  duint64 id;
  int region;      /**< 0 or more: contacts of one connected overlap share it. Not kept from step to step */
  dReal coherence; /**< of the region: 1 where its normals agree (flat), 0 where they cancel (a limb through a limb); -1
                      where the model does not know (PAIRWISE) */
  int triangle1;   /**< of g1, as `side1` of the contact: the one that has the feature, or the one it meets */
  int triangle2;   /**< of g2, as `side2` */
  int feature;     /**< dGPUTRIMESH_FEATURE_... */
  int feature_side; /**< whose vertex, edge or face it is: 1 for g1, 2 for g2; 0 for REGION and COPLANAR */
  int vertex1; /**< VERTEX: its number; CROSSING and MIDDLE: the smaller end of the edge; else -1. Numbers are those
                  of the mesh data, of vertices at one position the smallest */
  int vertex2; /**< CROSSING and MIDDLE: the greater end of the edge; else -1 */
  int flags;   /**< dGPUTRIMESH_CONTACT_... added up */
} dGpuTriMeshContactData;

/**
 * @brief Collides two geoms of this class as dCollide() does, and says more of each contact.
 *
 * The contacts are the same, byte for byte, as those of dCollide(o1, o2, flags, contact, skip), statistics and what is
 * remembered of the pair included. Nothing is kept for later: call this function in the near callback in place of
 * dCollide() for pairs whose data you want.
 *
 * @param o1         a geom of this class
 * @param o2         another one
 * @param flags      as in dCollide(): the lower 16 bits are the number of places in `contact` and in `data`, at least
 * 1; CONTACTS_UNIMPORTANT may be added
 * @param contact    receives the contacts; `contact[i].g1` is o1
 * @param skip       bytes from one contact to the next, at least sizeof(dContactGeom): for an array of dContact its
 * size
 * @param data       receives as many elements; may be NULL
 * @param data_skip  bytes from one element to the next, at least sizeof(dGpuTriMeshContactData)
 * @returns The number of contacts, 0 or more; dGPUTRIMESH_ERROR_CLASS if a geom is not of this class (dCollide() may
 *          know what to do with it); dGPUTRIMESH_ERROR_ARGUMENT if there is no place or a skip is too small. 0 also
 *          for a pair that cannot be collided: dGpuTriMeshGetError() says why, as after dCollide().
 * @remarks As dCollide(): from any number of threads at once, and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshCollideEx(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip,
                                 dGpuTriMeshContactData* data, int data_skip);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_CONTACT_DATA_H */
