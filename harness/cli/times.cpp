// SPDX-License-Identifier: BSD-3-Clause
#include "cli/times.h"

#include <chrono>

namespace otg::cli {

double timeOnce(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

std::vector<double> repeatTimes(int repeat, const std::function<double()>& body) {
  std::vector<double> times;
  double sum = 0;
  const int most = repeat > 0 ? repeat : 50;
  for (int i = 0; i < most; ++i) {
    times.push_back(body());
    sum += times.back();
    if (repeat == 0 && i >= 2 && sum > 500) break;
  }
  return times;
}

}  // namespace otg::cli
