// SPDX-License-Identifier: BSD-3-Clause
// `otg bench queries`: arrays of points and of rays against one mesh, and of pairs of meshes that overlap or not.
// Through the C API, the CPU beside an OpenCL device.
#include <fmt/format.h>
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <cmath>
#include <cstring>

#include "cli/progress.h"
#include "cli/query_options.h"
#include "dispatch/dispatcher.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "otg_bench/overlaps.h"
#include "otg_bench/rays.h"
#include "scenes/simulation.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

struct QueriesOptions {
  BenchOptions scene;
  std::vector<int> counts{1000, 10000, 100000, 1000000};
  std::vector<int> rays{1000, 10000, 100000, 1000000};
  std::vector<int> pairs{100, 1000, 10000};
  std::vector<int> devices;
  int alone = 100000;  ///< most points or rays that one thread does
  std::uint32_t seed = 1;
  opencl::Tuning tuning;
};

/// What one call returns, as bytes.
using Answers = std::vector<unsigned char>;

struct Ask {
  const char* name;
  std::function<void(dGeomID geom, const std::vector<dReal>& points, int count, Answers& answers)> run;
};

std::vector<Ask> asks() {
  const auto closest = [](dGeomID geom, const std::vector<dReal>& points, int count, Answers& answers) {
    answers.resize(static_cast<std::size_t>(count) * sizeof(dGpuTriMeshClosestPoint));
    dGeomGpuTriMeshClosestPoints(geom, points.data(), 3 * sizeof(dReal), count,
                                 reinterpret_cast<dGpuTriMeshClosestPoint*>(answers.data()));
  };
  const auto inside = [](dGeomID geom, const std::vector<dReal>& points, int count, Answers& answers) {
    answers.resize(static_cast<std::size_t>(count));
    dGeomGpuTriMeshPointsInside(geom, points.data(), 3 * sizeof(dReal), count, answers.data());
  };
  return {{"closest point and signed distance", closest}, {"inside", inside}};
}

/// Around: anywhere in a box 1.2 times as large as the mesh's. Near: within a hundredth of the mesh's size of vertices.
std::vector<dReal> drawPoints(const TriMesh& mesh, bool near, int count, truth::Random& random) {
  std::vector<dReal> points;
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  const double reach = 0.01 * double{mesh.radius()};
  for (int i = 0; i < count; ++i) {
    if (near) {
      const auto t = static_cast<std::size_t>(random.uniform(0, static_cast<double>(mesh.triangleCount())));
      const Vec3f& v = mesh.vertices()[mesh.triangles()[t].v[0]];
      for (const float x : {v.x, v.y, v.z}) points.push_back(double{x} + random.uniform(-reach, reach));
    } else {
      for (const auto& [low, high] : {std::pair{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}}) {
        const double middle = 0.5 * (double{low} + high), half = 0.6 * (double{high} - low);
        points.push_back(middle + random.uniform(-half, half));
      }
    }
  }
  return points;
}

/// What the device takes without what the CPU makes of its results.
double rawTime(const CollisionMesh& mesh, const std::vector<dReal>& points, int count, bool nearest, int repeat) {
  const auto slots = dispatcher().devices();
  if (slots.empty()) return NAN;
  const auto fill = [&](std::size_t begin, std::size_t end, Vec3d* to) {
    std::memcpy(to, points.data() + 3 * begin, (end - begin) * sizeof(Vec3d));
  };
  static_assert(sizeof(dReal) == sizeof(double));
  const auto take = [](std::size_t, std::size_t, const Vec3d*, const otg_uint*) {};
  const bool solid = mesh.mesh().meshClass() == MeshClass::kSolid;
  const auto once = [&] {
    slots.front()->backend->askPoints(mesh, {nearest || !solid, solid}, static_cast<std::size_t>(count), fill, take);
  };
  once();
  return median(repeatTimes(repeat, [&] { return timeOnce(once); }));
}

Json numberOrNull(double x) {
  return std::isfinite(x) ? Json(x) : Json();
}

