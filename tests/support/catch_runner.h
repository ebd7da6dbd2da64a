// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace otg::test {

/// Runs the tests that the command line asks for; the exit status.
int runCatch(int argc, char* argv[]);

}  // namespace otg::test
