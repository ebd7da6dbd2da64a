// SPDX-License-Identifier: BSD-3-Clause
// Grounds as one mesh and in pieces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "mesh/tri_mesh.h"
#include "scenes/mesh_arrays.h"

namespace otg::test {

/// A square sheet with its middle at the origin in k x k open pieces.
inline std::vector<scenes::MeshArrays> cutTerrain(const scenes::MeshArrays& whole, double size, int k) {
  std::vector<scenes::MeshArrays> pieces(static_cast<std::size_t>(k * k));
  std::vector<std::vector<std::uint32_t>> numbers(pieces.size(),
                                                  std::vector<std::uint32_t>(whole.vertices.size(), kNone));
  for (const Triangle& triangle : whole.triangles) {
    double x = 0, y = 0;
    for (const std::uint32_t v : triangle.v) {
      x += whole.vertices[v].x / 3;
      y += whole.vertices[v].y / 3;
    }
    const auto place = [&](double at) { return std::min(k - 1, static_cast<int>((at / size + 0.5) * k)); };
    const auto which = static_cast<std::size_t>(place(x) * k + place(y));
    Triangle own{};
    for (int c = 0; c < 3; ++c) {
      std::uint32_t& number = numbers[which][triangle.v[c]];
      if (number == kNone) {
        number = static_cast<std::uint32_t>(pieces[which].vertices.size());
        pieces[which].vertices.push_back(whole.vertices[triangle.v[c]]);
      }
      own.v[c] = number;
    }
    pieces[which].triangles.push_back(own);
  }
  return pieces;
}

/// A sheet that faces up with walls along its rim, and a bottom in the plane z = `bottom`: a solid.
inline scenes::MeshArrays blockUnder(const scenes::MeshArrays& sheet, float bottom) {
  scenes::MeshArrays block = sheet;
  const auto count = static_cast<std::uint32_t>(sheet.vertices.size());
  for (const Vec3f& v : sheet.vertices) block.vertices.push_back({v.x, v.y, bottom});
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Triangle& t : sheet.triangles) {
    for (int k = 0; k < 3; ++k) edges.insert({t.v[k], t.v[(k + 1) % 3]});
    block.triangles.push_back({{t.v[0] + count, t.v[2] + count, t.v[1] + count}});
  }
  for (const auto& [a, b] : edges) {
    if (edges.count({b, a}) != 0) continue;
    block.triangles.push_back({{a, a + count, b + count}});
    block.triangles.push_back({{a, b + count, b}});
  }
  return block;
}

}  // namespace otg::test
