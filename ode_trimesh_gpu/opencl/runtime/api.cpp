// SPDX-License-Identifier: BSD-3-Clause
// Loads the OpenCL loader.
#include "opencl/runtime/api.h"

#include <dlfcn.h>

#include <bit>
#include <initializer_list>

namespace otg::opencl {
namespace {

const Api* load() {
  void* library = nullptr;
  for (const char* name : {"libOpenCL.so.1", "libOpenCL.so"}) {
    library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (library != nullptr) break;
  }
  if (library == nullptr) return nullptr;
  static Api table;
#define OTG_CL_FIND(name)                                                  \
  table.name = std::bit_cast<decltype(table.name)>(dlsym(library, #name)); \
  if (table.name == nullptr) return nullptr;
  OTG_CL_FUNCTIONS(OTG_CL_FIND)
#undef OTG_CL_FIND
  return &table;
}

}  // namespace

const Api* api() {
  static const Api* const table = load();
  return table;
}

}  // namespace otg::opencl
