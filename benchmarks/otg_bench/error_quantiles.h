// SPDX-License-Identifier: BSD-3-Clause
// Errors in rows of benchmarks: median, a high percentile, largest.
#pragma once

#include "cli/command.h"
#include "truth/contact_errors.h"

namespace otg::cli {

/// Adds NAME_median, NAME_p99 (or another percentile) and NAME_max; null where there are no errors.
void addErrorQuantiles(Json& row, const std::string& name, const truth::Errors& errors, int percentile = 99);
/// What that added with the 99th percentile, as "median / 99 % / largest"; "-" where there are no errors.
std::string errorQuantilesInWords(const Json& row, const std::string& name);

}  // namespace otg::cli
