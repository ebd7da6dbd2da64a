// SPDX-License-Identifier: BSD-3-Clause
#include "ode/base/status.h"

namespace otg {
namespace {

/// Per thread, so that one thread's error is not another's.
thread_local int lastError = dGPUTRIMESH_OK;

}  // namespace

int noteStatus(int status) noexcept {
  if (status < 0) lastError = status;
  return status;
}

int takeStatus() noexcept {
  const int status = lastError;
  lastError = dGPUTRIMESH_OK;
  return status;
}

}  // namespace otg
