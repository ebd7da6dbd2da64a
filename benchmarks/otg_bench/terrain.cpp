// SPDX-License-Identifier: BSD-3-Clause
// `otg bench terrain`: ODE's shapes and convex meshes on a large open mesh, as mesh geoms and as dTriMesh geoms, in the
// same poses.
#include <fmt/format.h>
#include <ode/ode.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "otg_bench/trembling.h"
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

struct TerrainOptions {
  bool json = false;
  int poses = 200, repeat = 5, cells = 400;
  double cell = 0.25, overlap = 0.02;
  std::uint32_t seed = 1;
  std::string shape;
};

double heightAt(double x, double y) {
  return std::sin(0.31 * x) * std::cos(0.23 * y) + 0.1 * std::sin(1.7 * x + 1) * std::cos(1.3 * y);
}

scenes::MeshArrays makeTerrain(int cells, double cell) {
  scenes::MeshArrays out;
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      const double px = cell * (x - 0.5 * cells), py = cell * (y - 0.5 * cells);
      out.vertices.push_back({static_cast<float>(px), static_cast<float>(py), static_cast<float>(heightAt(px, py))});
    }
  }
  const auto n = static_cast<std::uint32_t>(cells) + 1;
  for (std::uint32_t y = 0; y + 1 < n; ++y) {
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t v = n * y + x;
      out.triangles.push_back({{v, v + 1, v + n + 1}});
      out.triangles.push_back({{v, v + n + 1, v + n}});
    }
  }
  return out;
}

/// What meets the terrain as our mesh geom, and what meets it as a dTriMesh: one shape of ODE's, or a mesh as either.
class Visitor {
 public:
  explicit Visitor(dGeomID shape) : ours(shape), stock(shape) {}
  explicit Visitor(const scenes::MeshArrays& mesh)
      : twins_(std::make_unique<MeshTwins>(mesh)), ours(twins_->ours), stock(twins_->stock) {}
  ~Visitor() {
    if (twins_ == nullptr) dGeomDestroy(ours);
  }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

 private:
  std::unique_ptr<MeshTwins> twins_;

 public:
  const dGeomID ours, stock;
};

void copyPose(dGeomID from, dGeomID to) {
  if (from == to) return;
  dGeomSetRotation(to, dGeomGetRotation(from));
  const dReal* const at = dGeomGetPosition(from);
  dGeomSetPosition(to, at[0], at[1], at[2]);
}

struct Shape {
  const char* name;
  std::function<std::unique_ptr<Visitor>()> make;
  /// Puts it where it meets the terrain.
  std::function<void(const MeshTwins&, dGeomID, truth::Random&)> place;
};

bool touches(const MeshTwins& terrain, dGeomID shape) {
  dContactGeom contact;
  return dCollide(terrain.stock, shape, 1, &contact, sizeof contact) > 0;
}

/// Turned anyhow, above a random place, as low as ODE says that it touches, then by the overlap lower.
void lower(const TerrainOptions& options, const MeshTwins& terrain, dGeomID shape, truth::Random& random, bool turned) {
  const double reach = 0.45 * options.cells * options.cell;
  const Transformd turn = random.rotation();
  dMatrix3 r;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = turned ? turn.r[3 * row + column] : row == column;
    r[4 * row + 3] = 0;
  }
  dGeomSetRotation(shape, r);
  const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
  const double ground = heightAt(x, y), height = lastTouch(ground, ground + 2, 1e-4, [&](double z) {
                                          dGeomSetPosition(shape, x, y, z);
                                          return touches(terrain, shape);
                                        });
  dGeomSetPosition(shape, x, y, height - options.overlap);
}

