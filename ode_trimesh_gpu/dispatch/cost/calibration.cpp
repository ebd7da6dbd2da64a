// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/cost/calibration.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include "base/vectors.h"
#include "dispatch/array_run.h"
#include "dispatch/cost/calibration_mesh.h"
#include "dispatch/cost/rehearsal.h"
#include "dispatch/distance_run.h"
#include "dispatch/threads/thread_pool.h"
#include "dispatch/threads/workspace_lease.h"
#include "opencl/runtime/stop.h"
#include "queries/mesh_overlap.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

/// Microseconds: the least of a few runs, which is what the work takes when nothing else is in the way.
template <class Work>
double timeOf(int repeat, Work&& work) {
  using Clock = std::chrono::steady_clock;
  double least = 1e30;
  opencl::checkStop();
  for (int i = 0; i < repeat; ++i) {
    const auto start = Clock::now();
    work();
    least = std::min(least, std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  return least;
}

/// So that the compiler does not leave out what leads to the number.
void keep(double sum) {
  volatile double kept = sum;
  static_cast<void>(kept);
}

struct Parallel {
  double threads = 1, speedup = 1;
  bool isDisturbed = false;  ///< other threads took the processors for more than a tenth of the time
};

/// Seconds that the calling thread was at work.
double processorTime() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// How much more all threads do than one.
Parallel measureThreads(const std::vector<Query>& queries) {
  const unsigned threads = defaultThreadCount();
  if (threads < 2 || queries.empty()) return {};
  ThreadPool pool(threads);
  Workspace workspace;
  const double alone = timeOf(2, [&] {
    for (const Query& query : queries) collide(query, workspace);
  });
  // So much work that starting the threads does not count: some milliseconds for each.
  const std::size_t rounds =
      threads * std::clamp<std::size_t>(static_cast<std::size_t>(3000 / std::max(alone, 1.0)), 1, 1000);
  using Clock = std::chrono::steady_clock;
  std::atomic<double> atWork{0}, taken{0};  // seconds, of all threads
  const double together = timeOf(2, [&] {
    pool.run(rounds, 1, [&](std::size_t begin, std::size_t end) {
      const auto start = Clock::now();
      const double before = processorTime();
      const WorkspaceLease lease;
      for (std::size_t i = begin; i < end; ++i) {
        for (const Query& query : queries) collide(query, *lease);
      }
      atWork += processorTime() - before;
      taken += std::chrono::duration<double>(Clock::now() - start).count();
    });
  });
  return {static_cast<double>(threads),
          std::clamp(static_cast<double>(rounds) * alone / together, 1.0, static_cast<double>(threads)),
          atWork < 0.9 * taken};
}

/// Points in a box twice as large as the mesh, of which an eighth lie where the mesh is.
std::vector<Vec3d> pointsAround(std::size_t count) {
  std::vector<Vec3d> points(count);
  std::uint64_t state = 1;
  const auto next = [&] {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return 4 * (static_cast<double>(state >> 11) * 0x1p-53 - 0.5);
  };
  for (Vec3d& p : points) p = {next(), next(), next()};
  return points;
}

/// What the model says of arrays of points. False if the device fails.
bool measurePoints(opencl::Backend& backend, std::span<const std::shared_ptr<const CollisionMesh>> meshes,
                   CostModel& model) {
  // So many that the device is busy; the CPU does some of them.
  const std::size_t most = backend.device().kind == opencl::DeviceKind::kCpu ? 1u << 12 : 1u << 18;
  constexpr std::size_t kOnHost = 512, kFew = 64;
  constexpr int kRepeat = 3;
  const std::vector<Vec3d> points = pointsAround(most);
  const auto perPoint = [](double time, std::size_t count) { return time / static_cast<double>(count); };
  bool good = true;
  double finish = 0;
  std::vector<std::pair<double, double>> launch, hostNearest, hostInside, deviceNearest, deviceInside;
  for (const auto& mesh : meshes) {
    const double work = pointWork(mesh->mesh());
    const auto onDevice = [&](opencl::PointRequest request, std::size_t count) {
      const auto fill = [&](std::size_t begin, std::size_t end, Vec3d* to) {
        std::copy(points.data() + begin, points.data() + end, to);
      };
      const auto take = [](std::size_t, std::size_t, const Vec3d*, const otg_uint*) {};
      const auto once = [&] { good = backend.askPoints(*mesh, request, count, fill, take) == count && good; };
      once();  // memory, uploads
      return timeOf(kRepeat, once);
    };
    const double few = onDevice({true, true}, kFew);
    const double nearest = onDevice({true, false}, most), inside = onDevice({false, true}, most);
    if (!good) return false;
    launch.emplace_back(work, few);
    deviceNearest.emplace_back(work, perPoint(std::max(nearest - few, 0.1 * nearest), most));
    deviceInside.emplace_back(work, perPoint(std::max(inside - few, 0.1 * inside), most));
    double sum = 0;
    const auto onHost = [&](const auto& one) {
      const double time = timeOf(kRepeat, [&] {
        for (std::size_t i = 0; i < kOnHost; ++i) one(i);
      });
      return perPoint(time, kOnHost);
    };
    std::vector<SurfacePoint> nearestOf(kOnHost);
    const double search = onHost([&](std::size_t i) { nearestOf[i] = closestPoint(*mesh, points[i]); });
    const double rest = onHost([&](std::size_t i) {
      const SurfacePoint found = pointOnTriangle(mesh->mesh(), nearestOf[i].triangle, points[i]);
      sum += outwardNormal(*mesh, found).x;
    });
    hostNearest.emplace_back(work, search + rest);
    finish = std::max(finish, rest);
    hostInside.emplace_back(work,
                            onHost([&](std::size_t i) { sum += isInside(*mesh, points[i], nearestOf[i]) ? 1 : 0; }));
    keep(sum);
  }
  model.pointLaunch = fitCost(launch);
  model.pointFinish = finish;
  model.hostNearest = fitCost(hostNearest);
  model.hostInside = fitCost(hostInside);
  model.deviceNearest = fitCost(deviceNearest);
  model.deviceInside = fitCost(deviceInside);
  return true;
}

/// Rays from around a mesh to somewhere near it, of which about a half hit it.
std::vector<LongRay> raysTowards(const TriMesh& mesh, std::size_t count) {
  const std::vector<Vec3d> points = pointsAround(2 * count);
  std::vector<LongRay> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d& from = points[2 * i];
    const Vec3d way = otgSub(otgScale(points[2 * i + 1], 0.5 * double{mesh.radius()}), from);
    const double length = norm(way);
    rays[i] = {{from, length > 0 ? otgScale(way, 1 / length) : Vec3d{0, 0, 1}},
               std::numeric_limits<double>::infinity()};
  }
  return rays;
}

/// What the model says of arrays of rays. False if the device fails.
bool measureRays(opencl::Backend& backend, std::span<const std::shared_ptr<const CollisionMesh>> meshes,
                 CostModel& model) {
  // As for points; more of them on the CPU, where they take less time.
  const std::size_t most = backend.device().kind == opencl::DeviceKind::kCpu ? 1u << 12 : 1u << 18;
  constexpr std::size_t kOnHost = 2048, kFew = 64;
  constexpr int kRepeat = 3;
  ThreadPool pool(defaultThreadCount());
  bool good = true;
  double finish = 0;
  std::vector<std::pair<double, double>> launch, host, device;
  for (const auto& mesh : meshes) {
    const double work = pointWork(mesh->mesh());
    const std::vector<LongRay> rays = raysTowards(mesh->mesh(), most);
    const auto onDevice = [&](std::size_t count) {
      // By all threads, as in use: one alone takes longer to copy rays than the device to cast them.
      const auto fill = [&](std::size_t begin, std::size_t end, LongRay* to) {
        pool.run(end - begin, 4096, [&](std::size_t b, std::size_t e) {
          std::copy(rays.data() + begin + b, rays.data() + begin + e, to + b);
        });
      };
      const auto take = [](std::size_t, std::size_t, const LongRay*, const otg_uint*) {};
      const auto once = [&] { good = backend.castRays(*mesh, false, count, fill, take) == count && good; };
      once();  // memory, uploads
      return timeOf(kRepeat, once);
    };
    const double few = onDevice(kFew), all = onDevice(most);
    if (!good) return false;
    launch.emplace_back(work, few);
    device.emplace_back(work, std::max(all - few, 0.1 * all) / static_cast<double>(most));
    double sum = 0;
    std::vector<RayHit> hits(kOnHost);
    const auto onHost = [&](const auto& one) {
      const double time = timeOf(kRepeat, [&] {
        for (std::size_t i = 0; i < kOnHost; ++i) one(i);
      });
      return time / static_cast<double>(kOnHost);
    };
    const RayJob job{mesh.get(), false, Place::kCpu};
    const double search = onHost([&](std::size_t i) { hits[i] = answerOne(job, rays[i]); });
    const double again = onHost([&](std::size_t i) {
      RayHit hit;
      if (hits[i].triangle != kNone) TriangleRay(mesh->mesh(), rays[i].ray).hits(hits[i].triangle, hit);
      sum += hit.distance;
    });
    keep(sum);
    host.emplace_back(work, search);
    finish = std::max(finish, again);
  }
  model.rayLaunch = fitCost(launch);
  model.hostRay = fitCost(host);
  model.deviceRay = fitCost(device);
  model.rayFinish = finish;
  return true;
}

/// What the model says of yes or no, from these pairs and as many of each as keep the device busy. False if it fails.
bool measureOverlaps(opencl::Backend& backend, const std::vector<Query>& some, std::size_t pairs, CostModel& model) {
  constexpr int kRepeat = 3;
  constexpr std::size_t kOnHost = 32;
  bool good = true;
  std::vector<std::uint8_t> answer;
  // As many a little elsewhere: what is soon found in one pose, and what lies in caches, is not what batches meet.
  const auto jittered = [](const Query& query, std::size_t count) {
    std::vector<Query> all(count, query);
    const double reach = 1e-3 * static_cast<double>(query.a->mesh().radius());
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2.4 * static_cast<double>(i);  // the golden angle: no two alike
      all[i].bInA.t.x += reach * std::cos(angle);
      all[i].bInA.t.y += reach * std::sin(angle);
    }
    return all;
  };
  const auto run = [&](const std::vector<Query>& queries) {
    good = backend.intersectBatch(queries, answer) && good;  // memory, uploads
    return timeOf(kRepeat, [&] { good = backend.intersectBatch(queries, answer) && good; });
  };
  std::vector<std::pair<double, double>> host, device;
  for (const Query& query : some) {
    const double work = expectedWork(query);
    const double once = run(jittered(query, pairs)), twice = run(jittered(query, 2 * pairs));
    device.emplace_back(work, std::max(twice - once, 0.1 * twice) / static_cast<double>(pairs));
    const std::vector<Query> onHost = jittered(query, kOnHost);
    const double time = timeOf(kRepeat, [&] {
      for (const Query& one : onHost) keep(overlap(one) ? 1 : 0);
    });
    host.emplace_back(work, time / static_cast<double>(kOnHost));
    if (!good) return false;
  }
  model.overlapLaunch = run({some[0]});
  model.batchOverlap = fitCost(device);
  model.hostOverlap = fitCost(host);
  return good;
}

