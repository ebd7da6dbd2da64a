// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/batch_scenes.h"

#include <numbers>

#include "dispatch/threads/thread_pool.h"
#include "otg_bench/bench.h"
#include "scenes/generated_meshes.h"
#include "scenes/height_grid.h"

namespace otg::cli {
namespace {

Transformd turn(const Vec3d& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  const double x = axis.x, y = axis.y, z = axis.z;
  return {{c + x * x * k, x * y * k - z * s, x * z * k + y * s, y * x * k + z * s, c + y * y * k, y * z * k - x * s,
           z * x * k - y * s, z * y * k + x * s, c + z * z * k},
          {0, 0, 0}};
}

BodyList built(const std::vector<scenes::MeshArrays>& arrays) {
  BodyList bodies;
  for (const scenes::MeshArrays& a : arrays) {
    bodies.push_back(std::make_shared<CollisionMesh>(sortedForLocality(*scenes::build(a)), BuildStrategy::kSah));
  }
  return bodies;
}

/// Puts every pair where `place(i, height)` says, with the height at which it comes apart times `nearer`, or 1.004 for
/// one in four. Heights are looked for from 0 to `most`.
template <class Place>
void bringTogether(std::vector<Query>& queries, double most, double nearer, const Place& place) {
  ThreadPool(defaultThreadCount()).run(queries.size(), 16, [&](std::size_t begin, std::size_t end) {
    Workspace workspace;
    for (std::size_t i = begin; i < end; ++i) {
      Query& query = queries[i];
      double inside = 0, outside = most;
      for (int step = 0; step < 11; ++step) {
        const double middle = 0.5 * (inside + outside);
        query.bInA.t = place(i, middle);
        findIntersectingPairs(query, workspace);
        (workspace.intersecting.empty() ? outside : inside) = middle;
      }
      query.bInA.t = place(i, outside * (i % 4 != 0 ? nearer : 1.004));
    }
  });
}

}  // namespace

BodyList batchBodies() {
  std::vector<scenes::MeshArrays> arrays = {scenes::makeSphere(0.9, 2),
                                            scenes::makeTorus(0.7, 0.25, 24, 12),
                                            scenes::makeCylinder(0.5, 1.4, 64, 6),
                                            scenes::makeGear(20, 0.9, 0.2, 0.4, 0.2),
                                            scenes::makeBox({1, 1.2, 1.4}, 6),
                                            scenes::makeBowl(0.9, 0.15, 24, 8)};
  for (std::uint32_t seed = 1; seed <= 6; ++seed) arrays.push_back(scenes::makeLump(0.9, 3, 0.25, seed));
  for (std::uint32_t seed = 7; seed <= 10; ++seed) arrays.push_back(scenes::makeLump(0.9, 4, 0.25, seed));
  return built(arrays);
}

BodyList overlapBodies() {
  std::vector<scenes::MeshArrays> arrays;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) arrays.push_back(scenes::makeLump(0.9, 4, 0.25, seed));
  return built(arrays);
}

BodyList denseBodies() {
  std::vector<scenes::MeshArrays> arrays = {
      scenes::makeTorus(0.7, 0.25, 100, 100),   scenes::makeCylinder(0.5, 1.4, 96, 40),
      scenes::makeGear(60, 0.9, 0.1, 0.4, 0.3), scenes::makeBowl(0.9, 0.1, 64, 24),
      scenes::makeBolt(0.4, 0.1, 1, 48),        scenes::makeSphere(0.9, 5)};
  for (std::uint32_t seed = 21; seed <= 24; ++seed) arrays.push_back(scenes::makeLump(0.9, 5, 0.3, seed));
  BodyList bodies = batchBodies();
  const BodyList more = built(arrays);
  bodies.insert(bodies.end(), more.begin(), more.end());
  return bodies;
}

BodyList nutAndBolt() {
  return built({scenes::makeBolt(8, 2, 40, 192), scenes::makeNut(8, 2, 13, 0.1, 192)});
}

