// SPDX-License-Identifier: BSD-3-Clause
// Meshes whose vertices move while they are resident: only what has changed is sent, and answers are the host's.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <thread>

#include "opencl/meshes/pack_mesh.h"
#include "opencl/meshes/packed_motion.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "scenes/height_grid.h"
#include "support/solid_batches.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;
using opencl::FaultInjection;

namespace {

/// As the library makes meshes, and to be moved.
std::shared_ptr<CollisionMesh> movable(const MeshArrays& arrays) {
  return std::make_shared<CollisionMesh>(buildTriMesh(arrays.input(), {}, MeshOrder::kLocal).mesh, BuildStrategy::kSah);
}

/// A closed body, one of several components, a sheet, an open mesh with vertices that lie together.
std::vector<std::shared_ptr<CollisionMesh>> movableMeshes() {
  HeightGrid grid;
  grid.sizeX = grid.sizeY = 4;
  grid.columns = grid.rows = 41;
  setRoughHeights(grid, 0.2, 1.2, 1);
  MeshArrays soup = makeSphere(1, 3);
  soup.triangles.resize(soup.triangles.size() - 200);
  std::vector<Vec3f> apart;  // each triangle with vertices of its own
  for (Triangle& t : soup.triangles) {
    for (std::uint32_t& v : t.v) {
      apart.push_back(soup.vertices[v]);
      v = static_cast<std::uint32_t>(apart.size() - 1);
    }
  }
  soup.vertices = apart;
  const Transformd aside{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1.4, 0, 0}};
  return {movable(makeLump(0.9, 4, 0.2, 5)),
          movable(merge({makeSphere(0.6, 3), transformed(makeSphere(0.6, 3), aside)})), movable(sheetOf(grid)),
          movable(soup)};
}

/// Moves about `count` vertices by `most` at most along each axis, those of one point together. Whether that could be
/// done in place.
bool moveAbout(CollisionMesh& mesh, Draw& draw, std::uint32_t count, bool sideBySide, double most = 0.003) {
  const auto vertices = static_cast<std::uint32_t>(mesh.mesh().vertices().size());
  const std::uint32_t first = draw.below(vertices);
  std::vector<std::uint32_t> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t v = sideBySide ? (first + i) % vertices : draw.below(vertices);
    points.push_back(mesh.mesh().topology().weld[v]);
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<Vec3f> to(vertices);
  for (const std::uint32_t p : points) {
    const Vec3f& at = mesh.mesh().vertices()[p];
    const Vec3d by = draw.inBox(most);
    to[p] = {at.x + static_cast<float>(by.x), at.y + static_cast<float>(by.y), at.z + static_cast<float>(by.z)};
  }
  std::vector<MovedVertex> moved;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const std::uint32_t p = mesh.mesh().topology().weld[v];
    if (std::binary_search(points.begin(), points.end(), p)) moved.push_back({v, to[p]});
  }
  return mesh.moveSome(moved);
}

bool sameUnits(std::span<const opencl::MeshUnit> x, std::span<const opencl::MeshUnit> y) {
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size_bytes()) == 0;
}

/// Whether trees have the same nodes, but for their boxes: the fourth words up to the triangles, and of the cut.
bool sameNodes(const opencl::PackedMesh& x, const opencl::PackedMesh& y) {
  if (x.units.size() != y.units.size() || x.place.rings != y.place.rings || x.place.cut != y.place.cut) return false;
  for (std::size_t i = 0; i < x.place.rings; ++i) {
    if (x.units[i].w != y.units[i].w) return false;
  }
  return true;
}

