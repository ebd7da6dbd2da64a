/* SPDX-License-Identifier: BSD-3-Clause */
/* What validation found out about a mesh, as plain structures. */
#ifndef ODE_TRIMESH_GPU_REPORT_H
#define ODE_TRIMESH_GPU_REPORT_H

#include <ode/common.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief The kinds of problem that validation distinguishes; each says what `elements` of dGpuTriMeshProblem are.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_PROBLEM_NULL_ARRAY = 0,            /**< refused */
  dGPUTRIMESH_PROBLEM_TOO_MANY_VERTICES = 1,     /**< refused */
  dGPUTRIMESH_PROBLEM_TOO_MANY_TRIANGLES = 2,    /**< refused */
  dGPUTRIMESH_PROBLEM_INDEX_OUT_OF_RANGE = 3,    /**< refused; triangles */
  dGPUTRIMESH_PROBLEM_NONFINITE_VERTEX = 4,      /**< refused; vertices */
  dGPUTRIMESH_PROBLEM_EMPTY = 5,                 /**< no triangles */
  dGPUTRIMESH_PROBLEM_DEGENERATE_TRIANGLE = 6,   /**< all corners exactly on a line; triangles */
  dGPUTRIMESH_PROBLEM_DUPLICATE_TRIANGLE = 7,    /**< the same corners as an earlier one; triangles */
  dGPUTRIMESH_PROBLEM_BOUNDARY_EDGE = 8,         /**< an edge used once; triangles */
  dGPUTRIMESH_PROBLEM_NON_MANIFOLD_EDGE = 9,     /**< an edge used more than twice; triangles */
  dGPUTRIMESH_PROBLEM_NON_MANIFOLD_VERTEX = 10,  /**< its triangles form more than one fan; vertices */
  dGPUTRIMESH_PROBLEM_INCONSISTENT_WINDING = 11, /**< neighbours wound in opposite ways; triangles */
  dGPUTRIMESH_PROBLEM_INWARD_WINDING = 12,       /**< a closed part facing inward; connected parts */
  dGPUTRIMESH_PROBLEM_EULER_MISMATCH = 13,       /**< the number of edges is not 3/2 of the number of triangles */
  dGPUTRIMESH_PROBLEM_UNUSED_VERTEX = 14         /**< no triangle uses it; vertices; harmless */
};

/** @brief How many elements a dGpuTriMeshProblem names at most. @ingroup gputrimesh */
#define dGPUTRIMESH_PROBLEM_ELEMENTS 8

/**
 * @brief One kind of problem of one mesh.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshProblem {
  dsizeint size;                              /**< sizeof(dGpuTriMeshProblem) of your program; set by ...Init */
  int kind;                                   /**< dGPUTRIMESH_PROBLEM_... */
  int count;                                  /**< how many elements have it */
  int element_count;                          /**< how many of them are named here */
  int elements[dGPUTRIMESH_PROBLEM_ELEMENTS]; /**< the first ones, ascending */
  const char* message;                        /**< one sentence with the numbers in it; belongs to the mesh data */
} dGpuTriMeshProblem;

/**
 * @brief Counts and properties of a mesh. Flags are 0 or 1; edges are counted on vertices welded by position,
 * or by index in a solid that touches itself.
 *
 * A mesh that is no solid is a sheet if it is oriented, not closed, and has no edge of more than two triangles. A
 * closed mesh that is wound inward is a body to visitors outside, and a room to those inside. Any other mesh is a
 * shell.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshReport {
  dsizeint size; /**< sizeof(dGpuTriMeshReport) of your program; set by ...Init */
  int accepted;  /**< there is a mesh; otherwise see dGpuTriMeshDataGetErrorString() */
  int valid;     /**< accepted, and nothing wrong but unused vertices */

  int vertices;   /**< number of vertices */
  int triangles;  /**< number of triangles */
  int edges;      /**< number of edges */
  int components; /**< pieces that hang together by edges */

  int closed;   /**< every edge is used exactly twice */
  int manifold; /**< no edge used more than twice, one fan of triangles at every vertex */
  int oriented; /**< neighbours wound the same way */
  int outward;  /**< closed parts face outward, cavities inward */
  int solid;    /**< the mesh has an inside: closed, oriented, outward. Surfaces may touch along edges, which then have
                     more than two triangles, and the mesh is not `closed`. Other meshes: see above */

  int degenerate_triangles;  /**< triangles without area */
  int duplicate_triangles;   /**< triangles with the vertices of another one */
  int nonfinite_vertices;    /**< vertices with a coordinate that is infinite or no number */
  int boundary_edges;        /**< edges of one triangle */
  int non_manifold_edges;    /**< edges of three triangles or more */
  int non_manifold_vertices; /**< vertices with several fans of triangles */
  int inconsistent_edges;    /**< edges whose two triangles are wound against each other */
  int problem_count;         /**< as dGpuTriMeshDataGetProblemCount() */

  /* What repairs did, if any were requested. */
  int welded_vertices;    /**< vertices that became one with another at the same place */
  int dropped_degenerate; /**< triangles without area that were left out */
  int dropped_duplicates; /**< repeated triangles that were left out */
  int flipped_triangles;  /**< triangles whose winding was turned round */

  double volume; /**< cubic units, signed: negative when wound inward; 0 for a mesh that was refused */
  double area;   /**< square units */
} dGpuTriMeshReport;

/**
 * @brief Sets the size and zeroes the rest. NULL does nothing.
 * @param report  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshReportInit(dGpuTriMeshReport* report);

/**
 * @brief Sets the size and zeroes the rest. NULL does nothing.
 * @param problem  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshProblemInit(dGpuTriMeshProblem* problem);

/**
 * @brief A short name such as "boundary edge" for a dGPUTRIMESH_PROBLEM_... value.
 * @param kind  any value; unknown ones get a name that says so
 * @returns A string that is never NULL and lives for ever.
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API const char* dGpuTriMeshProblemName(int kind);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_REPORT_H */
