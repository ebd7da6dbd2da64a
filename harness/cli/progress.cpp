// SPDX-License-Identifier: BSD-3-Clause
#include "cli/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace otg::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kFirstLine{5}, kBetweenLines{10};
/// Of less no estimate: first steps make what the others share.
constexpr double kLeastShare = 0.03;

Progress* innermost = nullptr;
Clock::time_point start, nextLine;

std::string inWords(double seconds) {
  if (seconds < 100) return fmt::format("{:.0f} s", seconds);
  if (seconds < 6000) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

std::string progressInWords(double share, std::chrono::duration<double> elapsed) {
  std::string done = fmt::format("{:.0f} % done after {}", 100 * share, inWords(elapsed.count()));
  if (share < kLeastShare) return done;
  return fmt::format("{}, about {} left", done, inWords(elapsed.count() * (1 - share) / share));
}

Progress::Progress(std::size_t steps) : outer_(innermost), steps_(std::max<std::size_t>(steps, 1)) {
  if (outer_ == nullptr) {
    start = Clock::now();
    nextLine = start + kFirstLine;
  }
  innermost = this;
}

Progress::~Progress() {
  innermost = outer_;
}

void Progress::step() {
  done_ = std::min(done_ + 1, steps_);
  const Clock::time_point now = Clock::now();
  if (now < nextLine) return;
  const double part = share();
  if (part >= 1) return;
  nextLine = now + kBetweenLines;
  fmt::print(stderr, "{}\n", progressInWords(part, now - start));
}

double Progress::share() const {
  double share = 0;
  for (const Progress* part = this; part != nullptr; part = part->outer_) {
    share = (static_cast<double>(part->done_) + share) / static_cast<double>(part->steps_);
  }
  return share;
}

}  // namespace otg::cli
