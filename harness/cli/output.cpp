// SPDX-License-Identifier: BSD-3-Clause
// Output of the commands: JSON, tables, progress, hashes.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "cli/command.h"

namespace otg::cli {

void printJson(const Json& document) {
  const std::string text = document.dump(1, ' ', false, Json::error_handler_t::replace);
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fputc('\n', stdout);
}

void printTable(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> width;
  width.reserve(head.size());
  for (const std::string& cell : head) width.push_back(cell.size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
  }
  // Text reads better from the left.
  const auto isText = [&](std::size_t column) {
    return column == 0 || std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
             return column < row.size() && row[column].find(' ') != std::string::npos;
           });
  };
  std::vector<bool> left;
  for (std::size_t i = 0; i < head.size(); ++i) left.push_back(isText(i));
  const auto printRow = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) line += "  ";
      line += left[i] ? fmt::format("{:<{}}", row[i], width[i]) : fmt::format("{:>{}}", row[i], width[i]);
    }
    fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
  };
  printRow(head);
  for (const auto& row : rows) printRow(row);
}

void printTable(const std::string& title, const Json& rows) {
  fmt::print("\n{}\n", title);
  if (rows.empty()) {
    fmt::print("(none)\n");
    return;
  }
  std::vector<std::string> head;
  for (const auto& entry : rows.front().items()) head.push_back(entry.key());
  std::vector<std::vector<std::string>> cells;
  for (const Json& row : rows) {
    std::vector<std::string>& line = cells.emplace_back();
    for (const std::string& key : head) {
      const Json value = row.value(key, Json());
      if (value.is_string())
        line.push_back(value.get<std::string>());
      else if (value.is_number_float() && key.ends_with("percent"))
        line.push_back(fmt::format("{:.1f}", value.get<double>()));
      else if (value.is_number_float())
        line.push_back(fmt::format("{:.4g}", value.get<double>()));
      else if (value.is_null())
        line.push_back("-");
      else
        line.push_back(value.dump());
    }
  }
  printTable(head, cells);
}

void progress(const std::string& line) {
  fmt::print(stderr, "{}\n", line);
}

std::string Fnv1a::hex() const {
  return fmt::format("{:016x}", state_);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace otg::cli
