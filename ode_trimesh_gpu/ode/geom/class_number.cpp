// SPDX-License-Identifier: BSD-3-Clause
#include "ode/geom/class_number.h"

#include <atomic>
#include <utility>

namespace otg {
namespace {

/// Of the process: ODE's class table is one per process, too.
std::atomic<int> classNumber{-1};
std::atomic<std::uint64_t> serials{0};

thread_local bool probeAnswered = false;

}  // namespace

int registeredClass() noexcept {
  return classNumber.load(std::memory_order_acquire);
}

void setRegisteredClass(int number) noexcept {
  classNumber.store(number);
}

std::uint64_t nextSerial() noexcept {
  return serials.fetch_add(1, std::memory_order_relaxed);
}

void answerProbe() noexcept {
  probeAnswered = true;
}

bool takeProbeAnswer() noexcept {
  return std::exchange(probeAnswered, false);
}

}  // namespace otg
