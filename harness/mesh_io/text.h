// SPDX-License-Identifier: BSD-3-Clause
// Cutting text into lines, words and numbers, for the mesh readers.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace otg::mesh_io {

inline bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Takes the next line (without its end) off the front of `rest`; false at the end of the text.
inline bool takeLine(std::string_view& rest, std::string_view& line) {
  if (rest.empty()) return false;
  const std::size_t end = rest.find('\n');
  line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

/// Takes the next word off the front of `line`; empty when there is none.
inline std::string_view takeWord(std::string_view& line) {
  std::size_t begin = 0;
  while (begin < line.size() && isBlank(line[begin])) ++begin;
  std::size_t end = begin;
  while (end < line.size() && !isBlank(line[end])) ++end;
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

/// Quoted for a message, cut to a bearable length, unprintable bytes as '?'.
inline std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 40)) text += (c >= 32 && c < 127) ? c : '?';
  return text + (word.size() > 40 ? "...'" : "'");
}

/// Decimal number, correctly rounded; "nan" and "inf" are numbers here. Beyond double's range: infinity or zero.
inline double parseReal(std::string_view word) {
  std::string_view digits = word;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size() || digits.empty()) {
    throw std::runtime_error("expected a number, found " + quoted(word));
  }
  if (error == std::errc::result_out_of_range) {
    const bool tiny = digits.find("e-") != std::string_view::npos || digits.find("E-") != std::string_view::npos;
    value = tiny ? 0 : std::numeric_limits<double>::infinity();
    if (digits.front() == '-') value = -value;
  }
  return value;
}

inline std::int64_t parseInteger(std::string_view word) {
  std::string_view digits = word;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty()) {
    throw std::runtime_error("expected an integer, found " + quoted(word));
  }
  return value;
}

/// An index as the mesh stores it: whatever does not fit becomes one that is certainly out of range.
inline std::uint32_t toIndex(std::int64_t value) {
  return value < 0 || value > 0xfffffffe ? 0xffffffffu : static_cast<std::uint32_t>(value);
}

}  // namespace otg::mesh_io
