// SPDX-License-Identifier: BSD-3-Clause
#include "cli/pose.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <vector>

#include "cli/command.h"
#include "cli/input_file.h"
#include "collide/rotation_tolerance.h"
#include "mesh_io/text.h"

namespace otg::cli {
namespace {

/// The numbers of a comma- or blank-separated list; nothing if a word is not a number.
std::optional<std::vector<double>> parseNumbers(std::string text) {
  for (char& c : text) {
    if (c == ',' || c == ';' || c == '\n') c = ' ';
  }
  std::vector<double> values;
  std::string_view rest = text;
  try {
    for (std::string_view word = mesh_io::takeWord(rest); !word.empty(); word = mesh_io::takeWord(rest)) {
      values.push_back(mesh_io::parseReal(word));
    }
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
  return values;
}

void collectNumbers(const nlohmann::json& value, std::vector<double>& values, const std::string& path) {
  if (value.is_number()) {
    values.push_back(value.get<double>());
  } else if (value.is_array()) {
    for (const auto& element : value) collectNumbers(element, values, path);
  } else {
    throw InputError(path + ": a pose matrix must be an array of numbers");
  }
}

std::vector<double> numbersFromJson(const std::string& text, const std::string& path, const std::string& member) {
  nlohmann::json document = nlohmann::json::parse(text, nullptr, false);
  if (document.is_discarded()) throw InputError(path + ": neither 16 numbers nor valid JSON");
  if (!member.empty()) {
    if (!document.is_object() || !document.contains(member)) {
      throw InputError(fmt::format("{}: has no pose named '{}'", path, member));
    }
    const nlohmann::json chosen = document[member];
    document = chosen;
  }
  if (document.is_object()) {
    if (!document.contains("T")) throw InputError(path + ": the JSON object has no pose matrix \"T\"");
    const nlohmann::json chosen = document["T"];
    document = chosen;
  }
  std::vector<double> values;
  collectNumbers(document, values, path);
  return values;
}

Transformd poseFromFile(const std::string& path, const std::string& member) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(path + ": the pose file cannot be opened");
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  std::vector<double> values;
  if (const auto plain = member.empty() ? parseNumbers(text) : std::nullopt; plain && !plain->empty()) {
    values = *plain;
  } else {
    values = numbersFromJson(text, path, member);
  }
  if (values.size() != 16) {
    throw InputError(
        fmt::format("{}: a pose file must hold a 4x4 matrix, 16 numbers; it holds {}", path, values.size()));
  }
  return poseFromMatrix(values.data(), path);
}

Transformd poseFromQuaternion(const std::vector<double>& v, const std::string& text) {
  for (const double x : v) {
    if (!std::isfinite(x)) throw InputError("--pose " + text + ": a pose must be made of finite numbers");
  }
  const double length = std::sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6]);
  if (!(std::fabs(length - 1) <= 1e-3)) {
    throw InputError(fmt::format("--pose {}: the quaternion qw,qx,qy,qz must have length 1, not {:.6g}", text, length));
  }
  const double w = v[3] / length, x = v[4] / length, y = v[5] / length, z = v[6] / length;
  Transformd pose;
  const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                       2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                       2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  std::copy(std::begin(r), std::end(r), pose.r);
  pose.t = {v[0], v[1], v[2]};
  return pose;
}

}  // namespace

Transformd poseFromMatrix(const double* values, const std::string& source) {
  for (int i = 0; i < 16; ++i) {
    if (!std::isfinite(values[i])) throw InputError(source + ": a pose must be made of finite numbers");
  }
  if (values[12] != 0 || values[13] != 0 || values[14] != 0 || values[15] != 1) {
    throw InputError(source + ": the last row of a pose matrix must be 0 0 0 1");
  }
  Transformd pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.r[3 * row + column] = values[4 * row + column];
  }
  pose.t = {values[3], values[7], values[11]};
  const double defect = rotationDefect(pose);
  if (std::isinf(defect)) {
    throw InputError(source + ": the upper left 3x3 of a pose matrix must be a rotation; this one mirrors or flattens");
  }
  if (defect > kRotationTolerance) {
    throw InputError(
        fmt::format("{}: the upper left 3x3 of a pose matrix must be a rotation; the norm of R^T R - 1 is "
                    "{:.2g}, at most {:g} is taken",
                    source, defect, kRotationTolerance));
  }
  if (defect > 1e-6) {
    progress(fmt::format("warning: {}: not quite a rotation (the norm of R^T R - 1 is {:.2g}); used as given", source,
                         defect));
  }
  return pose;
}

Transformd parsePose(const std::string& text) {
  const auto fileOf = [](const std::string& path) {
    std::error_code ignored;
    const std::string found = findInput(path);
    return std::filesystem::is_regular_file(found, ignored) ? found : std::string();
  };
  if (const std::string file = fileOf(text); !file.empty()) return poseFromFile(file, "");
  const auto numbers = parseNumbers(text);
  if (numbers && numbers->size() == 7) return poseFromQuaternion(*numbers, text);
  if (numbers || text.find(',') != std::string::npos) {
    throw UsageError(fmt::format("--pose {}: expected seven numbers tx,ty,tz,qw,qx,qy,qz{}", text,
                                 numbers ? fmt::format(", found {}", numbers->size()) : std::string()));
  }
  const std::size_t mark = text.rfind('#');
  if (mark != std::string::npos) {
    const std::string file = fileOf(text.substr(0, mark));
    if (!file.empty()) return poseFromFile(file, text.substr(mark + 1));
  }
  if (text.find_first_of("./#") != std::string::npos) throw InputError(text + ": no such pose file");
  throw UsageError(fmt::format("--pose {}: expected tx,ty,tz,qw,qx,qy,qz or a file with a 4x4 matrix", text));
}

}  // namespace otg::cli
