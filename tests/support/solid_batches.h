// SPDX-License-Identifier: BSD-3-Clause
// What tests of batches of the model `solid` share.
#pragma once

#include "support/opencl.h"

namespace otg::test {

using MeshList = std::vector<std::shared_ptr<const CollisionMesh>>;

inline std::vector<std::vector<Contact>> onHost(const std::vector<Query>& queries) {
  std::vector<std::vector<Contact>> contacts;
  Workspace workspace;
  for (const Query& query : queries) {
    collide(query, workspace);
    contacts.push_back(workspace.reduced);
  }
  return contacts;
}

inline bool same(const SolidHistory::State& x, const SolidHistory::State& y) {
  return x.escape == y.escape && x.escapeLeft == y.escapeLeft && x.clampLeft == y.clampLeft &&
         x.deepNormal == y.deepNormal && x.hasPose == y.hasPose && x.pose.t == y.pose.t;
}

inline std::size_t countWrong(const opencl::BatchAnswer& answer, const std::vector<std::vector<Contact>>& expected) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) wrong += sameBytes(answer.of(i), expected[i]) ? 0 : 1;
  return wrong;
}

/// Runs the batch; how many pairs the device finished by itself.
inline std::size_t checkBatch(opencl::Backend& backend, const std::vector<Query>& queries,
                              const std::vector<std::vector<Contact>>& expected) {
  opencl::BatchAnswer answer;
  CHECK(backend.collideBatch(queries, answer));
  REQUIRE(answer.size() == queries.size());
  CHECK(countWrong(answer, expected) == 0);
  CHECK(backend.counts().onHost == 0);
  return queries.size() - answer.leftToHost;
}

}  // namespace otg::test
