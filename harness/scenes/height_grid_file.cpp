// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/height_grid_file.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include "scenes/json_reader.h"

namespace otg::scenes {
namespace {

using nlohmann::json;

constexpr double kLargest = 1e9;  // metres
constexpr double kMostSamples = 2.5e6;

/// Rows of numbers, of which all have as many.
void readHeights(ObjectReader& reader, HeightGrid& grid) {
  const json& rows = *reader.member("heights");
  const char* const expected = "must be an array of at least 2 rows, each with the same number of heights, at least 2";
  if (!rows.is_array() || rows.size() < 2 || !rows[0].is_array() || rows[0].size() < 2) {
    reader.fail("heights", expected);
  }
  if (double(rows.size()) * double(rows[0].size()) > kMostSamples) reader.fail("heights", "more than 2.5 million");
  grid.rows = static_cast<int>(rows.size());
  grid.columns = static_cast<int>(rows[0].size());
  for (const json& row : rows) {
    if (!row.is_array() || row.size() != rows[0].size()) reader.fail("heights", expected);
    for (const json& height : row) {
      if (!height.is_number() || !(std::fabs(height.get<double>()) <= kLargest)) {
        reader.fail("heights", "every height must be a number up to 1e9");
      }
      grid.heights.push_back(height.get<float>());
    }
  }
}

void generateHeights(ObjectReader& reader, HeightGrid& grid) {
  const auto counts = reader.numbers("samples", 2);
  for (const double n : counts.value_or(std::vector<double>{33, 33})) {
    if (!(n >= 2 && n <= 1e6 && n == std::floor(n))) reader.fail("samples", "must be two whole numbers from 2");
  }
  grid.columns = counts ? static_cast<int>((*counts)[0]) : 33;
  grid.rows = counts ? static_cast<int>((*counts)[1]) : 33;
  if (double(grid.columns) * grid.rows > kMostSamples) reader.fail("samples", "more than 2.5 million");
  const std::string kind = reader.text("generate", "");
  if (kind == "flat") {
    setHeights(grid, [](double, double) { return 0.0; });
  } else if (kind == "slope") {
    const double rise = reader.requiredNumber("rise", -kLargest, kLargest);
    setHeights(grid, [=](double x, double) { return rise * x; });
  } else if (kind == "hills") {
    const double height = reader.requiredNumber("height", -kLargest, kLargest);
    const double k = 2 * 3.14159265358979323846 / reader.requiredNumber("length", 1e-9, kLargest);
    setHeights(grid, [=](double x, double y) { return height * std::cos(k * x) * std::cos(k * y); });
  } else if (kind == "rough") {
    const double height = reader.requiredNumber("height", -kLargest, kLargest);
    setRoughHeights(grid, height, reader.requiredNumber("length", 1e-9, kLargest),
                    static_cast<std::uint32_t>(reader.integer("seed", 1, 0, 1 << 30)));
  } else {
    reader.fail("generate", "'" + kind + "' is none of: flat, slope, hills, rough");
  }
}

}  // namespace

std::shared_ptr<const HeightGrid> readHeightGrid(const json& value, const std::string& where) {
  ObjectReader reader(value, where);
  auto grid = std::make_shared<HeightGrid>();
  const auto size = reader.numbers("size", 2);
  if (!size) reader.fail("size", "is missing");
  for (const double x : *size) {
    if (!(x >= 1e-9 && x <= kLargest)) reader.fail("size", "must be two lengths above 0");
  }
  grid->sizeX = (*size)[0];
  grid->sizeY = (*size)[1];
  if (reader.has("heights") == reader.has("generate")) {
    throw SceneError(where + ": needs either the key 'heights' or the key 'generate'");
  }
  if (reader.has("heights"))
    readHeights(reader, *grid);
  else
    generateHeights(reader, *grid);
  grid->thickness = reader.number("thickness", 1, 0, kLargest);
  grid->wraps = reader.boolean("wrap", false);
  reader.finish();
  return grid;
}

bool namesHeightGrid(const std::string& path) {
  return path.size() > 5 && path.compare(path.size() - 5, 5, ".json") == 0;
}

std::shared_ptr<const HeightGrid> loadHeightGrid(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw SceneError(path + ": the heightfield cannot be opened");
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  try {
    return readHeightGrid(json::parse(text, nullptr, true, true), path);
  } catch (const json::exception& error) {
    throw SceneError(path + ": not valid JSON: " + error.what());
  }
}

}  // namespace otg::scenes
