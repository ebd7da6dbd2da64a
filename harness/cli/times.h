// SPDX-License-Identifier: BSD-3-Clause
// Times of calls.
#pragma once

#include <functional>
#include <vector>

namespace otg::cli {

/// Medians of repeated runs of `body`, which returns milliseconds by itself when it measures less than the whole call.
std::vector<double> repeatTimes(int repeat, const std::function<double()>& body);
/// Wall time of one call, in milliseconds.
double timeOnce(const std::function<void()>& body);

}  // namespace otg::cli
