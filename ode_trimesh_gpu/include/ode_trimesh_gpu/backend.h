/* SPDX-License-Identifier: BSD-3-Clause */
/* Where collisions are computed: the CPU, OpenCL devices, or both at once. The contacts do not depend on it. */
#ifndef ODE_TRIMESH_GPU_BACKEND_H
#define ODE_TRIMESH_GPU_BACKEND_H

#include <ode/common.h>

#include "export.h"
#include "params.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Says where the queries of all geoms are computed that have no choice of their own
 *        (dGpuTriMeshParams::backend), and opens the default device if that needs one and none is open.
 *
 * Opening a device is slow. The first time on a machine it builds all kernels and measures the costs of queries, for
 * some tens of seconds. Both are kept on disk (OTG_CACHE_DIR, else XDG_CACHE_HOME or ~/.cache). No other function opens
 * devices but dGpuTriMeshOpenDevices(), and no query builds kernels, so that no dCollide() waits for it.
 *
 * AUTO opens in the background and returns at once: the CPU computes until the device is ready, with the same contacts,
 * and dGpuTriMeshWaitForDevices() waits for it. OPENCL opens before it returns, and waits for a device that is being
 * opened in the background. A program that ends meanwhile waits for the kernel that is being built.
 * A child process made by fork() meanwhile has to do with the CPU: drivers may have been locked when it was made.
 *
 * AUTO does not open a device of type CPU, and gives it no work if it is open: it has the cores that the library's own
 * threads have, and is slower on them. OPENCL does.
 *
 * Before the first call it is AUTO with no device open, which is the CPU. The environment variable OTG_BACKEND (auto,
 * cpu or opencl) has the first dGpuTriMeshInit() call this function.
 *
 * @param backend  dGPUTRIMESH_BACKEND_AUTO, CPU or OPENCL
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_NO_DEVICE if OPENCL was requested and no device can be used: the choice holds,
 *          and the CPU computes until one is open; dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MEMORY. Never
 *          dGPUTRIMESH_NO_DEVICE for AUTO; errors in the background go to stderr, once
 * @remarks From any thread, also while others collide.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshSetBackend(int backend);

/**
 * @brief Waits until a device that dGpuTriMeshSetBackend() opens in the background is ready.
 *
 * For programs that measure, or that do not want to compute their first steps on the CPU alone. With 0 it says whether
 * devices are ready.
 *
 * @param milliseconds  how long at most; 0 not at all, less than 0 for as long as it takes
 * @returns dGPUTRIMESH_OK if a device is open; dGPUTRIMESH_OPENING if one is still being opened; dGPUTRIMESH_NO_DEVICE
 *          if none was requested or none can be used; dGPUTRIMESH_ERROR_MEMORY.
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshWaitForDevices(int milliseconds);

/**
 * @brief What dGpuTriMeshSetBackend() was called with last.
 * @returns dGPUTRIMESH_BACKEND_..., dGPUTRIMESH_BACKEND_AUTO before the first call.
 * @remarks May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetBackend(void);

/**
 * @brief Chooses for one geom: sets dGpuTriMeshParams::backend, and the choices for single phases back to it.
 * @param g        a geom of this class, or a dTriMesh that collides through this library
 * @param backend  dGPUTRIMESH_BACKEND_...
 * @returns dGPUTRIMESH_OK; dGPUTRIMESH_NO_DEVICE as dGpuTriMeshSetBackend(), but nothing is opened;
 *          dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks May be called from a near callback, but not while another thread collides the geom.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshSetBackend(dGeomID g, int backend);

/**
 * @brief The `backend` of a geom's parameters.
 * @param g  a geom of this class, or a dTriMesh that collides through this library
 * @returns dGPUTRIMESH_BACKEND_..., or dGPUTRIMESH_ERROR_CLASS, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks May be called from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGeomGpuTriMeshGetBackend(dGeomID g);

/**
 * @brief Opens OpenCL devices in place of those that are open. Batches are divided among all of them.
 *
 * Each has a context of its own; every mesh that collides there is kept in its memory until that is needed for others.
 * Where a device fails, the CPU computes the query. After dGPUTRIMESH_DEVICE_FAILURES failures in a row the device is
 * switched off, with a line on stderr.
 *
 * @param indices  numbers of devices, as `otg devices` lists them. The same one may be there several times. NULL: see
 * count
 * @param count    how many. With indices NULL: 0 for the default device (the first GPU, else the first accelerator,
 *                 else the first CPU; the environment variable OTG_OPENCL_DEVICE names another one), -1 for all GPUs
 * @returns How many are open now, 0 or more (one that cannot be opened is left out, and a line on stderr says why);
 *          dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks From any thread; queries under way finish on the devices that they have. Slow: see dGpuTriMeshSetBackend().
 *          What is being opened in the background is dropped.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshOpenDevices(const int* indices, int count);

/**
 * @brief Limits the memory that this library takes on each device: meshes, and lists and results of queries.
 *
 * A mesh is sent to a device when it first collides there, and stays until others need its room. The least recently
 * used meshes go first, and are sent again when they are needed. Meshes take half of the memory at most. Lists and
 * results stay for later queries, until others need their room or dGpuTriMeshReleaseDeviceMemory() is called. A batch
 * that does not fit at once is done in parts. The CPU computes a query that does not fit. A device that has no room for
 * the first lists, 10 to 20 MB, is not opened.
 *
 * @param bytes  0 for half of the device's memory, which is the default. The environment variable OTG_DEVICE_MEMORY (a
 *               number of bytes) has the first dGpuTriMeshInit() call this function
 * @remarks From any thread. It holds for devices that are opened afterwards; those that are open keep their limit.
 * @sa dGpuTriMeshGetDevice(), which counts uploads, updates, evictions and bytes
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshSetDeviceMemory(duint64 bytes);

/**
 * @brief What dGpuTriMeshSetDeviceMemory() was called with last.
 * @returns Bytes, 0 before the first call.
 * @remarks May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API duint64 dGpuTriMeshGetDeviceMemory(void);

/**
 * @brief Gives back what no query uses at the moment, on all open devices: lists and results that were kept for later
 *        queries, and the meshes of a device if no query has any of them. They are made and sent again when needed.
 * @returns Bytes that were given back. Results that are still held, as those of a batch that was not released, stay.
 * @remarks From any thread; does not wait for queries. Not from a near callback if you want the next query to be fast.
 * @ingroup gputrimesh
 */
