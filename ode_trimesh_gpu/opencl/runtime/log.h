// SPDX-License-Identifier: BSD-3-Clause
// Where failures of OpenCL are reported.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace otg::opencl {

/// Takes one line without a line break. Called under a lock, from any thread.
using LogSink = std::function<void(const std::string& line)>;

/// Replaces the sink, which is stderr by default; an empty function restores that.
void setLogSink(LogSink sink);

/// Reports a failed call, once for each (call, code) of the process; counts every one.
void logFailure(const char* call, int code, const std::string& detail);

/// Logs another line, as it is.
void logLine(const std::string& text);
/// The same, but of equal texts only the first.
void logLineOnce(const std::string& text);

/// Failures since the process began, reported or not.
std::uint64_t failureCount();

/// Test hook: every failure is new again.
void forgetFailures();

}  // namespace otg::opencl
