// SPDX-License-Identifier: BSD-3-Clause
// The phases of the published design one by one, in every mixture with the host's: the host's pairs and contacts.
#include <algorithm>

#include "bvh/layouts.h"
#include "opencl/published/published_design.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/log.h"
#include "support/mesh_samples.h"
#include "support/opencl.h"
#include "support/opencl_scenes.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;
using opencl::LevelsOptions;
using opencl::NearOrder;
using opencl::NearReport;
using opencl::PrefixSums;

namespace {

constexpr NearOrder kOrders[] = {NearOrder::kContactsFirst, NearOrder::kFilterFirst};

opencl::Backend& shared() {
  static const std::shared_ptr<opencl::Backend> backend = openBackend();
  REQUIRE(backend);
  return *backend;
}

std::vector<TrianglePair> sorted(std::vector<TrianglePair> pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// All that follows a middle phase, in both orders, for candidates that are there.
void checkNear(opencl::Backend& backend, const Query& query, const Workspace& host,
               const std::vector<TrianglePair>& candidates) {
  for (const NearOrder order : kOrders) {
    INFO((order == NearOrder::kContactsFirst ? "contacts first" : "filter first"));
    Workspace device;
    device.candidates = candidates;
    CHECK(backend.published().decideCandidates(query, device, order));
    CHECK((device.intersecting == host.intersecting));
    CHECK((device.candidates == candidates));
    NearReport report;
    CHECK(backend.published().collideCandidates(query, device, order, &report));
    CHECK((device.intersecting == host.intersecting));
    checkSame(device, host);
    CHECK(report.candidates <= candidates.size());
    CHECK(report.records >= host.intersecting.size());
    CHECK(report.bytesSent == report.triangles * 48 + report.candidates * 8);
    CHECK(report.triangles <= query.a->mesh().triangleCount() + query.b->mesh().triangleCount());
  }
}

/// Candidates by levels from trees on the device and from trees that are sent, and each of them with either near phase.
void checkMixtures(opencl::Backend& backend, const Query& query, const Workspace& host, std::uint32_t startDepth) {
  Workspace middle;
  middlePhase(query, middle);
  checkNear(backend, query, host, middle.candidates);
  for (const bool isSent : {false, true}) {
    INFO((isSent ? "sent" : "resident"));
    Workspace device;
    LevelsOptions how;
    how.startDepth = startDepth;
    how.sendTrees = isSent;
    how.prefixSums = isSent ? PrefixSums::kSinglePass : PrefixSums::kWorkEfficient;
    CHECK(backend.published().findCandidatesByLevels(query, device, how));
    const std::vector<TrianglePair> found = sorted(device.candidates);
    CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
    CHECK(device.stats.candidatePairs == found.size());
    Query same = query;
    same.options.middle = {isSent ? Traversal::kQuantized : Traversal::kStandard, DescentRule::kBoth, 6};
    Workspace byHost;
    middlePhase(same, byHost);
    CHECK((found == sorted(byHost.candidates)));
    nearPhase(query, device);
    CHECK((device.intersecting == host.intersecting));
    checkNear(backend, query, host, found);
  }
}

}  // namespace

TEST_CASE("named scenes have the host's contacts in every mixture of phases") {
  std::size_t pairs = 0;
  for (const Scene& scene : makeScenes()) {
    INFO(scene.name);
    const auto a = collisionMesh(scene.a), b = collisionMesh(scene.b);
    for (const ContactModel model : {ContactModel::kPairwise, ContactModel::kSolid}) {
      Query query = makeQuery(*a, *b, scene.bInA);
      query.options.contacts = model;
      query.options.solid.convexPath = false;
      query.options.maxContacts = 20;
      Workspace host;
      collide(query, host);
      checkMixtures(shared(), query, host, 3);
      pairs += host.intersecting.size();
    }
  }
  CHECK(pairs > 3000);
  CHECK(shared().counts().onHost == 0);
}

TEST_CASE("meshes of every kind have the host's contacts in both orders of the near phase") {
  std::vector<samples::NamedMesh> meshes = samples::ordinaryMeshes();
  for (samples::NamedMesh& mesh : samples::pathologicalMeshes()) {
    if (mesh.mesh->triangleCount() <= 1100) meshes.push_back(std::move(mesh));
  }
  std::vector<std::shared_ptr<CollisionMesh>> trees;
  for (const samples::NamedMesh& mesh : meshes) {
    trees.push_back(std::make_shared<CollisionMesh>(mesh.mesh, BuildStrategy::kSah));
  }
  Draw draw(3);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    for (std::size_t j = 0; j < trees.size(); ++j) {
      if (trees[i]->mesh().triangleCount() * trees[j]->mesh().triangleCount() > 1000000) continue;
      INFO(meshes[i].name << " and " << meshes[j].name);
      const Vec3f ca = trees[i]->mesh().center(), cb = trees[j]->mesh().center();
      const double reach = std::min({trees[i]->mesh().radius(), trees[j]->mesh().radius(), 1e30f});
      const Transformd pose = makeQuarterTurn(draw.below(24), {0, 0, 0});
      const Vec3d moved = otgTransform(pose, Vec3d{cb.x, cb.y, cb.z});
      const Vec3d jitter = draw.inBox(0.3 * reach);
      Query query = makeQuery(*trees[i], *trees[j], pose);
      query.bInA.t = {ca.x - moved.x + jitter.x, ca.y - moved.y + jitter.y, ca.z - moved.z + jitter.z};
      Workspace host, middle;
      collide(query, host);
      middlePhase(query, middle);
      checkNear(shared(), query, host, middle.candidates);
      pairs += host.intersecting.size();
    }
  }
  CHECK(pairs > 3000);
  CHECK(shared().counts().onHost == 0);
}

