// SPDX-License-Identifier: BSD-3-Clause
// What a misspelt word was meant to be.
#pragma once

#include <set>
#include <string>

namespace otg::scenes {

/// The word that takes the fewest edits, or "" where all take more than `most`.
std::string nearestWord(const std::string& word, const std::set<std::string>& words, std::size_t most);

}  // namespace otg::scenes
