// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/json_reader.h"

#include <cmath>
#include <sstream>

#include "scenes/nearest_word.h"

namespace otg::scenes {
namespace {

std::string shown(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace

ObjectReader::ObjectReader(const nlohmann::json& object, std::string where)
    : object_(object), where_(std::move(where)) {
  if (!object_.is_object()) throw SceneError(where_ + ": must be an object");
}

bool ObjectReader::has(const std::string& key) {
  known_.insert(key);
  return object_.contains(key);
}

void ObjectReader::fail(const std::string& key, const std::string& what) const {
  std::string misspelt;
  if (object_.is_object() && !object_.contains(key)) {
    std::set<std::string> others;
    for (const auto& entry : object_.items()) {
      if (known_.count(entry.key()) == 0) others.insert(entry.key());
    }
    misspelt = nearestWord(key, others, key.size() / 3);  // few: others may be known keys
  }
  throw SceneError(where_ + ": key '" + key + "': " + what +
                   (misspelt.empty() ? "" : "; did you mean it by '" + misspelt + "'?"));
}

double ObjectReader::number(const std::string& key, double fallback, double low, double high) {
  return has(key) ? requiredNumber(key, low, high) : fallback;
}

double ObjectReader::requiredNumber(const std::string& key, double low, double high) {
  if (!has(key)) fail(key, "is missing");
  const nlohmann::json& value = object_[key];
  if (!value.is_number()) fail(key, "must be a number");
  const double x = value.get<double>();
  if (!(x >= low && x <= high)) {
    fail(key, shown(x) + " is out of range (" + shown(low) + " to " + shown(high) + ")");
  }
  return x;
}

std::optional<double> ObjectReader::optionalNumber(const std::string& key, double low, double high) {
  if (!has(key)) return std::nullopt;
  return requiredNumber(key, low, high);
}

double ObjectReader::numberOrInfinity(const std::string& key, double fallback, double low) {
  if (has(key) && object_[key].is_string()) {
    if (object_[key] != "infinity") fail(key, "must be a number or \"infinity\"");
    return std::numeric_limits<double>::infinity();
  }
  return number(key, fallback, low, 1e300);
}

int ObjectReader::integer(const std::string& key, int fallback, int low, int high) {
  if (!has(key)) return fallback;
  if (!object_[key].is_number_integer()) fail(key, "must be an integer");
  return static_cast<int>(requiredNumber(key, low, high));
}

bool ObjectReader::boolean(const std::string& key, bool fallback) {
  if (!has(key)) return fallback;
  if (!object_[key].is_boolean()) fail(key, "must be true or false");
  return object_[key].get<bool>();
}

std::string ObjectReader::text(const std::string& key, const std::string& fallback) {
  if (!has(key)) return fallback;
  if (!object_[key].is_string()) fail(key, "must be text");
  return object_[key].get<std::string>();
}

std::optional<std::vector<double>> ObjectReader::numbers(const std::string& key, std::size_t count) {
  if (!has(key)) return std::nullopt;
  const nlohmann::json& value = object_[key];
  const std::string expected = "must be an array of " + std::to_string(count) + " numbers";
  if (!value.is_array() || value.size() != count) fail(key, expected);
  std::vector<double> result;
  for (const nlohmann::json& element : value) {
    if (!element.is_number() || !std::isfinite(element.get<double>())) fail(key, expected);
    result.push_back(element.get<double>());
  }
  return result;
}

Vec3d ObjectReader::vector(const std::string& key, Vec3d fallback, double largest) {
  const auto values = numbers(key, 3);
  for (const double x : values.value_or(std::vector<double>())) {
    if (!(std::fabs(x) <= largest))
      fail(key, shown(x) + " is out of range (" + shown(-largest) + " to " + shown(largest) + ")");
  }
  return values ? Vec3d{(*values)[0], (*values)[1], (*values)[2]} : fallback;
}

const nlohmann::json* ObjectReader::member(const std::string& key) {
  return has(key) ? &object_[key] : nullptr;
}

void ObjectReader::finish() const {
  for (const auto& entry : object_.items()) {
    if (known_.count(entry.key()) > 0) continue;
    const std::string meant = nearestWord(entry.key(), known_, entry.key().size() / 3 + 1);
    throw SceneError(where_ + ": unknown key '" + entry.key() + "'" +
                     (meant.empty() ? "" : "; did you mean '" + meant + "'?"));
  }
}

}  // namespace otg::scenes
