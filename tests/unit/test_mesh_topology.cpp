// SPDX-License-Identifier: BSD-3-Clause
// The invariants that Topology promises, on solids, shells and soups.
#include <algorithm>
#include <random>

#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;
using namespace otg::scenes;

namespace {

void checkInvariants(const MeshArrays& mesh) {
  const Topology topology = buildTopology(mesh.vertices, mesh.triangles);
  REQUIRE(topology.weld.size() == mesh.vertices.size());
  REQUIRE(topology.edgeOf.size() == 3 * mesh.triangles.size());
  REQUIRE(topology.twin.size() == topology.edgeOf.size());
  REQUIRE(topology.componentOf.size() == mesh.triangles.size());
  bool good = true;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::uint32_t first = 0;
    while (mesh.vertices[first] != mesh.vertices[v]) ++first;
    good &= topology.weld[v] == first;
  }
  CHECK(good);

  const auto ends = [&](std::uint32_t h) {
    const Triangle& t = mesh.triangles[h / 3];
    return std::pair{topology.weld[t.v[h % 3]], topology.weld[t.v[(h % 3 + 1) % 3]]};
  };
  std::vector<std::vector<std::uint32_t>> uses(topology.edgeCount());
  std::uint32_t nextEdge = 0, nextComponent = 0;
  for (std::uint32_t h = 0; h < topology.edgeOf.size(); ++h) {
    const std::uint32_t e = topology.edgeOf[h];
    if (e == kNone) {
      good &= topology.twin[h] == kNone && topology.componentOf[h / 3] == kNone;
      continue;
    }
    REQUIRE(e <= nextEdge);  // numbered in the order of first appearance
    nextEdge += e == nextEdge;
    good &= topology.edges[e].a == std::min(ends(h).first, ends(h).second);
    good &= topology.edges[e].b == std::max(ends(h).first, ends(h).second);
    uses[e].push_back(h);
    const std::uint32_t c = topology.componentOf[h / 3];
    REQUIRE(c <= nextComponent);
    nextComponent += c == nextComponent;
  }
  CHECK(nextEdge == topology.edgeCount());
  CHECK(nextComponent == topology.componentCount());
  std::vector<std::uint8_t> closed(topology.componentCount(), 1);
  for (const auto& use : uses) {
    const bool twins = use.size() == 2 && ends(use[0]).first == ends(use[1]).second;
    for (std::size_t i = 0; i < use.size(); ++i) {
      good &= topology.twin[use[i]] == (twins ? use[1 - i] : kNone);
      good &= topology.componentOf[use[i] / 3] == topology.componentOf[use[0] / 3];
      closed[topology.componentOf[use[i] / 3]] &= twins;
    }
  }
  CHECK(good);
  CHECK(std::ranges::equal(closed, topology.componentClosed));

  MeshArrays turned = mesh;
  for (Triangle& t : turned.triangles) std::swap(t.v[1], t.v[2]);
  const Topology own = buildTopology(turned.vertices, turned.triangles), derived = turnedTopology(topology);
  CHECK(std::ranges::equal(derived.weld, own.weld));
  CHECK(std::ranges::equal(derived.edgeOf, own.edgeOf));
  CHECK(std::ranges::equal(derived.twin, own.twin));
  CHECK(std::ranges::equal(derived.edges, own.edges,
                           [](const auto& a, const auto& b) { return a.a == b.a && a.b == b.b; }));
  CHECK(std::ranges::equal(derived.componentOf, own.componentOf));
  CHECK(std::ranges::equal(derived.componentClosed, own.componentClosed));
}

}  // namespace

TEST_CASE("topology keeps its promises on solids") {
  checkInvariants(makeBox({1, 2, 3}, 4));
  checkInvariants(makeTorus(2, 0.5, 12, 8));
  checkInvariants(merge({makeSphere(1, 2), makeGear(9, 3, 0.4, 1, 1)}));
}

TEST_CASE("topology keeps its promises on soups and on hubs with many edges") {
  std::mt19937 random(11);
  for (int round = 0; round < 50; ++round) {
    MeshArrays soup;
    const std::uint32_t points = 3 + static_cast<std::uint32_t>(random() % 60);
    for (std::uint32_t i = 0; i < points; ++i)
      soup.vertices.push_back(
          {static_cast<float>(random() % 4), static_cast<float>(random() % 4), static_cast<float>(random() % 3)});
    const auto any = [&] { return static_cast<std::uint32_t>(random() % points); };
    for (int i = 0; i < 150; ++i) soup.triangles.push_back({{round % 2 ? 0 : any(), any(), any()}});
    checkInvariants(soup);
  }
  checkInvariants(makeCylinder(1, 1, 500));
}

TEST_CASE("components are found by edges and know their volume") {
  const MeshArrays box = makeBox({1, 1, 1});
  // Sharing a corner only: two components.
  const MeshArrays two = merge({box, transformed(makeBox({2, 2, 2}), {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1.5, 1.5, 1.5}})});
  const Topology topology = buildTopology(two.vertices, two.triangles);
  REQUIRE(topology.componentCount() == 2);
  CHECK(topology.componentVolume[0] == Approx(1));
  CHECK(topology.componentVolume[1] == Approx(8));
  CHECK(topology.componentOf[0] == 0);
  CHECK(topology.componentOf[topology.componentOf.size() - 1] == 1);
}
