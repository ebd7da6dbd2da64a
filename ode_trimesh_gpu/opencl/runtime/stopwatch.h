// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace otg::opencl {

/// Reads the clock only if it is to.
class Stopwatch {
 public:
  explicit Stopwatch(bool on) : on_(on), start_(on ? Clock::now() : Clock::time_point{}) {}
  double ms() const { return on_ ? std::chrono::duration<double, std::milli>(Clock::now() - start_).count() : 0; }

 private:
  using Clock = std::chrono::steady_clock;
  bool on_;
  Clock::time_point start_;
};

}  // namespace otg::opencl
