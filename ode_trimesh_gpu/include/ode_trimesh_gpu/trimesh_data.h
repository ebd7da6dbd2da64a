/* SPDX-License-Identifier: BSD-3-Clause */
/* Mesh data: arrays in, validated mesh and its tree out. Shared between any number of geoms. */
#ifndef ODE_TRIMESH_GPU_TRIMESH_DATA_H
#define ODE_TRIMESH_GPU_TRIMESH_DATA_H

#include <ode/common.h>
/* In this order: ODE's header of triangle meshes does not include what it needs. */
#include <ode/collision_trimesh.h>

#include "export.h"
#include "report.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief A mesh with its tree, the counterpart of ODE's dTriMeshDataID.
 * @ingroup gputrimesh
 */
struct dxGpuTriMeshData;
typedef struct dxGpuTriMeshData* dGpuTriMeshDataID;

/**
 * @brief Makes an object without triangles. Fill it with one of the Build functions.
 * @returns The object, yours until dGpuTriMeshDataDestroy(); NULL when memory is short.
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API dGpuTriMeshDataID dGpuTriMeshDataCreate(void);

/**
 * @brief Gives the object back. Geoms that use it keep the mesh and go on working.
 *
 * After this the id must not be used, and dGeomGpuTriMeshGetData() of those geoms returns NULL. The mesh is freed with
 * the last of them.
 * @param g  the object; NULL does nothing. One that was given back already is left alone, with
 *           dGPUTRIMESH_ERROR_ARGUMENT for dGpuTriMeshGetError()
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshDataDestroy(dGpuTriMeshDataID g);

/**
 * @brief Builds from single precision vertices. Argument for argument dGeomTriMeshDataBuildSingle(), but the arrays are
 *        copied and need not outlive the call.
 *
 * The mesh is validated; whatever can be worked with is accepted as it is, triangle numbers unchanged, and reported
 * (dGpuTriMeshDataGetReport()): open meshes, degenerate and duplicate triangles, mixed winding. Refused are null
 * arrays, indices out of range, vertices that are NaN or infinite, and more than 2^28 vertices or triangles. No
 * triangles at all is a mesh that touches nothing.
 *
 * Geoms that use the object have the new mesh from now on and are marked as moved (dGeomMoved()). After an error the
 * object keeps the mesh that it had. After dGPUTRIMESH_ERROR_MESH report and problems are those of the refused mesh.
 * After any other error they are left as they were.
 *
 * @param g             the object
 * @param Vertices      x, y, z of each vertex, in the mesh's frame; may be NULL when VertexCount is 0
 * @param VertexStride  bytes from one vertex to the next; 0 means tightly packed
 * @param VertexCount   number of vertices
 * @param Indices       three 32-bit vertex indices for each triangle, counter-clockwise seen from outside; may be NULL
 * when IndexCount is 0
 * @param IndexCount    number of indices: three times the number of triangles
 * @param TriStride     bytes from one triangle to the next; 0 means tightly packed
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MESH or dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not from a near callback when geoms use the object. A geom inside a dGeomTransform is marked as moved, but
 *          ODE offers no way to reach the transform: move or re-set the transform geom yourself.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataBuildSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                                       const void* Indices, int IndexCount, int TriStride);

/**
 * @brief The same with an argument for normals, so that calls of dGeomTriMeshDataBuildSingle1() need no change. They
 * are not read: this library computes the normals that it needs.
 * @param g             the object
 * @param Vertices      x, y, z of each vertex, single precision
 * @param VertexStride  bytes from one vertex to the next; 0: tightly packed
 * @param VertexCount   number of vertices
 * @param Indices       three vertex indices of 32 bits for each triangle
 * @param IndexCount    number of indices: three times the number of triangles
 * @param TriStride     bytes from one triangle to the next; 0: tightly packed
 * @param Normals       may be NULL
 * @returns As dGpuTriMeshDataBuildSingle(), whose other arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataBuildSingle1(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                                        const void* Indices, int IndexCount, int TriStride, const void* Normals);

/**
 * @brief Builds from double precision vertices, which are rounded to single precision once; otherwise as
 *        dGpuTriMeshDataBuildSingle(). A double that single precision can't hold is refused as infinite.
 * @param g             the object
 * @param Vertices      x, y, z of each vertex, double precision
 * @param VertexStride  bytes from one vertex to the next; 0: tightly packed
 * @param VertexCount   number of vertices
 * @param Indices       three vertex indices of 32 bits for each triangle
 * @param IndexCount    number of indices: three times the number of triangles
 * @param TriStride     bytes from one triangle to the next; 0: tightly packed
 * @returns As dGpuTriMeshDataBuildSingle(), whose arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataBuildDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                                       const void* Indices, int IndexCount, int TriStride);

/**
 * @brief The same with an argument for normals, which are not read.
 * @param g             the object
 * @param Vertices      x, y, z of each vertex, double precision
 * @param VertexStride  bytes from one vertex to the next; 0: tightly packed
 * @param VertexCount   number of vertices
 * @param Indices       three vertex indices of 32 bits for each triangle
 * @param IndexCount    number of indices: three times the number of triangles
 * @param TriStride     bytes from one triangle to the next; 0: tightly packed
 * @param Normals       may be NULL
 * @returns As dGpuTriMeshDataBuildDouble(), whose other arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataBuildDouble1(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int VertexCount,
                                        const void* Indices, int IndexCount, int TriStride, const void* Normals);

/**
 * @brief Builds from ODE's own types, as dGeomTriMeshDataBuildSimple() does: Vertices is an array of dVector3, that is
 *        *four* dReal for each vertex of which the last is not read.
 * @param g            the object
 * @param Vertices     VertexCount times four numbers
 * @param VertexCount  number of vertices
 * @param Indices      three vertex indices for each triangle, tightly packed
 * @param IndexCount   number of indices: three times the number of triangles
 * @returns As dGpuTriMeshDataBuildSingle().
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataBuildSimple(dGpuTriMeshDataID g, const dReal* Vertices, int VertexCount,
                                       const dTriIndex* Indices, int IndexCount);

/**
 * @brief The same with an argument for normals, which are not read.
 * @param g            the object
 * @param Vertices     VertexCount times four numbers
 * @param VertexCount  number of vertices
 * @param Indices      three vertex indices for each triangle, tightly packed
 * @param IndexCount   number of indices: three times the number of triangles
 * @param Normals      may be NULL
 * @returns As dGpuTriMeshDataBuildSimple(), whose other arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataBuildSimple1(dGpuTriMeshDataID g, const dReal* Vertices, int VertexCount,
                                        const dTriIndex* Indices, int IndexCount, const int* Normals);

/**
 * @brief The number type of vertices in dGpuTriMeshBuildParams.
 * @ingroup gputrimesh
 */
