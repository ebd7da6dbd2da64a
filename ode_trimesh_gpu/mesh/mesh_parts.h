// SPDX-License-Identifier: BSD-3-Clause
// A TriMesh taken apart, for what stores and restores one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mesh/tri_mesh.h"

namespace otg {

/// All that a TriMesh is made of: see there.
struct TriMeshParts {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> degenerate;
  Topology topology;
  ValidationReport report;
  MassProperties mass;
  Vec3f boundsMin{}, boundsMax{}, center{}, origin{};
  float radius = 0;
  std::size_t inputVertexCount = 0;
  std::vector<std::uint32_t> inputVertexOf, callerTriangle;  ///< triangleOfCaller is the inverse of callerTriangle

  /// Copies.
  static TriMeshParts of(const TriMesh& mesh);
  /// What is wrong with the parts, in words: numbers that point nowhere, sizes that do not match, vertices that are not
  /// finite. Empty when a mesh made of them can be worked with; that it is the mesh which it says it is (its normals,
  /// its volume) is not checked.
  std::string fault() const;
  /// Of parts without fault.
  static std::shared_ptr<const TriMesh> assemble(TriMeshParts&& parts);
};

}  // namespace otg
