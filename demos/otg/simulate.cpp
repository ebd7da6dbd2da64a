// SPDX-License-Identifier: BSD-3-Clause
// `otg simulate SCENE.json`: steps an ODE world and says what happened.
#include <fmt/format.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>

#include "otg/commands.h"
#include "scenes/gltf_animation.h"
#include "scenes/html_page.h"
#include "scenes/povray_scene.h"
#include "scenes/recording.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

using scenes::BodyState;
using scenes::Recording;
using scenes::Simulation;
using scenes::StepRecord;

struct SimulateOptions {
  std::string scene, glb, html, csv, povray;
  std::vector<double> pictureTimes;  ///< seconds; empty: six, evenly spaced
  int steps = -1;
  double dt = 0;
  int contactsPerRegion = 0;  ///< 0: the scene's
  double regionMerge = -1;    ///< negative: the scene's
  bool noHistory = false;
  bool prefetch = false;
  std::string backend;
  int threads = 0;
  bool json = false;
};

Json toJson(const Vec3d& v) {
  return Json::array({v.x, v.y, v.z});
}

/// What is kept of every step.
struct Run {
  std::vector<StepRecord> records;
  std::vector<scenes::Energy> energies;  ///< after each step
  Fnv1a hash;
};

/// Frames of a recording for pictures: those nearest to the times, or six evenly spaced ones.
std::vector<std::size_t> picturedFrames(const Recording& recording, const std::vector<double>& times) {
  constexpr std::size_t kPictures = 6;
  const std::size_t last = recording.times.size() - 1;
  std::vector<std::size_t> frames;
  if (times.empty()) {
    for (std::size_t i = 0; i < kPictures; ++i) frames.push_back(i * last / (kPictures - 1));
  }
  for (const double time : times) {
    const double frame = std::max(0.0, time) / (recording.stepsPerFrame * recording.dt);
    frames.push_back(static_cast<std::size_t>(std::min(double(last), std::round(frame))));
  }
  return frames;
}

void addToHash(Fnv1a& hash, const Simulation& simulation, const StepRecord& record) {
  hash.add(record.contacts);
  for (std::size_t i = 0; i < simulation.bodyCount(); ++i) {
    const BodyState state = simulation.state(i);
    hash.add(state.position);
    hash.add(state.rotation);
    hash.add(state.linearVelocity);
    hash.add(state.angularVelocity);
  }
}

