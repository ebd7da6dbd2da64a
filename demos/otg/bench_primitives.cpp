// SPDX-License-Identifier: BSD-3-Clause
// `otg bench primitives`: meshes of a box, a sphere and a cylinder against ODE's shapes, beside the same pairs of ODE's
// own shapes, and against the least way out of the two convex bodies.
#include <fmt/format.h>
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cmath>

#include "otg/bench.h"
#include "otg/error_quantiles.h"
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"
#include "truth/contact_errors.h"
#include "truth/contact_families.h"
#include "truth/tessellated_bodies.h"

namespace otg::cli {
namespace {

using truth::ConvexBody;
using truth::Errors;

struct PrimitivesOptions {
  bool json = false;
  int poses = 2000;
  std::uint32_t seed = 1;
};

/// One of the shapes that are compared, as a geom of ODE's.
dGeomID makeNative(const ConvexBody& body) {
  switch (body.kind) {
    case ConvexBody::Kind::kSphere:
      return dCreateSphere(nullptr, body.radius);
    case ConvexBody::Kind::kBox:
      return dCreateBox(nullptr, 2 * body.half.x, 2 * body.half.y, 2 * body.half.z);
    case ConvexBody::Kind::kCapsule:
      return dCreateCapsule(nullptr, body.radius, 2 * body.length);
    case ConvexBody::Kind::kCylinder:
    case ConvexBody::Kind::kPolyhedron:
      break;
  }
  return dCreateCylinder(nullptr, body.radius, 2 * body.length);
}

void place(dGeomID geom, const Transformd& pose) {
  dMatrix3 r;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) r[4 * row + column] = pose.r[3 * row + column];
    r[4 * row + 3] = 0;
  }
  dGeomSetRotation(geom, r);
  dGeomSetPosition(geom, pose.t.x, pose.t.y, pose.t.z);
}

struct Deepest {
  int count = 0;
  double depth = 0;
  Vec3d normal{0, 0, 0};
};

Deepest collide(dGeomID a, dGeomID b) {
  dContactGeom contacts[64];
  Deepest deepest;
  deepest.count = dCollide(a, b, 64, contacts, sizeof(dContactGeom));
  for (int i = 0; i < deepest.count; ++i) {
    if (i > 0 && contacts[i].depth <= deepest.depth) continue;
    deepest.depth = contacts[i].depth;
    deepest.normal = {contacts[i].normal[0], contacts[i].normal[1], contacts[i].normal[2]};
  }
  return deepest;
}

