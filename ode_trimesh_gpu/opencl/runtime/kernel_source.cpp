// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/runtime/kernel_source.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "base/environment.h"

namespace otg::opencl {
namespace {

constexpr int kMostNested = 32;

std::string readFile(const std::string& name) {
  if (const std::string folder = readEnvironment().kernelFolder; !folder.empty()) {
    std::ifstream in(folder + "/" + name, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || !text) throw std::runtime_error("no kernel file " + name + " in OTG_KERNEL_DIR");
    return text.str();
  }
  for (unsigned i = 0; i < kKernelFileCount; ++i) {
    if (name == kKernelFiles[i].name) return kKernelFiles[i].text;
  }
  throw std::runtime_error("no kernel file " + name);
}

void append(const std::string& name, int nested, std::string& out) {
  if (nested > kMostNested) throw std::runtime_error("kernel files include each other: " + name);
  constexpr std::string_view kInclude = "#include \"";
  const std::string text = readFile(name);
  out += "#line 1 \"" + name + "\"\n";
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    ++number;
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    const std::size_t end = line.starts_with(kInclude) ? line.find('"', kInclude.size()) : line.npos;
    if (end == line.npos) {
      out += line;
      out += '\n';
      continue;
    }
    append(std::string(line.substr(kInclude.size(), end - kInclude.size())), nested + 1, out);
    out += "#line " + std::to_string(number + 1) + " \"" + name + "\"\n";
  }
}

}  // namespace

std::string kernelSource(const std::string& name) {
  std::string out;
  append(name, 0, out);
  return out;
}

}  // namespace otg::opencl
