// SPDX-License-Identifier: BSD-3-Clause
// fork() with a device open: the child computes on the CPU, has no devices, and ends in every way.
#include "support/fork_child.h"

using namespace otg;
using namespace otg::test;

TEST_CASE("a child of a process that has a device open") {
  const OdeSession session;
  REQUIRE(dGpuTriMeshSetThreadCount(2) == dGPUTRIMESH_OK);
  REQUIRE(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  REQUIRE(dGpuTriMeshGetDeviceCount() > 0);
  const ForkScene scene;  // on the device
  REQUIRE(scene.hasContacts());
  checkChildren(scene);
  CHECK(dGpuTriMeshGetDeviceCount() > 0);
  CHECK(childFault(ChildEnd::kExit, [&] {
          if (dGpuTriMeshGetDeviceCount() != 0 || dGpuTriMeshOpenDevices(nullptr, 0) != 0) return false;
          if (dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) != dGPUTRIMESH_NO_DEVICE) return false;
          dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO);
          return dGpuTriMeshWaitForDevices(0) >= 0 && scene.isAsBefore();
        }) == "");
  // The parent has forgotten nothing.
  CHECK(scene.isAsBefore());
  dGpuTriMeshCloseDevices();
}

TEST_CASE("a child that is made while a device is being opened") {
  const OdeSession session;
  const ForkScene scene;
  for (int round = 0; round < 5; ++round) {
    dGpuTriMeshCloseDevices();
    dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO);
    std::this_thread::sleep_for(std::chrono::milliseconds(7 * round));
    CHECK(childFault(ChildEnd::kExit, [&] { return scene.isAsBefore(); }) == "");
  }
  dGpuTriMeshWaitForDevices(-1);
  dGpuTriMeshCloseDevices();
}
