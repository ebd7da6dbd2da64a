// SPDX-License-Identifier: BSD-3-Clause
// Sets variables of the process, which standard C++ cannot.
#pragma once

#include <cstdlib>

namespace otg::test {

inline void setVariable(const char* name, const char* value) {
#ifdef _WIN32
  _putenv_s(name, value);
#else
  setenv(name, value, 1);
#endif
}

inline void unsetVariable(const char* name) {
#ifdef _WIN32
  _putenv_s(name, "");
#else
  unsetenv(name);
#endif
}

}  // namespace otg::test