class CsvFile {
 public:
  explicit CsvFile(const std::string& path) : path_(path) {
    if (path.empty()) return;
    file_.reset(std::fopen(path.c_str(), "wb"));
    if (!file_) throw InputError(path + ": cannot be written");
    fmt::print(file_.get(),
               "step,time,contacts,contacts_before_reduction,collide_ms,step_ms,kinetic_energy,potential_energy,"
               "intersecting_pairs\n");
  }
  void write(int step, double time, const StepRecord& record, const scenes::Energy& energy) {
    if (!file_) return;
    fmt::print(file_.get(), "{},{:.9g},{},{},{:.4f},{:.4f},{:.9g},{:.9g},{}\n", step, time, record.contacts,
               record.contactsBeforeReduction, record.collideMs, record.stepMs, energy.kinetic, energy.potential,
               record.intersectingPairs);
  }
  void close() {
    if (file_ && std::fclose(file_.release()) != 0) throw InputError(path_ + ": writing failed");
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
};

Run runSteps(Simulation& simulation, int steps, double dt, const SimulateOptions& options) {
  Run run;
  CsvFile csv(options.csv);
  std::unique_ptr<scenes::Recorder> recorder;
  if (!options.glb.empty() || !options.html.empty() || !options.povray.empty()) {
    recorder = std::make_unique<scenes::Recorder>(simulation, dt);
  }
  auto lastNews = std::chrono::steady_clock::now();
  for (int step = 1; step <= steps; ++step) {
    const StepRecord record = simulation.step(dt);
    addToHash(run.hash, simulation, record);
    run.records.push_back(record);
    run.energies.push_back(simulation.energy());
    csv.write(step, step * dt, record, run.energies.back());
    if (recorder) recorder->add(simulation, record);
    if (std::chrono::steady_clock::now() - lastNews > std::chrono::seconds(2)) {
      progress(fmt::format("step {} of {}: {} contacts, {:.2f} ms colliding, {:.2f} ms stepping", step, steps,
                           record.contacts, record.collideMs, record.stepMs));
      lastNews = std::chrono::steady_clock::now();
    }
  }
  csv.close();
  if (!options.glb.empty()) scenes::writeGlb(options.glb, recorder->recording());
  if (!options.html.empty()) scenes::writeHtmlPage(options.html, options.scene, recorder->recording());
  if (!options.povray.empty()) {
    const Recording& recording = recorder->recording();
    scenes::writePovrayFrames(options.povray, recording, picturedFrames(recording, options.pictureTimes));
  }
  return run;
}

/// Whether an OpenCL device computed anything.
bool devicesHelped() {
  bool any = false;
  for (int i = 0; i < dGpuTriMeshGetDeviceCount(); ++i) {
    dGpuTriMeshDevice device;
    dGpuTriMeshDeviceInit(&device);
    if (dGpuTriMeshGetDevice(i, &device) == dGPUTRIMESH_OK) any = any || device.queries > device.failed_queries;
  }
  return any;
}

Json describe(const Simulation& simulation, const Run& run, double dt, const scenes::Energy& start) {
  Json document;
  std::vector<int> contacts;
  std::vector<double> stepMs, collideMs;
  std::uint64_t beforeReduction = 0, pairs = 0;
  for (const StepRecord& record : run.records) {
    contacts.push_back(record.contacts);
    beforeReduction += record.contactsBeforeReduction;
    pairs += record.intersectingPairs;
    stepMs.push_back(record.stepMs);
    collideMs.push_back(record.collideMs);
  }
  document["steps"] = run.records.size();
  document["dt"] = dt;
  document["contacts_per_step"] = contacts;
  document["step_ms"] = stepMs;
  document["collide_ms"] = collideMs;
  const double n = std::max<double>(1, double(run.records.size()));
  document["summary"] = {{"mean_contacts", std::accumulate(contacts.begin(), contacts.end(), 0.0) / n},
                         {"mean_contacts_before_reduction", double(beforeReduction) / n},
                         {"mean_intersecting_pairs", double(pairs) / n},
                         {"max_contacts", contacts.empty() ? 0 : *std::max_element(contacts.begin(), contacts.end())},
                         {"median_step_ms", median(stepMs)},
                         {"median_collide_ms", median(collideMs)},
                         {"total_step_ms", std::accumulate(stepMs.begin(), stepMs.end(), 0.0)},
                         {"total_collide_ms", std::accumulate(collideMs.begin(), collideMs.end(), 0.0)}};
  const scenes::Energy end = simulation.energy();
  document["energy"] = {
      {"initial", start.total()}, {"final", end.total()}, {"kinetic", end.kinetic}, {"potential", end.potential}};
  document["bodies"] = Json::array();
  for (std::size_t i = 0; i < simulation.bodyCount(); ++i) {
    const BodyState state = simulation.state(i);
    document["bodies"].push_back({{"name", simulation.description(i).name},
                                  {"position", toJson(state.position)},
                                  {"rotation", state.rotation},
                                  {"linear_velocity", toJson(state.linearVelocity)},
                                  {"angular_velocity", toJson(state.angularVelocity)},
                                  {"center_of_mass", toJson(state.centerOfMass)},
                                  {"static", simulation.description(i).isStatic}});
  }
  document["backend"] = devicesHelped() ? "opencl" : "cpu";
  document["hash"] = run.hash.hex();
  return document;
}

void printReadable(const Json& document) {
  const Json& summary = document["summary"];
  fmt::print("{} steps of {} s\n", document["steps"].get<std::size_t>(), document["dt"].get<double>());
  fmt::print("contacts per step   {:.1f} on average (from {:.1f} pairs of intersecting triangles), {} at most\n",
             summary["mean_contacts"].get<double>(), summary["mean_intersecting_pairs"].get<double>(),
             summary["max_contacts"].get<int>());
  fmt::print("time per step       {:.3f} ms colliding, {:.3f} ms stepping (medians)\n",
             summary["median_collide_ms"].get<double>(), summary["median_step_ms"].get<double>());
  fmt::print("energy              {:.6g} J at the start, {:.6g} J at the end\n",
             document["energy"]["initial"].get<double>(), document["energy"]["final"].get<double>());
  fmt::print("hash                {}\n\n", document["hash"].get<std::string>());
  std::vector<std::vector<std::string>> rows;
  for (const Json& body : document["bodies"]) {
    const auto p = body["position"].get<std::vector<double>>(), v = body["linear_velocity"].get<std::vector<double>>();
    const auto q = body["rotation"].get<std::vector<double>>();
    rows.push_back({body["name"].get<std::string>(), fmt::format("{:.5f} {:.5f} {:.5f}", p[0], p[1], p[2]),
                    fmt::format("{:.4f} {:.4f} {:.4f} {:.4f}", q[0], q[1], q[2], q[3]),
                    fmt::format("{:.4f} {:.4f} {:.4f}", v[0], v[1], v[2])});
  }
  printTable({"body", "position", "rotation w x y z", "velocity"}, rows);
}

int simulate(const SimulateOptions& options) {
  scenes::SceneDescription scene = scenes::loadScene(options.scene);
  if (options.contactsPerRegion > 0) scene.contactsPerRegion = options.contactsPerRegion;
  if (options.regionMerge >= 0) scene.regionMerge = options.regionMerge;
  if (options.noHistory) scene.history = false;
  const scenes::OdeSession session;
  if (!options.backend.empty()) {
    const int backend = options.backend == "opencl" ? dGPUTRIMESH_BACKEND_OPENCL
                        : options.backend == "auto" ? dGPUTRIMESH_BACKEND_AUTO
                                                    : dGPUTRIMESH_BACKEND_CPU;
    const int status = dGpuTriMeshSetBackend(backend);
    dGpuTriMeshWaitForDevices(-1);  // the report says who computes, which must not depend on when the device is ready
    if (status == dGPUTRIMESH_NO_DEVICE) {
      progress("note: no OpenCL device can be used (`otg devices` lists what there is); the CPU computes");
    }
  }
  dGpuTriMeshSetThreadCount(options.threads);
  Simulation simulation(scene);
  simulation.setPrefetch(options.prefetch);
  const double dt = options.dt > 0 ? options.dt : scene.dt;
  const scenes::Energy start = simulation.energy();
  const Run run = runSteps(simulation, options.steps >= 0 ? options.steps : scene.steps, dt, options);
  const Json document = describe(simulation, run, dt, start);
  if (options.json)
    printJson(document);
  else
    printReadable(document);
  return kOk;
}

}  // namespace

void addSimulateCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("simulate", "Step an ODE world of meshes and primitives (format: docs/scene_format.md)");
  auto options = std::make_shared<SimulateOptions>();
  command->add_option("SCENE", options->scene, "Scene file, JSON")->required();
  command->add_option("--steps", options->steps, "Number of steps instead of the scene's")
      ->check(CLI::Range(0, 100000000));
  command->add_option("--dt", options->dt, "Time step in seconds instead of the scene's")
      ->check(CLI::Range(1e-9, 10.0));
  command
      ->add_option("--contacts-per-region", options->contactsPerRegion,
                   "At most this many contacts for one connected overlap of two meshes, instead of the scene's number")
      ->check(CLI::Range(1, 64));
  command
      ->add_option("--region-merge", options->regionMerge,
                   "Regions of contact of two meshes that come nearer to each other than this are one, instead of the "
                   "scene's length")
      ->check(CLI::Range(0.0, 1e30));
  command->add_flag("--no-history", options->noHistory,
                    "Contacts of meshes depend on the poses and velocities of the moment alone");
  command->add_flag("--prefetch", options->prefetch, "Compute the contacts of meshes ahead of the near callbacks");
  command->add_option("--threads", options->threads, "With --prefetch: threads; 0: one for each core (or OTG_THREADS)")
      ->check(CLI::Range(0, 1024));
  command->add_option("--backend", options->backend, "Where meshes are collided (cpu)")
      ->check(CLI::IsMember({"auto", "cpu", "opencl"}));
  command->add_option("--glb", options->glb, "Write the motion as an animation, binary glTF");
  command->add_option("--html", options->html, "Write the motion as a page for any browser, which needs no server");
  command->add_option("--povray", options->povray, "Write single frames into this folder, to be drawn by POV-Ray");
  command
      ->add_option("--picture-times", options->pictureTimes, "Times of those frames in seconds, as t,t,...; else six")
      ->delimiter(',')
      ->needs("--povray");
  command->add_option("--csv", options->csv, "Write contacts, times and energies of every step");
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return simulate(*options); }; });
}

}  // namespace otg::cli
