// SPDX-License-Identifier: BSD-3-Clause
// What a simulator that watches kernels has to say of them.
#pragma once

#include <string>
#include <vector>

namespace otg::test {

/// The reports in what a process with simulated kernels said on stderr, but for those that are meant: races in which
/// one side is a line of the kernels that reads through a pointer to `volatile`, or says `// unordered`. What is no
/// report of the simulator's counts as one; how many warnings a compiler had does not.
std::vector<std::string> unexpectedReports(const std::string& errors);

}  // namespace otg::test
