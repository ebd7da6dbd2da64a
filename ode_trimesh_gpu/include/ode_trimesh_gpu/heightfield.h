/* SPDX-License-Identifier: BSD-3-Clause */
/* ODE's heightfields as ground for meshes. */
#ifndef ODE_TRIMESH_GPU_HEIGHTFIELD_H
#define ODE_TRIMESH_GPU_HEIGHTFIELD_H

#include <ode/common.h>
/* In this order: it needs the types of the one above. */
#include <ode/collision.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief What the samples of a heightfield are.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_HEIGHTS_CALLBACK = 0, /**< `callback` is called for them */
  dGPUTRIMESH_HEIGHTS_BYTE = 1,     /**< unsigned char */
  dGPUTRIMESH_HEIGHTS_SHORT = 2,    /**< short */
  dGPUTRIMESH_HEIGHTS_SINGLE = 3,   /**< float */
  dGPUTRIMESH_HEIGHTS_DOUBLE = 4    /**< double */
};

/**
 * @brief What a dHeightfieldDataID was built from. The members are the arguments of ODE's functions
 *        dGeomHeightfieldDataBuild...(). Filled by dGpuTriMeshHeightfieldInit() with zeros, and scale 1.
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshHeightfield {
  dsizeint size;       /**< sizeof(dGpuTriMeshHeightfield) of your program; set by ...Init */
  int type;            /**< dGPUTRIMESH_HEIGHTS_... */
  const void* heights; /**< sample (i, j), i along x and j along z, at i + j * width_samples; not for callbacks */
  int copy;            /**< 0: the array is read at each collision and must live as long as the data */
  dHeightfieldGetHeight* callback; /**< gets user_data and the numbers of a sample */
  void* user_data;                 /**< handed to the callback */
  dReal width;                     /**< along x, greater than 0 */
  dReal depth;                     /**< along z, greater than 0 */
  int width_samples;               /**< along x, at least 2 */
  int depth_samples;               /**< along z, at least 2 */
  dReal scale;                     /**< a height is sample * scale + offset, along y */
  dReal offset;                    /**< what is added to the scaled sample */
  dReal thickness;                 /**< how far the ground reaches below its lowest height */
  int wrap;                        /**< not 0: the field repeats itself for ever along x and z */
} dGpuTriMeshHeightfield;

