// SPDX-License-Identifier: BSD-3-Clause
// For programs that list OpenCL devices. It is not in the library, which neither forks nor ends a process.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include "opencl/runtime/device_info.h"

namespace otg::scenes {

/// Lists the devices in a child process first: false if a driver ended it. Drivers have been seen to do that (PoCL
/// where /sys is not mounted), and listDevices() would be the end of the program. Only for programs that have one
/// thread as yet, as all that fork.
inline bool driversSurviveListing() {
  const pid_t child = fork();
  if (child == 0) {
    opencl::listDevices();
    _exit(0);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status);
}

}  // namespace otg::scenes
