// SPDX-License-Identifier: BSD-3-Clause
// All of Catch2 2.13, which is a header, apart from the assertions: the slowest file of the tests to compile.
#include "support/catch_runner.h"

#ifdef OTG_CATCH3
#include <catch2/catch_session.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#endif

namespace otg::test {

int runCatch(int argc, char* argv[]) {
  return Catch::Session().run(argc, argv);
}

}  // namespace otg::test