enum { dGPUTRIMESH_VERTEX_SINGLE = 0, dGPUTRIMESH_VERTEX_DOUBLE = 1 };

/**
 * @brief Repairs that dGpuTriMeshDataBuild() may do: any of these added up. What was done is in the report. Repairs
 * change the numbers of triangles and vertices.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_REPAIR_NONE = 0,
  dGPUTRIMESH_REPAIR_WELD = 1,            /**< merge vertices with equal positions */
  dGPUTRIMESH_REPAIR_DROP_DEGENERATE = 2, /**< remove triangles whose corners lie exactly on a line */
  dGPUTRIMESH_REPAIR_DROP_DUPLICATES = 4, /**< keep only the first of triangles with the same corners */
  dGPUTRIMESH_REPAIR_ORIENT = 8,          /**< flip triangles so that neighbours agree and closed parts face outward */
  dGPUTRIMESH_REPAIR_ALL = 15
};

/**
 * @brief How the tree is built.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_TREE_SAH = 0, /**< binned surface-area heuristic: the default, fewest box tests */
  dGPUTRIMESH_TREE_MEAN_SPLIT =
      1 /**< axis of greatest variance of the box centres, split at their mean: faster to build */
};

/**
 * @brief Everything that a mesh is built from. Set the defaults with dGpuTriMeshBuildParamsInit(), then what you need.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshBuildParams {
  dsizeint size;        /**< sizeof(dGpuTriMeshBuildParams) of your program; set by ...Init */
  const void* vertices; /**< as in dGpuTriMeshDataBuildSingle() */
  int vertex_type;      /**< dGPUTRIMESH_VERTEX_SINGLE (default) or dGPUTRIMESH_VERTEX_DOUBLE */
  int vertex_stride;    /**< bytes, 0 (default) = tightly packed */
  int vertex_count;     /**< number of vertices */
  const void* indices;  /**< 32-bit */
  int index_count;      /**< three times the number of triangles */
  int tri_stride;       /**< bytes, 0 (default) = tightly packed */
  int repair;           /**< dGPUTRIMESH_REPAIR_... added up; none by default */
  int tree;             /**< dGPUTRIMESH_TREE_... */
} dGpuTriMeshBuildParams;

