// SPDX-License-Identifier: BSD-3-Clause
// `otg bench small`: pairs of small bodies, one dCollide at a time: ODE's own shape, its dTriMesh, and our mesh.
#include <fmt/format.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <numbers>
#include <random>

#include "base/vectors.h"
#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "primitives/convex_hull.h"
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

struct SmallOptions {
  bool json = false;
  int poses = 64, repeat = 31, calls = 20;
  std::uint32_t seed = 1;
  std::string pair;
};

/// A ball of circles of latitude, 2 segments (rings - 1) triangles.
scenes::MeshArrays makeBall(double radius, int segments, int rings) {
  scenes::MeshArrays mesh;
  mesh.vertices.push_back({0, 0, static_cast<float>(radius)});
  for (int i = 1; i < rings; ++i) {
    const double down = std::numbers::pi * i / rings;
    for (int j = 0; j < segments; ++j) {
      const double round = 2 * std::numbers::pi * j / segments;
      mesh.vertices.push_back({static_cast<float>(radius * std::sin(down) * std::cos(round)),
                               static_cast<float>(radius * std::sin(down) * std::sin(round)),
                               static_cast<float>(radius * std::cos(down))});
    }
  }
  mesh.vertices.push_back({0, 0, static_cast<float>(-radius)});
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  const auto at = [&](int ring, int j) { return static_cast<std::uint32_t>(1 + (ring - 1) * segments + j % segments); };
  for (int j = 0; j < segments; ++j) {
    mesh.triangles.push_back({{0, at(1, j), at(1, j + 1)}});
    for (int i = 1; i < rings - 1; ++i) {
      mesh.triangles.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1)}});
      mesh.triangles.push_back({{at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
    }
    mesh.triangles.push_back({{last, at(rings - 1, j + 1), at(rings - 1, j)}});
  }
  return mesh;
}

