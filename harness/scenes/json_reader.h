// SPDX-License-Identifier: BSD-3-Clause
// Reading a JSON object whose every key must be known, with messages that say where.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "scenes/scene_description.h"

namespace otg::scenes {

/// One JSON object. Every getter marks its key as known; finish() throws for the others.
class ObjectReader {
 public:
  /// `where` is how messages name the object, for example "scene.json: bodies[2]".
  ObjectReader(const nlohmann::json& object, std::string where);

  bool has(const std::string& key);
  /// Throws. Of a key that is missing it names the one that is there and most like it.
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  /// A finite number within [low, high].
  double number(const std::string& key, double fallback, double low = -1e300, double high = 1e300);
  double requiredNumber(const std::string& key, double low, double high);
  std::optional<double> optionalNumber(const std::string& key, double low, double high);
  /// As number(), or the text "infinity".
  double numberOrInfinity(const std::string& key, double fallback, double low);
  int integer(const std::string& key, int fallback, int low, int high);
  bool boolean(const std::string& key, bool fallback);
  std::string text(const std::string& key, const std::string& fallback);
  /// Array of exactly `count` finite numbers.
  std::optional<std::vector<double>> numbers(const std::string& key, std::size_t count);
  /// Three numbers, none of them beyond `largest` on either side of 0.
  Vec3d vector(const std::string& key, Vec3d fallback, double largest = 1e300);
  /// The member itself, or null.
  const nlohmann::json* member(const std::string& key);
  /// One of `names`; its value.
  template <class T>
  T choice(const std::string& key, T fallback, const std::vector<std::pair<const char*, T>>& names) {
    if (!has(key)) return fallback;
    const std::string word = text(key, "");
    std::string known;
    for (const auto& [name, value] : names) {
      if (word == name) return value;
      known += known.empty() ? name : std::string(", ") + name;
    }
    fail(key, "'" + word + "' is none of: " + known);
  }

  const std::string& where() const { return where_; }
  /// Throws for a key that no getter has requested; names the one that is most like it.
  void finish() const;

 private:
  const nlohmann::json& object_;
  std::string where_;
  std::set<std::string> known_;
};

}  // namespace otg::scenes
