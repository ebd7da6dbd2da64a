// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/cost/rehearsal.h"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <vector>

#include "dispatch/cost/calibration_mesh.h"
#include "opencl/runtime/stop.h"

namespace otg {
namespace {

struct Bodies {
  std::shared_ptr<const CollisionMesh> a, b;
  explicit Bodies(int steps) : a(calibrationBody(steps, 0)), b(calibrationBody(steps, 1)) {}
  Query at(double distance, ContactModel contacts) const {
    Query query;
    query.a = a.get();
    query.b = b.get();
    query.bInA = Transformd{{1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8}, {0.6 * distance, 0.48 * distance, 0.64 * distance}};
    query.options.contacts = contacts;
    query.options.maxContacts = 64;
    return query;
  }
};

/// Meshes that leave to double arithmetic what it cannot decide, and one that is no solid.
struct FlatThings {
  std::shared_ptr<const CollisionMesh> wedge = calibrationMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                                               {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{0, 3, 2}}});
  std::shared_ptr<const CollisionMesh> sheet =
      calibrationMesh({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {{{0, 1, 2}}, {{0, 2, 3}}});
};

/// One upon the other: `a` and `b` where they were made.
Query inPlace(const CollisionMesh& a, const CollisionMesh& b, ContactModel contacts) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
  query.options.contacts = contacts;
  query.options.maxContacts = 64;
  return query;
}

/// Exact arithmetic: with few open hits and with many, contacts and pairs alone; in batches, too. And a sheet.
bool rehearseFlat(opencl::Backend& backend, const Bodies& small, bool solids) {
  const FlatThings flat;
  Workspace workspace;
  opencl::BatchAnswer answer;
  const Query few = inPlace(*flat.wedge, *flat.wedge, ContactModel::kPairwise);
  const Query many = inPlace(*small.a, *small.a, ContactModel::kPairwise);
  Query asCone = few;
  asCone.options.reduction.method = Reduction::kCone;
  bool good = true;
  for (const Query* query : std::initializer_list<const Query*>{&few, &many, &asCone}) {
    opencl::checkStop();
    good = backend.collide(*query, workspace) && good;
  }
  // A lane's first query with open hits has the host decide them.
  for (int i = 0; i < 2; ++i) good = backend.findIntersectingPairs(few, workspace) && good;
  opencl::checkStop();
  good = backend.collideBatch(std::vector<Query>{few, many, few}, answer) && good;
  if (!solids) return good;
  opencl::checkStop();
  return backend.collideBatch(std::vector<Query>(2, inPlace(*small.a, *flat.sheet, ContactModel::kSolid)), answer) &&
         good;
}

/// Pairs alone, with few hits and with many; twice, because a query goes by what the last one found.
bool rehearsePairs(opencl::Backend& backend, const Bodies& small, const Bodies& large, bool solids) {
  bool good = true;
  Workspace workspace;
  for (const ContactModel contacts : {ContactModel::kPairwise, ContactModel::kSolid}) {
    if (contacts == ContactModel::kSolid && !solids) continue;
    for (const Bodies* bodies : {&small, &large, &large}) {
      opencl::checkStop();
      good = backend.collide(bodies->at(1.4, contacts), workspace) && good;
    }
  }
  return backend.findIntersectingPairs(small.at(1.8, ContactModel::kPairwise), workspace) && good;
}

bool rehearseBatches(opencl::Backend& backend, const Bodies& small, const Bodies& large, bool solids) {
  bool good = true;
  opencl::BatchAnswer answer;
  std::vector<Query> queries;
  for (const double distance : {1.97, 1.4, 0.9}) queries.push_back(small.at(distance, ContactModel::kPairwise));
  queries.push_back(large.at(1.4, ContactModel::kPairwise));
  good = backend.collideBatch(queries, answer) && good;
  std::vector<std::uint8_t> meet;
  good = backend.intersectBatch(queries, meet) && good;
  if (!solids) return good;
  opencl::checkStop();
  for (Query& query : queries) query.options.contacts = ContactModel::kSolid;
  constexpr std::size_t kDescribed = 64;  // fewer are not described
  queries.insert(queries.end(), kDescribed, large.at(1.8, ContactModel::kSolid));
  return backend.collideBatch(queries, answer) && good;
}

bool rehearseArrays(opencl::Backend& backend, const Bodies& small) {
  constexpr std::size_t kCount = 64;
  const auto fillPoints = [](std::size_t begin, std::size_t end, Vec3d* to) {
    std::fill(to, to + (end - begin), Vec3d{0.3, 0.2, 1.1});
  };
  const auto takePoints = [](std::size_t, std::size_t, const Vec3d*, const otg_uint*) {};
  const auto fillRays = [](std::size_t begin, std::size_t end, LongRay* to) {
    std::fill(to, to + (end - begin), LongRay{{{3, 0.1, 0.1}, {-1, 0, 0}}, 10});
  };
  const auto takeRays = [](std::size_t, std::size_t, const LongRay*, const otg_uint*) {};
  const opencl::RunParts run = [](std::size_t count, const auto& work) { work(0, count); };
  bool good = true;
  for (const opencl::PointWish wish : {opencl::PointWish{true, false}, {false, true}, {true, true}}) {
    if (!backend.answersPoints()) break;
    good = backend.askPoints(*small.a, wish, kCount, fillPoints, takePoints) == kCount && good;
  }
  for (const bool cullBack : {false, true}) {
    if (!backend.answersRays()) break;
    good = backend.castRays(*small.a, cullBack, kCount, fillRays, takeRays) == kCount && good;
  }
  if (!backend.answersDistances()) return good;
  const Query apart = small.at(3, ContactModel::kPairwise);
  TrianglePair nearest;
  return backend.nearestTriangles({&apart, 1}, std::numeric_limits<double>::infinity(), {&nearest, 1}, run) == 1 &&
         good;
}

}  // namespace

bool mayDoSolids(const opencl::Backend& backend) {
  return backend.device().kind != opencl::DeviceKind::kCpu && backend.device().doubles;
}

bool rehearse(opencl::Backend& backend) {
  const Bodies small(6), large(36);
  const bool solids = mayDoSolids(backend);
  for (std::size_t failed = backend.failedPrograms();;) {
    if (rehearsePairs(backend, small, large, solids) && rehearseBatches(backend, small, large, solids) &&
        rehearseFlat(backend, small, solids) && rehearseArrays(backend, small)) {
      return true;
    }
    // Once more without what could not be built.
    if (backend.failedPrograms() == failed) return false;
    failed = backend.failedPrograms();
  }
}

}  // namespace otg
