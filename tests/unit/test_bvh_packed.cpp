// SPDX-License-Identifier: BSD-3-Clause
// The layout for devices: what it holds, how full it is, and that its validator notices damage.
#include <algorithm>
#include <set>

#include "bvh/packed_tree.h"
#include "support/catch.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::samples;

TEST_CASE("packed trees of all kinds of meshes are valid") {
  std::vector<NamedMesh> meshes = ordinaryMeshes();
  for (NamedMesh& mesh : pathologicalMeshes()) {
    if (mesh.mesh->triangleCount() <= 20000) meshes.push_back(std::move(mesh));
  }
  for (const NamedMesh& mesh : meshes) {
    const BinaryTree tree = buildTree(*mesh.mesh, BuildStrategy::kSah);
    for (const std::uint32_t leaf : {1u, 3u, 4u, 16u}) {
      INFO(mesh.name << ", " << leaf << " triangles to a leaf");
      const PackedTree packed = makePackedTree(tree, leaf);
      CHECK(validateLayout(packed, *mesh.mesh) == "");
      for (const PackedNode& node : packed.nodes) {
        if (node.isLeaf() && -node.count > static_cast<int>(leaf)) FAIL("a leaf of " << -node.count << " triangles");
      }
    }
  }
}

TEST_CASE("the cut of a large mesh is full, and that of a small one is its leaves") {
  const MeshPtr large = scenes::build(scenes::makeLump(1, 5, 0.2, 3));
  const PackedTree packed = makePackedTree(buildTree(*large, BuildStrategy::kSah), 4);
  CHECK(packed.cut.size() <= kMaxCutNodes);
  CHECK(packed.cut.size() > kMaxCutNodes - kPackedArity);
  const MeshPtr small = scenes::build(scenes::makeTorus(1, 0.3, 16, 8));
  const PackedTree few = makePackedTree(buildTree(*small, BuildStrategy::kSah), 4);
  CHECK(few.cut.size() == static_cast<std::size_t>(
                              std::count_if(few.nodes.begin(), few.nodes.end(), [](auto& n) { return n.isLeaf(); })));
}

TEST_CASE("the validator notices damage to a packed tree") {
  const MeshPtr mesh = scenes::build(scenes::makeSphere(1, 3));
  const PackedTree good = makePackedTree(buildTree(*mesh, BuildStrategy::kSah), 4);
  REQUIRE(validateLayout(good, *mesh) == "");
  std::set<std::string> errors;
  const auto damaged = [&](auto&& change) {
    PackedTree tree = good;
    change(tree);
    errors.insert(validateLayout(tree, *mesh));
    CHECK(validateLayout(tree, *mesh) != "");
  };
  damaged([](PackedTree& t) { t.nodes[5].extent.x *= 0.9f; });
  damaged([](PackedTree& t) { t.nodes[5].center.y += 0.1f; });
  damaged([](PackedTree& t) { t.nodes[0].count = 1; });
  damaged([](PackedTree& t) { t.nodes[0].first = 2; });
  damaged([](PackedTree& t) { t.triangles[1] = t.triangles[0]; });
  damaged([](PackedTree& t) { t.triangles.pop_back(); });
  damaged([](PackedTree& t) { ++t.depth; });
  damaged([](PackedTree& t) { t.cut.pop_back(); });
  damaged([](PackedTree& t) { t.cut[0] = t.cut[1]; });
  damaged([](PackedTree& t) { t.cut.push_back(0); });
  damaged([](PackedTree& t) { t.cut.clear(); });
  CHECK(errors.size() > 7);
}
