// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/call.h"

#include <atomic>

#include "opencl/runtime/log.h"

namespace otg::opencl {
namespace {

std::atomic<std::uint64_t> calls{0};
std::atomic<std::uint64_t> firstFault{0};  // number of the call, 0 for none
std::atomic<std::uint64_t> lastFault{0};
std::atomic<cl_int> faultCode{CL_OUT_OF_RESOURCES};

}  // namespace

ClError::ClError(const char* call, cl_int code, const std::string& detail)
    : std::runtime_error(std::string(call) + " failed with " + std::to_string(code) +
                         (detail.empty() ? std::string() : ": " + detail)),
      call_(call),
      code_(code) {}

void logError(const ClError& error) {
  logFailure(error.call(), error.code(), error.what());
}

void FaultInjection::failAt(std::uint64_t nth, cl_int code, std::uint64_t more) {
  const std::uint64_t first = nth == 0 ? 0 : calls.load() + nth;
  firstFault = 0;
  faultCode = code;
  lastFault = first + more;
  firstFault = first;
}

std::uint64_t FaultInjection::callCount() {
  return calls;
}

namespace detail {

cl_int beginCall() {
  if (isOpenclForeign()) return CL_INVALID_CONTEXT;
  const std::uint64_t number = calls.fetch_add(1, std::memory_order_relaxed) + 1;
  const std::uint64_t first = firstFault.load(std::memory_order_relaxed);
  return first != 0 && number >= first && number <= lastFault ? faultCode.load() : CL_SUCCESS;
}

void reportRelease(const char* call, cl_int code) noexcept {
  try {
    logFailure(call, code, {});
  } catch (...) {  // no memory for a line of log
  }
}

}  // namespace detail
}  // namespace otg::opencl
