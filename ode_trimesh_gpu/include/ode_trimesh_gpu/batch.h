/* SPDX-License-Identifier: BSD-3-Clause */
/* Many pairs at once: arrays of pairs, contacts of whole spaces ahead of their near callbacks, work in the background.
 */
#ifndef ODE_TRIMESH_GPU_BATCH_H
#define ODE_TRIMESH_GPU_BATCH_H

#include <ode/common.h>
#include <ode/contact.h>

#include "contact_data.h"
#include "export.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * @brief Two geoms of this class, or dTriMesh geoms that collide through it: see dGpuTriMeshCollidePairs().
 * @ingroup gputrimesh
 */
typedef struct dGpuTriMeshPair {
  dGeomID o1; /**< the first geom: normals point into it */
  dGeomID o2; /**< the second geom */
} dGpuTriMeshPair;

/**
 * @brief Computes the contacts of all pairs of a space that have a mesh at once, so that the near callbacks of the
 *        dSpaceCollide() that follows find them ready.
 *
 *     dGpuTriMeshPrefetch(space);
 *     dSpaceCollide(space, data, &nearCallback);   -- as it is: its calls of dCollide() are quick now
 *
 * The pairs are computed by all threads (dGpuTriMeshSetThreadCount()) and by the devices that geoms may use. A call of
 * dCollide(), dGpuTriMeshCollideEx() or of a contact array takes what is ready if it is the very same query:
 * both meshes, both poses, velocities, parameters and what is remembered of the pair unchanged to the last bit.
 * Anything else is computed as if nothing had been prefetched. Either way the contacts are the same, byte for byte, and
 * so is what is remembered and counted, but for `prefetched` in dGpuTriMeshStats.
 *
 * Pairs of a mesh with a sphere, box, capsule, cylinder, convex or plane are among them; their sizes count as the poses
 * do. The CPU computes them, for as many contacts as the pair's last request. Where nothing has changed since the last
 * prefetch (bodies at rest) its result is taken again. Three kinds are left out: rays, which are as quick as the
 * look-up; heightfields, whose heights may change unnoticed; and geoms in a dGeomTransform. Meshes with callbacks for
 * triangles are left to the near callback.
 *
 * A dTriMesh of ODE's is a mesh here in the pairs in which dCollide() comes to this library: with a geom of this class,
 * and with what dGpuTriMeshOverrideTriMesh() and dGpuTriMeshOverrideTriMeshWith() have taken over. After dCloseODE()
 * those pairs are ODE's own again. This function does not see that, and its work on them is unused until they are taken
 * over anew. A prefetch looks for changes of its data as a collision does, so that it finds small ones earlier. Two
 * geoms that have not collided yet get their order here, as from dGpuTriMeshOverridePrepare(). For contacts that are
 * equal byte for byte, prepare the geoms, or have the near callback take pairs in the order of dSpaceCollide().
 *
 * Pairs of meshes with CONTACTS_UNIMPORTANT are always computed in the near callback: their contacts are others.
 *
 * @param space  its pairs are found by dSpaceCollide() with ODE's own rules (category and collide bits, enabled geoms,
 *               bodies), and those in spaces inside it as well
 * @returns The number of pairs that are ready, 0 or more; dGPUTRIMESH_ERROR_ARGUMENT for NULL,
 *          dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not from a near callback, and not while another thread changes or collides geoms of the space.
 * @remarks What is ready is kept until the next prefetch that meets the geom, or the end of the geom. It takes memory
 * for all contacts of a pair: dGpuTriMeshParams::max_contacts bounds them.
 * @sa dGpuTriMeshPrefetchSpaces
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshPrefetch(dSpaceID space);

/**
 * @brief Says whether a pair is worth computing ahead: 0 if the near callback will not request it, as for bodies that a
 *        joint connects.
 * @param data  what dGpuTriMeshPrefetchSpaces() or dGpuTriMeshCollideSpace() was given
 * @param o1    a geom
 * @param o2    another one
 * @returns 0: leave the pair out. dGpuTriMeshPrefetchSpaces() then leaves it to the near callback; with
 *          dGpuTriMeshCollideSpace() it has no contacts.
 * @remarks Called by the calling thread, with the space locked: do not change geoms, spaces or bodies in it.
 * @ingroup gputrimesh
 */
