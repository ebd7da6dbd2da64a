// SPDX-License-Identifier: BSD-3-Clause
// What `otg soak` does again and again: everything that a long-lived program does, each result twice, in two ways.
#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace otg::cli {

struct SoakCounts {
  std::uint64_t rounds = 0, worlds = 0, steps = 0, queries = 0, compared = 0;
  std::uint64_t devicesOpened = 0, callsFailed = 0;
  std::uint64_t differences = 0;
  std::string firstDifference;  ///< kind of the first, with the seed of its round
};

/// One ODE session must exist. Rounds use ODE, so they run in one thread; the library has its own.
class SoakRounds {
 public:
  /// `withDevice`: the default OpenCL device is opened and closed now and then, and some of its calls fail.
  explicit SoakRounds(bool withDevice) : withDevice_(withDevice) {}
  ~SoakRounds();
  SoakRounds(const SoakRounds&) = delete;
  SoakRounds& operator=(const SoakRounds&) = delete;

  /// Everything that a round makes it destroys; what it does depends on the seed alone.
  void run(std::uint64_t seed);
  /// Devices and threads are given back: what memory the process has now does not depend on the rounds before.
  void settle();
  const SoakCounts& counts() const { return counts_; }

 private:
  void chooseDevices();
  void world();
  void pairs();
  void questions();
  void compare(bool same, const char* what);
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  double uniform(double low, double high);

  bool withDevice_ = false, isOpen_ = false;
  std::uint64_t seed_ = 0;
  std::mt19937 random_;
  SoakCounts counts_;
};

}  // namespace otg::cli