/// What is wrong with the tree of a packed mesh, or with its triangles.
std::string treeFault(const opencl::PackedMesh& packed, const CollisionMesh& mesh) {
  PackedTree tree;
  const auto nodeAt = [&](std::size_t at) {
    const opencl::MeshUnit &c = packed.units[at], &e = packed.units[at + 1];
    return PackedNode{{c.x, c.y, c.z}, static_cast<std::int32_t>(c.w), {e.x, e.y, e.z}, static_cast<std::int32_t>(e.w)};
  };
  for (std::size_t at = packed.place.nodes; at < packed.place.soup; at += 2) tree.nodes.push_back(nodeAt(at));
  for (std::size_t at = packed.place.soup; at < packed.place.cut; at += 3) {
    const std::uint32_t t = packed.units[at].w;
    tree.triangles.push_back(t);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const opencl::MeshUnit corner = opencl::triangleCorner(mesh.mesh(), t, k);
      if (!sameUnits({&packed.units[at + k], 1}, {&corner, 1})) return "an old corner";
    }
  }
  for (std::uint32_t i = 0; i < packed.place.cutCount; ++i) {
    PackedNode node = nodeAt(packed.place.cut + 2 * std::size_t{i});
    const auto number = static_cast<std::uint32_t>(node.first);
    node.first = tree.nodes[number].first;
    if (std::memcmp(&node, &tree.nodes[number], sizeof node) != 0) return "an old node in the cut";
    tree.cut.push_back(number);
  }
  tree.depth = packed.place.depth;
  return validateLayout(tree, mesh.mesh());
}

struct Pairs {
  std::vector<std::shared_ptr<CollisionMesh>> meshes = movableMeshes();
  std::vector<Query> queries;
  Pairs() {
    Draw draw(4);
    for (std::size_t i = 0; i < 24; ++i) {
      const CollisionMesh &a = *meshes[i % 4], &b = *meshes[(i / 4) % 2];
      Query query = makeQuery(a, b, makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(1)));
      query.options.contacts = ContactModel::kSolid;
      query.options.maxContacts = 16;
      queries.push_back(query);
    }
  }
};

}  // namespace

TEST_CASE("what has changed of a packed mesh makes of it what packing anew makes") {
  Draw draw(3);
  int whole = 0, tails = 0, none = 0;
  for (const auto& mesh : movableMeshes()) {
    mesh->adjacency();
    REQUIRE(moveAbout(*mesh, draw, 1, true));
    std::shared_ptr<const opencl::PackedPlaces> places;
    opencl::PackedMesh kept = opencl::packMesh(*mesh, opencl::MeshLayout::kEightWide, 4, 0, &places);
    std::uint64_t seen = mesh->moves();
    for (int step = 0; step < 60; ++step) {
      INFO("step " << step);
      const int moves = 1 + step % 3;
      for (int i = 0; i < moves; ++i) {
        if (!moveAbout(*mesh, draw, 1 + draw.below(12), step % 2 == 0, step % 4 == 3 ? 0.003 : 1e-5)) ++none;
      }
      auto triangles = mesh->changedSince(seen);
      seen = mesh->moves();
      if (!triangles) {  // too many at once
        kept = opencl::packMesh(*mesh, opencl::MeshLayout::kEightWide, 4, 0, &places);
        continue;
      }
      const auto changes = places->changesOf(*mesh, std::move(*triangles));
      REQUIRE(changes);
      std::vector<std::uint32_t> at = changes->at;
      std::sort(at.begin(), at.end());
      CHECK(std::adjacent_find(at.begin(), at.end()) == at.end());
      for (std::size_t i = 0; i < changes->at.size(); ++i) kept.units[changes->at[i]] = changes->units[i];
      const opencl::PackedMesh anew = opencl::packMesh(*mesh, opencl::MeshLayout::kEightWide, 4);
      if (sameNodes(kept, anew)) {
        CHECK(sameUnits(kept.units, anew.units));
        ++whole;
      } else {  // a tree made anew may open other nodes
        CHECK(sameUnits(std::span(kept.units).subspan(kept.place.rings),
                        std::span(anew.units).subspan(anew.place.rings)));
        CHECK(treeFault(kept, *mesh).empty());
        kept = opencl::packMesh(*mesh, opencl::MeshLayout::kEightWide, 4, 0, &places);
        ++tails;
      }
    }
  }
  CHECK(whole > 100);
  CHECK(none < 20);
  INFO(tails << " with other nodes");
}

