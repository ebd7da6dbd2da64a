// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/height_grid.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace otg::scenes {

void setHeights(HeightGrid& grid, const std::function<double(double x, double y)>& height) {
  grid.heights.clear();
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) grid.heights.push_back(static_cast<float>(height(grid.x(i), grid.y(j))));
  }
}

void setRoughHeights(HeightGrid& grid, double height, double length, std::uint32_t seed) {
  struct Wave {
    double kx, ky, phase, height;
  };
  constexpr int kOctaves = 4, kWaves = 6;
  // No distribution of the standard library: their numbers differ from one library to the next.
  std::mt19937 random(seed);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  constexpr double kTurn = 2 * 3.14159265358979323846;
  std::vector<Wave> waves;
  double sum = 0;
  for (int octave = 0; octave < kOctaves; ++octave) {
    const double part = std::ldexp(1.0, -octave), k = kTurn / (length * part);
    for (int i = 0; i < kWaves; ++i) {
      const double direction = kTurn * uniform(), phase = kTurn * uniform();
      waves.push_back({k * std::cos(direction), k * std::sin(direction), phase, part});
      sum += part;
    }
  }
  setHeights(grid, [&](double x, double y) {
    double z = 0;
    for (const Wave& w : waves) z += w.height * std::cos(w.kx * x + w.ky * y + w.phase);
    return height * z / sum;
  });
}

MeshArrays sheetOf(const HeightGrid& grid) {
  MeshArrays sheet;
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      sheet.vertices.push_back({static_cast<float>(grid.x(i)), static_cast<float>(grid.y(j)), grid.at(i, j)});
    }
  }
  const auto columns = static_cast<std::uint32_t>(grid.columns), rows = static_cast<std::uint32_t>(grid.rows);
  for (std::uint32_t j = 0; j + 1 < rows; ++j) {
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
      sheet.triangles.push_back({{a, b, d}});
      sheet.triangles.push_back({{a, d, c}});
    }
  }
  return sheet;
}

MeshArrays solidOf(const HeightGrid& grid, double depth) {
  MeshArrays solid = sheetOf(grid);
  const auto below = static_cast<std::uint32_t>(solid.vertices.size());
  const std::size_t surface = solid.triangles.size();
  for (std::uint32_t v = 0; v < below; ++v) {
    solid.vertices.push_back({solid.vertices[v].x, solid.vertices[v].y, static_cast<float>(-depth)});
  }
  for (std::size_t t = 0; t < surface; ++t) {
    const Triangle& top = solid.triangles[t];
    solid.triangles.push_back({{top.v[0] + below, top.v[2] + below, top.v[1] + below}});
  }
  const auto wall = [&](std::uint32_t u, std::uint32_t v) {  // the surface lies on the left of u to v, seen from above
    solid.triangles.push_back({{v, u, u + below}});
    solid.triangles.push_back({{v, u + below, v + below}});
  };
  const auto columns = static_cast<std::uint32_t>(grid.columns), rows = static_cast<std::uint32_t>(grid.rows);
  for (std::uint32_t i = 0; i + 1 < columns; ++i) {
    wall(i, i + 1);
    wall((rows - 1) * columns + i + 1, (rows - 1) * columns + i);
  }
  for (std::uint32_t j = 0; j + 1 < rows; ++j) {
    wall((j + 1) * columns, j * columns);
    wall((j + 1) * columns - 1, (j + 2) * columns - 1);
  }
  return solid;
}

std::vector<float> fieldSamples(const HeightGrid& grid) {
  std::vector<float> samples;
  samples.reserve(grid.heights.size());
  for (int j = grid.rows - 1; j >= 0; --j) {
    const auto row = grid.heights.begin() + static_cast<std::ptrdiff_t>(j) * grid.columns;
    samples.insert(samples.end(), row, row + grid.columns);
  }
  return samples;
}

}  // namespace otg::scenes