/**
 * @brief Sets the size and the defaults: no arrays, no repair, the default tree. NULL does nothing.
 * @param params  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshBuildParamsInit(dGpuTriMeshBuildParams* params);

/**
 * @brief Builds with options; otherwise as dGpuTriMeshDataBuildSingle().
 * @param g       the object
 * @param params  what to build from, and how; `params->size` must be sizeof(dGpuTriMeshBuildParams)
 * @returns As there; dGPUTRIMESH_ERROR_ARGUMENT also for a size or an option that this version does not know.
 * @remarks As there.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataBuild(dGpuTriMeshDataID g, const dGpuTriMeshBuildParams* params);

/**
 * @brief Moves the vertices of a built mesh and refits its tree: much faster than building, the counterpart of changing
 *        the arrays in place and calling dGeomTriMeshDataUpdate().
 *
 * The triangles stay. Geoms that use the object are marked as moved. The cost of a tree is the sum of the surface areas
 * of its boxes over that of the whole mesh's box; queries take about as long. Where that has become 1.5 times what it
 * was when the tree was built, the tree is built anew. The tree does not change any contact.
 *
 * @param g             the object, built before. Where repair merged vertices, the first of them moves the merged one
 * @param Vertices      x, y, z in single precision, in the mesh's frame; copied
 * @param VertexStride  bytes from one vertex to the next; 0 means tightly packed
 * @param VertexCount   as many as the mesh was built from
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MESH (another count, NaN, infinity; the mesh
 * is unchanged) or dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not from a near callback when geoms use the object, and not while another thread uses it.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUpdateVerticesSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride,
                                                int VertexCount);

/**
 * @brief The same from double precision.
 * @param g             the object
 * @param Vertices      x, y, z of each vertex, double precision
 * @param VertexStride  bytes from one vertex to the next; 0: tightly packed
 * @param VertexCount   number of vertices
 * @returns As dGpuTriMeshDataUpdateVerticesSingle(), whose arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUpdateVerticesDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride,
                                                int VertexCount);

/**
 * @brief The same from an array of dVector3 (four dReal for each vertex), the counterpart of
 * dGpuTriMeshDataBuildSimple().
 * @param g            the object
 * @param Vertices     VertexCount times four numbers
 * @param VertexCount  number of vertices
 * @returns As dGpuTriMeshDataUpdateVerticesSingle(), whose arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUpdate(dGpuTriMeshDataID g, const dReal* Vertices, int VertexCount);

/**
 * @brief Moves some of the vertices of a built mesh, those with the numbers First to First + Count - 1, at a cost that
 *        follows their number; the others stay where they are.
 *
 * What comes of it is, to the last bit of every contact, what dGpuTriMeshDataUpdateVerticesSingle() makes of all
 * vertices. Boxes are refitted from the moved triangles up, and what the contact models need is worked out again for
 * these and their neighbours. The first call for an object prepares for that. This takes about a third of the time of a
 * build, and 80 bytes for each triangle.
 *
 * In some cases it costs as much as moving all vertices: the tree has to be built anew (see
 * dGpuTriMeshDataUpdateVerticesSingle()); vertices part or meet; a triangle loses or gains its area; the mesh turns
 * inside out; its middle has moved by a sixteenth of its size; edges have more than two triangles in a mesh without a
 * rim; or a batch under way uses the mesh. A mesh of several closed components is looked at whole where one lies in
 * another one or comes near to it. So is a mesh that is no solid, at the next query with another one that is none. The
 * meshes of geoms with a scale follow in the same way. Devices are sent what has changed when they need it next
 * (docs/opencl.md says when they are sent the whole mesh).
 *
 * @param g             the object, built before. Numbers are those of the arrays that it was built from; where repair
 *                      merged vertices, the first of them moves the merged one and the others do nothing
 * @param Vertices      x, y, z of the moved vertices alone, in single precision, in the mesh's frame; copied. May be
 *                      NULL when Count is 0
 * @param VertexStride  bytes from one vertex to the next; 0 means tightly packed
 * @param First         number of the first vertex that moves
 * @param Count         how many move
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT (also for numbers that the mesh does not have),
 *          dGPUTRIMESH_ERROR_MESH (NaN, infinity) or dGPUTRIMESH_ERROR_MEMORY. After an error the mesh is unchanged.
 * @remarks Not from a near callback when geoms use the object, and not while another thread uses it.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUpdateRangeSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int First,
                                             int Count);

/**
 * @brief The same from double precision, rounded to single precision once.
 * @param g             the object
 * @param Vertices      x, y, z of the moved vertices alone, double precision
 * @param VertexStride  bytes from one vertex to the next; 0: tightly packed
 * @param First         number of the first vertex that moves
 * @param Count         how many move
 * @returns As dGpuTriMeshDataUpdateRangeSingle(), whose arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUpdateRangeDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride, int First,
                                             int Count);

/**
 * @brief dGpuTriMeshDataUpdateRangeSingle() for vertices with any numbers.
 * @param g             as there
 * @param Vertices      x, y, z of the moved vertices alone: the first one's, with the number Numbers[0], and so on
 * @param VertexStride  bytes from one vertex to the next; 0 means tightly packed
 * @param Numbers       Count numbers of vertices, in any order; of one that comes twice the later place counts. Copied;
 *                      may be NULL when Count is 0
 * @param Count         how many move
 * @returns As there.
 * @remarks As there.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUpdateListSingle(dGpuTriMeshDataID g, const void* Vertices, int VertexStride,
                                            const int* Numbers, int Count);

/**
 * @brief The same from double precision, rounded to single precision once.
 * @param g             the object
 * @param Vertices      x, y, z of the moved vertices alone, double precision
 * @param VertexStride  bytes from one vertex to the next; 0: tightly packed
 * @param Numbers       numbers of the vertices
 * @param Count         how many move
 * @returns As dGpuTriMeshDataUpdateListSingle(), whose arguments, errors and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataUpdateListDouble(dGpuTriMeshDataID g, const void* Vertices, int VertexStride,
                                            const int* Numbers, int Count);

/**
 * @brief Fills a report on the last Build or Update: counts and what is right and wrong with the mesh.
 * @param g       the object
 * @param report  `report->size` must be sizeof(dGpuTriMeshReport): see dGpuTriMeshReportInit()
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_ARGUMENT.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataGetReport(dGpuTriMeshDataID g, dGpuTriMeshReport* report);

/**
 * @brief How many kinds of problem the last Build or Update found.
 * @param g  the object
 * @returns 0 or more; 0 for NULL.
 * @remarks May be called from a near callback, but not while another thread changes the object.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataGetProblemCount(dGpuTriMeshDataID g);

/**
 * @brief One problem: its kind, how many elements have it, the first few of them, and a sentence.
 * @param g        the object
 * @param Index    0 to dGpuTriMeshDataGetProblemCount() - 1
 * @param problem  `problem->size` must be sizeof(dGpuTriMeshProblem): see dGpuTriMeshProblemInit(). Its message lives
 * until the next Build or Update of the object, or its end.
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_ARGUMENT.
 * @remarks May be called from a near callback, but not while another thread changes the object.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataGetProblem(dGpuTriMeshDataID g, int Index, dGpuTriMeshProblem* problem);

/**
 * @brief How many kinds of repair the last Build did.
 * @param g  the object
 * @returns 0 or more; 0 for NULL.
 * @remarks May be called from a near callback, but not while another thread changes the object.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataGetRepairCount(dGpuTriMeshDataID g);

/**
 * @brief One sentence on one kind of repair.
 * @param g      the object
 * @param Index  0 to dGpuTriMeshDataGetRepairCount() - 1
 * @returns A string that lives until the next Build or Update of the object, or its end; NULL for an index out of
 * range.
 * @remarks May be called from a near callback, but not while another thread changes the object.
 * @ingroup gputrimesh
 */
