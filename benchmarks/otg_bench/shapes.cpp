// SPDX-License-Identifier: BSD-3-Clause
// `otg bench shapes`: ODE's own shapes on small and on convex meshes, beside a dTriMesh of the same triangles.
#include <fmt/format.h>
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cstdarg>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/contact_hash.h"
#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "scenes/convex_geom.h"
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

struct ShapesOptions {
  bool json = false;
  int poses = 64, repeat = 15, calls = 20;
  double overlap = 0.01;
  std::uint32_t seed = 1;
  std::string pair;
};

constexpr int kPlaces = 64;

struct NamedMesh {
  const char* name;
  scenes::MeshArrays arrays;
  bool isGround;  ///< met from above only
};

struct NamedShape {
  const char* name;
  std::function<dGeomID()> make;
};

scenes::MeshArrays twoTriangles() {
  scenes::MeshArrays mesh;
  mesh.vertices = {{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  return mesh;
}

std::vector<NamedMesh> meshesOfShapes() {
  return {{"2 triangles", twoTriangles(), true},
          {"box, 12", scenes::makeBox({1, 1, 1}), false},
          {"box, 3,072", scenes::makeBox({1, 1, 1}, 16), false},
          {"sphere, 1,280", scenes::makeSphere(0.5, 3), false},
          {"torus, 1,152", scenes::makeTorus(0.4, 0.1, 36, 16), false}};
}

/// A geom and where it goes: planes have no pose.
void put(dGeomID shape, const Vec3d& direction, double height) {
  if (dGeomGetClass(shape) == dPlaneClass) {
    dGeomPlaneSetParams(shape, -direction.x, -direction.y, -direction.z, -height);
  } else {
    dGeomSetPosition(shape, direction.x * height, direction.y * height, direction.z * height);
  }
}

struct ShapePose {
  Transformd turn;
  Vec3d direction;
  double height;
};

/// Anyhow turned, along a direction as near as it touches, then by the overlap nearer. Ours is queried: of a convex,
/// and of what is inside, a dTriMesh gives nothing.
ShapePose drawPose(dGeomID mesh, dGeomID shape, bool isGround, double overlap, truth::Random& random) {
  ShapePose pose{random.rotation(), isGround ? Vec3d{0, 0, 1} : random.direction(), 0};
  if (dGeomGetClass(shape) != dPlaneClass) poseGeom(shape, pose.turn);
  const auto touchesAt = [&](double height) {
    put(shape, pose.direction, height);
    dContactGeom contact;
    return dCollide(mesh, shape, 1, &contact, sizeof contact) > 0;
  };
  pose.height = lastTouch(0, 3, 1e-5, touchesAt) - overlap;
  return pose;
}

struct ShapeTimes {
  double us = 0, contacts = 0;
  Fnv1a hash;
};

/// The median over runs of the mean of all poses, at each of which it is queried several times. `moves`: a little
/// elsewhere for each call, as bodies at rest tremble.
ShapeTimes timeShape(dGeomID mesh, dGeomID shape, const std::vector<ShapePose>& poses, const ShapesOptions& options,
                     bool moves) {
  dContactGeom contacts[kPlaces];
  ShapeTimes out;
  std::size_t found = 0;
  const auto askAll = [&](bool hashes) {
    found = 0;
    for (const ShapePose& pose : poses) {
      if (dGeomGetClass(shape) != dPlaneClass) poseGeom(shape, pose.turn);
      for (int i = 0; i < options.calls; ++i) {
        if (moves || i == 0) put(shape, pose.direction, pose.height + (moves ? 1e-7 * (i % 3) : 0));
        const int count = dCollide(mesh, shape, kPlaces, contacts, sizeof(dContactGeom));
        found += static_cast<std::size_t>(count);
        if (!hashes) continue;
        out.hash.add(count);
        for (int k = 0; k < count; ++k) {
          addToHash(out.hash, contacts[k]);
          out.hash.add(contacts[k].side1);
        }
      }
    }
  };
  askAll(true);
  const double calls = static_cast<double>(poses.size()) * options.calls;
  out.us = 1e3 * median(repeatTimes(options.repeat, [&] { return timeOnce([&] { askAll(false); }); })) / calls;
  out.contacts = static_cast<double>(found) / calls;
  return out;
}

Json measureShape(const NamedMesh& mesh, const NamedShape& named, const ShapesOptions& options) {
  const MeshTwins twins(mesh.arrays);
  const dGeomID shape = named.make();
  truth::Random random(options.seed);
  std::vector<ShapePose> poses;
  poses.reserve(static_cast<std::size_t>(options.poses));
  for (int i = 0; i < options.poses; ++i) {
    poses.push_back(drawPose(twins.ours, shape, mesh.isGround, options.overlap, random));
  }
  const ShapeTimes stock = timeShape(twins.stock, shape, poses, options, true);
  const ShapeTimes moved = timeShape(twins.ours, shape, poses, options, true);
  const ShapeTimes still = timeShape(twins.ours, shape, poses, options, false);
  dGeomDestroy(shape);
  return {{"mesh", mesh.name},
          {"shape", named.name},
          {"us", moved.us},
          {"still_us", still.us},
          {"us_of_dtrimesh", stock.us},
          {"times", moved.us / stock.us},
          {"contacts", moved.contacts},
          {"contacts_of_dtrimesh", stock.contacts},
          {"hash", moved.hash.hex()}};
}

int benchShapes(const ShapesOptions& options) {
  const scenes::OdeSession session;
  dSetMessageHandler([](int, const char*, va_list) {});  // what a dTriMesh says of buckets that are full
  const scenes::ConvexData convex(scenes::makeSphere(0.3, 1));
  const std::vector<NamedShape> shapes = {{"sphere", [] { return dCreateSphere(nullptr, 0.3); }},
                                          {"box", [] { return dCreateBox(nullptr, 0.6, 0.5, 0.4); }},
                                          {"capsule", [] { return dCreateCapsule(nullptr, 0.2, 0.4); }},
                                          {"cylinder", [] { return dCreateCylinder(nullptr, 0.25, 0.5); }},
                                          {"convex of 80", [&] { return convex.makeGeom(nullptr); }},
                                          {"plane", [] { return dCreatePlane(nullptr, 0, 0, 1, 0); }}};
  Json rows = Json::array();
  const std::vector<NamedMesh> meshes = meshesOfShapes();
  Progress all(meshes.size() * shapes.size());
  for (const NamedMesh& mesh : meshes) {
    for (const NamedShape& shape : shapes) {
      const bool isWanted = fmt::format("{} / {}", mesh.name, shape.name).find(options.pair) != std::string::npos;
      const bool isEndless = mesh.isGround && std::string(shape.name) == "plane";  // parallel planes
      if (isWanted && !isEndless) rows.push_back(measureShape(mesh, shape, options));
      all.step();
    }
  }
  dSetMessageHandler(nullptr);
  printBench({{"bench", "shapes"}, {"tables", {{"ODE's shapes on meshes: microseconds, contacts", rows}}}},
             options.json);
  return 0;
}

}  // namespace

void addBenchShapes(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand("shapes", "ODE's shapes on small and convex meshes, beside a dTriMesh");
  auto options = std::make_shared<ShapesOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--poses", options->poses, "Poses of each pair")->check(CLI::Range(1, 100000));
  command->add_option("--calls", options->calls, "Queries in a row at each pose")->check(CLI::Range(1, 1000000));
  command->add_option("--repeat", options->repeat, "Runs, of which the median counts")->check(CLI::Range(1, 100000));
  command->add_option("--overlap", options->overlap, "How deep shapes are in the mesh")->check(CLI::Range(0.0, 1.0));
  command->add_option("--pair", options->pair, "Only pairs whose \"mesh / shape\" contains this");
  command->add_option("--seed", options->seed, "Of the random poses");
  command->callback([options, &action] { action = [options] { return benchShapes(*options); }; });
}

}  // namespace otg::cli