TEST_CASE("the changes of the last moves are known, up to a share of the mesh") {
  Draw draw(5);
  const auto mesh = movable(makeLump(0.9, 3, 0.2, 5));
  const std::uint64_t before = mesh->moves();
  CHECK(mesh->changedSince(before)->empty());
  CHECK(!mesh->changedSince(before + 1));
  REQUIRE(moveAbout(*mesh, draw, 1, true));
  REQUIRE(mesh->changedSince(before));
  const std::size_t one = mesh->changedSince(before)->size();
  CHECK(one >= 3);
  REQUIRE(moveAbout(*mesh, draw, 1, true));
  CHECK(mesh->changedSince(before)->size() > one);
  CHECK(mesh->changedSince(before + 1)->size() < mesh->changedSince(before)->size());
  const std::weak_ptr<const void> structure = mesh->structure(), lifetime = mesh->lifetime();
  for (int i = 0; i < 60; ++i) moveAbout(*mesh, draw, 5, false);
  CHECK(!mesh->changedSince(before));
  CHECK(mesh->changedSince(mesh->moves() - 1));
  CHECK(mesh->changedSince(mesh->moves() - 2)->size() <= mesh->mesh().triangleCount() / CollisionMesh::kLoggedShare);
  CHECK(!structure.expired());
  CHECK(lifetime.expired());
  REQUIRE(moveAbout(*mesh, draw, 600, true));  // more than the share at once
  CHECK(!mesh->changedSince(mesh->moves() - 1));
  CHECK(mesh->changedSince(mesh->moves())->empty());
}

TEST_CASE("meshes that move between queries have the host's contacts, on devices that saw other moves") {
  Pairs pairs;
  const auto often = openBackend(), seldom = openBackend();
  opencl::Tuning tight;
  tight.meshBudget = 2 << 20;  // for some of the meshes
  const auto small = openBackend(tight);
  REQUIRE((often && seldom && small));
  Draw draw(9);
  for (int step = 0; step < 24; ++step) {
    INFO("step " << step);
    for (const auto& mesh : pairs.meshes) {
      if (draw.below(3) > 0) moveAbout(*mesh, draw, 1 + draw.below(step % 8 == 7 ? 900 : 20), step % 2 == 0);
    }
    const auto expected = onHost(pairs.queries);
    const auto check = [&](opencl::Backend& backend) {
      opencl::BatchAnswer answer;
      CHECK(backend.collideBatch(pairs.queries, answer));
      CHECK(countWrong(answer, expected) == 0);
    };
    check(*often);
    if (step % 5 == 4) check(*seldom);
    if (step % 3 == 2) check(*small);
    for (std::size_t i = 0; i < 3; ++i) checkParity(*often, pairs.queries[draw.below(24)]);
  }
  CHECK(often->counts().meshUpdates > 20);
  CHECK(seldom->counts().meshUpdates > 0);
  CHECK(small->counts().meshEvictions > 0);
  for (const auto& backend : {often, seldom, small}) CHECK(backend->counts().onHost == 0);

  // What is sent follows what has moved.
  const auto sent = [&](std::uint32_t vertices, bool sideBySide) {
    const std::uint64_t before = often->counts().meshBytesSent, uploads = often->counts().meshUploads;
    REQUIRE(moveAbout(*pairs.meshes[0], draw, vertices, sideBySide));
    checkParity(*often, makeQuery(*pairs.meshes[0], *pairs.meshes[0], makePose({0, 0, 1}, 0.3, {1.2, 0.1, 0.2})));
    return std::pair{often->counts().meshBytesSent - before, often->counts().meshUploads - uploads};
  };
  const std::uint64_t mesh = 16 * opencl::packMesh(*pairs.meshes[0], opencl::MeshLayout::kEightWide, 4).units.size();
  CHECK(sent(1, true).first < mesh / 200);
  CHECK(sent(1, true).second == 0);
  CHECK(sent(30, true).first < mesh / 20);
  const auto [most, uploads] = sent(2500, true);  // nearly all of it
  CHECK(most > mesh * 9 / 10);
  CHECK(most < mesh * 11 / 10);
  CHECK(uploads == 1);
  CHECK(sent(1, true).first < mesh / 200);
}