Json pointRows(const QueriesOptions& options, int repeat, bool withDevices) {
  Json rows = Json::array();
  const std::vector<BenchMesh> meshes = benchMeshes(options.scene);
  Progress parts(meshes.size() * asks().size() * 2 * options.counts.size());
  for (const BenchMesh& mesh : meshes) {
    const auto sorted = sortedForLocality(*mesh.mesh);
    const CollisionMesh tree(sorted, BuildStrategy::kSah);
    const dGpuTriMeshDataID data = meshData(*mesh.mesh, mesh.name);
    const dGeomID geom = dCreateGpuTriMesh(nullptr, data);
    for (const Ask& ask : asks()) {
      for (const bool near : {false, true}) {
        for (const int count : options.counts) {
          truth::Random random(options.seed);
          const std::vector<dReal> points = drawPoints(*mesh.mesh, near, count, random);
          Answers expected, answers;
          bool same = true;
          const auto timed = [&](int backend, unsigned with, int most) {
            dGeomGpuTriMeshSetBackend(geom, backend);
            dGpuTriMeshSetThreadCount(static_cast<int>(with));
            ask.run(geom, points, count, answers);
            same = same && answers == expected;
            return median(repeatTimes(std::min(most, repeat),
                                      [&] { return timeOnce([&] { ask.run(geom, points, count, answers); }); }));
          };
          dGeomGpuTriMeshSetBackend(geom, dGPUTRIMESH_BACKEND_CPU);
          dGpuTriMeshSetThreadCount(0);
          ask.run(geom, points, count, expected);
          const double one = count <= options.alone ? timed(dGPUTRIMESH_BACKEND_CPU, 1, 3) : NAN;
          const double all = timed(dGPUTRIMESH_BACKEND_CPU, 0, repeat);
          const double onDevice = withDevices ? timed(dGPUTRIMESH_BACKEND_OPENCL, 0, repeat) : NAN;
          const std::uint64_t before = deviceSum(&dGpuTriMeshDevice::calls);
          dGeomGpuTriMeshSetBackend(geom, dGPUTRIMESH_BACKEND_AUTO);
          ask.run(geom, points, count, answers);
          same = same && answers == expected;
          Fnv1a hash;
          hash.add(expected.data(), expected.size());
          const bool nearest = ask.name[0] == 'c';
          rows.push_back(
              {{"mesh", mesh.name},
               {"asked", ask.name},
               {"points", near ? "near" : "around"},
               {"count", count},
               {"one_thread_ms", numberOrNull(one)},
               {"all_threads_ms", all},
               {"device_ms", numberOrNull(onDevice)},
               {"device_alone_ms", withDevices ? numberOrNull(rawTime(tree, points, count, nearest, repeat)) : Json()},
               {"one_thread_per_s", numberOrNull(1e3 * count / one)},
               {"all_threads_per_s", 1e3 * count / all},
               {"device_per_s", numberOrNull(1e3 * count / onDevice)},
               {"times_all_threads", numberOrNull(all / onDevice)},
               {"auto", deviceSum(&dGpuTriMeshDevice::calls) > before ? "opencl" : "cpu"},
               {"answers", same ? "same" : "DIFFERENT"},
               {"hash", hash.hex()}});
          parts.step();
        }
      }
    }
    dGeomDestroy(geom);
    dGpuTriMeshDataDestroy(data);
  }
  dGpuTriMeshSetThreadCount(0);
  return rows;
}

int benchQueries(const QueriesOptions& options) {
  const scenes::OdeSession session;
  const int repeat = options.scene.repeat > 0 ? options.scene.repeat : 7;
  const unsigned threads = defaultThreadCount();
  std::vector<int> devices = options.devices;
  const std::vector<opencl::DeviceInfo> found = findDevices();
  if (devices.empty() && opencl::defaultDevice(found) >= 0) devices = {opencl::defaultDevice(found)};
  const std::size_t opened = devices.empty() ? 0 : dispatcher().open(devices, options.tuning);
  const auto slots = dispatcher().devices();
  const std::string device = opened > 0 ? slots.front()->backend->device().name : "";
  Progress all(4);
  const Json points = pointRows(options, repeat, opened > 0);
  all.step();
  const Json rays = rayRows(options.scene, options.rays, options.alone, repeat, opened > 0);
  all.step();
  const Json overlaps = overlapRows(options.scene, options.pairs, repeat, opened > 0);
  all.step();
  const Json distances = distanceRows(options.scene, options.pairs, repeat, opened > 0);
  Json costs;
  if (opened > 0) {
    const CostModel& model = slots.front()->costs;
    const auto line = [](const Cost& cost) { return Json{{"fixed", cost.fixed}, {"per_level", cost.perTriangle}}; };
    costs = {{"host_nearest", line(model.hostNearest)},
             {"host_inside", line(model.hostInside)},
             {"device_nearest", line(model.deviceNearest)},
             {"device_inside", line(model.deviceInside)},
             {"launch", line(model.pointLaunch)},
             {"finish", model.pointFinish},
             {"host_overlap", line(model.hostOverlap)},
             {"device_overlap", line(model.batchOverlap)},
             {"host_distance", line(model.hostDistance)},
             {"device_distance", line(model.batchDistance)},
             {"distance_launch", model.distanceLaunch},
             {"host_ray", line(model.hostRay)},
             {"device_ray", line(model.deviceRay)},
             {"ray_launch", line(model.rayLaunch)},
             {"ray_finish", model.rayFinish},
             {"overlap_launch", model.overlapLaunch},
             {"speedup", model.hostSpeedup}};
  }
  const Json document{
      {"bench", "queries"},
      {"device", device},
      {"threads", threads},
      {"costs_us", costs},
      {"tables", {{"points", points}, {"rays", rays}, {"overlaps", overlaps}, {"distances", distances}}}};
  printBench(document, options.scene.json);
  return 0;
}

}  // namespace

void addBenchQueries(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand(
      "queries",
      "Arrays of points and of rays against a mesh, and of pairs of meshes, an OpenCL device beside the CPU");
  auto options = std::make_shared<QueriesOptions>();
  options->scene.addTo(*command, false);
  command->add_option("--points", options->counts, "How many")->delimiter(',')->check(CLI::Range(1, 100000000));
  command->add_option("--rays", options->rays, "How many rays")->delimiter(',')->check(CLI::Range(1, 100000000));
  command->add_option("--pairs", options->pairs, "How many pairs of meshes")
      ->delimiter(',')
      ->check(CLI::Range(1, 10000000));
  command->add_option("--device", options->devices, "Number of the device, as `otg devices` has it")->delimiter(',');
  command->add_option("--alone", options->alone, "Most points or rays that are also given to one thread");
  command->add_option("--piece", options->tuning.pointPiece, "Points of a piece at most")
      ->check(CLI::Range(1, 1 << 30));
  command->add_option("--group", options->tuning.pointGroup, "Work-items of a work-group")->check(CLI::Range(1, 1024));
  command->add_option("--leaf", options->tuning.leafTriangles, "Triangles of a leaf at most")->check(CLI::Range(1, 8));
  command->add_option("--seed", options->seed, "Of the random numbers");
  command->callback([options, &action] { action = [options] { return benchQueries(*options); }; });
}

}  // namespace otg::cli