typedef int dGpuTriMeshPairFilter(void* data, dGeomID o1, dGeomID o2);

/**
 * @brief dGpuTriMeshPrefetch() for several spaces, of one world or of many, as one batch. Pairs of geoms in two
 *        different ones of these spaces are not among its pairs.
 * @param spaces  none of them NULL; one that is listed twice, or that lies inside another one, is done once
 * @param count   how many
 * @param filter  which pairs; NULL: all
 * @param data    passed to the filter
 * @returns As dGpuTriMeshPrefetch().
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshPrefetchSpaces(const dSpaceID* spaces, int count, dGpuTriMeshPairFilter* filter, void* data);

/**
 * @brief Collides all geoms of a space and fills one array with their contacts, so that a program makes its joints in
 *        one loop and needs no near callback.
 *
 *     dContact contacts[4096];
 *     int n = dGpuTriMeshCollideSpace(space, 16, NULL, NULL, &contacts[0].geom, sizeof(dContact), 4096);
 *     for (int i = 0; i < n; ++i) {
 *       contacts[i].surface = ...
 *       dBodyID b1 = dGeomGetBody(contacts[i].geom.g1), b2 = dGeomGetBody(contacts[i].geom.g2);
 *       dJointAttach(dJointCreateContact(world, joints, &contacts[i]), b1, b2);
 *     }
 *
 * The broad phase runs once. Pairs that dGpuTriMeshPrefetch() would compute are computed by all threads and devices,
 * every other pair by dCollide() on the calling thread: geoms of ODE's own, heightfields, rays, meshes with callbacks.
 * If the meshes of all pairs have no more than 4,096 triangles together, the calling thread computes every pair.
 * The contacts are those of dSpaceCollide() with a near callback that calls dCollide(), byte for byte. So is their
 * order: pairs as the broad phase finds them first, then the pairs in spaces inside `space`. It depends on neither
 * threads nor devices. What is remembered of pairs and counted is the same, too, but for `prefetched` in
 * dGpuTriMeshStats: pairs that were shared count there.
 *
 * @param space     whose geoms; spaces in it are collided with the rest and among themselves
 * @param flags     of each dCollide(): the lower 16 bits are the most contacts of a pair, at least 1;
 *                  CONTACTS_UNIMPORTANT may be added
 * @param filter    which pairs; NULL: all. Bodies that a joint connects are left out here
 * @param data      passed to the filter
 * @param contact   receives the contacts, in world coordinates; g1 and g2 are their geoms. May be NULL if `capacity` is
 * 0
 * @param skip      bytes from one place to the next, at least sizeof(dContactGeom): sizeof(dContact) fills an array of
 *                  dContact through its member `geom`
 * @param capacity  how many places there are. When the array is full, pairs that are left are not collided
 * @returns The number of contacts, `capacity` at most: that many say that there may be more.
 * dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks Not from a near callback, and not while another thread changes or collides geoms of the space.
 * @sa dGpuTriMeshPrefetch
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshCollideSpace(dSpaceID space, int flags, dGpuTriMeshPairFilter* filter, void* data,
                                    dContactGeom* contact, int skip, int capacity);

/**
 * @brief Collides an array of pairs, by all threads and the devices that the geoms may use. Pair i has the contacts
 * that dCollide(pairs[i].o1, pairs[i].o2, flags, ...) would give it, byte for byte.
 *
 * What is remembered of pairs and counted is as after these calls in the order of the array. A pair may be listed more
 * than once. Two geoms of one body, and a geom with itself, have no contacts, as in dCollide().
 *
 * Once dGpuTriMeshOverrideTriMesh() was called, dTriMesh geoms may be among them. From then on a pointer to a destroyed
 * geom is not recognised: there must be none.
 *
 * @param pairs          geoms of this class, and dTriMesh geoms as said above
 * @param count          how many pairs
 * @param flags          as in dCollide(): the lower 16 bits are the number N of places for each pair, at least 1;
 *                       CONTACTS_UNIMPORTANT may be added
 * @param contact        receives the contacts, in world coordinates: those of pair i begin at place i * N; count * N
 *                       places in all
 * @param skip           bytes from one place to the next, at least sizeof(dContactGeom)
 * @param contact_count  receives the number of contacts of each pair; `count` elements
 * @returns The number of contacts in all; dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_CLASS if a geom is none of
 *          these, dGPUTRIMESH_ERROR_MEMORY: then nothing was written or counted. A single pair that cannot be collided
 *          (see dGpuTriMeshStats) has no contacts, and dGpuTriMeshGetError() says why.
 * @remarks As dCollide(): from any number of threads at once, and from a near callback. The threads of the library call
 *          no function of ODE.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshCollidePairs(const dGpuTriMeshPair* pairs, int count, int flags, dContactGeom* contact, int skip,
                                    int* contact_count);

/**
 * @brief An array of pairs that is computed in the background.
 * @ingroup gputrimesh
 */
