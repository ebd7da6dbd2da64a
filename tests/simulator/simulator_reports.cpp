// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/simulator_reports.h"

#include <regex>
#include <sstream>

#include "opencl/runtime/kernel_source.h"

namespace otg::test {
namespace {

std::string lineOf(const std::string& file, int number) {
  for (unsigned i = 0; i < opencl::kKernelFileCount; ++i) {
    if (file != opencl::kKernelFiles[i].name) continue;
    std::istringstream text(opencl::kKernelFiles[i].text);
    std::string line;
    for (int n = 0; n < number && std::getline(text, line);) ++n;
    return line;
  }
  return {};
}

/// One work-item's access: by an atomic operation, or to what is `volatile`.
bool isGuarded(const std::string& access) {
  for (const char* word : {" volatile ", "atomic_", "atom_"}) {
    if (access.find(word) != std::string::npos) return true;
  }
  return false;
}

bool isMeant(const std::string& report) {
  static const std::regex place(R"(At line (\d+) \(column \d+\) of (\S+):)");
  if (report.find("data race at ") == std::string::npos) return false;
  for (std::sregex_iterator i(report.begin(), report.end(), place), end; i != end; ++i) {
    if (lineOf((*i)[2], std::stoi((*i)[1])).find("// unordered") != std::string::npos) return true;
  }
  const std::size_t second = report.find("Second entity:");
  return second != std::string::npos && isGuarded(report.substr(0, second)) && isGuarded(report.substr(second));
}

}  // namespace

std::vector<std::string> unexpectedReports(const std::string& errors) {
  static const std::regex warnings(R"(\d+ warnings? generated\.)");
  std::vector<std::string> found;
  std::string report;
  const auto end = [&] {
    if (!report.empty() && !isMeant(report)) found.push_back(report);
    report.clear();
  };
  // A report begins at the margin, and its other lines are indented.
  std::istringstream text(errors);
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || std::regex_match(line, warnings)) continue;
    if (line[0] != '\t') end();
    report += line + '\n';
  }
  end();
  return found;
}

}  // namespace otg::test
