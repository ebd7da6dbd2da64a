// SPDX-License-Identifier: BSD-3-Clause
// Meshes for tests of trees: well-formed bodies, random soups, and inputs made to hurt.
#pragma once

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/generated_meshes.h"

namespace otg::samples {

using MeshPtr = std::shared_ptr<const TriMesh>;

struct NamedMesh {
  std::string name;
  MeshPtr mesh;
};

/// Triangles of three vertices of their own.
class Soup {
 public:
  void add(Vec3f a, Vec3f b, Vec3f c) {
    const auto first = static_cast<std::uint32_t>(arrays_.vertices.size());
    for (const Vec3f& corner : {a, b, c}) arrays_.vertices.push_back(corner);
    arrays_.triangles.push_back({{first, first + 1, first + 2}});
  }
  /// A right triangle of the given size with its corner at p.
  void addAt(Vec3f p, float size) { add(p, {p.x + size, p.y, p.z}, {p.x, p.y + size, p.z + size}); }
  MeshPtr build() const { return scenes::build(arrays_); }

 private:
  scenes::MeshArrays arrays_;
};

/// Corners uniform in a cube of half-width `spread` around `middle`, triangles about `size` large.
inline MeshPtr randomSoup(std::uint32_t seed, int triangles, float spread, float size, Vec3f middle = {0, 0, 0}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto near = [&](Vec3f p, float reach) {
    return Vec3f{p.x + reach * unit(random), p.y + reach * unit(random), p.z + reach * unit(random)};
  };
  Soup soup;
  for (int i = 0; i < triangles; ++i) {
    const Vec3f at = near(middle, spread);
    soup.add(near(at, size), near(at, size), near(at, size));
  }
  return soup.build();
}

/// The mesh with its vertices times the factors, facing as it did. Null if one is no finite float any more.
inline MeshPtr scaledMesh(const TriMesh& mesh, const Vec3f& by) {
  std::vector<Vec3f> vertices(mesh.inputVertexCount());
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3f& p = mesh.vertices()[v];
    vertices[mesh.callerVertex(v)] = {p.x * by.x, p.y * by.y, p.z * by.z};
  }
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  return moveVertices(mesh, input, ((by.x < 0) != (by.y < 0)) != (by.z < 0)).mesh;
}

/// A closed prism, z up. Its surface falls from x = -size / 2 and from x = size / 2 to a concave kink at x = 0.
inline scenes::MeshArrays makeValley(double leftRise, double rightRise, double size, double below) {
  scenes::MeshArrays mesh;
  const auto half = static_cast<float>(size / 2), bottom = static_cast<float>(-below);
  for (const float y : {-half, half}) {
    for (const float x : {-half, 0.0f, half}) {
      const double rise = x > 0 ? rightRise : leftRise;
      mesh.vertices.push_back({x, y, static_cast<float>(rise * std::fabs(double{x}))});
    }
    for (const float x : {-half, 0.0f, half}) mesh.vertices.push_back({x, y, bottom});
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({{a, b, c}});
    mesh.triangles.push_back({{a, c, d}});
  };
  for (const std::uint32_t i : {0u, 1u}) {
    quad(i, i + 1, i + 7, i + 6);       // the surface
    quad(i + 3, i + 9, i + 10, i + 4);  // the bottom
    quad(i + 3, i + 4, i + 1, i);       // the front
    quad(i + 9, i + 6, i + 7, i + 10);  // the back
  }
  quad(0, 6, 9, 3);
  quad(2, 5, 11, 8);
  return mesh;
}

