// SPDX-License-Identifier: BSD-3-Clause
// Round and square bodies, and the ground.
#include "scenes/generated_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "base/vectors.h"
#include "scenes/mesh_builder.h"

namespace otg::scenes {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

Vec3d normalized(const Vec3d& v) {
  return v * (1 / norm(v));
}

/// Directions of the corners of a subdivided icosahedron, three for each triangle.
std::vector<std::array<Vec3d, 3>> sphereTriangles(int level) {
  const double g = std::numbers::phi;
  const Vec3d corners[12] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                             {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  constexpr int kFaces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  std::vector<std::array<Vec3d, 3>> triangles;
  for (const auto& f : kFaces)
    triangles.push_back({normalized(corners[f[0]]), normalized(corners[f[1]]), normalized(corners[f[2]])});
  for (int i = 0; i < level; ++i) {
    std::vector<std::array<Vec3d, 3>> finer;
    finer.reserve(4 * triangles.size());
    for (const auto& [a, b, c] : triangles) {
      // A sum of two does not depend on their order, so both neighbours of an edge get the same midpoint.
      const Vec3d ab = normalized(a + b), bc = normalized(b + c), ca = normalized(c + a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  return triangles;
}

}  // namespace

MeshArrays makeBox(Vec3d size, int n) {
  MeshBuilder builder;
  // Lattice points are named by integers, so that faces share them exactly.
  const auto at = [&](int i, int j, int k) {
    return Vec3d{size.x * (2 * i - n) / (2 * n), size.y * (2 * j - n) / (2 * n), size.z * (2 * k - n) / (2 * n)};
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      builder.quad(at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j));
      builder.quad(at(n, i, j), at(n, i + 1, j), at(n, i + 1, j + 1), at(n, i, j + 1));
      builder.quad(at(i, 0, j), at(i + 1, 0, j), at(i + 1, 0, j + 1), at(i, 0, j + 1));
      builder.quad(at(i, n, j), at(i, n, j + 1), at(i + 1, n, j + 1), at(i + 1, n, j));
      builder.quad(at(i, j, 0), at(i, j + 1, 0), at(i + 1, j + 1, 0), at(i + 1, j, 0));
      builder.quad(at(i, j, n), at(i + 1, j, n), at(i + 1, j + 1, n), at(i, j + 1, n));
    }
  }
  return builder.finish();
}

MeshArrays makeCubes(int n, const std::function<bool(int, int, int)>& isFull) {
  MeshBuilder builder;
  const auto isIn = [&](int x, int y, int z) {
    return std::min({x, y, z}) >= 0 && std::max({x, y, z}) < n && isFull(x, y, z);
  };
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        if (!isIn(x, y, z)) continue;
        const auto at = [&](int i, int j, int k) { return Vec3d{1.0 * (x + i), 1.0 * (y + j), 1.0 * (z + k)}; };
        if (!isIn(x - 1, y, z)) builder.quad(at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
        if (!isIn(x + 1, y, z)) builder.quad(at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
        if (!isIn(x, y - 1, z)) builder.quad(at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
        if (!isIn(x, y + 1, z)) builder.quad(at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
        if (!isIn(x, y, z - 1)) builder.quad(at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
        if (!isIn(x, y, z + 1)) builder.quad(at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
      }
    }
  }
  return builder.finish();
}

MeshArrays makeSphere(double radius, int level) {
  MeshBuilder builder;
  for (const auto& [a, b, c] : sphereTriangles(level)) builder.triangle(a * radius, b * radius, c * radius);
  return builder.finish();
}

MeshArrays makeLump(double radius, int level, double amplitude, std::uint32_t seed) {
  // A few cosine bumps of random direction and frequency; the raw generator, because distributions differ by library.
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  struct Bump {
    Vec3d direction;
    double phase;
  };
  std::array<Bump, 6> bumps;
  for (Bump& bump : bumps) {
    const double x = uniform(), y = uniform(), z = uniform();
    bump = {Vec3d{x, y, z} * 5.0, uniform() * std::numbers::pi};
  }
  const auto lumpy = [&](const Vec3d& d) {
    double height = 0;
    for (const Bump& bump : bumps) height += std::cos(otgDot(bump.direction, d) + bump.phase);
    return d * (radius * (1 + amplitude * height / static_cast<double>(bumps.size())));
  };
  MeshBuilder builder;
  for (const auto& [a, b, c] : sphereTriangles(level)) builder.triangle(lumpy(a), lumpy(b), lumpy(c));
  return builder.finish();
}

MeshArrays makeTorus(double majorRadius, double minorRadius, int majorSegments, int minorSegments) {
  MeshBuilder builder;
  addTube(builder, majorSegments, minorSegments, [&](int i, int j) {
    const double u = kTwoPi * (i % majorSegments) / majorSegments, v = kTwoPi * j / minorSegments;
    const double r = majorRadius + minorRadius * std::cos(v);
    return Vec3d{r * std::cos(u), r * std::sin(u), minorRadius * std::sin(v)};
  });
  return builder.finish();
}

MeshArrays makeCylinder(double radius, double height, int segments, int stacks) {
  MeshBuilder builder;
  const auto at = [&](int i, int j) {
    const double u = kTwoPi * j / segments;
    return Vec3d{radius * std::cos(u), radius * std::sin(u), height * (2 * i - stacks) / (2 * stacks)};
  };
  addTube(builder, stacks, segments, [&](int i, int j) { return at(stacks - i, j); });
  addFan(builder, {0, 0, height / 2}, segments, [&](int j) { return at(stacks, j); });
  addFan(builder, {0, 0, -height / 2}, segments, [&](int j) { return at(0, (segments - j) % segments); });
  return builder.finish();
}

MeshArrays makeCapsule(double radius, double length, int segments, int rings) {
  // Rings from the one below the upper pole down to the one above the lower pole; the equator is there twice.
  const auto at = [&](int ring, int j) {
    const bool upper = ring < rings;
    const int fromPole = upper ? ring + 1 : 2 * rings - ring;
    const double polar = kTwoPi / 4 * fromPole / rings, u = kTwoPi * (j % segments) / segments;
    const double across = fromPole == rings ? 1.0 : std::sin(polar), along = fromPole == rings ? 0.0 : std::cos(polar);
    const double z = 0.5 * length + radius * along;
    return Vec3d{radius * across * std::cos(u), radius * across * std::sin(u), upper ? z : -z};
  };
  const double pole = 0.5 * length + radius;
  MeshBuilder builder;
  addTube(builder, 2 * rings - 1, segments, at);
  addFan(builder, {0, 0, pole}, segments, [&](int j) { return at(0, j); });
  addFan(builder, {0, 0, -pole}, segments, [&](int j) { return at(2 * rings - 1, segments - j); });
  return builder.finish();
}

MeshArrays makeTetrahedron(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  if (otgDot(otgCross(b - a, c - a), d - a) < 0) std::swap(b, c);
  MeshBuilder builder;
  builder.triangle(a, c, b);
  builder.triangle(a, b, d);
  builder.triangle(b, c, d);
  builder.triangle(c, a, d);
  return builder.finish();
}

MeshArrays makeBowl(double radius, double thickness, int segments, int rings) {
  // The profile runs from the outer pole up to the rim and down the inside to the inner pole.
  const double inner = radius - thickness;
  const auto at = [&](double r, int ring, int j) {
    const double u = kTwoPi * j / segments, polar = kTwoPi / 4 * ring / rings;
    // cos(pi / 2) is not zero in floating point; both rims lie exactly in the plane z = 0.
    return Vec3d{r * std::sin(polar) * std::cos(u), r * std::sin(polar) * std::sin(u),
                 ring == rings ? 0.0 : -r * std::cos(polar)};
  };
  MeshBuilder builder;
  addTube(builder, 2 * rings - 1, segments, [&](int i, int j) {
    const int ring = 2 * rings - 1 - i;
    return ring < rings ? at(radius, ring + 1, j) : at(inner, 2 * rings - ring, j);
  });
  addFan(builder, {0, 0, -radius}, segments, [&](int j) { return at(radius, 1, (segments - j) % segments); });
  addFan(builder, {0, 0, -inner}, segments, [&](int j) { return at(inner, 1, j); });
  return builder.finish();
}

MeshArrays makeGround(double size, double thickness, int n, const std::function<double(double, double)>& height) {
  const auto coordinate = [&](int i) { return size * (2 * i - n) / (2 * n); };
  const auto top = [&](int i, int j) {
    const double x = coordinate(i), y = coordinate(j);
    return Vec3d{x, y, height ? height(x, y) : 0.0};
  };
  const auto bottom = [&](int i, int j) { return Vec3d{coordinate(i), coordinate(j), -thickness}; };
  MeshBuilder builder;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) builder.quad(top(i, j), top(i + 1, j), top(i + 1, j + 1), top(i, j + 1));
  // The rim counter-clockwise seen from above; below, a fan to the centre closes it.
  const auto rim = [&](const auto& at, int k) {
    const int side = k / n % 4, along = k % n;
    return side == 0 ? at(along, 0) : side == 1 ? at(n, along) : side == 2 ? at(n - along, n) : at(0, n - along);
  };
  for (int k = 0; k < 4 * n; ++k) {
    builder.quad(rim(bottom, k), rim(bottom, k + 1), rim(top, k + 1), rim(top, k));
    builder.triangle({0, 0, -thickness}, rim(bottom, k + 1), rim(bottom, k));
  }
  return builder.finish();
}

}  // namespace otg::scenes
