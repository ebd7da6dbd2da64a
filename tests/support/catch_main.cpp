// SPDX-License-Identifier: BSD-3-Clause
// main of all tests but those of an OpenCL device. Catch2 2.13 is itself compiled in catch_runner.cpp, once.
#include "support/catch_runner.h"

int main(int argc, char* argv[]) {
  return otg::test::runCatch(argc, argv);
}
