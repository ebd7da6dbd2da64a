// SPDX-License-Identifier: BSD-3-Clause
// The CPU's own work on the pairs and meshes of a batch, by the threads that a caller lends. Free of OpenCL's types.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

namespace otg::opencl {

/// Calls the work for consecutive parts of [0, count), on whatever threads it likes, and returns when all are done, as
/// ThreadPool::run does; or throws what the work throws.
using RunParts =
    std::function<void(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)>& work)>;

constexpr std::size_t kPart = 256;  ///< items that are worth a thread's while
constexpr std::size_t partsOf(std::size_t count) {
  return (count + kPart - 1) / kPart;
}

/// work(begin, end) for parts of [0, count) that begin at multiples of kPart, by `threads` if there are any.
template <class Work>
void runParts(const RunParts* threads, std::size_t count, const Work& work) {
  if (threads == nullptr || count <= kPart) {
    work(std::size_t{0}, count);
    return;
  }
  (*threads)(partsOf(count),
             [&](std::size_t begin, std::size_t end) { work(begin * kPart, std::min(end * kPart, count)); });
}

}  // namespace otg::opencl
