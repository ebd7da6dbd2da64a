// SPDX-License-Identifier: BSD-3-Clause
// `otg bench heightfield`: meshes of a box and of a ball on a large heightfield, at rest, moving and above it, and the
// same body of ODE's own; also building the field, and a box that slides over a kink.
#include <fmt/format.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <chrono>
#include <cmath>

#include "cli/contact_hash.h"
#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "otg_bench/kink.h"
#include "scenes/height_grid.h"
#include "scenes/heightfield_geom.h"
#include "scenes/simulation.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

struct FieldOptions {
  bool json = false;
  int samples = 1025, repeat = 200, steps = 400;
  double step = 0.05;
  std::uint32_t seed = 1;
};

constexpr int kFieldPlaces = 64;

double microseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

/// One body as a mesh geom and as ODE's.
struct FieldBody {
  const char* name;
  scenes::MeshArrays arrays;
  dGeomID own;
  double halfHeight;
};

/// Times of dCollide with the field, its contacts, and a hash of these.
class FieldRun {
 public:
  explicit FieldRun(dGeomID field) : field_(field) {}
  double ask(dGeomID body) {
    dContactGeom contacts[kFieldPlaces];
    int count = 0;
    const double time =
        microseconds([&] { count = dCollide(body, field_, kFieldPlaces, contacts, sizeof(dContactGeom)); });
    hash_.add(count);
    for (int i = 0; i < count; ++i) addToHash(hash_, contacts[i]);
    lastCount_ = count;
    return time;
  }
  int lastCount() const { return lastCount_; }
  std::string hash() const { return hash_.hex(); }

 private:
  dGeomID field_;
  Fnv1a hash_;
  int lastCount_ = 0;
};

/// The height at which the mesh's middle is to be, so that it is a fiftieth of its size in the ground.
double restingHeight(const FieldBody& body, dGeomID geom, FieldRun& run, double x, double y) {
  const auto touchesAt = [&](double z) {
    dGeomSetPosition(geom, x, y, z);
    run.ask(geom);
    return run.lastCount() > 0;
  };
  return lastTouch(-4, 4 + 2 * body.halfHeight, 1e-4, touchesAt) - 0.04 * body.halfHeight;
}

/// About as high as the ground is.
double heightNear(const scenes::HeightGrid& grid, double x, double y) {
  const double u = (x / grid.sizeX + 0.5) * (grid.columns - 1), v = (y / grid.sizeY + 0.5) * (grid.rows - 1);
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const double a = u - i, b = v - j;
  return (1 - b) * ((1 - a) * grid.at(i, j) + a * grid.at(i + 1, j)) +
         b * ((1 - a) * grid.at(i, j + 1) + a * grid.at(i + 1, j + 1));
}

Json measureBody(const FieldBody& body, const scenes::HeightGrid& grid, dGeomID field, double size,
                 const FieldOptions& options) {
  const MeshInput in = body.arrays.input();
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  dGpuTriMeshDataBuildSingle(data, in.vertices, sizeof(Vec3f), static_cast<int>(in.vertexCount), in.indices,
                             static_cast<int>(3 * in.triangleCount), sizeof(Triangle));
  const dGeomID mesh = dCreateGpuTriMesh(nullptr, data);
  FieldRun search(field), run(field), stock(field);
  const double x = 3.3, y = -2.7, z = restingHeight(body, mesh, search, x, y);
  std::vector<double> rest, above, ownRest;
  dGeomSetPosition(mesh, x, y, z);
  dGeomSetPosition(body.own, x, y, z);
  for (int i = 0; i <= options.repeat; ++i) {
    const double time = run.ask(mesh);
    if (i > 0) rest.push_back(time);
  }
  const int contacts = run.lastCount();
  for (int i = 0; i < std::min(options.repeat, 20); ++i) ownRest.push_back(stock.ask(body.own));
  const int ownContacts = stock.lastCount();
  double moving = 0;
  for (int i = 0; i < options.steps; ++i) {
    const double at = x + options.step * i;
    dGeomSetPosition(mesh, at, y, z + heightNear(grid, at, y) - heightNear(grid, x, y));
    moving += run.ask(mesh);
  }
  for (int i = 0; i < options.repeat; ++i) {
    dGeomSetPosition(mesh, x + options.step * i, y, z + 100);
    above.push_back(run.ask(mesh));
  }
  dGeomDestroy(mesh);
  dGpuTriMeshDataDestroy(data);
  return {{"mesh", body.name},
          {"triangles", static_cast<int>(in.triangleCount)},
          {"size_m", size},
          {"at_rest_us", median(rest)},
          {"moving_us", moving / std::max(1, options.steps)},
          {"above_us", median(above)},
          {"own_body_us", median(ownRest)},
          {"contacts", contacts},
          {"contacts_of_own", ownContacts},
          {"hash", run.hash()}};
}