typedef struct dxGpuTriMeshBatch* dGpuTriMeshBatchID;

/**
 * @brief Begins to collide an array of pairs and returns at once.
 *
 *     dGpuTriMeshBatchID batch = dGpuTriMeshBatchSubmit(pairs, count, 16);
 *     ... other work; geoms may move, get other meshes, be destroyed ...
 *     n = dGpuTriMeshBatchWait(batch);
 *     contacts = malloc(n * sizeof(dContactGeom));
 *     dGpuTriMeshBatchCollect(batch, contacts, sizeof(dContactGeom), NULL, 0, first);
 *     dGpuTriMeshBatchDestroy(batch);
 *
 * Poses, velocities, parameters and what is remembered of the pairs are those of the moment of this call, and so are
 * the contacts. The geoms remember and count the collision when it is collected. A dTriMesh and its data may be
 * destroyed meanwhile, too.
 *
 * @param pairs  as in dGpuTriMeshCollidePairs(); copied
 * @param count  how many
 * @param flags  as there
 * @returns The batch, which the caller destroys; NULL: dGpuTriMeshGetError() says why, as there.
 * @remarks From any thread, and from a near callback. Any number of batches may be under way at once.
 * @ingroup gputrimesh
 */
OTG_API dGpuTriMeshBatchID dGpuTriMeshBatchSubmit(const dGpuTriMeshPair* pairs, int count, int flags);

