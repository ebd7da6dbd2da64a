// SPDX-License-Identifier: BSD-3-Clause
// Pairs of soups of triangles that are hard to decide, by what makes them so.
#pragma once

#include <span>

#include "scenes/generated_meshes.h"
#include "truth/contact_families.h"

namespace otg::cli {

struct ExactScene {
  scenes::MeshArrays a, b;
  Transformd bInA;
};

struct ExactFamily {
  const char* name;
  ExactScene (*make)(truth::Random&);
};

/// Triangles of each soup.
inline constexpr int kExactTriangles = 40;

std::span<const ExactFamily> exactFamilies();

/// The scene 2^exponent times as large. Below the least float, coordinates are rounded.
void scaleScene(ExactScene& scene, int exponent);

}  // namespace otg::cli