scenes::MeshArrays makeHull(std::mt19937& random, int points) {
  std::normal_distribution<double> normal;
  std::vector<Vec3d> places;
  places.reserve(static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) places.push_back(unit(Vec3d{normal(random), normal(random), normal(random)}) * 0.5);
  scenes::MeshArrays mesh;
  for (const Vec3d& p : places) {
    mesh.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  for (const auto& t : convexHull(places)) mesh.triangles.push_back({{t[0], t[1], t[2]}});
  return mesh;
}

Transformd rotationAbout(const Vec3d& axis, double angle, const Vec3d& t) {
  const double s = std::sin(angle / 2), w = std::cos(angle / 2), x = s * axis.x, y = s * axis.y, z = s * axis.z;
  return {
      {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
       2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
      t};
}

struct SmallPair {
  std::string name;
  scenes::MeshArrays mesh;
  std::function<dGeomID()> native;  ///< empty: ODE has no such shape
  std::function<Transformd(std::mt19937&)> pose;
};

Vec3d anyDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return unit(Vec3d{normal(random), normal(random), normal(random)});
}

std::vector<SmallPair> smallPairs(const SmallOptions& options) {
  const auto box = [] { return dCreateBox(nullptr, 1, 1, 1); };
  const auto ball = [] { return dCreateSphere(nullptr, 0.5); };
  const auto trembling = [](double by) {
    return [by](std::mt19937& random) {
      std::uniform_real_distribution<double> uniform(-by, by);
      return rotationAbout(anyDirection(random), uniform(random),
                           {uniform(random), uniform(random), 0.999 + 0.1 * uniform(random)});
    };
  };
  const auto along = [](double distance) {
    return [distance](std::mt19937& random) {
      std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
      const Vec3d way = anyDirection(random) * distance;
      return rotationAbout(anyDirection(random), angle(random), way);
    };
  };
  /// Boxes of bodies overlap in all three coordinates, the bodies are apart.
  const auto diagonal = [](double distance) {
    return [distance](std::mt19937& random) {
      std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
      return rotationAbout(anyDirection(random), angle(random), Vec3d{1, 1, 1} * (distance / std::sqrt(3.0)));
    };
  };
  std::mt19937 random(options.seed);
  std::vector<SmallPair> pairs = {
      {"boxes, 12 triangles, aligned", scenes::makeBox({1, 1, 1}), box, trembling(0)},
      {"boxes, 12 triangles, trembling by 1e-4", scenes::makeBox({1, 1, 1}), box, trembling(1e-4)},
      {"boxes, 12 triangles, trembling by 0.05", scenes::makeBox({1, 1, 1}), box, trembling(0.05)},
      {"boxes, 3,072 triangles, aligned", scenes::makeBox({1, 1, 1}, 16), box, trembling(0)},
      {"boxes, 3,072 triangles, trembling by 1e-4", scenes::makeBox({1, 1, 1}, 16), box, trembling(1e-4)},
      {"balls, 120 triangles, 2 % in", makeBall(0.5, 10, 7), ball, along(0.98)},
      {"balls, 960 triangles, 2 % in", makeBall(0.5, 24, 21), ball, along(0.98)},
      {"balls, 9,800 triangles, 2 % in", makeBall(0.5, 70, 71), ball, along(0.98)},
      {"geodesic balls, 5,120 triangles, 2 % in", scenes::makeSphere(0.5, 4), ball, along(0.98)},
      {"cylinders, 48 sides, stacked", scenes::makeCylinder(0.5, 1, 48),
       [] { return dCreateCylinder(nullptr, 0.5, 1); }, trembling(1e-4)},
      {"capsules, 24 x 8", scenes::makeCapsule(0.25, 0.5, 24, 8), [] { return dCreateCapsule(nullptr, 0.25, 0.5); },
       along(0.65)},
      {"hulls of 20 points", makeHull(random, 20), {}, along(0.85)},
      {"hulls of 60 points", makeHull(random, 60), {}, along(0.9)},
      {"hulls of 200 points", makeHull(random, 200), {}, along(0.95)},
      {"boxes apart, their bounds overlap", scenes::makeBox({1, 1, 1}), box, diagonal(1.74)},
      {"balls of 960 apart, their bounds overlap", makeBall(0.5, 24, 21), ball, diagonal(1.3)},
      {"balls of 960, apart by 1 %", makeBall(0.5, 24, 21), ball, along(1.01)},
      {"tori, 1,152 triangles, crossed", scenes::makeTorus(0.4, 0.1, 36, 16), {}, along(0.9)},
      {"tori apart, their bounds overlap", scenes::makeTorus(0.4, 0.1, 36, 16), {}, diagonal(1.3)},
  };
  if (!options.pair.empty()) {
    std::erase_if(pairs, [&](const SmallPair& p) { return p.name.find(options.pair) == std::string::npos; });
  }
  return pairs;
}

using Pairs = std::vector<std::pair<dGeomID, dGeomID>>;

struct SmallTimes {
  double us = 0, contacts = 0;
};

/// The median over runs of the mean of all pairs, each queried several times. `moves`: the second geom is put
/// a little elsewhere before each call, as bodies at rest tremble.
SmallTimes timeAll(const Pairs& pairs, const SmallOptions& options, bool moves = false) {
  constexpr int kPlaces = 64;
  dContactGeom contacts[kPlaces];
  std::size_t found = 0;
  int step = 0;
  const auto askAll = [&] {
    found = 0;
    for (const auto& [a, b] : pairs) {
      dVector3 at;
      std::copy_n(dGeomGetPosition(b), 3, at);
      for (int i = 0; i < options.calls; ++i) {
        const double by = 1e-7 * (++step % 3 - 1);
        if (moves) dGeomSetPosition(b, at[0] + by, at[1] + by, at[2] - by);
        found += static_cast<std::size_t>(dCollide(a, b, kPlaces, contacts, sizeof(dContactGeom)));
      }
      if (moves) dGeomSetPosition(b, at[0], at[1], at[2]);
    }
  };
  askAll();
  const double calls = static_cast<double>(pairs.size()) * options.calls;
  const double ms = median(repeatTimes(options.repeat, [&] { return timeOnce(askAll); }));
  return {1e3 * ms / calls, static_cast<double>(found) / calls};
}

Json measureSmall(const SmallPair& pair, const SmallOptions& options) {
  std::mt19937 random(options.seed);
  std::vector<Transformd> poses;
  poses.reserve(static_cast<std::size_t>(options.poses));
  for (int i = 0; i < options.poses; ++i) poses.push_back(pair.pose(random));
  const auto mesh = scenes::build(pair.mesh);
  const dGpuTriMeshDataID data = meshData(*mesh, pair.name);
  const dTriMeshDataID stockData = dGeomTriMeshDataCreate();
  const MeshInput in = pair.mesh.input();
  dGeomTriMeshDataBuildSingle(stockData, in.vertices, sizeof(Vec3f), static_cast<int>(in.vertexCount), in.indices,
                              static_cast<int>(3 * in.triangleCount), sizeof(Triangle));
  const auto pairsOf = [&](const std::function<dGeomID()>& make) {
    Pairs pairs;
    for (const Transformd& pose : poses) {
      pairs.emplace_back(make(), make());
      poseGeom(pairs.back().first, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});
      poseGeom(pairs.back().second, pose);
    }
    return pairs;
  };
  const auto measure = [&](const std::function<dGeomID()>& make, bool moves = false) {
    const Pairs pairs = pairsOf(make);
    const SmallTimes times = timeAll(pairs, options, moves);
    for (const auto& [a, b] : pairs) {
      dGeomDestroy(a);
      dGeomDestroy(b);
    }
    return times;
  };
  Json row = {{"pair", pair.name}, {"triangles", in.triangleCount}};
  if (pair.native) {
    const SmallTimes native = measure(pair.native);
    row["native_us"] = native.us;
    row["native_contacts"] = native.contacts;
  } else {
    row["native_us"] = row["native_contacts"] = nullptr;
  }
  const SmallTimes stock = measure([&] { return dCreateTriMesh(nullptr, stockData, nullptr, nullptr, nullptr); });
  const SmallTimes ours = measure([&] { return dCreateGpuTriMesh(nullptr, data); });
  const SmallTimes moved = measure([&] { return dCreateGpuTriMesh(nullptr, data); }, true);
  dGpuTriMeshDataDestroy(data);
  dGeomTriMeshDataDestroy(stockData);
  // The query alone, and the stages for any solids.
  const CollisionMesh body(mesh, BuildStrategy::kSah);
  Workspace workspace;
  const auto alone = [&](bool convexPath) {
    const auto askAll = [&] {
      for (const Transformd& pose : poses) {
        Query query;
        query.a = query.b = &body;
        query.bInA = pose;
        query.options.contacts = ContactModel::kSolid;
        query.options.solid.convexPath = convexPath;
        for (int i = 0; i < options.calls; ++i) collide(query, workspace);
      }
    };
    askAll();
    const double ms = median(repeatTimes(options.repeat, [&] { return timeOnce(askAll); }));
    return 1e3 * ms / (static_cast<double>(poses.size()) * options.calls);
  };
  row["stock_us"] = stock.us;
  row["stock_contacts"] = stock.contacts;
  row["ours_us"] = ours.us;
  row["ours_contacts"] = ours.contacts;
  row["ours_moved_us"] = moved.us;
  row["query_us"] = alone(true);
  row["any_solids_us"] = alone(false);
  return row;
}

