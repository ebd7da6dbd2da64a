// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/register_limit.h"

#include <cstdlib>
#include <string_view>

namespace otg::opencl {

unsigned registerLimitOf(const std::string& options) {
  constexpr std::string_view kOption = "-cl-nv-maxrregcount=";
  const std::size_t at = options.find(kOption);
  if (at == std::string::npos) return 0;
  return static_cast<unsigned>(std::strtoul(options.c_str() + at + kOption.size(), nullptr, 10));
}

std::optional<Bytes> withRegisterLimit(const Bytes& binary, unsigned registers) {
  const std::string text(binary.begin(), binary.end());
  if (registers == 0 || text.find(".version") == std::string::npos) return std::nullopt;
  if (text.find(".maxnreg") != std::string::npos) return std::nullopt;
  const std::string directive = ".maxnreg " + std::to_string(registers) + "\n";
  std::string limited;
  std::size_t done = 0;
  for (std::size_t entry = text.find(".entry"); entry != std::string::npos; entry = text.find(".entry", done)) {
    // Directives stand between the list of parameters and the body.
    const std::size_t body = text.find('{', entry);
    if (body == std::string::npos) return std::nullopt;
    limited.append(text, done, body - done);
    limited += directive;
    done = body;
  }
  if (done == 0) return std::nullopt;
  limited.append(text, done);
  return Bytes(limited.begin(), limited.end());
}

}  // namespace otg::opencl