OTG_API duint64 dGpuTriMeshReleaseDeviceMemory(void);

/**
 * @brief Closes all devices, when the queries that use them are done. The CPU computes from here on. Not needed at the
 *        end of a program. What is being opened in the background is dropped; that is not waited for.
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshCloseDevices(void);

/** Failures in a row after which a device is switched off, until it is opened again. A failure is a call (a query or a
 * batch) that the device could not finish. */
#define dGPUTRIMESH_DEVICE_FAILURES 3

/**
 * @brief An open device and what became of its work. Filled by dGpuTriMeshGetDevice().
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshDevice {
  dsizeint size;           /**< sizeof(dGpuTriMeshDevice) of your program; set by ...Init */
  int index;               /**< its number in the list of all devices */
  int switched_off;        /**< 1 after too many failures in a row */
  char name[128];          /**< cut if it is longer */
  duint64 queries;         /**< pairs that it was given */
  duint64 failed_queries;  /**< of these, in calls that failed */
  duint64 calls;           /**< single queries and batches */
  duint64 failed_calls;    /**< of these, those that failed */
  duint64 mesh_uploads;    /**< meshes that were sent there */
  duint64 mesh_updates;    /**< changes of meshes that were sent there, of vertices that had moved */
  duint64 mesh_evictions;  /**< meshes that had to make room for others */
  duint64 mesh_bytes_sent; /**< of mesh_uploads and mesh_updates together */
  duint64 mesh_bytes;      /**< that meshes take there now */
  duint64 memory_bytes;    /**< that all buffers take there now: meshes, lists and results */
} dGpuTriMeshDevice;

/**
 * @brief Sets the size and zeroes the rest. NULL does nothing.
 * @param device  may be NULL
 * @remarks Needs no ODE. May be called from any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshDeviceInit(dGpuTriMeshDevice* device);

/**
 * @brief How many devices are open, switched off or not; without those that are being opened in the background.
 * @returns 0 or more.
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetDeviceCount(void);

/**
 * @brief Describes an open device.
 * @param Index   0 to dGpuTriMeshGetDeviceCount() - 1
 * @param device  `device->size` must be sizeof(dGpuTriMeshDevice): see dGpuTriMeshDeviceInit()
 * @returns dGPUTRIMESH_OK, dGPUTRIMESH_ERROR_ARGUMENT or dGPUTRIMESH_ERROR_MEMORY.
 * @remarks From any thread.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetDevice(int Index, dGpuTriMeshDevice* device);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_BACKEND_H */