std::vector<Shape> shapesOf(const TerrainOptions& options) {
  const auto solid = [&options](const MeshTwins& t, dGeomID g, truth::Random& r) { lower(options, t, g, r, true); };
  const auto flat = [&options](const MeshTwins& t, dGeomID g, truth::Random& r) { lower(options, t, g, r, false); };
  const auto plane = [](const MeshTwins&, dGeomID g, truth::Random& random) {
    // A plane that the lowest valleys reach through.
    const Vec3d n = random.direction();
    const Vec3d up{0.002 * n.x, 0.002 * n.y, 1};
    const double scale = 1 / std::sqrt(otgDot(up, up));
    dGeomPlaneSetParams(g, scale * up.x, scale * up.y, scale * up.z, random.uniform(-1.1, -1));
  };
  const auto ray = [&options](const MeshTwins&, dGeomID g, truth::Random& random) {
    const double reach = 0.45 * options.cells * options.cell;
    dGeomRaySetClosestHit(g, 1);
    dGeomRaySet(g, random.uniform(-reach, reach), random.uniform(-reach, reach), 3, random.uniform(-1, 1),
                random.uniform(-1, 1), -1);
  };
  const auto one = [](auto make) { return [make] { return std::make_unique<Visitor>(make()); }; };
  return {{"sphere", one([] { return dCreateSphere(nullptr, 0.5); }), solid},
          {"box", one([] { return dCreateBox(nullptr, 1, 0.7, 0.4); }), solid},
          {"box, lying", one([] { return dCreateBox(nullptr, 1, 0.7, 0.4); }), flat},
          {"capsule", one([] { return dCreateCapsule(nullptr, 0.3, 0.6); }), solid},
          {"cylinder", one([] { return dCreateCylinder(nullptr, 0.3, 0.8); }), solid},
          {"cylinder, standing", one([] { return dCreateCylinder(nullptr, 0.3, 0.8); }), flat},
          {"plane", one([] { return dCreatePlane(nullptr, 0, 0, 1, 0); }), plane},
          {"ray", one([] { return dCreateRay(nullptr, 10); }), ray},
          {"mesh box of 12", one([] {
             return scenes::makeBox({1, 0.7, 0.4});
           }),
           solid},
          {"mesh box of 12, lying", one([] {
             return scenes::makeBox({1, 0.7, 0.4});
           }),
           flat},
          {"mesh box of 192", one([] {
             return scenes::makeBox({1, 0.7, 0.4}, 4);
           }),
           solid},
          {"mesh box of 3,072", one([] {
             return scenes::makeBox({1, 0.7, 0.4}, 16);
           }),
           solid},
          {"mesh cylinder of 192", one([] { return scenes::makeCylinder(0.3, 0.8, 48); }), solid},
          {"mesh cylinder, standing", one([] { return scenes::makeCylinder(0.3, 0.8, 48); }), flat},
          {"mesh capsule of 208", one([] { return scenes::makeCapsule(0.3, 0.6, 13, 4); }), solid},
          {"mesh ball of 80", one([] { return scenes::makeSphere(0.5, 1); }), solid}};
}

Json runShape(const MeshTwins& terrain, const Shape& shape, const TerrainOptions& options) {
  truth::Random random(options.seed);
  const std::unique_ptr<Visitor> visitor = shape.make();
  TremblingRun ours, stock;
  Progress parts(static_cast<std::size_t>(options.poses));
  for (int i = 0; i < options.poses; ++i, parts.step()) {
    shape.place(terrain, visitor->stock, random);
    copyPose(visitor->stock, visitor->ours);
    addPose(terrain.ours, visitor->ours, options.repeat, ours);
    addPose(terrain.stock, visitor->stock, options.repeat, stock);
  }
  Json row{{"shape", shape.name}};
  row.update(compare(ours, stock));
  return row;
}

int benchTerrain(const TerrainOptions& options) {
  const scenes::OdeSession session;
  const MeshTwins terrain(makeTerrain(options.cells, options.cell));
  Json rows = Json::array();
  std::vector<Shape> shapes = shapesOf(options);
  if (!options.shape.empty()) std::erase_if(shapes, [&](const Shape& shape) { return options.shape != shape.name; });
  Progress all(shapes.size());
  for (const Shape& shape : shapes) {
    rows.push_back(runShape(terrain, shape, options));
    all.step();
  }
  const std::string title = fmt::format("Shapes on a terrain of {} triangles, cells of {}: microseconds, contacts",
                                        terrain.triangles(), options.cell);
  if (options.json) {
    printJson({{"bench", "terrain"}, {"triangles", terrain.triangles()}, {"tables", {{"shapes", rows}}}});
  } else {
    printTable(title, rows);
  }
  return 0;
}

}  // namespace

void addBenchTerrain(CLI::App& bench, Action& action) {
  CLI::App* command =
      bench.add_subcommand("terrain", "ODE's shapes and convex meshes on a large open mesh, beside a dTriMesh");
  auto options = std::make_shared<TerrainOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--poses", options->poses, "Poses of each shape")->check(CLI::Range(1, 100000));
  command->add_option("--repeat", options->repeat, "Queries at each pose, of which the median counts")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--cells", options->cells, "Squares along each side, of two triangles each")
      ->check(CLI::Range(1, 4000));
  command->add_option("--cell", options->cell, "Side of a square; shapes are about 1 large")
      ->check(CLI::Range(1e-3, 1e3));
  command->add_option("--overlap", options->overlap, "How deep shapes are in the terrain")->check(CLI::Range(0.0, 1.0));
  command->add_option("--shape", options->shape, "This one alone");
  command->add_option("--seed", options->seed, "Of the random numbers");
  command->callback([options, &action] { action = [options] { return benchTerrain(*options); }; });
}

}  // namespace otg::cli
