/* SPDX-License-Identifier: BSD-3-Clause */
/* Many pairs at once: contacts ahead of a space's near callbacks, arrays of pairs, work in the background, and threads
 * of the program's own. And more about each contact than dContactGeom holds. */
#include "example.h"

enum { kBoxes = 12, kPlaces = 16 };
static int found;

static void nearCallback(void* data, dGeomID o1, dGeomID o2) {
  dContactGeom contacts[kPlaces];
  (void)data;
  found += dCollide(o1, o2, kPlaces, contacts, sizeof contacts[0]); /* ready already */
}
static int onlyPlaceable(void* data, dGeomID o1, dGeomID o2) {
  (void)data;
  return dGeomGetBody(o1) == dGeomGetBody(o2);
}

/* Where a program's own scheduler would hand the tasks to its threads. */
static void runTasks(void* data, int count, dGpuTriMeshTask* task, void* context) {
  int i;
  (void)data;
  for (i = 0; i < count; ++i) task(context, i);
}

int main(void) {
  static dContactGeom contacts[kBoxes * kPlaces], collected[kBoxes * kPlaces];
  static dGpuTriMeshContactData known[kBoxes * kPlaces];
  dGpuTriMeshPair pairs[kBoxes - 1];
  int counts[kBoxes - 1], first[kBoxes], i, total;
  dGeomID boxes[kBoxes];
  dGpuTriMeshDataID data;
  dGpuTriMeshBatchID batch;
  dSpaceID space;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  EXPECT(dGpuTriMeshSetThreadCount(2) == dGPUTRIMESH_OK && dGpuTriMeshGetThreadCount() == 2);
  data = makeBox();
  space = dHashSpaceCreate(0);
  for (i = 0; i < kBoxes; ++i) { /* a row in which each overlaps the next one */
    boxes[i] = dCreateGpuTriMesh(space, data);
    dGeomSetPosition(boxes[i], 0.9 * i, 0, 0);
    if (i > 0) pairs[i - 1].o1 = boxes[i - 1], pairs[i - 1].o2 = boxes[i];
  }

  EXPECT(dGpuTriMeshPrefetch(space) == kBoxes - 1);
  dSpaceCollide(space, 0, &nearCallback);
  EXPECT(found >= 4 * (kBoxes - 1));
  EXPECT(dGpuTriMeshPrefetchSpaces(&space, 1, &onlyPlaceable, 0) == kBoxes - 1);

  /* The same contacts in one array, without a near callback. */
  EXPECT(dGpuTriMeshCollideSpace(space, kPlaces, 0, 0, contacts, sizeof contacts[0], kBoxes * kPlaces) == found);

  total = dGpuTriMeshCollidePairs(pairs, kBoxes - 1, kPlaces, contacts, sizeof contacts[0], counts);
  EXPECT(total == found && counts[0] >= 4);

  /* The threads of the program's own scheduler instead of the library's. */
  EXPECT(dGpuTriMeshSetTaskRunner(&runTasks, 0) == dGPUTRIMESH_OK);
  total = dGpuTriMeshCollidePairs(pairs, kBoxes - 1, kPlaces, contacts, sizeof contacts[0], counts);
  EXPECT(total == found); /* so few pairs need no help */
  EXPECT(dGpuTriMeshSetTaskRunner(0, 0) == dGPUTRIMESH_OK);

  batch = dGpuTriMeshBatchSubmit(pairs, kBoxes - 1, kPlaces);
  EXPECT(batch != 0);
  for (i = 0; !dGpuTriMeshBatchIsDone(batch) && i < 100; ++i) { /* other work goes here */
  }
  EXPECT(dGpuTriMeshBatchWait(batch) == total);
  EXPECT(dGpuTriMeshBatchCollect(batch, collected, sizeof collected[0], known, sizeof known[0], first) == total);
  EXPECT(first[0] == 0 && first[kBoxes - 1] == total && known[0].id != 0);
  dGpuTriMeshBatchDestroy(batch);

  total = dGpuTriMeshCollideEx(boxes[0], boxes[1], kPlaces, contacts, sizeof contacts[0], known, sizeof known[0]);
  EXPECT(total == counts[0]);
  for (i = 0; i < total; ++i) {
    printf("contact %08x%08x: region %d, feature %d of geom %d\n", (unsigned)(known[i].id >> 32), (unsigned)known[i].id,
           known[i].region, known[i].feature, known[i].feature_side);
  }

  dSpaceDestroy(space);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
