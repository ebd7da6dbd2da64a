// SPDX-License-Identifier: BSD-3-Clause
// Meshes that no solid is made of, with random proportions: what programs load when nobody has looked.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "support/shell_scenes.h"

namespace otg::test {

enum class Hostile {
  kQuad,
  kTwoSided,
  kOpenBox,
  kMisoriented,
  kDoubled,
  kNeedles,
  kBowTie,
  kMoebius,
  kNested,
  kHoles,
  kSeveral,
  kFins,
  kTornBall,
  kSoup,
  kSolid
};
inline constexpr std::array kHostile = {
    Hostile::kQuad,    Hostile::kTwoSided, Hostile::kOpenBox,  Hostile::kMisoriented, Hostile::kDoubled,
    Hostile::kNeedles, Hostile::kBowTie,   Hostile::kMoebius,  Hostile::kNested,      Hostile::kHoles,
    Hostile::kSeveral, Hostile::kFins,     Hostile::kTornBall, Hostile::kSoup,        Hostile::kSolid};
inline const char* nameOf(Hostile kind) {
  constexpr const char* kNames[] = {"quad",    "two-sided", "open box",  "misoriented", "doubled",
                                    "needles", "bow-tie",   "moebius",   "nested",      "holes",
                                    "several", "fins",      "torn ball", "soup",        "solid"};
  return kNames[static_cast<int>(kind)];
}

inline void append(scenes::MeshArrays& to, const scenes::MeshArrays& from, const Vec3d& by = {0, 0, 0}) {
  const auto first = static_cast<std::uint32_t>(to.vertices.size());
  for (const Vec3f& v : from.vertices) {
    to.vertices.push_back(
        {static_cast<float>(v.x + by.x), static_cast<float>(v.y + by.y), static_cast<float>(v.z + by.z)});
  }
  for (const Triangle& t : from.triangles) {
    to.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  }
}

/// A strip of `cells` cells around the z axis that turns over once.
inline scenes::MeshArrays moebius(double radius, double width, int cells) {
  scenes::MeshArrays strip;
  for (int i = 0; i < cells; ++i) {
    const double a = 6.283185307179586 * i / cells, half = 0.5 * a;
    for (const double side : {-0.5, 0.5}) {
      const double r = radius + side * width * std::cos(half);
      strip.vertices.push_back({static_cast<float>(r * std::cos(a)), static_cast<float>(r * std::sin(a)),
                                static_cast<float>(side * width * std::sin(half))});
    }
  }
  for (int i = 0; i < cells; ++i) {
    const auto a = static_cast<std::uint32_t>(2 * i), b = a + 1;
    const bool isLast = i + 1 == cells;
    const std::uint32_t c = isLast ? 1 : a + 2, d = isLast ? 0 : a + 3;
    strip.triangles.push_back({{a, c, d}});
    strip.triangles.push_back({{a, d, b}});
  }
  return strip;
}

/// With about the sides `size`, which mass and pose go by.
inline scenes::MeshArrays makeHostile(Hostile kind, const Vec3d& size, Draw& draw) {
  scenes::MeshArrays box = scenes::makeBox(size), mesh;
  const auto leave = [&](scenes::MeshArrays from, std::uint32_t oneOf) {
    std::erase_if(from.triangles, [&](const Triangle&) { return draw.below(oneOf) == 0; });
    return from;
  };
  switch (kind) {
    case Hostile::kQuad:
      return flatSheet(size.x, size.y, 1 + static_cast<int>(draw.below(4)));
    case Hostile::kTwoSided:
      return twoSided(flatSheet(size.x, size.y, 1 + static_cast<int>(draw.below(4))));
    case Hostile::kOpenBox:
      return withoutLid(box, static_cast<float>(size.z / 2));
    case Hostile::kMisoriented: {
      box = scenes::makeBox(size, 1 + static_cast<int>(draw.below(3)));
      for (Triangle& t : box.triangles) {
        if (draw.below(4) == 0) t = turned(t);
      }
      return box;
    }
    case Hostile::kDoubled:
      return doubled(box);
    case Hostile::kNeedles:  // triangles from the middle outward, long and thin
      for (int i = 0; i < 24; ++i) {
        const Vec3d d = draw.direction(), e = draw.direction();
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back({0, 0, 0});
        const Vec3d tip{0.5 * size.x * d.x, 0.5 * size.y * d.y, 0.5 * size.z * d.z};
        mesh.vertices.push_back({static_cast<float>(tip.x), static_cast<float>(tip.y), static_cast<float>(tip.z)});
        mesh.vertices.push_back({static_cast<float>(tip.x + 0.03 * e.x), static_cast<float>(tip.y + 0.03 * e.y),
                                 static_cast<float>(tip.z + 0.03 * e.z)});
        mesh.triangles.push_back({{first, first + 1, first + 2}});
      }
      return mesh;
    case Hostile::kBowTie:  // two boxes that have an edge in common, and a quad at a corner
      append(mesh, scenes::makeBox(otgScale(size, 0.5)), otgScale(size, -0.25));
      append(mesh, scenes::makeBox(otgScale(size, 0.5)), {0.25 * size.x, 0.25 * size.y, -0.25 * size.z});
      append(mesh, flatSheet(0.5 * size.x, 0.5 * size.y, 1), {0.25 * size.x, -0.25 * size.y, 0});
      return mesh;
    case Hostile::kMoebius:
      return moebius(0.4 * size.x, 0.3 * size.x, 24);
    case Hostile::kNested:  // doubled, with a smaller one inside that faces inward
      mesh = doubled(box);
      append(mesh, turned(scenes::makeBox(otgScale(size, draw.uniform(0.5, 0.95)))));
      return mesh;
    case Hostile::kHoles:
      return leave(flatSheet(size.x, size.y, 6), 5);
    case Hostile::kSeveral:
      append(mesh, scenes::makeBox(otgScale(size, 0.5)), {-0.25 * size.x, 0, -0.25 * size.z});
      append(mesh, withoutLid(scenes::makeBox(otgScale(size, 0.4)), static_cast<float>(0.2 * size.z)),
             {0.3 * size.x, 0, -0.25 * size.z});
      append(mesh, flatSheet(size.x, size.y, 2));
      return mesh;
    case Hostile::kFins:  // three sheets with an edge in common
      for (int i = 0; i < 3; ++i) {
        const double a = 2.0943951023931953 * i;
        append(mesh, scenes::transformed(
                         flatSheet(0.5 * size.x, size.y, 2),
                         makePose({0, 1, 0}, a, {0.25 * size.x * std::cos(a), 0, -0.25 * size.x * std::sin(a)})));
      }
      return mesh;
    case Hostile::kTornBall:
      return leave(scaled(scenes::makeSphere(0.5, 2), size), 8);
    case Hostile::kSoup:
      for (int i = 0; i < 30; ++i) {
        for (std::uint32_t k = 0; k < 3; ++k) {
          mesh.vertices.push_back({static_cast<float>(draw.uniform(-0.5, 0.5) * size.x),
                                   static_cast<float>(draw.uniform(-0.5, 0.5) * size.y),
                                   static_cast<float>(draw.uniform(-0.5, 0.5) * size.z)});
        }
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.triangles.push_back({{first, first + 1, first + 2}});
      }
      return mesh;
    default:
      return box;
  }
}

}  // namespace otg::test
