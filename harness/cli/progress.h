// SPDX-License-Identifier: BSD-3-Clause
// Long runs say on stderr how much is done, and how long the rest will take.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace otg::cli {

/// Steps of a run, of roughly equal length. The first line comes after five seconds, the next ones every ten. Steps of
/// an object that is made within a step of another one are parts of that step. For one thread.
class Progress {
 public:
  explicit Progress(std::size_t steps);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// One more step is done.
  void step();
  /// How much of the whole run is done, 0 to 1.
  double share() const;

 private:
  Progress* outer_;
  std::size_t steps_, done_ = 0;
};

/// "40 % done after 12 s, about 18 s left", without the estimate while it would be a guess.
std::string progressInWords(double share, std::chrono::duration<double> elapsed);

}  // namespace otg::cli