/// Closed bodies as users have them, a soup, and the smallest meshes.
inline std::vector<NamedMesh> ordinaryMeshes() {
  std::vector<NamedMesh> meshes;
  const auto add = [&](const char* name, const scenes::MeshArrays& arrays) {
    meshes.push_back({name, scenes::build(arrays)});
  };
  add("tetrahedron", scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  add("box", scenes::makeBox({1, 2, 3}, 4));
  add("sphere", scenes::makeSphere(0.3, 4));
  add("torus", scenes::makeTorus(1.0, 0.25, 48, 24));
  add("cylinder", scenes::makeCylinder(0.05, 0.4, 32, 3));
  add("lump", scenes::makeLump(2.0, 4, 0.3, 7));
  add("ground",
      scenes::makeGround(100, 1, 40, [](double x, double y) { return std::sin(0.3 * x) * std::cos(0.2 * y); }));
  add("cubes that touch along edges",
      scenes::makeCubes(4, [](int x, int y, int z) { return (7 * x + 5 * y * y + 3 * z) % 4 < 2; }));
  add("empty", {});
  Soup one;
  one.addAt({5, -3, 2}, 0.5f);
  meshes.push_back({"one triangle", one.build()});
  meshes.push_back({"soup", randomSoup(1, 3000, 1.0f, 0.1f)});
  meshes.push_back({"soup far from its origin", randomSoup(2, 1000, 1.0f, 0.1f, {1e6f, -3e5f, 7e4f})});
  return meshes;
}

/// Inputs that make a careless build deep, slow, or unsound.
inline std::vector<NamedMesh> pathologicalMeshes() {
  std::vector<NamedMesh> meshes;
  constexpr int kMany = 100000;
  const auto add = [&](const char* name, const auto& fill) {
    Soup soup;
    fill(soup);
    meshes.push_back({name, soup.build()});
  };
  add("copies of one triangle", [](Soup& soup) {
    for (int i = 0; i < kMany; ++i) soup.addAt({1, 2, 3}, 0.25f);
  });
  add("all in one point", [](Soup& soup) {
    for (int i = 0; i < 5000; ++i) soup.addAt({0.1f, 0.2f, 0.3f}, 0);
  });
  add("concentric", [](Soup& soup) {  // equal centres, different boxes
    for (int i = 1; i <= 5000; ++i) {
      const auto r = static_cast<float>(i);
      soup.add({-r, -r, -r}, {r, r, r}, {r, -r, r});
    }
  });
  add("a line", [](Soup& soup) {
    for (int i = 0; i < kMany; ++i) soup.addAt({static_cast<float>(i), 0, 0}, 0.5f);
  });
  add("one huge and many tiny", [](Soup& soup) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1, 1);
    soup.add({-1e6f, -1e6f, 0}, {1e6f, -1e6f, 0}, {0, 1e6f, 1e6f});
    for (int i = 1; i < kMany; ++i) soup.addAt({unit(random), unit(random), unit(random)}, 1e-4f);
  });
  add("one far away from many", [](Soup& soup) {
    soup.addAt({1e30f, 1e30f, 1e30f}, 1e25f);
    for (int i = 1; i < 5000; ++i) soup.addAt({static_cast<float>(i % 70), static_cast<float>(i / 70), 0}, 1);
  });
  add("positions halving", [](Soup& soup) {
    for (int i = 0; i < 250; ++i) soup.addAt({std::ldexp(1.0f, 120 - i), 0, 0}, std::ldexp(1.0f, 118 - i));
  });
  add("positions halving, many at each", [](Soup& soup) {
    for (int i = 0; i < kMany; ++i) {
      const int e = 120 - i % 250;
      soup.addAt({std::ldexp(1.0f, e), std::ldexp(1.0f, e), 0}, std::ldexp(1.0f, e - 3));
    }
  });
  add("sizes halving in one place", [](Soup& soup) {
    for (int i = 0; i < 20000; ++i) soup.addAt({1, 1, 1}, std::ldexp(1.0f, 100 - i % 220));
  });
  add("as large as floats get", [](Soup& soup) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto anywhere = [&] { return kLargest * unit(random); };
    soup.add({-kLargest, -kLargest, -kLargest}, {kLargest, kLargest, kLargest}, {kLargest, -kLargest, 0});
    for (int i = 0; i < 1000; ++i) {
      const Vec3f a{anywhere(), anywhere(), anywhere()}, b{anywhere(), anywhere(), anywhere()};
      soup.add(a, b, {anywhere(), anywhere(), anywhere()});
      soup.add(a, a, a);
    }
  });
  add("large on one side", [](Soup& soup) {  // the middle of the bounds has to be rounded
    constexpr float kLargest = std::numeric_limits<float>::max();
    const float next = std::nextafter(kLargest, 0.0f);
    soup.add({kLargest, 1, -kLargest}, {-next, kLargest, 3}, {0, next, 1e-38f});
    for (int i = 0; i < 100; ++i) soup.addAt({std::ldexp(1.0f, 127 - i), std::ldexp(-1.0f, 126 - i), 1}, 1e-3f);
  });
  add("smaller than normal floats", [](Soup& soup) {
    constexpr float kTiny = std::numeric_limits<float>::denorm_min();
    for (int i = 0; i < 1000; ++i) soup.addAt({kTiny * (i % 10), kTiny * (i / 10 % 10), kTiny * (i / 100)}, 2 * kTiny);
  });
  return meshes;
}

}  // namespace otg::samples
