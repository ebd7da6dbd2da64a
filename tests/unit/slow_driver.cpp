// SPDX-License-Identifier: BSD-3-Clause
// A driver for OpenCL's loader that has no platforms, and takes its time while it is loaded.
#include <atomic>
#include <chrono>
#include <thread>

/// Of the program that loads it.
extern "C" std::atomic<bool> otgTestDriverIsLoaded, otgTestDriverIsUnderWay;

namespace {

const bool kLoaded = [] {
  otgTestDriverIsUnderWay = true;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  otgTestDriverIsLoaded = true;
  return true;
}();

}  // namespace
