// SPDX-License-Identifier: BSD-3-Clause
// `otg bench primitives`: meshes of a box, a sphere and a cylinder against ODE's shapes. Beside them are pairs of ODE's
// own shapes, and the least way out of the two convex bodies.
#include "otg_bench/primitives.h"

#include <fmt/format.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/error_quantiles.h"
#include "scenes/simulation.h"
#include "truth/contact_errors.h"

namespace otg::cli {

using truth::ConvexBody;
using truth::Errors;
using truth::TessellatedBody;

MeshGeom::MeshGeom(const scenes::MeshArrays& mesh) : data_(dGpuTriMeshDataCreate()) {
  const MeshInput input = mesh.input();
  dGpuTriMeshDataBuildSingle(data_, input.vertices, sizeof(Vec3f), static_cast<int>(input.vertexCount), input.indices,
                             static_cast<int>(3 * input.triangleCount), sizeof(Triangle));
  geom_ = dCreateGpuTriMesh(nullptr, data_);
}

MeshGeom::~MeshGeom() {
  dGeomDestroy(geom_);
  dGpuTriMeshDataDestroy(data_);
}

NativeGeom::NativeGeom(const ConvexBody& body, const scenes::MeshArrays& mesh)
    : geom_(truth::makeShapeGeom(body, mesh, convex_)) {}

std::vector<TessellatedBody> comparedMeshes() {
  return {{"box", truth::boxBody({0.5, 0.35, 0.2}), scenes::makeBox({1, 0.7, 0.4}, 2)},
          {"sphere, 20,480 triangles", truth::ballBody(0.5), scenes::makeSphere(0.5, 5)},
          {"cylinder, 512 triangles", truth::cylinderBody(0.3, 0.4), scenes::makeCylinder(0.3, 0.8, 128, 1)}};
}

void placeGeom(dGeomID geom, const Transformd& pose) {
  dMatrix3 r;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = pose.r[3 * row + column];
    r[4 * row + 3] = 0;
  }
  dGeomSetRotation(geom, r);
  dGeomSetPosition(geom, pose.t.x, pose.t.y, pose.t.z);
}

