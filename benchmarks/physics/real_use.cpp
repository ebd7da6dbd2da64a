// SPDX-License-Identifier: BSD-3-Clause
// What users do: a robot arm's collision meshes, gears that run for a minute, a machine screw, a heap of scanned
// figures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "mesh_io/mesh_file.h"
#include "physics/scene.h"
#include "physics/thread_reference.h"

namespace otg::physics {
namespace {

/// A file of the folder of meshes, all lengths times `scale`.
scenes::MeshArrays loadMesh(const std::string& file, double scale = 1) {
  const mesh_io::MeshFile read = mesh_io::loadMeshFile((std::filesystem::path(meshFolder()) / file).string());
  scenes::MeshArrays mesh;
  for (const Vec3d& v : read.vertices)
    mesh.vertices.push_back(
        {static_cast<float>(scale * v.x), static_cast<float>(scale * v.y), static_cast<float>(scale * v.z)});
  mesh.triangles = read.triangles;
  return mesh;
}

Scene realScene(const char* name, const char* what, std::vector<std::string> files,
                const std::function<Result(const Case&)>& run) {
  Scene scene;
  scene.name = name;
  scene.family = "real";
  scene.what = what;
  scene.run = run;
  scene.meshFiles = std::move(files);
  scene.steppings = {kW, kQ20};
  scene.axes = kAxisSeed | kAxisBuffer;
  scene.seeds = 3;
  scene.hasNative = false;
  scene.realUse = true;
  scene.seconds = 100;
  return scene;
}

const std::vector<std::string>& pandaFiles() {
  static const std::vector<std::string> kFiles = [] {
    std::vector<std::string> files;
    files.reserve(8);
    for (int i = 0; i < 8; ++i) files.push_back(fmt::format("panda_link{}.ply", i));
    return files;
  }();
  return kFiles;
}

/// Poses of the arm's links for joint angles in radians (Franka Emika's table of Denavit-Hartenberg parameters in
/// Craig's convention).
std::vector<Eigen::Isometry3d> pandaPoses(const std::vector<double>& joints) {
  constexpr double kA[7] = {0, 0, 0, 0.0825, -0.0825, 0, 0.088}, kD[7] = {0.333, 0, 0.316, 0, 0.384, 0, 0};
  constexpr int kQuarterTurns[7] = {0, -1, 1, 1, -1, 1, 1};
  std::vector<Eigen::Isometry3d> poses{Eigen::Isometry3d::Identity()};
  for (std::size_t i = 0; i < 7; ++i) {
    Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
    step.rotate(Eigen::AngleAxisd(kQuarterTurns[i] * std::numbers::pi / 2, Vec::UnitX()));
    step.translate(Vec(kA[i], 0, 0));
    step.rotate(Eigen::AngleAxisd(joints[i], Vec::UnitZ()));
    step.translate(Vec(0, 0, kD[i]));
    poses.push_back(poses.back() * step);
  }
  return poses;
}

/// Neighbours overlap by centimetres at every joint, and with some joint angles other links run into each other too.
Result panda(const Case& run) {
  constexpr int kArms = 10;
  std::mt19937 random(static_cast<std::uint32_t>(run.randomSeed));
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  std::vector<ShapePointer> links;
  std::vector<Vec> centers;
  for (const std::string& file : pandaFiles()) {
    Vec center = Vec::Zero();
    links.push_back(makeShape(loadMesh(file), {}, &center));
    centers.push_back(center);
  }
  RigOptions options;
  options.gravity = Vec::Zero();
  Result result;
  double apart = 0, rise = 0;
  for (int arm = 0; arm < kArms; ++arm) {
    std::vector<double> joints;
    joints.reserve(7);
    for (int i = 0; i < 7; ++i) joints.push_back(2.5 * uniform());
    const std::vector<Eigen::Isometry3d> poses = pandaPoses(joints);
    Rig rig(run, options);
    for (std::size_t i = 0; i < links.size(); ++i)
      rig.addBody(links[i], poses[i] * centers[i], Rotation(poses[i].rotation()));
    double freeSince = 0, energyFree = 0, armRise = 0;
    long touching = 0;
    rig.run(2, [&] {
      const bool touches = !rig.contactsNow().empty();
      if (touches) {
        ++touching;
        freeSince = rig.time();
        energyFree = rig.energy();
      } else {
        armRise = std::max(armRise, (rig.energy() - energyFree) / rig.bodyCount());
      }
      return true;
    });
    apart = std::max(apart, freeSince);
    rise = std::max(rise, armRise);
    for (const auto& [measure, value] : rig.measures()) {
      double& worst = result.measures.emplace(measure, value).first->second;
      worst = measure == "finite" ? std::min(worst, value) : std::max(worst, value);
    }
    if (arm == 0) result.energyHistory = rig.energyHistory();
  }
  result.measures["apart"] = apart;
  result.measures["gain_when_free"] = rise;
  return result;
}

Result gearMinute(const Case& run) {
  constexpr double kSpeed = 2, kPitchRadius = 1, kBrake = 0.5;
  constexpr int kTeeth = 20;
  RigOptions options;
  options.gravity = Vec::Zero();
  options.mu = 0.1;
  Rig rig(run, options);
  const ShapePointer gear = gearShape(kTeeth, kPitchRadius, 0.2, 0.3, 0.3);
  const int driver = rig.addBody(gear, {0, 0, 0});
  const int driven = rig.addBody(gear, {2 * kPitchRadius + 0.02, 0, 0}, about(Vec::UnitZ(), 180 + 180.0 / kTeeth));
  rig.addMotor(driver, Vec::UnitZ(), kSpeed, 100);
  rig.addMotor(driven, Vec::UnitZ(), 0, kBrake);
  double speed = 0, torque = 0, square = 0, most = 0;
  long count = 0;
  rig.run(60, [&] {
    if (rig.time() < 1) return true;
    const double t = rig.motorTorque(driver);
    speed -= rig.angularVelocity(driven).z() / kSpeed;
    torque += t;
    square += t * t;
    most = std::max(most, std::abs(t));
    ++count;
    return true;
  });
  const double n = static_cast<double>(std::max(1L, count)), mean = torque / n;
  Result result = resultOf(rig);
  result.measures["mean_speed"] = speed / n;
  result.measures["mean_torque"] = mean / kBrake;
  result.measures["torque_ripple"] = std::sqrt(std::max(0.0, square / n - mean * mean)) / kBrake;
  result.measures["torque_peak"] = most / kBrake;
  return result;
}

Result machineScrew(const Case& run) {
  // Millimetres to a thread of 1 m: crests at 0.5 m, a pitch of 0.125 m.
  constexpr double kScale = 1.0 / 16, kPitch = 2 * kScale, kHeight = 20 * kScale, kSeconds = 2;
  RigOptions options;
  options.mu = 0;
  Rig rig(run, options);
  const scenes::MeshArrays bolt = loadMesh("bolt_m16.ply", kScale);
  Vec center;
  const ShapePointer nut = makeShape(loadMesh("nut_m16.ply", kScale), {}, &center);
  rig.addStatic(makeStaticShape(bolt), {0, 0, 0});
  rig.addBody(nut, center + Vec(0, 0, kHeight));
  rig.run(kSeconds);
  Result result = resultOf(rig);
  // 96 columns, rows of an eighth of the pitch at the same heights everywhere: every twelfth column repeats.
  const ThreadSetup setup{
      bolt,
      scenes::transformed(nut->mesh, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {center.x(), center.y(), center.z() + kHeight}}),
      kPitch,
      8,
      nut->inertia(2, 2),
      9.81,
      12 * 64};
  const ThreadMotion reference = plasticThreadReference(setup, kSeconds);
  const double travel = rig.position(0).z() - rig.startPosition(0).z();
  result.measures["travel"] = travel;
  result.measures["reference"] = reference.travel;
  result.measures["share"] = travel / reference.travel;
  result.measures["tilt"] = rig.tilt(0);
  return result;
}

Result heapOfArmadillos(const Case& run) {
  constexpr int kCount = 30;
  scenes::MeshArrays mesh = loadMesh("armadillo_4.ply", 0.005);  // 1.2 m from hand to tail
  const ShapePointer figure = makeShape(std::move(mesh));
  Rig rig(run);
  rig.addStatic(groundShape(20, 1, 20), {0, 0, 0});
  std::mt19937 random(static_cast<std::uint32_t>(run.randomSeed));
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  for (int i = 0; i < kCount; ++i) {
    const double x = uniform(), y = uniform(), w = uniform(), u = uniform(), v = uniform(), s = uniform();
    // Layers of six, clear of each other.
    const int column = i % 3, row = i / 3 % 2, layer = i / 6;
    const Vec place(0.95 * (column - 1) + 0.02 * x, 0.95 * (row - 0.5) + 0.02 * y, 0.7 + 1.1 * layer);
    rig.addBody(figure, place, Rotation(w, u, v, s).normalized());
  }
  double overlapped = 0;
  for (const Contact& contact : rig.contactsNow()) overlapped = std::max(overlapped, contact.depth);
  rig.run(10);
  Result result = resultOf(rig);
  double lowest = rig.position(0).z();
  for (int i = 0; i < rig.bodyCount(); ++i) lowest = std::min(lowest, rig.position(i).z());
  result.measures["lowest"] = lowest;
  result.measures["overlap_at_start"] = overlapped;
  result.measures["ke_each"] = result.measures["ke"] / kCount;
  return result;
}

}  // namespace

