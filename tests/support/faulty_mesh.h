// SPDX-License-Identifier: BSD-3-Clause
// Solids with the faults that models have.
#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include "scenes/mesh_arrays.h"
#include "support/catch.h"

namespace otg::test {

/// A mesh with faults, and which way each triangle faces.
struct Faulty {
  scenes::MeshArrays mesh;
  std::vector<std::int8_t> sides;

  explicit Faulty(scenes::MeshArrays from) : mesh(std::move(from)), sides(mesh.triangles.size(), 1) {}

  Triangle take(std::mt19937& random) {
    const std::size_t t = random() % mesh.triangles.size();
    const Triangle out = mesh.triangles[t];
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(t));
    return out;
  }
  void put(const Triangle& t) {
    mesh.triangles.push_back(t);
    sides.push_back(1);
  }
  std::uint32_t between(std::uint32_t a, std::uint32_t b, float share) {
    const Vec3f &p = mesh.vertices[a], &q = mesh.vertices[b];
    mesh.vertices.push_back(otgAdd(p, otgScale(otgSub(q, p), share)));
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  }

  void loseTriangle(std::mt19937& random) { take(random); }
  /// A hole in the middle of a triangle.
  void pierce(std::mt19937& random) {
    const Triangle t = take(random);
    const std::uint32_t middle = between(between(t.v[0], t.v[1], 0.5F), t.v[2], 0.3F);
    std::uint32_t inner[3];
    for (int k = 0; k < 3; ++k) inner[k] = between(middle, t.v[k], 0.1F);
    for (int k = 0; k < 3; ++k) {
      put({{t.v[k], t.v[(k + 1) % 3], inner[(k + 1) % 3]}});
      put({{t.v[k], inner[(k + 1) % 3], inner[k]}});
    }
  }
  /// A vertex on an edge that the neighbour does not have.
  void crack(std::mt19937& random) {
    const Triangle t = take(random);
    const std::uint32_t on = between(t.v[0], t.v[1], 0.4F);
    put({{t.v[0], on, t.v[2]}});
    put({{on, t.v[1], t.v[2]}});
  }
  /// The same with vertices on both sides of the edge.
  void crackTwice(std::mt19937& random) {
    const Triangle t = take(random);
    const auto other = std::ranges::find_if(mesh.triangles, [&](const Triangle& o) {
      return std::ranges::any_of(std::array{0, 1, 2},
                                 [&](int k) { return o.v[k] == t.v[1] && o.v[(k + 1) % 3] == t.v[0]; });
    });
    REQUIRE(other != mesh.triangles.end());
    const Triangle neighbour = *other;
    mesh.triangles.erase(other);
    sides.pop_back();
    const std::uint32_t near = between(t.v[0], t.v[1], 0.3F), far = between(t.v[0], t.v[1], 0.7F);
    put({{t.v[0], near, t.v[2]}});
    put({{near, far, t.v[2]}});
    put({{far, t.v[1], t.v[2]}});
    const std::uint32_t on = between(t.v[0], t.v[1], 0.45F);
    for (std::size_t k = 0; k < 3; ++k) {
      if (neighbour.v[k] != t.v[1] || neighbour.v[(k + 1) % 3] != t.v[0]) continue;
      put({{neighbour.v[k], on, neighbour.v[(k + 2) % 3]}});
      put({{on, neighbour.v[(k + 1) % 3], neighbour.v[(k + 2) % 3]}});
    }
  }
  void turnOne(std::mt19937& random) {
    const std::size_t t = random() % mesh.triangles.size();
    std::swap(mesh.triangles[t].v[1], mesh.triangles[t].v[2]);
    sides[t] = -1;
  }
  void doubleAll() {
    const std::size_t count = mesh.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      mesh.triangles.push_back(mesh.triangles[t]);
      sides.push_back(sides[t]);
    }
  }
};

}  // namespace otg::test
