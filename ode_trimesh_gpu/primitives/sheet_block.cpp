// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/sheet_block.h"

#include <algorithm>
#include <map>

#include "base/vectors.h"
#include "bvh/wide_search.h"

namespace otg {
namespace {

constexpr double kSteepest = 0.1;  // cosine between a triangle's normal and the mean

std::vector<std::uint32_t> trianglesNear(const CollisionMesh& sheet, const Transformd& frame, const Vec3d& half) {
  std::vector<std::uint32_t> near;
  searchWide(sheet.wide(), BoxQuery(sheet, frame, half), [&](std::uint32_t t) {
    if (!sheet.mesh().isDegenerate(t)) near.push_back(t);
  });
  std::sort(near.begin(), near.end());
  return near;
}

/// The vertices in front and behind, and triangles between them.
class Builder {
 public:
  Builder(const CollisionMesh& sheet, const Vec3d& back) : mesh_(sheet.mesh()), back_(back) {}

  void add(std::uint32_t from, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.push_back({{a, b, c}});
    origins_.push_back(from);
  }
  /// The number of a vertex in front; the one behind it has the next number.
  std::uint32_t front(std::uint32_t corner) {
    const std::uint32_t v = mesh_.topology().weld[corner];
    const auto [it, isNew] = number_.try_emplace(v, static_cast<std::uint32_t>(vertices_.size()));
    if (isNew) {
      const Vec3f& p = mesh_.vertices()[v];
      vertices_.push_back(p);
      vertices_.push_back(
          {static_cast<float>(p.x + back_.x), static_cast<float>(p.y + back_.y), static_cast<float>(p.z + back_.z)});
    }
    return it->second;
  }

  SheetBlock build() {
    MeshInput input;
    input.vertices = vertices_.data();
    input.vertexCount = vertices_.size();
    input.indices = triangles_.data();
    input.triangleCount = triangles_.size();
    const MeshResult result = buildTriMesh(input);
    if (!result.mesh || result.mesh->meshClass() != MeshClass::kSolid) return {};
    return {std::make_shared<const CollisionMesh>(result.mesh, BuildStrategy::kSah), std::move(origins_)};
  }

 private:
  const TriMesh& mesh_;
  const Vec3d back_;
  std::vector<Vec3f> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> origins_;
  std::map<std::uint32_t, std::uint32_t> number_;
};

}  // namespace

SheetBlock sheetBlock(const CollisionMesh& sheet, const Transformd& frame, const Vec3d& half, double depth) {
  const std::vector<std::uint32_t> near = trianglesNear(sheet, frame, half);
  const Adjacency& adjacency = sheet.adjacency();
  Vec3d sum{0, 0, 0};
  for (const std::uint32_t t : near) sum = sum + adjacency.normal[t] * adjacency.area[t];
  const Vec3d normal = unit(sum);
  for (const std::uint32_t t : near) {
    if (!(otgDot(adjacency.normal[t], normal) > kSteepest)) return {};
  }
  Builder builder(sheet, normal * -depth);
  const TriMesh& mesh = sheet.mesh();
  for (const std::uint32_t t : near) {
    const Triangle& corners = mesh.triangles()[t];
    std::uint32_t v[3];
    for (int k = 0; k < 3; ++k) v[k] = builder.front(corners.v[k]);
    builder.add(t, v[0], v[1], v[2]);
    builder.add(t, v[0] + 1, v[2] + 1, v[1] + 1);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t twin = mesh.topology().twin[3 * t + k];
      if (twin != kNone && std::binary_search(near.begin(), near.end(), twin / 3)) continue;
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      builder.add(t, b, a, a + 1);
      builder.add(t, b, a + 1, b + 1);
    }
  }
  return builder.build();
}

}  // namespace otg