/**
 * @brief Zeroes the structure, sets its size, and the scale to 1. NULL does nothing.
 * @param field  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshHeightfieldInit(dGpuTriMeshHeightfield* field);

/**
 * @brief Describes to the library what the samples of a heightfield are, so that meshes collide with it.
 *
 * ODE does not give the heights of its heightfields, and its own collider for them takes no geoms of other classes than
 * its own. A mesh that meets a heightfield whose heights the library does not know gets no contacts. dMessage() says so
 * once for each dHeightfieldDataID, the pair counts as failed, and dGpuTriMeshGetError() is
 * dGPUTRIMESH_ERROR_UNSUPPORTED.
 *
 * dGpuTriMeshHeightfieldDataBuildSingle() and its like do both, build the data of ODE and describe them. This function
 * is for data that other code has built.
 *
 * @par The ground The surface is the one that ODE collides its own geoms with: each cell of the grid is cut into two
 * triangles from (i + 1, j) to (i, j + 1). Below the surface all is solid, down to the field's lowest height less
 * `thickness`, which is the lower end of its AABB. Callback fields without dGeomHeightfieldDataSetBounds() have no
 * lower end. A field that does not wrap has walls at its edges. A body whose middle lies above that bottom always
 * leaves through the surface or a wall, however thin the ground; one from below meets the bottom.
 *
 * @par Contacts
 * Those of two meshes, as the parameters of the mesh geom have it: with dGPUTRIMESH_CONTACTS_SOLID those of two solids
 * for closed meshes, and those of shells for open ones. The heightfield's side is -1. Heights are rounded to single
 * precision relative to a height under the mesh. So the place of the field in the world costs no digits.
 *
 * @par What is read when
 * The samples under the mesh are read each time that the pair collides, as ODE does: heights of a callback, or of an
 * array that was not copied, may change between two collisions. The mesh of the ground under each body is kept as long
 * as the heights there stay the same; where they change it is refitted. A field costs nothing where nothing touches it.
 *
 * @par Errors
 * With more than 2^23 samples under one mesh the pair has no contacts and leaves dGPUTRIMESH_ERROR_MEMORY. Where
 * heights under the mesh are not finite it has none either, and may leave dGPUTRIMESH_ERROR_MESH.
 *
 * @param data   what `field` describes. This is not checked against ODE
 * @param field  copied; see dGpuTriMeshHeightfield for its arrays
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not while another thread collides geoms that have the data. Callbacks are called by every thread that
 *          collides such a geom, with ODE's space locked.
 * @remarks ODE's box of a placeable heightfield that is turned is too small, so that spaces miss pairs: a non-placeable
 *          field, or a geom in no space, has no such trouble.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshHeightfieldDataDescribe(dHeightfieldDataID data, const dGpuTriMeshHeightfield* field);

/**
 * @brief Forgets the heights of data that are to be destroyed by dGeomHeightfieldDataDestroy(), or built anew by
 *        other code. NULL and data of which nothing is known do nothing.
 * @param data  may be NULL
 * @remarks Not while another thread collides geoms that have the data.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshHeightfieldDataForget(dHeightfieldDataID data);

/**
 * @brief dGeomHeightfieldDataBuildCallback(), whose arguments these are, and dGpuTriMeshHeightfieldDataDescribe().
 * @param d             data of ODE's, made by dGeomHeightfieldDataCreate()
 * @param pUserData     handed to the callback
 * @param pCallback     the height of a sample; called whenever a geom that has the data collides
 * @param width         size along x of the field, in its frame
 * @param depth         size along z
 * @param widthSamples  samples along x, 2 or more
 * @param depthSamples  samples along z, 2 or more
 * @param scale         what heights are multiplied by before they are used
 * @param offset        what is added to them then
 * @param thickness     how far the solid goes down below the lowest height
 * @param bWrap         other than 0: the field repeats itself for ever
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_ERROR_ARGUMENT for arguments at which ODE would abort, and then nothing is done;
 *          dGPUTRIMESH_ERROR_MEMORY. This holds for the other functions of this kind as well.
 * @remarks Not while another thread collides geoms that have the data, and not from their near callbacks.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshHeightfieldDataBuildCallback(dHeightfieldDataID d, void* pUserData,
                                                    dHeightfieldGetHeight* pCallback, dReal width, dReal depth,
                                                    int widthSamples, int depthSamples, dReal scale, dReal offset,
                                                    dReal thickness, int bWrap);
/**
 * @brief dGeomHeightfieldDataBuildByte(), and dGpuTriMeshHeightfieldDataDescribe(). With `bCopyHeightData` the library
 *        keeps a copy of its own beside ODE's.
 * @param d                data of ODE's, made by dGeomHeightfieldDataCreate()
 * @param pHeightData      widthSamples * depthSamples heights, row by row along x
 * @param bCopyHeightData  0: the array is read where it is, and has to outlive the data
 * @param width            size along x of the field, in its frame
 * @param depth            size along z
 * @param widthSamples     samples along x, 2 or more
 * @param depthSamples     samples along z, 2 or more
 * @param scale            what heights are multiplied by before they are used
 * @param offset           what is added to them then
 * @param thickness        how far the solid goes down below the lowest height
 * @param bWrap            other than 0: the field repeats itself for ever
 * @returns As dGpuTriMeshHeightfieldDataBuildCallback(), whose thread rule holds.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshHeightfieldDataBuildByte(dHeightfieldDataID d, const unsigned char* pHeightData,
                                                int bCopyHeightData, dReal width, dReal depth, int widthSamples,
                                                int depthSamples, dReal scale, dReal offset, dReal thickness,
                                                int bWrap);
/**
 * @brief dGeomHeightfieldDataBuildShort(), and dGpuTriMeshHeightfieldDataDescribe().
 * @param d                data of ODE's, made by dGeomHeightfieldDataCreate()
 * @param pHeightData      widthSamples * depthSamples heights, row by row along x
 * @param bCopyHeightData  0: the array is read where it is, and has to outlive the data
 * @param width            size along x of the field, in its frame
 * @param depth            size along z
 * @param widthSamples     samples along x, 2 or more
 * @param depthSamples     samples along z, 2 or more
 * @param scale            what heights are multiplied by before they are used
 * @param offset           what is added to them then
 * @param thickness        how far the solid goes down below the lowest height
 * @param bWrap            other than 0: the field repeats itself for ever
 * @returns As dGpuTriMeshHeightfieldDataBuildByte(), whose arguments and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshHeightfieldDataBuildShort(dHeightfieldDataID d, const short* pHeightData, int bCopyHeightData,
                                                 dReal width, dReal depth, int widthSamples, int depthSamples,
                                                 dReal scale, dReal offset, dReal thickness, int bWrap);
/**
 * @brief dGeomHeightfieldDataBuildSingle(), and dGpuTriMeshHeightfieldDataDescribe().
 * @param d                data of ODE's, made by dGeomHeightfieldDataCreate()
 * @param pHeightData      widthSamples * depthSamples heights, row by row along x
 * @param bCopyHeightData  0: the array is read where it is, and has to outlive the data
 * @param width            size along x of the field, in its frame
 * @param depth            size along z
 * @param widthSamples     samples along x, 2 or more
 * @param depthSamples     samples along z, 2 or more
 * @param scale            what heights are multiplied by before they are used
 * @param offset           what is added to them then
 * @param thickness        how far the solid goes down below the lowest height
 * @param bWrap            other than 0: the field repeats itself for ever
 * @returns As dGpuTriMeshHeightfieldDataBuildByte(), whose arguments and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshHeightfieldDataBuildSingle(dHeightfieldDataID d, const float* pHeightData, int bCopyHeightData,
                                                  dReal width, dReal depth, int widthSamples, int depthSamples,
                                                  dReal scale, dReal offset, dReal thickness, int bWrap);
/**
 * @brief dGeomHeightfieldDataBuildDouble(), and dGpuTriMeshHeightfieldDataDescribe().
 * @param d                data of ODE's, made by dGeomHeightfieldDataCreate()
 * @param pHeightData      widthSamples * depthSamples heights, row by row along x
 * @param bCopyHeightData  0: the array is read where it is, and has to outlive the data
 * @param width            size along x of the field, in its frame
 * @param depth            size along z
 * @param widthSamples     samples along x, 2 or more
 * @param depthSamples     samples along z, 2 or more
 * @param scale            what heights are multiplied by before they are used
 * @param offset           what is added to them then
 * @param thickness        how far the solid goes down below the lowest height
 * @param bWrap            other than 0: the field repeats itself for ever
 * @returns As dGpuTriMeshHeightfieldDataBuildByte(), whose arguments and thread rule hold.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshHeightfieldDataBuildDouble(dHeightfieldDataID d, const double* pHeightData, int bCopyHeightData,
                                                  dReal width, dReal depth, int widthSamples, int depthSamples,
                                                  dReal scale, dReal offset, dReal thickness, int bWrap);

/**
 * @brief dGpuTriMeshHeightfieldDataForget(), and dGeomHeightfieldDataDestroy(). NULL does nothing.
 * @param d  data of ODE's that no geom has any more
 * @remarks Not while another thread uses the data.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshHeightfieldDataDestroy(dHeightfieldDataID d);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_HEIGHTFIELD_H */
