// SPDX-License-Identifier: BSD-3-Clause
// What tests of pairs share whose overlap a device describes, alone and in batches.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "collide/solid/contour.h"
#include "collide/solid/inside.h"
#include "collide/solid/regions.h"
#include "support/mesh_samples.h"
#include "support/solid_batches.h"

namespace otg::test {

/// Fine enough for large regions, and some that are not.
inline MeshList bodies() {
  using namespace scenes;
  MeshList meshes;
  for (const MeshArrays& arrays :
       {makeLump(1, 5, 0.3, 8), makeBox({1, 1.2, 0.9}, 24), makeTorus(0.8, 0.3, 90, 40), makeSphere(0.9, 5),
        makeGear(12, 0.9, 0.2, 0.3, 0.1), makeBowl(0.9, 0.15, 48, 16), makeBox({1, 1, 1}, 1)}) {
    meshes.push_back(collisionMesh(arrays));
  }
  return meshes;
}

inline opencl::Tuning always() {
  opencl::Tuning tuning;
  tuning.overlapHits = 1;
  return tuning;
}

/// Turned by up to 3, and off by `least` to `most`. Drawn one by one: compilers differ in which argument they make
/// first.
inline Transformd poseAround(Draw& draw, double least, double most) {
  const double far = draw.uniform(least, most);
  const Vec3d move = otgScale(draw.direction(), far);
  const double angle = draw.uniform(0, 3);
  return makePose(draw.direction(), angle, move);
}

inline std::vector<Query> overlaps(const MeshList& meshes, std::uint32_t seed, std::size_t count, double reach = 1.1) {
  Draw draw(seed);
  Workspace workspace;
  std::vector<Query> queries;
  const auto any = [&] { return draw.below(static_cast<std::uint32_t>(meshes.size())); };
  while (queries.size() < count) {
    const std::size_t a = any(), b = any();
    Query query = makeQuery(*meshes[a], *meshes[b], poseAround(draw, 0.2, reach));
    findIntersectingPairs(query, workspace);
    if (workspace.intersecting.empty()) continue;
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = static_cast<int>(4 + 20 * draw.below(4));
    queries.push_back(query);
  }
  return queries;
}

/// Pairs with a region whose points leave each by its own face: devices leave them to the host.
inline std::size_t unevenPairs(const std::vector<Workspace>& answers) {
  return static_cast<std::size_t>(
      std::count_if(answers.begin(), answers.end(), [](const Workspace& w) { return w.stats.unevenRegions > 0; }));
}

inline std::vector<Workspace> answersOnHost(const std::vector<Query>& queries) {
  std::vector<Workspace> answers(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) collide(queries[i], answers[i]);
  return answers;
}

/// How many pairs the device described.
inline std::uint64_t checkAll(opencl::Backend& backend, std::span<const Query> queries,
                              std::span<const Workspace> expected) {
  const std::uint64_t before = backend.counts().described;
  Workspace workspace;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    INFO("query " << i);
    CHECK(backend.collide(queries[i], workspace));
    checkSame(workspace, expected[i]);
  }
  CHECK(backend.counts().onHost == 0);
  return backend.counts().described - before;
}

/// Its vertices moved about, so that the surface folds over itself in many places.
inline scenes::MeshArrays crumpled(scenes::MeshArrays arrays, float by, std::uint32_t seed) {
  Draw draw(seed);
  for (Vec3f& v : arrays.vertices) {
    const double far = draw.uniform(0, static_cast<double>(by));
    const Vec3d d = otgScale(draw.direction(), far);
    v = {v.x + static_cast<float>(d.x), v.y + static_cast<float>(d.y), v.z + static_cast<float>(d.z)};
  }
  return arrays;
}

/// The overlap of a pair as the host finds it.
struct HostOverlap {
  Contour contour;
  InsideFlags inside;
  OverlapRegions regions;
  explicit HostOverlap(const Query& query) {
    Workspace workspace;
    RegionBuilder builder;
    const PlacedMeshes meshes(query);
    findIntersectingPairs(query, workspace);
    std::sort(workspace.intersecting.begin(), workspace.intersecting.end());
    traceContour(meshes, workspace.intersecting, contour);
    floodInside(meshes, contour, inside);
    builder.build(meshes, contour, inside, regions);
  }
};

/// What contradicts itself in a pair, as the host finds it.
struct AtOdds {
  bool crossings = false, votes = false, stretches = false;
  bool any() const { return crossings || votes || stretches; }
};
inline AtOdds atOdds(const Query& query) {
  const HostOverlap found(query);
  return {found.contour.anomalies > 0, found.inside.anomalies > 0, found.regions.anomalies > 0};
}

inline bool canDescribe(const opencl::Backend& backend) {
  return backend.device().doubles && backend.device().longAtomics;
}

/// Gives the queries histories and moves them from step to step. `check` gets them, and the same ones with histories
/// for the host; the histories of both sides have to stay the same.
template <class Check>
void checkHistories(std::vector<Query> queries, std::uint32_t seed, int steps, const Check& check) {
  std::vector<Query> forHost = queries;
  std::vector<SolidHistory> onDevice(queries.size()), host(queries.size());
  Draw draw(seed);
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      queries[i].history = &onDevice[i];
      forHost[i].history = &host[i];
      queries[i].relativeVelocity = forHost[i].relativeVelocity = step % 2 != 0 ? draw.direction() : Vec3d{0, 0, 0};
    }
    check(queries, forHost);
    for (std::size_t i = 0; i < queries.size(); ++i) {
      CHECK(onDevice[i].current.escape == host[i].current.escape);
      CHECK(onDevice[i].current.escapeLeft == host[i].current.escapeLeft);
      CHECK(onDevice[i].current.clampLeft == host[i].current.clampLeft);
      CHECK(onDevice[i].current.isJammed == host[i].current.isJammed);
      CHECK(onDevice[i].before.deepNormal == host[i].before.deepNormal);
      CHECK(onDevice[i].current.deepNormal == host[i].current.deepNormal);
      if (step == 2) continue;  // the same pose again
      queries[i].bInA.t = forHost[i].bInA.t = otgAdd(queries[i].bInA.t, otgScale(draw.direction(), 0.02));
    }
  }
}

}  // namespace otg::test
