// SPDX-License-Identifier: BSD-3-Clause
// fork() while a thread of the library loads an OpenCL driver: it waits, because a child could not free the locks of
// the C library that such a thread holds.
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "opencl/runtime/api.h"
#include "opencl/runtime/device_info.h"
#include "support/catch.h"

extern "C" {
std::atomic<bool> otgTestDriverIsLoaded{false}, otgTestDriverIsUnderWay{false};
}

TEST_CASE("a child is made before a driver is loaded or after, never meanwhile") {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("otg_icd_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "slow.icd") << OTG_SLOW_DRIVER << '\n';
  setenv("OCL_ICD_VENDORS", (folder.string() + "/").c_str(), 1);  // of the loaders that Linux has
  std::atomic<bool> done{false};
  std::thread thread([&] {
    CHECK(otg::opencl::listDevices().empty());
    done = true;
  });
  while (!otgTestDriverIsUnderWay && !done) std::this_thread::yield();
  const bool wasUnderWay = otgTestDriverIsUnderWay;
  const pid_t child = fork();
  if (child == 0) _exit(otgTestDriverIsLoaded ? 0 : 1);
  thread.join();
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  std::filesystem::remove_all(folder);
  if (otg::opencl::api() == nullptr) return;  // no loader, so no drivers
  REQUIRE(wasUnderWay);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}
