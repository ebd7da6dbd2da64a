// SPDX-License-Identifier: BSD-3-Clause
#include "ode/base/environment_report.h"

#include <new>

#include "base/environment.h"
#include "opencl/runtime/log.h"

namespace otg {

void reportEnvironment() noexcept {
  try {
    for (const std::string& fault : readEnvironment().faults) opencl::logLineOnce(fault);
  } catch (const std::bad_alloc&) {
    return;
  }
}

}  // namespace otg