std::vector<Query> nutBoltQueries(const BodyList& bodies, int pairs) {
  constexpr double kPitch = 2, kPressed = 0.05;
  Random random(6);
  std::vector<Query> queries;
  for (int i = 0; i < pairs; ++i) {
    Query query;
    query.a = bodies[0].get();
    query.b = bodies[1].get();
    query.options.maxContacts = kBatchContacts;
    const double turns = random.uniform(0, 1);
    query.bInA = turn({0, 0, 1}, 2 * std::numbers::pi * turns);
    query.bInA.t = {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02),
                    kPitch * (4 + turns) - kPressed + random.uniform(-0.02, 0.02)};
    queries.push_back(query);
  }
  return queries;
}

std::vector<Query> batchQueries(const BodyList& bodies, int pairs, double nearer) {
  Random random(2);
  std::vector<Query> queries;
  std::vector<Vec3d> ways;
  for (int i = 0; i < pairs; ++i) {
    Query query;
    query.a = bodies[random.below(bodies.size())].get();
    query.b = bodies[random.below(bodies.size())].get();
    query.options.maxContacts = kBatchContacts;
    const double angle = random.uniform(0, 3);
    query.bInA = turn(random.direction(), angle);
    ways.push_back(random.direction());
    queries.push_back(query);
  }
  bringTogether(queries, 2.5, nearer, [&](std::size_t i, double apart) { return otgScale(ways[i], apart); });
  return queries;
}

BodyList stackBodies() {
  return built({scenes::makeBox({1, 1, 1}, 1), scenes::makeBox({1, 0.8, 0.5}, 1), scenes::makeBox({0.8, 0.8, 0.8}, 2),
                scenes::makeBox({20, 20, 1}, 1)});
}

std::vector<Query> stackQueries(const BodyList& boxes, int pairs) {
  Random random(4);
  std::vector<Query> queries;
  for (int i = 0; i < pairs; ++i) {
    Query query;
    query.a = boxes[i % 10 == 0 ? boxes.size() - 1 : random.below(boxes.size() - 1)].get();
    query.b = boxes[random.below(boxes.size() - 1)].get();
    query.options.maxContacts = kBatchContacts;
    query.bInA = i % 4 == 0 ? turn({0, 0, 1}, random.uniform(0, 3)) : Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
    if (i % 3 == 0) {
      const Transformd shaken = turn(random.direction(), 1e-6);
      query.bInA = i % 4 == 0 ? query.bInA : shaken;
    }
    const auto z = [](float x) { return static_cast<double>(x); };
    query.bInA.t = {i % 2 != 0 ? random.uniform(-0.2, 0.2) : 0, 0,
                    z(query.a->mesh().boundsMax().z) - z(query.b->mesh().boundsMin().z) - 1e-5};
    queries.push_back(query);
  }
  return queries;
}

BodyList terrainBodies() {
  scenes::HeightGrid grid;
  grid.sizeX = grid.sizeY = 40;
  grid.columns = grid.rows = 101;
  scenes::setRoughHeights(grid, 0.5, 8, 1);
  BodyList bodies = built({scenes::sheetOf(grid)});
  const BodyList others = batchBodies();
  bodies.insert(bodies.end(), others.begin(), others.end());
  return bodies;
}

std::vector<Query> terrainQueries(const BodyList& bodies, int pairs) {
  Random random(5);
  std::vector<Query> queries;
  std::vector<Vec3d> places;
  for (int i = 0; i < pairs; ++i) {
    Query query;
    query.a = bodies[0].get();
    query.b = bodies[1 + random.below(bodies.size() - 1)].get();
    query.options.maxContacts = kBatchContacts;
    const double angle = random.uniform(0, 3);
    query.bInA = turn(random.direction(), angle);
    places.push_back({random.uniform(-19.2, 19.2), random.uniform(-19.2, 19.2), 0});
    queries.push_back(query);
  }
  // Heights are from 1 m below the terrain's middle.
  bringTogether(queries, 4, 0.98, [&](std::size_t i, double height) {
    return Vec3d{places[i].x, places[i].y, height - 1};
  });
  return queries;
}

}  // namespace otg::cli
