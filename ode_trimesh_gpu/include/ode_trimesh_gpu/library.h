/* SPDX-License-Identifier: BSD-3-Clause */
/* Starting and ending use of the library, status codes, and what the library was built as. */
#ifndef ODE_TRIMESH_GPU_LIBRARY_H
#define ODE_TRIMESH_GPU_LIBRARY_H

#include <ode/common.h>

#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @defgroup gputrimesh GpuTriMesh Class
 * @ingroup collide
 *
 * A triangle-mesh geom class whose mesh-mesh contacts are exact about which triangles intersect, deterministic, and the
 * same in both call orders. What holds for every function of the group unless its own text says otherwise:
 *
 * @par Units and frames
 * Lengths are in the unit of your world (metres by habit). Vertices are in the mesh's own frame; the geom's position
 * and rotation (its body's, with the geom's offset applied) place that frame in the world.
 *
 * @par Ownership
 * Arrays and structures that you pass in are copied before the function returns. Strings that you get belong to the
 * library and say how long they live.
 *
 * @par Threads
 * Different threads may use different objects at once. Any number of threads may call dCollide() at once on geoms of
 * this class, even on the same pair. A function that changes an object (Set, Build, Update, Destroy) must not run while
 * another thread uses that object, or a geom of it: ODE's own rule for geoms and bodies.
 *
 * @par Near callback
 * ODE locks a space while it collides it. Functions that only read may be called from a near
 * callback; functions that change a geom or its data may not: they report to ODE that the geom has moved, and ODE
 * aborts on a locked space.
 *
 * @par Errors
 * No function aborts, throws or prints because of a bad argument. Most return a status: dGPUTRIMESH_OK
 * (zero), a negative error, after which nothing has changed, or a positive remark. Functions that return a pointer
 * return NULL, and dGpuTriMeshGetError() says why. Ids of destroyed mesh data and geoms of this class are recognised
 * (dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_CLASS), until a new object of this library has the same address.
 * Functions that take a dTriMesh as well recognise neither. Every function that reads or changes a mesh may also return
 * dGPUTRIMESH_ERROR_BUSY. A geom that a callback destroys during a query is destroyed; the query goes on with what it
 * has, and leaves dGPUTRIMESH_ERROR_BUSY. dCollide() has no place for an error: a pair that can't be collided gets no
 * contacts, is counted in `failed_queries` of dGpuTriMeshStats, and dGpuTriMeshGetError() says why.
 */

/**
 * @brief What functions of this library return.
 * @ingroup gputrimesh
 */
enum {
  dGPUTRIMESH_OK = 0,

  /* Done, but: */
  dGPUTRIMESH_NOT_SOLID = 1, /**< the mesh is open or wound inconsistently, so that its volume is a signed sum only */
  dGPUTRIMESH_NO_DEVICE = 2, /**< no OpenCL device is open, so that the CPU computes until there is one */
  dGPUTRIMESH_OPENING = 3,   /**< a device is being opened in the background; the CPU computes meanwhile */

  /* Not done, because: */
  dGPUTRIMESH_ERROR_ARGUMENT = -1, /**< a null pointer, a negative count or stride, an index or option out of range */
  dGPUTRIMESH_ERROR_MESH = -2,     /**< the mesh can't be worked with; the data's report says what is wrong where */
  dGPUTRIMESH_ERROR_MEMORY = -3,   /**< out of memory */
  dGPUTRIMESH_ERROR_UNSUPPORTED = -4, /**< this version of the library can't do that */
  dGPUTRIMESH_ERROR_ODE = -5,         /**< ODE is not initialised: call dInitODE2() first */
  dGPUTRIMESH_ERROR_PRECISION = -6,   /**< the ODE in this process has another dReal than this library was built for */
  dGPUTRIMESH_ERROR_CLASS = -7,       /**< the geom is not of this class */
  dGPUTRIMESH_ERROR_MASS = -8,        /**< the mesh has no positive volume, so that it has no mass */
  dGPUTRIMESH_ERROR_CLASS_COUNT = -9, /**< all of ODE's user classes are taken by others */
  dGPUTRIMESH_ERROR_POSE = -10,       /**< a geom's pose is not finite or not rigid: see dCreateGpuTriMesh() */
  dGPUTRIMESH_ERROR_FILE = -11,       /**< a file can't be read or written; errno says why */
  dGPUTRIMESH_ERROR_COOKED = -12,     /**< bytes that are no cooked mesh of this version, or are damaged; the data's
                                           error string says which */
  dGPUTRIMESH_ERROR_BUSY = -13 /**< mesh data, or the data or scale of a geom, are changed while a query uses them:
                                    by another thread, or by a callback of that very query. Reported to the one that
                                    came second, for which nothing is done */
};

