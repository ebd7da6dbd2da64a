// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/nearest_word.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace otg::scenes {
namespace {

/// How many letters have to be changed, put in, left out or exchanged with the next (Damerau, 1964).
std::size_t editsBetween(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::move(last);
    last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string nearestWord(const std::string& word, const std::set<std::string>& words, std::size_t most) {
  std::string nearest;
  std::size_t fewest = most + 1;
  for (const std::string& other : words) {
    const std::size_t edits = editsBetween(word, other);
    if (edits >= fewest) continue;
    fewest = edits;
    nearest = other;
  }
  return nearest;
}

}  // namespace otg::scenes
