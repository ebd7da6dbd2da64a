// SPDX-License-Identifier: BSD-3-Clause
// Refitting: the topology stays, the boxes are those of the moved vertices, and the quality measure tells the price.
#include <cmath>

#include "bvh/collision_mesh.h"
#include "support/catch.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::samples;

namespace {

MeshPtr moved(const TriMesh& mesh, const std::function<Vec3f(Vec3f)>& move) {
  std::vector<Vec3f> vertices(mesh.vertices().begin(), mesh.vertices().end());
  for (Vec3f& v : vertices) v = move(v);
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  const MeshResult result = moveVertices(mesh, input);
  REQUIRE(result.mesh != nullptr);
  return result.mesh;
}

bool sameTopology(const BinaryTree& a, const BinaryTree& b) {
  if (a.nodes.size() != b.nodes.size() || a.depth != b.depth || a.strategy != b.strategy) return false;
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (a.nodes[i].child != b.nodes[i].child || a.nodes[i].parent != b.nodes[i].parent) return false;
  }
  return true;
}

bool sameBoxes(const BinaryTree& a, const BinaryTree& b) {
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (!(a.nodes[i].center == b.nodes[i].center) || !(a.nodes[i].extent == b.nodes[i].extent)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("refitting to vertices that did not move changes nothing") {
  std::vector<NamedMesh> samples = ordinaryMeshes();
  for (NamedMesh& sample : pathologicalMeshes()) samples.push_back(std::move(sample));
  for (const NamedMesh& sample : samples) {
    INFO(sample.name);
    for (const BuildStrategy strategy : {BuildStrategy::kMeanSplit, BuildStrategy::kSah}) {
      const BinaryTree built = buildTree(*sample.mesh, strategy);
      BinaryTree tree = built;
      refitTree(tree, *sample.mesh);
      REQUIRE(sameTopology(tree, built));
      REQUIRE(sameBoxes(tree, built));
    }
  }
}

TEST_CASE("a refitted tree is valid for the moved mesh, and so are its layouts") {
  std::mt19937 random(21);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const NamedMesh& sample : ordinaryMeshes()) {
    INFO(sample.name);
    const CollisionMesh before(sample.mesh, BuildStrategy::kSah);
    for (const float reach : {0.01f, 1.0f, 1000.0f}) {
      const MeshPtr mesh = moved(*sample.mesh, [&](Vec3f v) {
        return Vec3f{v.x + reach * unit(random), v.y + reach * unit(random), v.z + reach * unit(random)};
      });
      BinaryTree refitted = before.tree();
      refitTree(refitted, *mesh);
      REQUIRE(sameTopology(refitted, before.tree()));
      REQUIRE(validateTree(refitted, *mesh) == "");
      const CollisionMesh after(mesh, before);
      REQUIRE(&after.mesh() == mesh.get());
      REQUIRE(validateTree(after.tree(), *mesh) == "");
      REQUIRE(validateLayout(after.quantized(), *mesh) == "");
      REQUIRE(validateLayout(after.noLeaf(), *mesh) == "");
      REQUIRE(validateLayout(after.wide(), *mesh) == "");
      if (sample.mesh->triangleCount() > 1) REQUIRE(validateTree(before.tree(), *mesh) != "");
    }
    REQUIRE(validateTree(before.tree(), *sample.mesh) == "");  // the first mesh keeps its tree
  }
}

TEST_CASE("a tree is built anew when refitting has made it too bad, and only then") {
  const MeshPtr sphere = scenes::build(scenes::makeSphere(1, 4));
  const CollisionMesh built(sphere, BuildStrategy::kSah);
  // A breath moves all vertices and keeps neighbours neighbours: the tree stays as good as it was.
  const CollisionMesh breath(moved(*sphere, [](Vec3f v) { return Vec3f{1.3f * v.x, 0.9f * v.y, 1.1f * v.z}; }), built);
  REQUIRE(sameTopology(breath.tree(), built.tree()));
  // A twist by small steps spreads every box: at no step is the tree worse than the bound, and it is built anew at
  // some.
  std::shared_ptr<const CollisionMesh> now = std::make_shared<const CollisionMesh>(sphere, BuildStrategy::kSah);
  int builds = 0;
  double lastBuilt = sahCost(now->tree());
  for (int step = 1; step <= 40; ++step) {
    const MeshPtr twisted = moved(*sphere, [&](Vec3f v) {
      const float angle = 0.5f * static_cast<float>(step) * v.z, c = std::cos(angle), s = std::sin(angle);
      return Vec3f{(3 + v.y) * c - v.x * s, (3 + v.y) * s + v.x * c, v.z};
    });
    const auto after = std::make_shared<const CollisionMesh>(twisted, *now);
    REQUIRE(validateTree(after->tree(), *twisted) == "");
    if (!sameTopology(after->tree(), now->tree())) {
      ++builds;
      REQUIRE(sameTopology(after->tree(), buildTree(*twisted, BuildStrategy::kSah)));
      lastBuilt = sahCost(after->tree());
    }
    REQUIRE(sahCost(after->tree()) <= CollisionMesh::kRebuildCost * lastBuilt);
    now = after;
  }
  REQUIRE(builds >= 1);
  REQUIRE(builds <= 10);
}

TEST_CASE("the quality measure") {
  // Two unit cubes' worth of triangles far apart: root, two sides. By hand: halves of areas over that of the root.
  Soup soup;
  soup.add({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  soup.add({9, 0, 0}, {10, 0, 0}, {9, 1, 1});
  const BinaryTree two = buildTree(*soup.build(), BuildStrategy::kSah);
  // Root 10 x 1 x 1 has 42 of surface, each side 6.
  REQUIRE(sahCost(two) == Approx((42.0 + 6 + 6) / 42).epsilon(1e-6));

  const MeshPtr sphere = scenes::build(scenes::makeSphere(1, 4));
  const CollisionMesh built(sphere, BuildStrategy::kSah);
  const double fresh = sahCost(built.tree());
  const CollisionMesh scaled(moved(*sphere, [](Vec3f v) { return Vec3f{4 * v.x, 4 * v.y, 4 * v.z}; }), built);
  REQUIRE(sahCost(scaled.tree()) == Approx(fresh).epsilon(1e-5));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  const MeshPtr noise = moved(*sphere, [&](Vec3f) { return Vec3f{unit(random), unit(random), unit(random)}; });
  BinaryTree tree = built.tree();
  refitTree(tree, *noise);
  const double refitted = sahCost(tree);
  REQUIRE(refitted > 1.05 * sahCost(buildTree(*noise, BuildStrategy::kSah)));
  REQUIRE(refitted > 5 * fresh);

  // Flat in two directions: no area to compare with, every box counts as the root's.
  Soup points;
  for (int i = 0; i < 4; ++i) points.addAt({1, 1, 1}, 0);
  REQUIRE(sahCost(buildTree(*points.build(), BuildStrategy::kSah)) == 7);
}