int benchSmall(const SmallOptions& options) {
  const scenes::OdeSession session;
  dSetMessageHandler([](int, const char*, va_list) {});  // what a dTriMesh says of buckets that are full
  Json rows = Json::array();
  const std::vector<SmallPair> pairs = smallPairs(options);
  Progress all(pairs.size());
  for (const SmallPair& pair : pairs) {
    rows.push_back(measureSmall(pair, options));
    all.step();
  }
  dSetMessageHandler(nullptr);
  if (options.json) {
    printJson({{"bench", "small"}, {"tables", {{"pairs", rows}}}});
  } else {
    printTable("Pairs of small bodies: microseconds of a dCollide, contacts", rows);
  }
  return 0;
}

}  // namespace

void addBenchSmall(CLI::App& bench, Action& action) {
  CLI::App* command =
      bench.add_subcommand("small", "Pairs of small bodies: ODE's shapes, its dTriMesh, and our meshes");
  auto options = std::make_shared<SmallOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--poses", options->poses, "Poses of each pair")->check(CLI::Range(1, 100000));
  command->add_option("--calls", options->calls, "Queries in a row at each pose")->check(CLI::Range(1, 1000000));
  command->add_option("--repeat", options->repeat, "Runs, of which the median counts")->check(CLI::Range(1, 100000));
  command->add_option("--pair", options->pair, "Only pairs whose name contains this");
  command->add_option("--seed", options->seed, "Of the random poses");
  command->callback([options, &action] { action = [options] { return benchSmall(*options); }; });
}

}  // namespace otg::cli