OTG_API const char* dGpuTriMeshDataGetRepair(dGpuTriMeshDataID g, int Index);

/**
 * @brief Why the last mesh or cooked mesh that the object was given was refused, in one sentence.
 *
 * Build, Update and Uncook set it when they return dGPUTRIMESH_ERROR_MESH or dGPUTRIMESH_ERROR_COOKED, and empty it
 * when they succeed. Other errors (ARGUMENT, BUSY, MEMORY, FILE) leave it as it was.
 * @param g  the object
 * @returns A string that is never NULL; it lives until the next Build, Update or Uncook, or the end of the object.
 * @remarks May be called from a near callback, but not while another thread changes the object.
 * @ingroup gputrimesh
 */
OTG_API const char* dGpuTriMeshDataGetErrorString(dGpuTriMeshDataID g);

/**
 * @brief Works out what ODE calls preprocessed data; the counterpart of dGeomTriMeshDataPreprocess2().
 *
 * With `1U << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES`: which edges and vertices of each triangle something can rest on
 * (dMESHDATAUSE_...), for dGpuTriMeshDataGet(). An edge is used if it is convex or the surface ends there, by the
 * triangle with the smaller number. A vertex is used if one of its edges is, by the first of its triangles. Edges that
 * are flat to within 0.1 degrees and concave ones are not used. With `1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES`:
 * nothing has to be worked out, dGpuTriMeshDataGetEdgeAngle() is always there.
 *
 * A later Build or Update of the object drops the flags. They are there to be read: no contacts depend on them, because
 * the contact models need no help against edges that do not matter.
 * @param g                  the object, built before
 * @param buildRequestFlags  as above, added up
 * @param requestExtraData   not read: angles are not rounded to bytes. May be NULL
 * @returns 1 as ODE does, 0 if memory is short, g is NULL or not built, or a flag is unknown; dGpuTriMeshGetError()
 * says why.
 * @remarks Not while another thread uses the object.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataPreprocess2(dGpuTriMeshDataID g, unsigned int buildRequestFlags,
                                       const dintptr* requestExtraData);

/**
 * @brief dGpuTriMeshDataPreprocess2() for the edges alone; the counterpart of dGeomTriMeshDataPreprocess().
 * @param g  the object, built before
 * @returns As dGpuTriMeshDataPreprocess2(), whose thread rule holds.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataPreprocess(dGpuTriMeshDataID g);

/**
 * @brief Sets additional data; the counterpart of dGeomTriMeshDataSet(), which does not copy: this one does.
 * @param g        the object, built before
 * @param data_id  dTRIMESHDATA_USE_FLAGS: in_data is one byte of dMESHDATAUSE_... for each triangle, in place of what
 *                 dGpuTriMeshDataPreprocess2() works out; NULL goes back to that. dTRIMESHDATA_FACE_NORMALS: not read,
 * as the normals of the Build functions are not
 * @param in_data  see there
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not while another thread uses the object.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataSet(dGpuTriMeshDataID g, int data_id, const void* in_data);

/**
 * @brief Additional data of a mesh; the counterpart of dGeomTriMeshDataGet().
 * @param g        the object, built before
 * @param data_id  dTRIMESHDATA_USE_FLAGS: what was set or worked out, a byte for each triangle; NULL before that.
 *                 dTRIMESHDATA_FACE_NORMALS: the unit normal of each triangle, three dReal for each in your order of
 *                 triangles, zeros for degenerate ones; computed on the first request
 * @returns An array that lives until the next Build, Update or Set of the object, or its end; NULL: see
 *          dGpuTriMeshGetError().
 * @remarks Not while another thread uses the object.
 * @ingroup gputrimesh
 */
