// SPDX-License-Identifier: BSD-3-Clause
// `otg bench floor`: meshes that stand on a mesh box, on a flat sheet, on blocks in one mesh and on ODE's box, beside
// dTriMesh geoms.
#include <fmt/format.h>
#include <ode/ode.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/input_file.h"
#include "cli/progress.h"
#include "mesh_io/mesh_file.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "otg_bench/trembling.h"
#include "scenes/generated_meshes.h"
#include "scenes/height_grid.h"
#include "scenes/simulation.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

struct FloorOptions {
  bool json = false;
  int poses = 50, repeat = 5;
  double overlap = 0.002;
  std::uint32_t seed = 1;
  std::vector<std::string> meshes;
};

struct Body {
  std::string name;
  scenes::MeshArrays mesh;
};

/// About as large as a ball of radius 1, with their middles at the origin.
std::vector<Body> bodiesOf(const FloorOptions& options) {
  if (options.meshes.empty()) {
    return {{"torus", scenes::makeTorus(0.7, 0.3, 72, 72)},
            {"lump", scenes::makeLump(0.8, 4, 0.5, 3)},
            {"bolt", scenes::makeBolt(0.4, 0.2, 1.5, 48)},
            {"gear", scenes::makeGear(16, 0.8, 0.2, 0.4, 0.2)},
            {"bowl", scenes::makeBowl(0.8, 0.2, 48, 24)}};
  }
  std::vector<Body> bodies;
  for (const std::string& file : options.meshes) {
    progress("reading " + file);
    bodies.push_back({std::filesystem::path(file).stem().string(),
                      scenes::broughtToOrigin(*mesh_io::loadTriMesh(findInput(file)), 1)});
  }
  return bodies;
}

constexpr Vec3d kFloor{8, 8, 2};

/// Turned anyhow, over the middle of the floor, with its lowest vertex below the top by the overlap.
void stand(const Body& body, const MeshTwins& twins, double overlap, truth::Random& random) {
  Transformd pose = random.rotation();
  double lowest = 0;
  for (const Vec3f& v : body.mesh.vertices) {
    lowest = std::min(lowest, otgRotate(pose, Vec3d{v.x, v.y, v.z}).z);
  }
  pose.t = {random.uniform(-1, 1), random.uniform(-1, 1), 0.5 * kFloor.z - lowest - overlap};
  poseGeom(twins.ours, pose);
  poseGeom(twins.stock, pose);
}

/// An open mesh of squares, as wide as the floor, at its top.
scenes::MeshArrays flatSheet() {
  constexpr int kCells = 16;
  scenes::HeightGrid grid;
  grid.sizeX = kFloor.x;
  grid.sizeY = kFloor.y;
  grid.columns = grid.rows = kCells + 1;
  scenes::setHeights(grid, [](double, double) { return 0.5 * kFloor.z; });
  return scenes::sheetOf(grid);
}

/// The floor with walls around it that begin in it, in one mesh.
scenes::MeshArrays floorWithWalls() {
  std::vector<scenes::MeshArrays> blocks{scenes::makeBox(kFloor)};
  const Vec3d along{kFloor.x, 0.2, 2}, across{0.2, kFloor.y, 2};
  for (const double side : {-0.5, 0.5}) {
    const Transformd y{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, side * (kFloor.y - 0.2), 0.9}};
    const Transformd x{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {side * (kFloor.x - 0.2), 0, 0.9}};
    blocks.push_back(scenes::transformed(scenes::makeBox(along), y));
    blocks.push_back(scenes::transformed(scenes::makeBox(across), x));
  }
  return scenes::merge(blocks);
}

/// What the meshes stand on, and what they stand on as dTriMesh geoms.
struct Floor {
  const char* name;
  dGeomID ours, stock;
};

Json measureBody(const Body& body, const MeshTwins& twins, const Floor& floor, const FloorOptions& options) {
  truth::Random random(options.seed);
  TremblingRun ours, stock;
  for (int i = 0; i < options.poses; ++i) {
    stand(body, twins, options.overlap, random);
    addPose(floor.ours, twins.ours, options.repeat, ours);
    addPose(floor.stock, twins.stock, options.repeat, stock);
  }
  Json row{{"body", body.name}, {"triangles", twins.triangles()}, {"floor", floor.name}};
  row.update(compare(ours, stock));
  return row;
}

int benchFloor(const FloorOptions& options) {
  const scenes::OdeSession session;
  const MeshTwins mesh(scenes::makeBox(kFloor)), sheet(flatSheet()), walls(floorWithWalls());
  const dGeomID box = dCreateBox(nullptr, kFloor.x, kFloor.y, kFloor.z);
  const Floor floors[] = {{"mesh box", mesh.ours, mesh.stock},
                          {"flat sheet", sheet.ours, sheet.stock},
                          {"blocks", walls.ours, walls.stock},
                          {"dBox", box, box}};
  const std::vector<Body> bodies = bodiesOf(options);
  Json rows = Json::array();
  Progress all(bodies.size());
  for (const Body& body : bodies) {
    const MeshTwins twins(body.mesh);
    for (const Floor& floor : floors) rows.push_back(measureBody(body, twins, floor, options));
    all.step();
  }
  dGeomDestroy(box);
  const std::string title = fmt::format("Meshes on a floor, {} deep: microseconds, contacts", options.overlap);
  printBench({{"bench", "floor"}, {"tables", {{title, rows}}}}, options.json);
  return 0;
}

}  // namespace

void addBenchFloor(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand("floor", "Meshes that stand on a floor, beside dTriMesh geoms");
  auto options = std::make_shared<FloorOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--poses", options->poses, "Poses of each mesh")->check(CLI::Range(1, 100000));
  command->add_option("--repeat", options->repeat, "Queries at each pose, of which the median counts")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--overlap", options->overlap, "How deep the lowest vertex is; meshes have a radius of about 1")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--seed", options->seed, "Of the random numbers");
  command->add_option("MESH", options->meshes, "Closed meshes (default: five that are generated)");
  command->callback([options, &action] { action = [options] { return benchFloor(*options); }; });
}

}  // namespace otg::cli