/**
 * @brief Whether a batch is computed: whether dGpuTriMeshBatchWait() would return at once.
 * @param batch  the batch
 * @returns 1 or 0; dGPUTRIMESH_ERROR_ARGUMENT for NULL.
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshBatchIsDone(dGpuTriMeshBatchID batch);

/**
 * @brief Waits until a batch is computed.
 * @param batch  the batch
 * @returns The number of contacts of all pairs; dGPUTRIMESH_ERROR_ARGUMENT for NULL; dGPUTRIMESH_ERROR_MEMORY if memory
 *          ran out on the way.
 * @remarks Several threads may wait for one batch.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshBatchWait(dGpuTriMeshBatchID batch);

/**
 * @brief Waits until a batch is computed and copies its contacts: those of all pairs, one after the other.
 *
 * The first call has those geoms that still exist remember and count the collision. Later calls give the same contacts
 * and change nothing.
 *
 * @param batch      the batch
 * @param contact    receives the contacts, in world coordinates as of the moment of submission; as many places as
 *                   dGpuTriMeshBatchWait() says. May be NULL if that is 0
 * @param skip       bytes from one place to the next, at least sizeof(dContactGeom)
 * @param data       receives the data of each contact; may be NULL
 * @param data_skip  bytes from one element to the next, at least sizeof(dGpuTriMeshContactData)
 * @param first      receives the place of each pair's first contact, and last the number of all contacts: one element
 *                   more than there are pairs. May be NULL
 * @returns The number of contacts; dGPUTRIMESH_ERROR_ARGUMENT, dGPUTRIMESH_ERROR_MEMORY.
 * @remarks One thread at a time for one batch, and as dCollide() with respect to the geoms.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshBatchCollect(dGpuTriMeshBatchID batch, dContactGeom* contact, int skip,
                                    dGpuTriMeshContactData* data, int data_skip, int* first);

/**
 * @brief Ends a batch; waits for it if it is not computed yet. NULL does nothing.
 * @param batch  the batch
 * @remarks Every batch has to be destroyed before the program ends.
 * @remarks By one thread, when no other one uses the batch any more.
 * @ingroup gputrimesh
 */
OTG_API void dGpuTriMeshBatchDestroy(dGpuTriMeshBatchID batch);

/**
 * @brief Sets how many threads work on one batch (a prefetch, an array of pairs), the calling one among them. The
 * results do not depend on it.
 *
 * Threads are started when a batch needs them and wait for the next one. Single calls of dCollide() are computed by the
 * calling thread.
 *
 * @param count  1 to 1024; 0 (which it is at first): as many as the environment variable OTG_THREADS says, else one for
 *               each core that the process may use; of 8 and more, one is left to the driver while devices are open
 * @returns dGPUTRIMESH_OK or dGPUTRIMESH_ERROR_ARGUMENT.
 * @remarks From any thread. Batches under way go on with the threads that they have.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshSetThreadCount(int count);

/**
 * @brief How many threads work on one batch.
 * @returns 1 or more: what dGpuTriMeshSetThreadCount() was called with, or what 0 stands for.
 * @remarks From any thread and from a near callback.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshGetThreadCount(void);

/**
 * @brief One task of a batch, for a scheduler of the program's own.
 * @param context  what the runner was called with
 * @param index    0 to one less than the number of tasks
 * @ingroup gputrimesh
 */
typedef void dGpuTriMeshTask(void* context, int index);

/**
 * @brief Calls task(context, i) for each i from 0 to count - 1, and returns when all calls have returned.
 *
 * The calls may be on any threads, at once or one after the other, in any order. A runner may be called by several
 * threads at once, and from within a task. It must not throw, and calls no function of this library.
 *
 * @param data     what dGpuTriMeshSetTaskRunner() was called with
 * @param count    the number of tasks: dGpuTriMeshGetThreadCount() at most
 * @param task     the function to call
 * @param context  its first argument
 * @ingroup gputrimesh
 */
typedef void dGpuTriMeshTaskRunner(void* data, int count, dGpuTriMeshTask* task, void* context);

/**
 * @brief Has a scheduler of the program's own work on batches, in place of threads of the library. For programs that
 *        have a pool of threads already. The results do not depend on it.
 *
 * Tasks share a batch among them: each takes pairs until there are none left. A batch requests as many tasks as
 * dGpuTriMeshGetThreadCount() says, or fewer if it is small. Threads that wait for devices or compute in the background
 * stay the library's own.
 *
 * @param runner  the function; NULL, which it is at first: threads of the library
 * @param data    its first argument
 * @returns dGPUTRIMESH_OK.
 * @remarks From any thread. Batches under way go on with what they have.
 * @ingroup gputrimesh
 */
OTG_API int dGpuTriMeshSetTaskRunner(dGpuTriMeshTaskRunner* runner, void* data);

#ifdef __cplusplus
}
#endif

#endif /* ODE_TRIMESH_GPU_BATCH_H */
