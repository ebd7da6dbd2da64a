/* SPDX-License-Identifier: BSD-3-Clause */
/* How geoms of this class collide: all choices with their defaults. */
#ifndef ODE_TRIMESH_GPU_PARAMS_H
#define ODE_TRIMESH_GPU_PARAMS_H

#include <ode/common.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief How two trees are searched for triangles that may touch. The contacts do not depend on it, only the time does.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_TRAVERSAL_STANDARD = 0,  /**< boxes in single precision */
  dGPUTRIMESH_TRAVERSAL_QUANTIZED = 1, /**< boxes in 16-bit integers: half the memory */
  dGPUTRIMESH_TRAVERSAL_NO_LEAF = 2,   /**< leaves without boxes: half the nodes, triangle tests instead */
  dGPUTRIMESH_TRAVERSAL_WIDE = 3,      /**< eight boxes at a time: the fastest, and the default */
  dGPUTRIMESH_TRAVERSAL_LEVELS = 4     /**< for devices, as published: one level of both trees after the other. A pair
                                          whose search runs on a device is searched by it there, alone, among arrays of
                                          pairs, too. The CPU searches as by WIDE. The device takes memory for it at the
                                          first use. For comparing */
};

/**
 * @brief Which of two nodes is opened next. The contacts do not depend on it, only the time does.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_DESCENT_FIRST_TREE = 0,  /**< down one tree to its leaves, then down the other */
  dGPUTRIMESH_DESCENT_LARGER = 1,      /**< the larger box */
  dGPUTRIMESH_DESCENT_ALTERNATING = 2, /**< one tree after the other */
  dGPUTRIMESH_DESCENT_BOTH = 3         /**< both at once */
};

/**
 * @brief What a contact is computed from.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_CONTACTS_AUTO = 0,     /**< SOLID, unless the other geom requests PAIRWISE */
  dGPUTRIMESH_CONTACTS_PAIRWISE = 1, /**< from each pair of intersecting triangles */
  dGPUTRIMESH_CONTACTS_SOLID = 2     /**< from the overlap as a whole, of two solids, or of a solid and what
                                      lies behind a sheet: an open mesh whose triangles agree in their winding.
                                      For other meshes from places behind the surface of the larger one */
};

/**
 * @brief How many contacts become few.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_REDUCTION_NONE = 0,    /**< all are kept */
  dGPUTRIMESH_REDUCTION_BINNING = 1, /**< one for each bin of position and normal */
  dGPUTRIMESH_REDUCTION_CONE = 2     /**< those that span the cone of all forces and torques */
};

/**
 * @brief Whether what earlier queries of a pair found may guide the next one.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_HISTORY_OFF = 0, /**< contacts depend on the poses and velocities of the moment alone */
  dGPUTRIMESH_HISTORY_ON = 1   /**< deep, entangled and contained bodies leave in the direction in which they began to;
                                    those that come to an open surface from behind are held there */
};

/**
 * @brief Where queries are computed. The contacts do not depend on it, only the time does.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_BACKEND_DEFAULT = 0, /**< as dGpuTriMeshSetBackend() has it for all geoms */
  dGPUTRIMESH_BACKEND_AUTO = 1,    /**< where it is expected to be faster, judged for each query or batch; a batch
                                      may be divided between the CPU and all devices */
  dGPUTRIMESH_BACKEND_CPU = 2,
  dGPUTRIMESH_BACKEND_OPENCL = 3 /**< on the open devices (see dGpuTriMeshOpenDevices()). On the CPU while none is open
                                    or when they fail */
};

/**
 * @brief The choices of one geom. Set the defaults with dGpuTriMeshParamsInit(), then what you need.
 *
 * Two geoms that collide may differ. Whatever the order of the call, the pair then has the reduction with the smaller
 * number (which drops less), and the larger number of bins. max_contacts, contacts_per_region and region_merge are the
 * smaller ones. Of the contact models AUTO gives way to the other. History is ON if both have it. CPU comes before
 * OPENCL, and OPENCL before AUTO. The search is that of the geom created first.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshParams {
  dsizeint size;     /**< sizeof(dGpuTriMeshParams) of your program; set by ...Init */
  int traversal;     /**< dGPUTRIMESH_TRAVERSAL_...; default WIDE */
  int descent;       /**< dGPUTRIMESH_DESCENT_...; default LARGER */
  int box_axes;      /**< axes of the box test: 6 (default) or 15 */
  int contact_model; /**< dGPUTRIMESH_CONTACTS_...; default AUTO */
  int reduction;     /**< for PAIRWISE and for contacts of shells: dGPUTRIMESH_REDUCTION_...; default BINNING */
  int bins[6];       /**< for BINNING: along x, y, z of position, then of normal; 1 to 64, default 3 */
  int max_contacts;  /**< at most this many for one pair of geoms: 1 to 65535 (default). The caller of dCollide() sets
                        the  other limit by the size of its array. The deepest of every region of contact come first. */
  int contacts_per_region; /**< for SOLID: at most this many from one connected overlap: 1 to 64, default 16. Fewer make
                              the solver's work smaller; 4 hold a box, fewer than 3 hold nothing upright */
  int history;             /**< for SOLID: dGPUTRIMESH_HISTORY_...; default ON. What is remembered of a pair is a few
                              numbers, for as long as the two are in contact. OFF for programs that set poses at will,
                              or that compare single queries: a body that is deep inside another may then waver between
                              two ways out */
  dReal region_merge;      /**< for SOLID: regions of contact of one pair count as one, with one contacts_per_region,
                              where they come at least this near to each other and push the same way to within 18
                              degrees. A length, default 0: off. For bodies that rest on many small feet, which
                              otherwise give contacts_per_region for each */
  int backend;             /**< dGPUTRIMESH_BACKEND_...; default DEFAULT */
  int middle_phase;        /**< the search alone: dGPUTRIMESH_BACKEND_..., DEFAULT (default) for what `backend` says */
  int near_phase; /**< the tests of triangles alone: the same. The contacts of PAIRWISE are made by a device if both
                     phases run there, those of SOLID as
                     docs/opencl.md says: in batches by a device, too, else in part */
  int max_pairs;  /**< the CPU looks at no more pairs of triangles whose boxes overlap: 1 or more, default 16777216. The
                     smaller number of two geoms counts. A pair of geoms with more has no contacts and leaves
                     dGPUTRIMESH_ERROR_MEMORY. Bounds the memory and time of meshes with many triangles in one place */
} dGpuTriMeshParams;

/**
 * @brief Sets the size and the defaults. NULL does nothing.
 * @param params  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshParamsInit(dGpuTriMeshParams* params);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_PARAMS_H */
