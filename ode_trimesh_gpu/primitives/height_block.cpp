// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/height_block.h"

namespace otg {
namespace {

Vec3d originOf(const HeightBlock& block) {
  const int i = block.columns / 2, j = block.rows / 2;
  return {i * block.columnWidth, block.at(i, j), j * block.rowDepth};
}

/// The samples round the rim, counter-clockwise seen from above (from +y, with x to the right and z towards the eye).
std::vector<std::uint32_t> rimOf(const HeightBlock& block) {
  const auto columns = static_cast<std::uint32_t>(block.columns), rows = static_cast<std::uint32_t>(block.rows);
  std::vector<std::uint32_t> rim;
  for (std::uint32_t j = 0; j + 1 < rows; ++j) rim.push_back(j * columns);
  for (std::uint32_t i = 0; i + 1 < columns; ++i) rim.push_back((rows - 1) * columns + i);
  for (std::uint32_t j = rows - 1; j > 0; --j) rim.push_back(j * columns + columns - 1);
  for (std::uint32_t i = columns - 1; i > 0; --i) rim.push_back(i);
  return rim;
}

/// The samples, below them those of the rim at the bottom, and the middle of the bottom.
std::vector<Vec3f> verticesOf(const HeightBlock& block, const Vec3d& origin) {
  const auto toFloat = [](double x, double y, double z) {
    return Vec3f{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  const int middleColumn = block.columns / 2, middleRow = block.rows / 2;
  std::vector<Vec3f> vertices;
  for (int j = 0; j < block.rows; ++j) {
    for (int i = 0; i < block.columns; ++i) {
      vertices.push_back(
          toFloat((i - middleColumn) * block.columnWidth, block.at(i, j) - origin.y, (j - middleRow) * block.rowDepth));
    }
  }
  const auto bottom = static_cast<float>(block.bottom - origin.y);
  for (const std::uint32_t v : rimOf(block)) vertices.push_back({vertices[v].x, bottom, vertices[v].z});
  const Vec3f &low = vertices.front(), &high = vertices[block.heights.size() - 1];
  vertices.push_back({0.5f * (low.x + high.x), bottom, 0.5f * (low.z + high.z)});
  return vertices;
}

std::vector<Triangle> trianglesOf(const HeightBlock& block) {
  const auto columns = static_cast<std::uint32_t>(block.columns), rows = static_cast<std::uint32_t>(block.rows);
  std::vector<Triangle> triangles;
  for (std::uint32_t j = 0; j + 1 < rows; ++j) {
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
      triangles.push_back({{a, c, b}});
      triangles.push_back({{d, b, c}});
    }
  }
  const std::vector<std::uint32_t> rim = rimOf(block);
  const auto count = static_cast<std::uint32_t>(rim.size());
  const auto below = columns * rows, middle = below + count;
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t next = (k + 1) % count;
    triangles.push_back({{rim[k], below + k, below + next}});
    triangles.push_back({{rim[k], below + next, rim[next]}});
    triangles.push_back({{middle, below + next, below + k}});
  }
  return triangles;
}

MeshInput inputOf(const std::vector<Vec3f>& vertices) {
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  return input;
}

}  // namespace

HeightBlockMesh meshOfBlock(const HeightBlock& block) {
  HeightBlockMesh made{nullptr, originOf(block)};
  const std::vector<Vec3f> vertices = verticesOf(block, made.origin);
  const std::vector<Triangle> triangles = trianglesOf(block);
  MeshInput input = inputOf(vertices);
  input.indices = triangles.data();
  input.triangleCount = triangles.size();
  const MeshResult built = buildTriMesh(input);
  if (built.mesh != nullptr) made.mesh = std::make_shared<const CollisionMesh>(built.mesh, BuildStrategy::kSah);
  return made;
}

HeightBlockMesh moveBlock(const HeightBlock& block, const CollisionMesh& before) {
  HeightBlockMesh made{nullptr, originOf(block)};
  const std::vector<Vec3f> vertices = verticesOf(block, made.origin);
  const MeshResult moved = moveVertices(before.mesh(), inputOf(vertices));
  if (moved.mesh != nullptr) made.mesh = std::make_shared<const CollisionMesh>(moved.mesh, before);
  return made;
}

}  // namespace otg
