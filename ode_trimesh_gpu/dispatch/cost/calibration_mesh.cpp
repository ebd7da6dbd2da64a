// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/cost/calibration_mesh.h"

#include <cmath>
#include <numbers>

namespace otg {

std::shared_ptr<const CollisionMesh> calibrationMesh(const std::vector<Vec3f>& vertices,
                                                     const std::vector<Triangle>& triangles) {
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  input.indices = triangles.data();
  input.triangleCount = triangles.size();
  const MeshResult result = buildTriMesh(input, RepairOptions::all(), MeshOrder::kBySize);
  return std::make_shared<const CollisionMesh>(result.mesh, BuildStrategy::kSah);
}

std::shared_ptr<const CollisionMesh> calibrationBody(int steps, double phase) {
  const int rings = 2 * steps, sectors = 2 * steps;
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  for (int i = 0; i <= rings; ++i) {
    const double theta = std::numbers::pi * i / rings;
    const double sine = i % rings == 0 ? 0 : std::sin(theta);  // else the surface does not close at one of the poles
    for (int k = 0; k < sectors; ++k) {
      const double phi = 2 * std::numbers::pi * k / sectors;
      const double r = 1 + 0.1 * std::sin(3 * phi + phase) * std::pow(sine, 3);
      // The zero added: vertices at one place that differ in the signs of zeros leave a pair to the CPU.
      vertices.push_back({static_cast<float>(r * sine * std::cos(phi) + 0.0),
                          static_cast<float>(r * sine * std::sin(phi) + 0.0), static_cast<float>(r * std::cos(theta))});
    }
  }
  const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * sectors + k % sectors); };
  for (int i = 0; i < rings; ++i) {
    for (int k = 0; k < sectors; ++k) {
      triangles.push_back({{at(i, k), at(i + 1, k), at(i + 1, k + 1)}});
      triangles.push_back({{at(i, k), at(i + 1, k + 1), at(i, k + 1)}});
    }
  }
  return calibrationMesh(vertices, triangles);
}

}  // namespace otg
