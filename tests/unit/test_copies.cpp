// SPDX-License-Identifier: BSD-3-Clause
// Triangles that lie on one another: the pairs are those of all of them, no contact is there twice.
#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "collide/query.h"
#include "collide/stages.h"
#include "mesh/copies.h"
#include "support/catch.h"
#include "support/mesh_samples.h"

using namespace otg;

namespace {

/// A soup, and the same with copies at random places; `originOf`: which triangle of the soup each one is.
struct WithCopies {
  scenes::MeshArrays plain, copied;
  std::vector<std::uint32_t> originOf;
};

WithCopies withCopies(std::uint32_t seed, int triangles, int copies) {
  WithCopies made;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < triangles; ++i) {
    const auto first = static_cast<std::uint32_t>(made.plain.vertices.size());
    const Vec3f at{unit(random), unit(random), unit(random)};
    for (int k = 0; k < 3; ++k)
      made.plain.vertices.push_back(
          {at.x + 0.5f * unit(random), at.y + 0.5f * unit(random), at.z + 0.5f * unit(random)});
    made.plain.triangles.push_back({{first, first + 1, first + 2}});
  }
  made.copied.vertices = made.plain.vertices;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(triangles); ++i) made.originOf.push_back(i);
  for (int i = 0; i < copies; ++i)
    made.originOf.push_back(static_cast<std::uint32_t>(random() % made.plain.triangles.size()));
  std::shuffle(made.originOf.begin(), made.originOf.end(), random);
  std::vector<bool> seen(made.plain.triangles.size(), false);
  for (const std::uint32_t origin : made.originOf) {
    Triangle t = made.plain.triangles[origin];
    if (seen[origin] && random() % 2 == 0) {  // with vertices of its own, beginning at another corner
      const auto first = static_cast<std::uint32_t>(made.copied.vertices.size());
      for (const std::uint32_t v : t.v) made.copied.vertices.push_back(made.copied.vertices[v]);
      t = {{first + 1, first + 2, first}};
    }
    seen[origin] = true;
    made.copied.triangles.push_back(t);
  }
  return made;
}

CollisionMesh meshOf(const scenes::MeshArrays& arrays) {
  return CollisionMesh(scenes::build(arrays), BuildStrategy::kSah);
}

Query queryOf(const CollisionMesh& a, const CollisionMesh& b, ContactModel model) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.2, 0.1, -0.1}};
  query.options.contacts = model;
  query.options.maxContacts = 1000;
  return query;
}

}  // namespace

TEST_CASE("the first of the triangles that lie on one another") {
  const WithCopies made = withCopies(1, 50, 100);
  const MeshResult built = buildTriMesh(made.copied.input());
  REQUIRE(built.mesh != nullptr);
  const auto first = built.mesh->firstCopies();
  REQUIRE(first.size() == made.originOf.size());
  for (std::size_t t = 0; t < first.size(); ++t) {
    const auto wanted = std::find(made.originOf.begin(), made.originOf.end(), made.originOf[t]);
    REQUIRE(first[t] == static_cast<std::size_t>(wanted - made.originOf.begin()));
  }
  CHECK(buildTriMesh(made.plain.input()).mesh->firstCopies().empty());
  // Turned round it is another one: its normal is.
  scenes::MeshArrays turned = made.plain;
  turned.triangles.push_back({{turned.triangles[0].v[0], turned.triangles[0].v[2], turned.triangles[0].v[1]}});
  CHECK(buildTriMesh(turned.input()).mesh->firstCopies().empty());
}

TEST_CASE("pairs are those of all copies, and no contact is there twice") {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const WithCopies a = withCopies(seed, 40, 60), b = withCopies(seed + 100, 40, seed % 3 == 0 ? 0 : 50);
    const CollisionMesh plainA = meshOf(a.plain), plainB = meshOf(b.plain), copiedA = meshOf(a.copied),
                        copiedB = meshOf(b.copied);
    for (const ContactModel model : {ContactModel::kSolid, ContactModel::kPairwise}) {
      Workspace plain, copied;
      collide(queryOf(plainA, plainB, model), plain);
      collide(queryOf(copiedA, copiedB, model), copied);
      std::vector<TrianglePair> wanted;
      for (std::uint32_t x = 0; x < a.originOf.size(); ++x) {
        for (std::uint32_t y = 0; y < b.originOf.size(); ++y) {
          const TrianglePair origin{a.originOf[x], b.originOf[y]};
          if (std::binary_search(plain.intersecting.begin(), plain.intersecting.end(), origin))
            wanted.push_back({x, y});
        }
      }
      REQUIRE(copied.intersecting == wanted);
      CHECK(copied.stats.intersectingPairs == wanted.size());
      if (model == ContactModel::kPairwise) continue;  // has contacts of each pair
      for (std::size_t i = 0; i < copied.reduced.size(); ++i) {
        const Contact& c = copied.reduced[i];
        for (std::size_t k = 0; k < i; ++k) {
          const Contact& d = copied.reduced[k];
          REQUIRE(!(c.position == d.position && c.normal == d.normal && c.triangleA == d.triangleA &&
                    c.triangleB == d.triangleB));
        }
      }
      CHECK(copied.reduced.empty() == plain.reduced.empty());
    }
  }
}

TEST_CASE("what a callback has left of the pairs of copies is in the regions of the first ones") {
  std::mt19937 random(5);
  std::size_t found = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const WithCopies a = withCopies(seed, 40, 60), b = withCopies(seed + 100, 40, 50);
    const CollisionMesh copiedA = meshOf(a.copied), copiedB = meshOf(b.copied);
    const Query query = queryOf(copiedA, copiedB, ContactModel::kPairwise);
    Workspace workspace;
    findIntersectingPairs(query, workspace);
    std::erase_if(workspace.intersecting, [&](const TrianglePair&) { return random() % 4 != 0; });
    pairwiseContacts(query, workspace);
    // Triangles of the soup share no edges: each of their pairs is a region.
    std::map<TrianglePair, std::uint32_t> regions;
    std::set<std::uint32_t> numbers;
    for (const Contact& c : workspace.contacts) {
      const auto [at, isNew] =
          regions.emplace(TrianglePair{a.originOf[c.triangleA], b.originOf[c.triangleB]}, c.region);
      CHECK(at->second == c.region);
      numbers.insert(c.region);
    }
    CHECK(numbers.size() == regions.size());
    CHECK(*numbers.rbegin() == regions.size() - 1);
    found += regions.size();
  }
  CHECK(found > 100);
}

TEST_CASE("copies stay copies when all vertices move together") {
  const WithCopies made = withCopies(5, 30, 30);
  const MeshResult built = buildTriMesh(made.copied.input());
  scenes::MeshArrays moved = made.copied;
  for (Vec3f& v : moved.vertices) v.z *= 2;
  const MeshResult after = moveVertices(*built.mesh, moved.input());
  REQUIRE(after.mesh != nullptr);
  CHECK(std::ranges::equal(after.mesh->firstCopies(), built.mesh->firstCopies()));
  // One corner alone: those that had a vertex of their own are copies no more.
  scenes::MeshArrays parted = made.copied;
  for (Vec3f& v : parted.vertices) v.x += 1e-3f * static_cast<float>(&v - parted.vertices.data());
  const MeshResult last = moveVertices(*built.mesh, parted.input());
  REQUIRE(last.mesh != nullptr);
  const MeshResult fresh = buildTriMesh(parted.input());
  CHECK(std::ranges::equal(last.mesh->firstCopies(), fresh.mesh->firstCopies()));
}
