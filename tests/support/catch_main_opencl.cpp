// SPDX-License-Identifier: BSD-3-Clause
// For tests that need an OpenCL device: without one the program says so and exits with 77, which ctest reports as
// skipped. The cache of programs is a folder of this process, removed at the end.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "dispatch/device_slot.h"
#include "opencl/runtime/device_info.h"
#include "scenes/opencl_drivers.h"
#include "support/catch_runner.h"

int main(int argc, char* argv[]) {
  if (!otg::scenes::driversSurviveListing()) {
    std::puts("skipped: the OpenCL driver ended the process that asked for its devices");
    return 77;
  }
  if (otg::opencl::defaultDevice(otg::opencl::listDevices()) < 0) {
    std::puts("skipped: no OpenCL device (Debian: pocl-opencl-icd)");
    return 77;
  }
  std::string folder = (std::filesystem::temp_directory_path() / "otg_test_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 1;
  setenv("OTG_CACHE_DIR", folder.c_str(), 1);
  otg::letCpusTakeAuto(true);  // so that tests of auto have a device on every machine
  const int status = otg::test::runCatch(argc, argv);
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  return status;
}