std::vector<Scene> realUseScenes() {
  std::vector<Scene> scenes{
      realScene(
          "real_panda",
          "The links of ten robot arms at random joint angles, overlapping at every joint, let go: they come apart",
          pandaFiles(), &panda),
      realScene("real_gears",
                "A gear drives another for a minute at constant speed: torque of its motor over the brake's", {},
                &gearMinute),
      realScene("real_screw", "A nut M16 runs down its bolt without friction for 2 s; share of the plastic reference",
                {"bolt_m16.ply", "nut_m16.ply"}, &machineScrew),
      realScene("real_heap", "Thirty scanned figures fall on a heap: at rest within 10 s, no energy gain",
                {"armadillo_4.ply"}, &heapOfArmadillos)};
  scenes[0].limits = {atMost("apart", 1), atMost("gain_when_free", 1e-6)};
  scenes[1].limits = {atLeast("mean_speed", 0.99), atMost("mean_speed", 1.01), atMost("depth_per_5ms", 0.01),
                      ofNative("mean_torque", Limit::Kind::kWithinShareOfNative, 0.1),
                      ofNative("torque_ripple", Limit::Kind::kWithinShareOfNative, 0.05)};
  scenes[1].axes = kAxisBuffer;
  scenes[1].hasNative = true;
  scenes[2].limits = {atLeast("share", 0.7), atMost("energy_gain", 0.05)};
  scenes[3].limits = {atMost("energy_gain", 0.05), atMost("ke_each", 0.01), atLeast("lowest", 0.1)};
  scenes[3].steppings = {kQ20};
  return scenes;
}

}  // namespace otg::physics