int benchHeightfield(const FieldOptions& options) {
  const scenes::OdeSession session;
  scenes::HeightGrid grid;
  grid.columns = grid.rows = options.samples;
  grid.sizeX = grid.sizeY = options.samples - 1;
  scenes::setRoughHeights(grid, 2, 30, options.seed);
  const auto field = std::make_unique<scenes::HeightfieldData>(grid);
  const dGeomID ground = field->makeGeom(nullptr, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});

  Json bodies = Json::array();
  Progress all(8);  // six bodies, the building, the kink
  for (const double size : {0.5, 8.0, 32.0}) {
    const FieldBody box{"box", scenes::makeBox({size, size, size}, 2), dCreateBox(nullptr, size, size, size), size / 2};
    const FieldBody ball{"ball", scenes::makeSphere(size / 2, 4), dCreateSphere(nullptr, size / 2), size / 2};
    for (const FieldBody* body : {&box, &ball}) {
      bodies.push_back(measureBody(*body, grid, ground, size, options));
      dGeomDestroy(body->own);
      all.step();
    }
  }
  dGeomDestroy(ground);

  const std::vector<float> samples = scenes::fieldSamples(grid);
  std::vector<double> ours, stock;
  for (int i = 0; i < 11; ++i) {
    const auto width = static_cast<dReal>(grid.sizeX);
    const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
    stock.push_back(1e-3 * microseconds([&] {
                      dGeomHeightfieldDataBuildSingle(data, samples.data(), 0, width, width, grid.columns, grid.rows, 1,
                                                      0, 1, 0);
                    }));
    ours.push_back(1e-3 * microseconds([&] {
                     dGpuTriMeshHeightfieldDataBuildSingle(data, samples.data(), 0, width, width, grid.columns,
                                                           grid.rows, 1, 0, 1, 0);
                   }));
    dGpuTriMeshHeightfieldDataDestroy(data);
  }
  all.step();
  const Json build = Json::array(
      {{{"samples", grid.columns * grid.rows}, {"build_ms", median(ours)}, {"build_ms_of_ode", median(stock)}}});
  printBench({{"bench", "heightfield"},
              {"samples", {grid.columns, grid.rows}},
              {"tables", {{"bodies", bodies}, {"build", build}, {"kink", kinkRows()}}}},
             options.json);
  return 0;
}

}  // namespace

void addBenchHeightfield(CLI::App& bench, Action& action) {
  CLI::App* command =
      bench.add_subcommand("heightfield", "Meshes on a rough heightfield with samples 1 m apart: microseconds");
  auto options = std::make_shared<FieldOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--samples", options->samples, "Along each side")->check(CLI::Range(128, 1500));
  command->add_option("--repeat", options->repeat, "Queries at rest, of which the median counts")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--steps", options->steps, "Places of the moving mesh, of which the mean counts")
      ->check(CLI::Range(1, 1000));
  command->add_option("--step", options->step, "From one place to the next, m")->check(CLI::Range(0.0, 0.05));
  command->add_option("--seed", options->seed, "Of the ground");
  command->callback([options, &action] { action = [options] { return benchHeightfield(*options); }; });
}

}  // namespace otg::cli
