// SPDX-License-Identifier: BSD-3-Clause
// Loads the OpenCL loader.
#include "opencl/runtime/api.h"

#include <atomic>
#include <bit>

#include "base/fork_gate.h"
#include "base/system.h"

namespace otg::opencl {
namespace {

constexpr long kNobody = -1;
std::atomic<long> loadedByGeneration{kNobody};

const Api* load() {
  void* const library = openSharedLibrary({"libOpenCL.so.1", "libOpenCL.so", "OpenCL.dll"});
  if (library == nullptr) return nullptr;
  static Api table;
#define OTG_CL_FIND(name)                                                         \
  table.name = std::bit_cast<decltype(table.name)>(findFunction(library, #name)); \
  if (table.name == nullptr) return nullptr;
  OTG_CL_FUNCTIONS(OTG_CL_FIND)
#undef OTG_CL_FIND
  return &table;
}

}  // namespace

bool isOpenclForeign() noexcept {
  const long loadedBy = loadedByGeneration.load(std::memory_order_acquire);
  return loadedBy != kNobody && loadedBy != static_cast<long>(forkGeneration());
}

const Api* api() {
  long nobody = kNobody;  // before it is loaded: a fork may come between
  loadedByGeneration.compare_exchange_strong(nobody, static_cast<long>(forkGeneration()));
  static const Api* const table = load();
  return table;
}

}  // namespace otg::opencl
