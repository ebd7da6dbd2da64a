// SPDX-License-Identifier: BSD-3-Clause
// Regions of contact against a quadratic reading of their definition.
#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include "collide/pairwise/contact_regions.h"
#include "support/catch.h"
#include "support/contact_samples.h"

using namespace otg;
using namespace otg::test;

namespace {

std::shared_ptr<const CollisionMesh> meshOf(const std::vector<Vec3f>& vertices,
                                            const std::vector<Triangle>& triangles) {
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  input.indices = triangles.data();
  input.triangleCount = triangles.size();
  const MeshResult result = buildTriMesh(input);
  REQUIRE(result.mesh);
  return std::make_shared<const CollisionMesh>(result.mesh, BuildStrategy::kSah);
}

/// n x n cells in the plane z = 0, two triangles each: an open sheet.
std::shared_ptr<const CollisionMesh> sheet(std::uint32_t n) {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) vertices.push_back({static_cast<float>(x), static_cast<float>(y), 0});
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t v = y * (n + 1) + x;
      triangles.push_back({{v, v + 1, v + n + 2}});
      triangles.push_back({{v, v + n + 2, v + n + 1}});
    }
  }
  return meshOf(vertices, triangles);
}

/// Pages of a book: every triangle uses the one edge, every second one in the opposite direction.
std::shared_ptr<const CollisionMesh> book(std::uint32_t pages) {
  std::vector<Vec3f> vertices = {{0, 0, 0}, {0, 0, 1}};
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < pages; ++i) {
    const double angle = 6.0 * i / pages;
    vertices.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.5f});
    triangles.push_back(i % 2 ? Triangle{{0, 1, i + 2}} : Triangle{{1, 0, i + 2}});
  }
  return meshOf(vertices, triangles);
}

bool meets(const TriMesh& mesh, std::uint32_t t, std::uint32_t u) {
  if (t == u) return true;
  const auto edges = [&](std::uint32_t triangle) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> result;
    const Triangle& corners = mesh.triangles()[triangle];
    for (int k = 0; k < 3; ++k) result.insert(std::minmax(corners.v[k], corners.v[(k + 1) % 3]));
    return result;
  };
  const auto first = edges(t), second = edges(u);
  return std::any_of(first.begin(), first.end(), [&](const auto& e) { return second.count(e) > 0; });
}

std::vector<std::uint32_t> naiveRegions(const TriMesh& a, const TriMesh& b, const std::vector<TrianglePair>& pairs) {
  std::vector<std::uint32_t> label(pairs.size(), kNone);
  std::uint32_t next = 0;
  for (std::size_t seed = 0; seed < pairs.size(); ++seed) {
    if (label[seed] != kNone) continue;
    std::vector<std::size_t> open = {seed};
    label[seed] = next;
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      for (std::size_t j = 0; j < pairs.size(); ++j) {
        if (label[j] == kNone && meets(a, pairs[i].a, pairs[j].a) && meets(b, pairs[i].b, pairs[j].b)) {
          label[j] = next;
          open.push_back(j);
        }
      }
    }
    ++next;
  }
  return label;
}

void fillContacts(Workspace& workspace) {
  workspace.contacts.clear();
  for (const TrianglePair& p : workspace.intersecting) {
    workspace.contacts.push_back(makeContact({0, 0, 0}, {0, 0, 1}, 0.1, p.a, p.b, 12345));
  }
}

void compare(const CollisionMesh& a, const CollisionMesh& b, double density, std::uint32_t seed) {
  Draw draw(seed);
  Query query;
  query.a = &a;
  query.b = &b;
  Workspace workspace;
  for (std::uint32_t i = 0; i < a.mesh().triangleCount(); ++i) {
    for (std::uint32_t j = 0; j < b.mesh().triangleCount(); ++j) {
      if (draw.uniform(0, 1) < density) workspace.intersecting.push_back({i, j});
    }
  }
  fillContacts(workspace);
  assignRegions(query, workspace);
  const std::vector<std::uint32_t> expected = naiveRegions(a.mesh(), b.mesh(), workspace.intersecting);
  std::vector<std::uint32_t> found;
  for (const Contact& c : workspace.contacts) found.push_back(c.region);
  CHECK(found == expected);
}

}  // namespace

TEST_CASE("regions agree with the definition on random sets of pairs") {
  const auto small = sheet(3), large = sheet(4), pages = book(15);
  std::uint32_t seed = 0;
  for (const double density : {0.01, 0.05, 0.1, 0.3}) {
    compare(*small, *large, density, ++seed);
    compare(*large, *small, density, ++seed);
    compare(*small, *pages, density, ++seed);
    compare(*pages, *small, density, ++seed);
    compare(*pages, *pages, density, ++seed);
  }
}

TEST_CASE("regions are numbered by the contacts that exist, in the order of their pairs") {
  const auto mesh = sheet(8);
  Query query;
  query.a = query.b = mesh.get();
  Workspace workspace;
  // Triangles 2 k and 2 k + 1 share their cell's diagonal; cells 0, 20 and 40 are far apart.
  workspace.intersecting = {{0, 0}, {0, 1}, {1, 1}, {40, 40}, {41, 41}, {80, 0}, {81, 0}};
  fillContacts(workspace);
  workspace.contacts.erase(workspace.contacts.begin() + 3, workspace.contacts.begin() + 5);  // region without contacts
  std::reverse(workspace.contacts.begin(), workspace.contacts.end());
  assignRegions(query, workspace);
  for (const Contact& c : workspace.contacts) CHECK(c.region == (c.triangleA >= 80 ? 1u : 0u));
}

TEST_CASE("two contacts of one pair share its region, and nothing gives nothing") {
  const auto mesh = sheet(2);
  Query query;
  query.a = query.b = mesh.get();
  Workspace workspace;
  assignRegions(query, workspace);
  CHECK(workspace.contacts.empty());
  workspace.intersecting = {{3, 4}};
  fillContacts(workspace);
  workspace.contacts.push_back(workspace.contacts[0]);
  assignRegions(query, workspace);
  CHECK(workspace.contacts[0].region == 0);
  CHECK(workspace.contacts[1].region == 0);
}

TEST_CASE("many triangles on one edge, and one triangle against very many, are one region") {
  const auto pages = book(20000);
  const auto one = sheet(1);
  Query query;
  query.a = pages.get();
  query.b = one.get();
  Workspace workspace;
  for (std::uint32_t i = 0; i < 20000; ++i) workspace.intersecting.push_back({i, 0});
  fillContacts(workspace);
  assignRegions(query, workspace);
  CHECK(std::all_of(workspace.contacts.begin(), workspace.contacts.end(),
                    [](const Contact& c) { return c.region == 0; }));

  const auto ground = sheet(100);
  query.a = one.get();
  query.b = ground.get();
  workspace.intersecting.clear();
  for (std::uint32_t i = 0; i < 20000; ++i) workspace.intersecting.push_back({0, i});
  fillContacts(workspace);
  assignRegions(query, workspace);
  CHECK(std::all_of(workspace.contacts.begin(), workspace.contacts.end(),
                    [](const Contact& c) { return c.region == 0; }));
}
