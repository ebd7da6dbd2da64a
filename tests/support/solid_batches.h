// SPDX-License-Identifier: BSD-3-Clause
// What tests of batches of the model `solid` share.
#pragma once

#include <vector>

#include "support/draw.h"
#include "support/opencl.h"

namespace otg::test {

using MeshList = std::vector<std::shared_ptr<const CollisionMesh>>;

/// Pairs that overlap by `depth` of the distance at which they come apart.
inline std::vector<Query> touching(const MeshList& meshes, std::uint32_t seed, std::size_t count, double least,
                                   double most) {
  Draw draw(seed);
  Workspace workspace;
  std::vector<Query> queries;
  const auto any = [&]() -> const CollisionMesh& {
    return *meshes[draw.below(static_cast<std::uint32_t>(meshes.size()))];
  };
  while (queries.size() < count) {
    const CollisionMesh& a = any();
    const CollisionMesh& b = any();
    const Vec3d turn = draw.direction(), way = draw.direction();
    const double angle = draw.uniform(0, 3);
    double inside = 0, outside = 3;
    Query query = makeQuery(a, b, makePose(turn, angle, {0, 0, 0}));
    for (int step = 0; step < 10; ++step) {
      const double middle = 0.5 * (inside + outside);
      query.bInA.t = otgScale(way, middle);
      findIntersectingPairs(query, workspace);
      (workspace.intersecting.empty() ? outside : inside) = middle;
    }
    query.bInA.t = otgScale(way, outside * (1 - draw.uniform(least, most)));
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 16;
    queries.push_back(query);
  }
  return queries;
}

inline std::vector<std::vector<Contact>> onHost(const std::vector<Query>& queries) {
  std::vector<std::vector<Contact>> contacts;
  Workspace workspace;
  for (const Query& query : queries) {
    collide(query, workspace);
    contacts.push_back(workspace.reduced);
  }
  return contacts;
}

/// How many contacts the host finds before it limits them.
inline std::uint64_t foundOnHost(const std::vector<Query>& queries) {
  std::uint64_t found = 0;
  Workspace workspace;
  for (const Query& query : queries) {
    collide(query, workspace);
    found += workspace.stats.contactsBeforeReduction;
  }
  return found;
}

inline bool same(const SolidHistory::State& x, const SolidHistory::State& y) {
  return x.escape == y.escape && x.escapeLeft == y.escapeLeft && x.clampLeft == y.clampLeft &&
         x.deepNormal == y.deepNormal && x.hasPose == y.hasPose && x.isJammed == y.isJammed && x.pose.t == y.pose.t &&
         x.side == y.side && x.front == y.front && x.deepest == y.deepest && x.content == y.content;
}

inline std::size_t countWrong(const opencl::BatchAnswer& answer, const std::vector<std::vector<Contact>>& expected) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) wrong += sameBytes(answer.of(i), expected[i]) ? 0 : 1;
  return wrong;
}

/// Runs the batch; of how many pairs the device made the contacts, whether or not the host made them again.
inline std::size_t checkBatch(opencl::Backend& backend, const std::vector<Query>& queries,
                              const std::vector<std::vector<Contact>>& expected) {
  opencl::BatchAnswer answer;
  CHECK(backend.collideBatch(queries, answer));
  REQUIRE(answer.size() == queries.size());
  CHECK(countWrong(answer, expected) == 0);
  CHECK(backend.counts().onHost == 0);
  return queries.size() - answer.leftToHost + answer.madeAgain;
}

}  // namespace otg::test