/// What the model says of distances, from these pairs moved apart. False if the device fails.
bool measureDistances(opencl::Backend& backend, const std::vector<Query>& some, std::size_t pairs, CostModel& model) {
  constexpr int kRepeat = 2;
  constexpr std::size_t kOnHost = 4;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ThreadPool pool(defaultThreadCount());
  const opencl::RunParts parts = [&](std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
    pool.run(count, 32, work);
  };
  bool good = true;
  const auto jittered = [](const Query& query, std::size_t count) {
    std::vector<Query> all(count, query);
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = 2.4 * static_cast<double>(i);  // the golden angle: no two alike
      all[i].bInA.t = otgScale(query.bInA.t, 1.5);
      all[i].bInA.t.x += 0.1 * std::cos(angle);
      all[i].bInA.t.y += 0.1 * std::sin(angle);
    }
    return all;
  };
  const auto run = [&](const std::vector<Query>& queries) {
    std::vector<TrianglePair> nearest(queries.size());
    const auto once = [&] {
      good = backend.nearestTriangles(queries, kInfinity, nearest, parts) == queries.size() && good;
    };
    once();  // memory, uploads
    return timeOf(kRepeat, once);
  };
  std::vector<std::pair<double, double>> host, device;
  for (const Query& query : some) {
    const double once = run(jittered(query, pairs)), twice = run(jittered(query, 2 * pairs));
    device.emplace_back(distanceWork(query), std::max(twice - once, 0.1 * twice) / static_cast<double>(pairs));
    const double time = timeOf(kRepeat, [&] {
      for (const Query& one : jittered(query, kOnHost)) keep(distanceApart(one, kInfinity).distance);
    });
    host.emplace_back(distanceWork(query), time / static_cast<double>(kOnHost));
    if (!good) return false;
  }
  model.distanceLaunch = run(jittered(some[0], 1));
  model.batchDistance = fitCost(device);
  model.hostDistance = fitCost(host);
  return good;
}