TEST_CASE("scaled images have the host's candidates and contacts in every mixture") {
  const CollisionMesh lump(build(makeLump(1, 3, 0.2, 1)), BuildStrategy::kSah);
  const CollisionMesh torus(build(makeTorus(1, 0.3, 31, 17)), BuildStrategy::kSah);
  for (const Vec3f by : {Vec3f{1.4f, 0.7f, 1}, Vec3f{-1, 1.1f, 0.6f}}) {
    const CollisionMesh image(samples::scaledMesh(lump.mesh(), by), lump, by);
    const Query query = makeQuery(image, torus, makePose({0.48, 0.6, 0.64}, 0.7, {0.9, 0.4, 0.1}));
    Workspace host, middle, device;
    collide(query, host);
    REQUIRE(host.intersecting.size() > 20);
    middlePhase(query, middle);
    checkNear(shared(), query, host, middle.candidates);
    for (const bool isSent : {false, true}) {
      LevelsOptions how;
      how.sendTrees = isSent;
      CHECK(shared().published().findCandidatesByLevels(query, device, how));
      nearPhase(query, device);
      CHECK((device.intersecting == host.intersecting));
    }
  }
}

TEST_CASE("only what a step needs is sent") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  const Query two = makeQuery(*lump, *torus, makeMove({0.7, 0.1, 0})), one = makeQuery(*lump, *lump, two.bInA);
  const auto nodes = [](const CollisionMesh& mesh) { return 2 * mesh.mesh().triangleCount() - 1; };
  const auto backend = openBackend();
  REQUIRE(backend);
  Workspace workspace;
  opencl::LevelsReport report;
  LevelsOptions how;
  how.sendTrees = true;
  const std::uint64_t starts = 2 * 64 * 4, steps = 2 * 16;
  for (int round = 0; round < 2; ++round) {
    CHECK(backend->published().findCandidatesByLevels(two, workspace, how, &report));
    CHECK(report.bytesSent == 16 * (nodes(*lump) + nodes(*torus)) + 2 * steps + starts);
    CHECK(backend->published().findCandidatesByLevels(one, workspace, how, &report));  // the same mesh twice: once
    CHECK(report.bytesSent == 16 * nodes(*lump) + steps + starts);
  }
  NearReport near;
  CHECK(backend->published().collideCandidates(one, workspace, NearOrder::kContactsFirst, &near, true));
  CHECK(near.candidates == workspace.candidates.size());
  CHECK(near.bytesSent < 16 * nodes(*lump));
  CHECK(near.times.total > 0);
  CHECK(backend->counts().meshUploads == 0);
}

TEST_CASE("a near phase whose lists are too short, without doubles, with nothing to do") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  const Query query = makeQuery(*lump, *torus, makeMove({0.7, 0.1, 0}));
  Workspace host, middle, none;
  collide(query, host);
  middlePhase(query, middle);
  REQUIRE(host.intersecting.size() > 50);
  opencl::Tuning tuning;
  tuning.hitPlaces = 1;
  tuning.recordsExpected = 1;
  const auto small = openBackend(tuning);
  checkNear(*small, query, host, middle.candidates);
  CHECK(small->counts().repeats > 0);
  tuning.doubles = false;
  checkNear(*openBackend(tuning), query, host, middle.candidates);
  const Query apart = makeQuery(*lump, *torus, makeMove({9, 0, 0}));
  collide(apart, none);
  checkNear(shared(), apart, none, {});
  // Candidates from anywhere: pairs that are far from each other, too.
  std::vector<TrianglePair> many = middle.candidates;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const TrianglePair pair{i, 7 * i % 1000};
    if (std::find(many.begin(), many.end(), pair) == many.end()) many.push_back(pair);
  }
  checkNear(shared(), query, host, many);
}

TEST_CASE("a query with more candidates than it may have is refused as on the host") {
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 61, 29));
  Query query = makeQuery(*lump, *torus, makeMove({0.7, 0.1, 0}));
  query.options.middle.maxPairs = 10;
  Workspace workspace;
  CHECK_THROWS_AS(shared().published().findCandidatesByLevels(query, workspace), TooManyPairs);
  CHECK_THROWS_AS(shared().findCandidates(query, workspace), TooManyPairs);
}

TEST_CASE("whichever call of a phase alone fails, the pairs and contacts are the host's") {
  opencl::forgetFailures();
  opencl::setLogSink([](const std::string&) {});
  const auto lump = collisionMesh(makeLump(1, 3, 0.2, 3)), torus = collisionMesh(makeTorus(0.9, 0.4, 31, 17));
  const Query query = makeQuery(*lump, *torus, makeMove({0.7, 0.1, 0}));
  Workspace host;
  collide(query, host);
  REQUIRE(host.intersecting.size() > 10);
  const auto backend = openBackend();
  std::size_t failed = 0;
  for (std::uint64_t n = 0; n <= 60; ++n) {
    Workspace device;
    LevelsOptions how;
    how.sendTrees = n % 2 == 0;
    how.prefixSums = PrefixSums::kSinglePass;
    opencl::FaultInjection::failAt(n, CL_OUT_OF_RESOURCES, n % 3 == 0 ? 1000000 : 0);
    bool good = backend->published().findCandidatesByLevels(query, device, how);
    opencl::FaultInjection::failAt(n % 20, CL_OUT_OF_RESOURCES, 0);
    good = backend->published().collideCandidates(query, device, kOrders[n % 2]) && good;
    opencl::FaultInjection::failAt(0);
    failed += good ? 0 : 1;
    REQUIRE(sameBytes(device.reduced, host.reduced));
  }
  CHECK(failed > 20);
  opencl::setLogSink({});
}