Transformd drawnPose(truth::Random& random, double reach) {
  Transformd pose = random.rotation();
  pose.t = {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
  return pose;
}

DeepestContact collideDeepest(dGeomID a, dGeomID b) {
  dContactGeom contacts[64];
  DeepestContact deepest;
  deepest.count = dCollide(a, b, 64, contacts, sizeof(dContactGeom));
  for (int i = 0; i < deepest.count; ++i) {
    const dContactGeom& c = contacts[i];
    if (i > 0 && c.depth <= deepest.depth) continue;
    deepest.depth = c.depth;
    deepest.position = {c.pos[0], c.pos[1], c.pos[2]};
    deepest.normal = {c.normal[0], c.normal[1], c.normal[2]};
  }
  return deepest;
}

bool PoseCounts::add(bool isOurs, bool isOdes) {
  ++poses;
  if (!isOurs) ++missed;
  if (!isOdes) ++missedByOde;
  return isOurs && isOdes;
}

Json makeRow(Json words, const PoseCounts& counts, const std::vector<std::pair<const char*, const Errors*>>& errors) {
  Json row = std::move(words);
  row["poses"] = counts.poses;
  row["missed"] = counts.missed;
  row["missed_by_ode"] = counts.missedByOde;
  for (const auto& [name, values] : errors) addErrorQuantiles(row, name, *values);
  return row;
}

namespace {

Json runPair(TessellatedBody subject, TessellatedBody partner, const PrimitivesOptions& options) {
  const MeshGeom mesh(subject.mesh);
  const NativeGeom native(subject.body, subject.mesh), other(partner.body, partner.mesh);
  truth::Random random(options.seed);
  Errors angle, depth, excess, own, nativeExcess;
  PoseCounts counts;
  for (int tries = 0; counts.poses < options.poses && tries < 400 * options.poses; ++tries) {
    subject.body.pose = drawnPose(random, 0.6);
    partner.body.pose = drawnPose(random, 0.6);
    placeGeom(other.id(), partner.body.pose);
    placeGeom(native.id(), subject.body.pose);
    // Poses by ODE's result or ours, whichever sees an overlap, so that what one of them misses is counted.
    const DeepestContact theirs = collideDeepest(native.id(), other.id());
    placeGeom(mesh.id(), subject.body.pose);
    const DeepestContact ours = collideDeepest(mesh.id(), other.id());
    if (theirs.count == 0 && ours.count == 0) continue;
    if ((ours.count > 0 ? ours.depth : theirs.depth) > 2 * kMostOverlap) continue;
    const double least = truth::leastSeparation(subject.body, partner.body);
    if (least < kLeastOverlap || least > kMostOverlap) continue;
    const bool isBoth = counts.add(ours.count > 0, theirs.count > 0);
    if (ours.count == 0) continue;
    const double along = separation(subject.body, partner.body, otgScale(ours.normal, -1.0));
    excess.add(std::max(0.0, along - least));
    own.add(std::fabs(ours.depth - along));
    if (!isBoth) continue;
    nativeExcess.add(std::max(0.0, separation(subject.body, partner.body, otgScale(theirs.normal, -1.0)) - least));
    angle.add(truth::angleBetween(ours.normal, theirs.normal));
    depth.add(std::fabs(ours.depth - theirs.depth));
  }
  return makeRow({{"mesh", subject.name}, {"shape", partner.name}}, counts,
                 {{"angle_to_ode", &angle},
                  {"depth_to_ode", &depth},
                  {"longer_way_out", &excess},
                  {"depth_along_normal", &own},
                  {"longer_way_out_of_ode", &nativeExcess}});
}

Json comparePairs(const PrimitivesOptions& options) {
  const std::vector<TessellatedBody> partners = truth::smallBodies();  // sphere, box, capsule, cylinder, convex
  Json rows = Json::array();
  const std::vector<TessellatedBody> subjects = comparedMeshes();
  Progress parts(subjects.size() * partners.size());
  for (const TessellatedBody& subject : subjects) {
    for (const TessellatedBody& partner : partners) {
      rows.push_back(runPair(subject, partner, options));
      parts.step();
    }
  }
  return rows;
}

/// Columns of words and counts, by key, and of quantiles, by key and title.
struct TableLayout {
  const char* title;
  std::vector<std::pair<std::string, std::string>> plain, errors;
};

void printRows(const TableLayout& layout, const Json& rows) {
  std::vector<std::string> heads;
  for (const auto& [key, words] : layout.plain) heads.push_back(words);
  for (const auto& [key, words] : layout.errors) heads.push_back(words);
  std::vector<std::vector<std::string>> lines;
  for (const Json& row : rows) {
    std::vector<std::string>& line = lines.emplace_back();
    for (const auto& [key, words] : layout.plain) {
      line.push_back(row[key].is_string() ? row[key].get<std::string>() : std::to_string(row[key].get<int>()));
    }
    for (const auto& [key, words] : layout.errors) line.push_back(errorQuantilesInWords(row, key));
  }
  fmt::print("{}\n", layout.title);
  printTable(heads, lines);
}

int benchPrimitives(const PrimitivesOptions& options) {
  const scenes::OdeSession session;
  Progress all(4);
  const auto part = [&](Json (*compare)(const PrimitivesOptions&)) {
    Json rows = compare(options);
    all.step();
    return rows;
  };
  const Json pairs = part(&comparePairs), planes = part(&comparePlanes), rays = part(&compareRays),
             meshes = part(&compareOtherMeshes);
  if (options.json) {
    printJson({{"bench", "primitives"},
               {"tables", {{"pairs", pairs}, {"planes", planes}, {"rays", rays}, {"meshes", meshes}}}});
    return 0;
  }
  fmt::print("Errors: median / 99 % / largest; lengths in the world's unit\n\n");
  printRows(
      {"Deepest contacts of overlaps of 0.001 to 0.1",
       {{"mesh", "mesh"}, {"shape", "shape"}, {"poses", "poses"}, {"missed", "missed"}, {"missed_by_ode", "by ODE"}},
       {{"angle_to_ode", "degrees from ODE's normal"},
        {"depth_to_ode", "from ODE's depth"},
        {"longer_way_out", "way out longer than the least"},
        {"longer_way_out_of_ode", "the same of ODE"},
        {"depth_along_normal", "depth from the way out"}}},
      pairs);
  printRows({"\nPlanes, overlaps of 0.001 to 0.1",
             {{"mesh", "mesh"}, {"poses", "poses"}, {"missed", "missed"}, {"missed_by_ode", "by ODE"}},
             {{"angle", "degrees from the plane's normal"},
              {"depth_to_ode", "from ODE's depth"},
              {"depth", "from the depth by formula"},
              {"depth_of_ode", "the same of ODE"}}},
            planes);
  printRows({"\nRays from outside",
             {{"mesh", "mesh"}, {"poses", "rays"}, {"missed", "missed"}, {"missed_by_ode", "by ODE"}},
             {{"angle_to_ode", "degrees from ODE's normal"}, {"distance_to_ode", "from ODE's distance"}}},
            rays);
  printRows({"\nMeshes on ODE's dTriMesh and heightfield, beside the same ground as a mesh",
             {{"mesh", "mesh"},
              {"other", "other"},
              {"poses", "poses"},
              {"missed", "seen by one"},
              {"other_counts", "other numbers of contacts"}},
             {{"angle", "degrees"}, {"depth", "depth"}, {"place", "place"}}},
            meshes);
  return 0;
}

}  // namespace

void addBenchPrimitives(CLI::App& bench, Action& action) {
  CLI::App* command =
      bench.add_subcommand("primitives", "Meshes against ODE's shapes, beside the same pair of ODE's own");
  auto options = std::make_shared<PrimitivesOptions>();
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->add_option("--poses", options->poses, "Overlapping poses of each pair")->check(CLI::Range(1, 1000000));
  command->add_option("--seed", options->seed, "Of the random numbers");
  command->callback([options, &action] { action = [options] { return benchPrimitives(*options); }; });
}

}  // namespace otg::cli