OTG_API const void* dGpuTriMeshDataGet(dGpuTriMeshDataID g, int data_id);

/**
 * @brief The same with the array's size in bytes; the counterpart of dGeomTriMeshDataGet2().
 * @param g         the object, built before
 * @param data_id   as in dGpuTriMeshDataGet()
 * @param pout_size receives the size, 0 with NULL; may be NULL
 * @returns As dGpuTriMeshDataGet().
 * @ingroup gputrimesh
 */
OTG_API const void* dGpuTriMeshDataGet2(dGpuTriMeshDataID g, int data_id, dsizeint* pout_size);

/**
 * @brief The flags of edges and vertices as a buffer; the counterpart of dGeomTriMeshDataGetBuffer(), which ODE advises
 *        against: dGpuTriMeshDataGet2() with dTRIMESHDATA_USE_FLAGS gives the same.
 * @param g       the object, built before
 * @param buf     receives the array, NULL before dGpuTriMeshDataPreprocess() or dGpuTriMeshDataSet(); it lives as
 * there. It is not to be written to. May be NULL
 * @param bufLen  receives its size in bytes. May be NULL
 * @remarks Not while another thread uses the object. With an object that is not built NULL and 0, and
 *          dGPUTRIMESH_ERROR_ARGUMENT for dGpuTriMeshGetError().
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshDataGetBuffer(dGpuTriMeshDataID g, unsigned char** buf, int* bufLen);

/**
 * @brief Sets the flags of edges and vertices; the counterpart of dGeomTriMeshDataSetBuffer(), which ODE advises
 *        against: dGpuTriMeshDataSet() with dTRIMESHDATA_USE_FLAGS does the same.
 * @param g    the object, built before
 * @param buf  one byte for each triangle, copied; NULL goes back to what dGpuTriMeshDataPreprocess() works out
 * @remarks Not while another thread uses the object. dGpuTriMeshGetError() reports errors.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshDataSetBuffer(dGpuTriMeshDataID g, unsigned char* buf);

/**
 * @brief The angle by which the surface turns at an edge: what dTRIDATAPREPROCESS_BUILD_FACE_ANGLES is for in ODE.
 * @param g         the object, built before
 * @param Triangle  a number of your triangles
 * @param Edge      0 for the edge from the first corner to the second, 1 from the second to the third, 2 from the third
 *                  to the first
 * @param angle     receives radians: 0 flat, up to pi for a convex edge (pi/2 at a box), down to -pi for a concave one;
 *                  pi where the surface ends, and where one of the triangles is degenerate
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_ARGUMENT.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshDataGetEdgeAngle(dGpuTriMeshDataID g, int Triangle, int Edge, dReal* angle);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_TRIMESH_DATA_H */