Transformd randomPose(truth::Random& random, double reach) {
  Transformd pose = random.rotation();
  pose.t = {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
  return pose;
}

/// Overlaps up to a tenth of the mesh's size: what worlds see, where nothing is deep in anything.
constexpr double kSize = 1, kLeast = 0.001, kMost = 0.1;

struct Subject {
  const char* name;
  ConvexBody body;
  scenes::MeshArrays mesh;
};
struct Partner {
  const char* name;
  ConvexBody body;
};

Json runPair(Subject subject, Partner partner, const PrimitivesOptions& options) {
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  const MeshInput input = subject.mesh.input();
  dGpuTriMeshDataBuildSingle(data, input.vertices, sizeof(Vec3f), static_cast<int>(input.vertexCount), input.indices,
                             static_cast<int>(3 * input.triangleCount), sizeof(Triangle));
  const dGeomID mesh = dCreateGpuTriMesh(nullptr, data), native = makeNative(subject.body),
                other = makeNative(partner.body);
  truth::Random random(options.seed);
  Errors angle, depth, excess, own, nativeExcess;
  int poses = 0, missed = 0, nativeMissed = 0;
  for (int tries = 0; poses < options.poses && tries < 400 * options.poses; ++tries) {
    subject.body.pose = randomPose(random, 0.6);
    partner.body.pose = randomPose(random, 0.6);
    place(other, partner.body.pose);
    place(native, subject.body.pose);
    // Poses by ODE's answer or ours, whichever sees an overlap, so that what one of them misses is counted.
    const Deepest theirs = collide(native, other);
    place(mesh, subject.body.pose);
    const Deepest ours = collide(mesh, other);
    if (theirs.count == 0 && ours.count == 0) continue;
    if (std::max(theirs.depth, ours.depth) > 2 * kMost) continue;
    const double least = truth::leastSeparation(subject.body, partner.body);
    if (least < kLeast * kSize || least > kMost * kSize) continue;
    ++poses;
    if (theirs.count == 0) ++nativeMissed;
    if (ours.count == 0) {
      ++missed;
      continue;
    }
    const double along = separation(subject.body, partner.body, otgScale(ours.normal, -1.0));
    excess.add(std::max(0.0, along - least));
    own.add(std::fabs(ours.depth - along));
    if (theirs.count == 0) continue;
    nativeExcess.add(std::max(0.0, separation(subject.body, partner.body, otgScale(theirs.normal, -1.0)) - least));
    angle.add(truth::angleBetween(ours.normal, theirs.normal));
    depth.add(std::fabs(ours.depth - theirs.depth));
  }
  Json row;
  row["mesh"] = subject.name;
  row["shape"] = partner.name;
  row["poses"] = poses;
  row["missed"] = missed;
  row["missed_by_ode"] = nativeMissed;
  addErrorQuantiles(row, "angle_to_ode", angle);
  addErrorQuantiles(row, "depth_to_ode", depth);
  addErrorQuantiles(row, "longer_way_out", excess);
  addErrorQuantiles(row, "depth_along_normal", own);
  addErrorQuantiles(row, "longer_way_out_of_ode", nativeExcess);
  for (const dGeomID geom : {mesh, native, other}) dGeomDestroy(geom);
  dGpuTriMeshDataDestroy(data);
  return row;
}

Json runAll(const PrimitivesOptions& options) {
  const scenes::OdeSession session;
  const Subject subjects[] = {
      {"box", truth::boxBody({0.5, 0.35, 0.2}), scenes::makeBox({1, 0.7, 0.4}, 2)},
      {"sphere, 20,480 triangles", truth::ballBody(0.5), scenes::makeSphere(0.5, 5)},
      {"cylinder, 512 triangles", truth::cylinderBody(0.3, 0.4), scenes::makeCylinder(0.3, 0.8, 128, 1)}};
  const Partner partners[] = {{"sphere", truth::ballBody(0.3)},
                              {"box", truth::boxBody({0.25, 0.3, 0.35})},
                              {"capsule", truth::capsuleBody(0.2, 0.3)},
                              {"cylinder", truth::cylinderBody(0.2, 0.3)}};
  Json rows = Json::array();
  for (const Subject& subject : subjects) {
    for (const Partner& partner : partners) {
      rows.push_back(runPair(subject, partner, options));
    }
  }
  return rows;
}

int benchPrimitives(const PrimitivesOptions& options) {
  const Json rows = runAll(options);
  if (options.json) {
    printJson({{"bench", "primitives"}, {"tables", {{"pairs", rows}}}});
    return 0;
  }
  const std::vector<std::pair<std::string, std::string>> columns = {{"angle_to_ode", "degrees from ODE's normal"},
                                                                    {"depth_to_ode", "from ODE's depth"},
                                                                    {"longer_way_out", "way out longer than the least"},
                                                                    {"longer_way_out_of_ode", "the same of ODE"},
                                                                    {"depth_along_normal", "depth from the way out"}};
  std::vector<std::string> heads = {"mesh", "shape", "poses", "missed", "by ODE"};
  for (const auto& [key, words] : columns) heads.push_back(words);
  std::vector<std::vector<std::string>> lines;
  for (const Json& row : rows) {
    std::vector<std::string>& line = lines.emplace_back();
    for (const char* key : {"mesh", "shape"}) line.push_back(row[key].get<std::string>());
    for (const char* key : {"poses", "missed", "missed_by_ode"}) line.push_back(std::to_string(row[key].get<int>()));
    for (const auto& [key, words] : columns) line.push_back(errorQuantilesInWords(row, key));
  }
  fmt::print("Deepest contacts of overlaps of 0.001 to 0.1 (median / 99 % / largest; lengths in the world's unit)\n");
  printTable(heads, lines);
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
