// SPDX-License-Identifier: BSD-3-Clause
#include "dispatch/overlap_run.h"

#include <exception>
#include <system_error>
#include <thread>

#include "queries/mesh_overlap.h"

namespace otg {
namespace {

using Indices = std::vector<std::size_t>;

/// Items that a thread takes at once: one, unless there are so many that taking them costs.
constexpr std::size_t kManyPairs = 1024, kPairsAtOnce = 8;
constexpr std::size_t kInsideAtOnce = 32, kReadAtOnce = 128;

bool hasTriangles(const opencl::PosedMeshes& pair) {
  const auto any = [](const CollisionMesh* mesh) { return mesh != nullptr && !mesh->tree().nodes.empty(); };
  return any(pair.a) && any(pair.b);
}

/// The device's part of some jobs, and what the CPU's threads add to it.
void askDevice(DeviceSlot& slot, ThreadPool& pool, std::span<const OverlapJob> jobs, std::span<const std::size_t> which,
               std::span<std::uint8_t> answers) {
  std::vector<const opencl::PosedMeshes*> pairs;
  pairs.reserve(which.size());
  for (const std::size_t i : which) pairs.push_back(&jobs[i].pair);
  const opencl::RunParts onHost = [&](std::size_t count, const ThreadPool::Work& work) {
    pool.run(count, 1, work, true);  // the device waits for it
  };
  std::vector<std::uint8_t> intersect;
  const bool good = slot.backend->intersectBatch(pairs, intersect, nullptr, onHost);
  slot.note(which.size(), good);
  pool.run(which.size(), kInsideAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Vec3d vertex{};
      answers[which[k]] = intersect[k] != 0 || containedVertex(opencl::queryOf(*pairs[k]), vertex) ? 1 : 0;
    }
  });
}

}  // namespace

bool areOverlapsSoonerOnDevice(double work, std::size_t pairs, const CostModel& costs, std::size_t devices,
                               unsigned threads) {
  if (!costs.knowsOverlaps()) return false;
  const auto of = [&](const Cost& cost) { return cost.fixed * static_cast<double>(pairs) + cost.perTriangle * work; };
  return costs.overlapLaunch + of(costs.batchOverlap) / static_cast<double>(devices) <
         of(costs.hostOverlap) / costs.speedup(threads);
}

void runOverlaps(ThreadPool& pool, const std::vector<std::shared_ptr<DeviceSlot>>& devices,
                 std::span<const OverlapJob> jobs, std::span<std::uint8_t> answers) {
  // By all threads: jobs are many and lie far apart.
  enum class Kind : std::uint8_t { kEmpty, kHost, kBound, kOpen };
  std::vector<Kind> kinds(jobs.size(), Kind::kEmpty);
  std::vector<double> works(jobs.size(), 0);  // where something depends on it
  pool.run(jobs.size(), kReadAtOnce, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      answers[i] = 0;
      if (!hasTriangles(jobs[i].pair)) continue;
      const bool isHosts = devices.empty() || (jobs[i].place == Place::kAuto && !devices[0]->isForAuto);
      const Place place = isHosts ? Place::kCpu : jobs[i].place;
      kinds[i] = place == Place::kCpu ? Kind::kHost : place == Place::kOpencl ? Kind::kBound : Kind::kOpen;
      const bool matters = kinds[i] == Kind::kOpen || devices.size() > 1;
      if (kinds[i] != Kind::kHost && matters) works[i] = expectedWork(opencl::queryOf(jobs[i].pair));
    }
  });
  Indices bound, open, host;
  double openWork = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (kinds[i] == Kind::kEmpty) continue;
    (kinds[i] == Kind::kHost ? host : kinds[i] == Kind::kBound ? bound : open).push_back(i);
    if (kinds[i] == Kind::kOpen) openWork += works[i];
  }
  const bool sooner = !open.empty() && areOverlapsSoonerOnDevice(openWork, open.size(), devices[0]->costs,
                                                                 devices.size(), pool.threadCount());
  Indices& target = sooner ? bound : host;
  target.insert(target.end(), open.begin(), open.end());
  // Rows of equal cost, one for each device.
  const auto cost = [&](std::size_t i) { return devices[0]->costs.batchOverlap.of(works[i]) + 1e-9; };
  double all = 0;
  for (const std::size_t i : bound) all += devices.size() > 1 ? cost(i) : 0;
  std::vector<std::thread> threads;
  std::vector<std::exception_ptr> errors(devices.size());
  const std::span<const std::size_t> row(bound);
  const auto ask = [&](std::size_t d, std::span<const std::size_t> part) {
    try {
      askDevice(*devices[d], pool, jobs, part, answers);
    } catch (...) {
      errors[d] = std::current_exception();
    }
  };
  double done = 0;
  std::size_t begin = 0;
  for (std::size_t d = 0; d < devices.size() && begin < row.size(); ++d) {
    std::size_t end = d + 1 == devices.size() ? row.size() : begin;
    const double share = all * static_cast<double>(d + 1) / static_cast<double>(devices.size());
    for (; end < row.size() && done < share; ++end) done += cost(row[end]);
    const std::span<const std::size_t> part = row.subspan(begin, end - begin);
    begin = end;
    if (part.empty()) continue;
    if (host.empty() && end == row.size()) {  // there is nothing else to be done meanwhile
      ask(d, part);
      continue;
    }
    try {
      threads.emplace_back([&ask, d, part] { ask(d, part); });
    } catch (const std::system_error&) {  // no thread to be had
      ask(d, part);
    }
  }
  try {
    pool.run(host.size(), host.size() < kManyPairs ? 1 : kPairsAtOnce, [&](std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) answers[host[k]] = overlap(opencl::queryOf(jobs[host[k]].pair)) ? 1 : 0;
    });
  } catch (...) {
    for (std::thread& thread : threads) thread.join();
    throw;
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace otg
