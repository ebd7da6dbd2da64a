// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/log.h"

#include <atomic>
#include <cstdio>
#include <mutex>
#include <set>
#include <utility>

#include "base/fork_gate.h"

namespace otg::opencl {
namespace {

struct Log {
  std::mutex mutex;
  LogSink sink;
  std::set<std::pair<std::string, int>> reported;
  std::set<std::string> lines;  ///< of logLineOnce()
  std::atomic<std::uint64_t> count{0};

  void write(const std::string& text) const {
    const std::string line = "ode_trimesh_gpu: " + text;
    if (sink) {
      sink(line);
    } else {
      std::fputs((line + "\n").c_str(), stderr);
    }
  }
};

Log& log() {
  // Never destroyed: threads may fail while the process ends.
  static Log* const instance = [] {
    auto* const made = new Log;
    addForkHooks({[] { log().mutex.lock(); }, [] { log().mutex.unlock(); }, [] { log().mutex.unlock(); }});
    return made;
  }();
  return *instance;
}

}  // namespace

void setLogSink(LogSink sink) {
  const std::lock_guard lock(log().mutex);
  log().sink = std::move(sink);
}

void logFailure(const char* call, int code, const std::string& detail) {
  Log& l = log();
  l.count.fetch_add(1, std::memory_order_relaxed);
  const std::lock_guard lock(l.mutex);
  if (!l.reported.emplace(call, code).second) return;
  std::string text = std::string(call) + " failed with " + std::to_string(code);
  if (!detail.empty()) text += ": " + detail;
  l.write(text);
}

void logLine(const std::string& text) {
  const std::lock_guard lock(log().mutex);
  log().write(text);
}

void logLineOnce(const std::string& text) {
  const std::lock_guard lock(log().mutex);
  if (log().lines.insert(text).second) log().write(text);
}

std::uint64_t failureCount() {
  return log().count;
}

void forgetFailures() {
  const std::lock_guard lock(log().mutex);
  log().reported.clear();
}

}  // namespace otg::opencl
