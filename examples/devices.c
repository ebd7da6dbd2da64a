/* SPDX-License-Identifier: BSD-3-Clause */
/* Where collisions are computed: the CPU, OpenCL devices, or whichever is faster. Runs without any device, too. */
#include "example.h"

int main(void) {
  dGpuTriMeshDataID data;
  dGpuTriMeshDevice device;
  dContactGeom here[16], there[16];
  dGeomID a, b;
  int status, count, i;
  EXPECT(dInitODE2(0) && dGpuTriMeshInit());
  data = makeBox();
  a = dCreateGpuTriMesh(0, data);
  b = dCreateGpuTriMesh(0, data);
  dGeomSetPosition(b, 0.1, 0.2, 0.9);
  count = dCollide(a, b, 16, here, sizeof here[0]);

  status = dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO); /* opens the default device in the background */
  EXPECT(status == dGPUTRIMESH_OK);
  EXPECT(dCollide(a, b, 16, there, sizeof there[0]) == count); /* here or there: the same contacts */
  status = dGpuTriMeshWaitForDevices(-1);
  EXPECT(status == dGPUTRIMESH_OK || status == dGPUTRIMESH_NO_DEVICE);

  status = dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL); /* would open it before it returns */
  EXPECT(status == dGPUTRIMESH_OK || status == dGPUTRIMESH_NO_DEVICE);
  EXPECT(dGpuTriMeshGetBackend() == dGPUTRIMESH_BACKEND_OPENCL);
  EXPECT(dCollide(a, b, 16, there, sizeof there[0]) == count);
  for (i = 0; i < count; ++i) EXPECT(here[i].depth == there[i].depth && here[i].pos[0] == there[i].pos[0]);

  for (i = 0; i < dGpuTriMeshGetDeviceCount(); ++i) {
    dGpuTriMeshDeviceInit(&device);
    EXPECT(dGpuTriMeshGetDevice(i, &device) == dGPUTRIMESH_OK);
    printf("%s: %u queries\n", device.name, (unsigned)device.queries);
  }
  EXPECT(dGeomGpuTriMeshSetBackend(a, dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK); /* this geom's own choice */
  EXPECT(dGeomGpuTriMeshGetBackend(a) == dGPUTRIMESH_BACKEND_CPU);
  dGpuTriMeshSetDeviceMemory((duint64)1 << 30); /* on each device that is opened from here on */
  EXPECT(dGpuTriMeshGetDeviceMemory() == (duint64)1 << 30);
  EXPECT(dGpuTriMeshOpenDevices(0, -1) >= 0); /* all GPUs, in place of what is open */
  dGpuTriMeshReleaseDeviceMemory();           /* what no query uses at the moment */
  dGpuTriMeshCloseDevices();
  EXPECT(dGpuTriMeshGetDeviceCount() == 0);

  dGeomDestroy(a);
  dGeomDestroy(b);
  dGpuTriMeshDataDestroy(data);
  dGpuTriMeshClose();
  dCloseODE();
  return 0;
}