/**
 * @brief Prepares the library and registers its geom class with ODE.
 *
 * Call it after dInitODE2() and before threads are started; again after every dCloseODE() / dInitODE2(). One of ODE's
 * four user classes is taken, once: further calls find the class in place and do nothing. dCreateGpuTriMesh() calls it
 * if you did not, so that its use is to learn early whether all is well.
 *
 * Every entry of ODE's collider table for this class and ODE's own classes is filled here, so that no thread writes to
 * that table later. Otherwise ODE fills it on first use, without a lock.
 *
 * @returns 1 on success. 0 if ODE is not initialised, was built with another precision than this library, or has no
 * user class left; see dGpuTriMeshGetError().
 * @remarks Like dInitODE2() it must not run while another thread is inside ODE. It replaces ODE's debug handler for the
 *          moment in which it finds out whether ODE is initialised.
 * @remarks Another library's class may have taken this class's number after dCloseODE() / dInitODE2(). To notice that,
 * a geom of that number is created, collided with a heightfield and a convex, and destroyed; its class data are all
 *          zero.
 * @sa dGpuTriMeshClose
 * @remarks fork(): it waits until calls of other threads and batches in the background have ended, for 5 seconds at
 *          most. The child has geoms, data and contacts as they were. It computes on the CPU with threads of its own,
 *          with the same results. If the parent has looked for OpenCL devices, the child has none and opens none. It
 *          may end in any way. A callback of the library that waits for the thread which forks holds
 *          the fork up for those 5 seconds.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshInit(void);

/**
 * @brief Ends the use of the library: frees the scratch memory that the calling thread keeps between collisions, and
 *        ends the opening of devices in the background, for which it waits until the kernel at hand is built.
 *
 * Call it before or after dCloseODE(), or not at all; other threads free theirs when they end. Geoms and data that
 * still exist stay valid, and dGpuTriMeshInit() may be called again, which goes on with opening a device for
 * dGPUTRIMESH_BACKEND_AUTO. ODE can't unregister a class, so the class stays registered until dCloseODE().
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshClose(void);

/**
 * @brief The class number of this library's geoms, as dGeomGetClass() returns it.
 * @returns The number, or -1 when the class was not registered yet.
 * @remarks It may change when ODE is closed and initialised again: do not keep it. May be called from any thread and
 * from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetClass(void);

/**
 * @brief The status of the last function of this library that failed on the calling thread.
 * @returns A negative status; dGPUTRIMESH_OK when none has failed since the thread began or since the last call of this
 *          function, which resets it. dCollide() of geoms of this class is among those functions: it leaves
 *          dGPUTRIMESH_ERROR_POSE, dGPUTRIMESH_ERROR_BUSY or dGPUTRIMESH_ERROR_MEMORY. With a heightfield it leaves
 *          dGPUTRIMESH_ERROR_UNSUPPORTED if the heights are not known, and may leave dGPUTRIMESH_ERROR_MESH if those
 *          under the mesh are not finite (see heightfield.h).
 * @remarks May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetError(void);

/**
 * @brief One sentence for a status.
 * @param status  any value; unknown ones get a sentence that says so
 * @returns A string that is never NULL and lives for ever.
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API const char* dGpuTriMeshErrorString(int status);

/**
 * @brief What this library was built as, in the manner of dGetConfiguration(): tokens separated by blanks.
 *
 * Tokens: `ode_trimesh_gpu`; `double_precision` or `single_precision`, which has to match the dReal of the program.
 * @returns A string that lives for ever.
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API const char* dGpuTriMeshGetConfiguration(void);

/**
 * @brief Whether one token is part of dGpuTriMeshGetConfiguration(), in the manner of dCheckConfiguration().
 * @param token  case matters
 * @returns 1 if it is, 0 if it is not or if token is NULL.
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshCheckConfiguration(const char* token);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_LIBRARY_H */