TEST_CASE("the near phase alone tests the triangles that are named where they are now, and keeps no mesh") {
  const auto backend = openBackend();
  REQUIRE(backend);
  const auto ball = movable(makeSphere(1, 3)), other = movable(makeTorus(1, 0.3, 31, 17));
  const std::vector<Vec3f> rest(ball->mesh().vertices().begin(), ball->mesh().vertices().end());
  std::size_t met = 0;
  const auto check = [&](double by) {
    const Query query = makeQuery(*ball, *other, makePose({0.48, 0.6, 0.64}, 0.7, {by, 0.4, 0.1}));
    Workspace host, device;
    middlePhase(query, host);
    device.candidates = host.candidates;
    nearPhase(query, host);
    REQUIRE(backend->decideCandidates(query, device));
    REQUIRE(device.intersecting == host.intersecting);
    met += host.intersecting.size();
  };
  check(0.8);
  // A few vertices at a time, until the ball is another body.
  const auto count = static_cast<std::uint32_t>(rest.size());
  for (std::uint32_t first = 0; first < count; first += 8) {
    std::vector<MovedVertex> moved;
    for (std::uint32_t v = first; v < std::min(count, first + 8); ++v) {
      const Vec3f& p = rest[v];
      moved.push_back({v, {p.x * (1 + 0.3f * std::sin(5 * p.y)), p.y * (1 - 0.3f * std::sin(4 * p.x)), p.z}});
    }
    REQUIRE(ball->moveSome(moved));
    check(0.8);
  }
  CHECK(backend->counts().meshUploads == 0);
  CHECK(met > 1000);
}

TEST_CASE("whichever call fails while a change is sent, the contacts are the same") {
  opencl::forgetFailures();
  opencl::setLogSink([](const std::string&) {});
  Draw draw(2);
  const auto a = movable(makeLump(1, 3, 0.2, 1)), b = movable(makeTorus(1, 0.3, 31, 17));
  const Query query = makeQuery(*a, *b, makePose({0.48, 0.6, 0.64}, 0.7, {1.1, 0.4, 0.1}));
  Workspace host, device;
  int failed = 0;
  std::uint64_t updates = 0;
  for (const bool first : {true, false}) {  // the kernel that places changes is made for the first of them
    auto backend = openBackend();
    REQUIRE(moveAbout(*a, draw, 3, true));
    REQUIRE(backend->collide(query, device));
    for (std::uint64_t n = 1; n <= (first ? 14 : 24); ++n) {
      for (const std::uint64_t more : {std::uint64_t{0}, std::uint64_t{1000000}}) {
        INFO("call " << n << " fails" << (more > 0 ? " and all after it" : ""));
        if (first) {
          backend = openBackend();
          REQUIRE(backend->collide(query, device));
        }
        REQUIRE(moveAbout(*a, draw, 3, true));
        collide(query, host);
        FaultInjection::failAt(n, CL_OUT_OF_RESOURCES, more);
        if (!backend->collide(query, device)) ++failed;
        FaultInjection::failAt(0);
        REQUIRE(sameBytes(device.reduced, host.reduced));
        REQUIRE(backend->collide(query, device));
        REQUIRE(sameBytes(device.reduced, host.reduced));
        updates += backend->counts().meshUpdates;
      }
    }
  }
  opencl::setLogSink({});
  CHECK(failed > 40);
  CHECK(updates > 20);
}

TEST_CASE("threads that meet a moved mesh at once send its changes once") {
  Pairs pairs;
  const auto backend = openBackend();
  REQUIRE(backend);
  Draw draw(6);
  std::atomic<int> wrong{0};
  const auto all = [&](const std::vector<std::vector<Contact>>& expected) {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        Workspace workspace;
        for (std::size_t i = t; i < pairs.queries.size(); i += 4) {
          backend->collide(pairs.queries[i], workspace);
          wrong += sameBytes(workspace.reduced, expected[i]) ? 0 : 1;
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  };
  moveAbout(*pairs.meshes[0], draw, 1, true);
  all(onHost(pairs.queries));
  for (int step = 0; step < 6; ++step) {
    const std::uint64_t before = backend->counts().meshUpdates;
    REQUIRE(moveAbout(*pairs.meshes[0], draw, 4, true));
    all(onHost(pairs.queries));
    CHECK(backend->counts().meshUpdates == before + 1);
  }
  CHECK(wrong == 0);
  CHECK(backend->counts().onHost == 0);
}
