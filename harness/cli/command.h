// SPDX-License-Identifier: BSD-3-Clause
// What the commands of the program `otg` and its benchmarks share: exit statuses, output.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/hash.h"

namespace otg::cli {

using Json = nlohmann::ordered_json;

enum ExitStatus { kOk = 0, kBadInput = 1, kBadUsage = 2 };

/// The input is bad: message on stderr, exit status 1. The message names the file and what is wrong.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The command line is wrong in a way that the parser cannot see: exit status 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The command that the command line chose; returns the exit status. Set by the callbacks of the subcommands.
using Action = std::function<int()>;

/// One JSON document on stdout. Bytes that are not UTF-8 (in file names) are replaced; NaN and infinity become null.
void printJson(const Json& document);
/// A table on stdout: numbers from the right, the first column and columns with spaces in them from the left.
void printTable(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);
/// The same from JSON rows: one column per key of the first row.
void printTable(const std::string& title, const Json& rows);
/// A line on stderr.
void progress(const std::string& line);

/// FNV-1a, 64 bits. Feed it values whose types have no padding.
class Fnv1a {
 public:
  void add(const void* bytes, std::size_t count) { state_ = fnv1a(bytes, count, state_); }
  template <class T>
  void add(const T& value) {
    add(&value, sizeof value);
  }
  std::string hex() const;

 private:
  std::uint64_t state_ = kFnvStart;
};

/// The middle value (the mean of the two middle ones for an even count); 0 for none.
double median(std::vector<double> values);

}  // namespace otg::cli