std::string processorName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) == 0) return line;
  }
  return "a processor";
}

}  // namespace

std::optional<CostModel> measureCosts(opencl::Backend& backend, bool* isDisturbed) {
  constexpr std::array kSteps = {2, 6, 18, 50};
  constexpr std::array kDistances = {1.97, 1.8, 1.4};
  constexpr int kRepeat = 3;
  std::vector<std::shared_ptr<const CollisionMesh>> meshes;
  for (const int steps : kSteps) {
    for (const double phase : {0.0, 1.0}) meshes.push_back(calibrationBody(steps, phase));
  }
  bool good = true;
  using Points = std::vector<std::pair<double, double>>;
  Points hostPairs, hostPairwise, hostSolid, devicePairs, devicePairwise, deviceSolid, batch;
  std::vector<SolidTime> solid;
  // Not on CPUs, whose threads are as quick without: kernels would be compiled for this alone.
  const bool doesSolids = mayDoSolids(backend);
  std::vector<Query> small;
  Workspace workspace;
  opencl::BatchAnswer answer;
  for (std::size_t i = 0; i < meshes.size(); i += 2) {
    for (const double distance : kDistances) {
      Query query;
      query.a = meshes[i].get();
      query.b = meshes[i + 1].get();
      query.bInA = Transformd{{1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8}, {0.6 * distance, 0.48 * distance, 0.64 * distance}};
      query.options.maxContacts = 64;
      const double work = expectedWork(query);
      const auto point = [&](Points& to, const std::function<void()>& run) {
        run();  // memory, uploads
        to.emplace_back(work, timeOf(kRepeat, run));
      };
      point(hostPairs, [&] { findIntersectingPairs(query, workspace); });
      point(hostPairwise, [&] { collide(query, workspace); });
      Query asSolid = query;
      asSolid.options.contacts = ContactModel::kSolid;
      point(hostSolid, [&] { collide(asSolid, workspace); });
      point(devicePairs, [&] { good = backend.findIntersectingPairs(query, workspace) && good; });
      point(devicePairwise, [&] { good = backend.collide(query, workspace) && good; });
      if (doesSolids) point(deviceSolid, [&] { good = backend.collide(asSolid, workspace) && good; });
      if (kSteps[i / 2] <= 18) small.push_back(query);
      if (!good) return std::nullopt;
    }
  }
  // Batches of one kind of pair each. As many pairs as keep every compute unit busy, because few pairs take as long as
  // the largest of them; then what twice as many take longer.
  const std::size_t pairs = std::clamp<std::size_t>(std::size_t{16} * backend.device().computeUnits, 64, 4096);
  const auto run = [&](const std::vector<Query>& queries) {
    good = backend.collideBatch(queries, answer) && good;
    return timeOf(kRepeat, [&] { good = backend.collideBatch(queries, answer) && good; });
  };
  const auto timeOfOne = [&](const Query& query, std::size_t count) {
    const double once = run(std::vector<Query>(count, query)), twice = run(std::vector<Query>(2 * count, query));
    return std::max(twice - once, 0.1 * twice) / static_cast<double>(count);
  };
  const double one = run({small[0]});
  for (const Query& query : small) {
    batch.emplace_back(expectedWork(query), timeOfOne(query, pairs));
    if (!good) return std::nullopt;
  }
  double oneSolid = 0;
  if (doesSolids) {
    // Some of which the overlaps are so large that they are described; fewer of these keep the device as busy.
    constexpr int kLargeSteps = 36;
    const auto largeA = calibrationBody(kLargeSteps, 0), largeB = calibrationBody(kLargeSteps, 1);
    std::vector<Query> solids = small;
    for (std::size_t i = 0; i < kDistances.size(); ++i) {
      solids.push_back(small[i]);
      solids.back().a = largeA.get();
      solids.back().b = largeB.get();
    }
    for (Query& query : solids) query.options.contacts = ContactModel::kSolid;
    oneSolid = run({solids[0]});
    constexpr std::size_t kFewSolids = 64;  // as many as are described
    for (const Query& query : solids) {
      const std::uint64_t before = backend.counts().described;
      good = backend.collideBatch(std::vector<Query>(kFewSolids, query), answer) && good;
      if (!good) return std::nullopt;
      if (answer.leftToHost > 0) continue;  // by this thread alone, which is not what batches meet, and takes seconds
      const bool described = backend.counts().described > before;
      const double time = timeOfOne(query, described ? std::max(pairs / 4, kFewSolids) : pairs);
      if (!good) return std::nullopt;
      solid.push_back({expectedWork(query), time, described});
    }
  }
  const Parallel parallel = measureThreads(small);
  CostModel model;
  model.hostPairs = fitCost(hostPairs);
  model.hostPairwise = fitCost(hostPairwise);
  model.devicePairs = fitCost(devicePairs);
  model.devicePairwise = fitCost(devicePairwise);
  if (!deviceSolid.empty()) model.deviceSolid = fitCost(deviceSolid);
  model.batchPair = fitCost(batch);
  model.batchLaunch = one;
  fitSolids(solid, hostSolid, model);
  if (!solid.empty()) model.solidLaunch = oneSolid;
  if (!measureOverlaps(backend, small, pairs, model)) return std::nullopt;
  if (backend.answersPoints() && backend.answersRays() && backend.answersDistances()) {
    std::vector<std::shared_ptr<const CollisionMesh>> some;
    for (std::size_t i = 0; i < meshes.size(); i += 2) some.push_back(meshes[i]);
    if (!measurePoints(backend, some, model) || !measureRays(backend, some, model)) return std::nullopt;
    std::vector<Query> apart;
    for (std::size_t i = 0; i < small.size(); i += kDistances.size()) apart.push_back(small[i]);
    if (!measureDistances(backend, apart, doesSolids ? pairs : 16, model)) return std::nullopt;
  }
  model.hostThreads = parallel.threads;
  model.hostSpeedup = parallel.speedup;
  if (isDisturbed != nullptr) *isDisturbed = parallel.isDisturbed;
  return good && model.isSane() ? std::optional(model) : std::nullopt;
}

std::string costKey(const opencl::DeviceInfo& device) {
  return "costs 8\n" + device.platform + "\n" + device.name + "\n" + device.version + "\n" + device.driver + "\n" +
         (device.doubles ? "doubles" : "no doubles") + "\n" + processorName();
}

std::optional<CostModel> storedCosts(const opencl::DeviceInfo& device, const opencl::ProgramCache& cache) {
  const std::optional<opencl::Bytes> stored = cache.load(costKey(device));
  return stored ? costModelFrom(*stored) : std::nullopt;
}

std::optional<CostModel> costsOf(opencl::Backend& backend, const opencl::ProgramCache& cache, KeptCosts kept) {
  if (const std::optional<CostModel> model = storedCosts(backend.device(), cache)) return model;
  bool isDisturbed = false;
  const std::optional<CostModel> model = measureCosts(backend, &isDisturbed);
  if (model && (kept == KeptCosts::kAll || !isDisturbed)) cache.store(costKey(backend.device()), toBytes(*model));
  return model;
}

}  // namespace otg
