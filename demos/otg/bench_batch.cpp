// SPDX-License-Identifier: BSD-3-Clause
// `otg bench batch`: single pairs and batches of pairs, an OpenCL device beside the CPU, every answer compared.
#include <fmt/format.h>

#include <atomic>
#include <thread>

#include "collide/query.h"
#include "opencl/backend.h"
#include "otg/bench.h"
#include "otg/query_options.h"
#include "scenes/generated_meshes.h"

namespace otg::cli {
namespace {

constexpr int kBatchContacts = 16, kSingleContacts = 64;
constexpr int kRepeat = 100;

/// A generator whose values are the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform(0, static_cast<double>(n))); }
  Vec3d direction() {
    for (;;) {
      const Vec3d v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      const double squared = otgDot(v, v);
      if (squared > 0.01 && squared < 1) return otgScale(v, 1 / std::sqrt(squared));
    }
  }

 private:
  std::uint64_t state_;
};

Transformd turn(const Vec3d& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  const double x = axis.x, y = axis.y, z = axis.z;
  return {{c + x * x * k, x * y * k - z * s, x * z * k + y * s, y * x * k + z * s, c + y * y * k, y * z * k - x * s,
           z * x * k - y * s, z * y * k + x * s, c + z * z * k},
          {0, 0, 0}};
}

std::string sameOrNot(bool same) {
  return same ? "same" : "DIFFERENT";
}

/// One pair at a time: the pose differs a little in every query, as it does in a simulation.
Json singleRow(const BenchOptions& options, const std::string& scene, const BenchMesh& entry,
               opencl::Backend* backend) {
  BenchOptions where = options;
  where.scene = scene;
  const CollisionMesh mesh(sortedInSpace(*entry.mesh), BuildStrategy::kSah);
  const Transformd pose = benchPose(where, mesh);
  const int repeat = options.repeat > 0 ? options.repeat : kRepeat;
  std::vector<Query> queries;
  Random random(1);
  for (int i = 0; i < repeat; ++i) {
    Query query;
    query.a = query.b = &mesh;
    query.bInA = pose;
    query.bInA.t = otgAdd(pose.t, otgScale(random.direction(), 1e-5 * static_cast<double>(mesh.mesh().radius())));
    query.options.maxContacts = kSingleContacts;
    queries.push_back(query);
  }
  Workspace workspace;
  std::vector<double> cpu, device;
  std::vector<std::string> hashes;
  std::uint64_t pairs = 0;
  collide(queries[0], workspace);
  for (const Query& query : queries) {
    cpu.push_back(timeOnce([&] { collide(query, workspace); }));
    hashes.push_back(hashOf(workspace.reduced));
    pairs = workspace.stats.intersectingPairs;
  }
  Json row = {{"mesh", entry.name},          {"triangles", mesh.mesh().triangleCount()}, {"scene", scene},
              {"intersecting_pairs", pairs}, {"contacts", workspace.reduced.size()},     {"cpu_ms", median(cpu)}};
  if (backend == nullptr) return row;
  bool same = true;
  std::vector<double> top, main, contacts, readBack, host, reduction;
  for (int i = 0; i < 3; ++i) backend->collide(queries[0], workspace);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    device.push_back(timeOnce([&] { backend->collide(queries[i], workspace); }));
    same = same && hashOf(workspace.reduced) == hashes[i];
  }
  for (const Query& query : queries) {
    opencl::StageTimes times;
    backend->collideProfiled(query, workspace, times);
    top.push_back(times.top);
    main.push_back(times.main);
    contacts.push_back(times.contacts);
    readBack.push_back(times.readBack);
    host.push_back(times.host);
    reduction.push_back(times.reduction);
  }
  row["opencl_ms"] = median(device);
  row["top_ms"] = median(top);
  row["main_ms"] = median(main);
  row["contacts_ms"] = median(contacts);
  row["read_back_ms"] = median(readBack);
  row["host_ms"] = median(host);
  row["reduction_ms"] = median(reduction);
  row["answers"] = sameOrNot(same);
  row["hash"] = hashes[0];
  return row;
}

/// Bodies of radius about 1 and 200 to 6,000 triangles.
std::vector<std::shared_ptr<const CollisionMesh>> batchBodies() {
  std::vector<scenes::MeshArrays> arrays = {scenes::makeSphere(0.9, 2),
                                            scenes::makeTorus(0.7, 0.25, 24, 12),
                                            scenes::makeCylinder(0.5, 1.4, 64, 6),
                                            scenes::makeGear(20, 0.9, 0.2, 0.4, 0.2),
                                            scenes::makeBox({1, 1.2, 1.4}, 6),
                                            scenes::makeBowl(0.9, 0.15, 24, 8)};
  for (std::uint32_t seed = 1; seed <= 6; ++seed) arrays.push_back(scenes::makeLump(0.9, 3, 0.25, seed));
  for (std::uint32_t seed = 7; seed <= 10; ++seed) arrays.push_back(scenes::makeLump(0.9, 4, 0.25, seed));
  std::vector<std::shared_ptr<const CollisionMesh>> bodies;
  for (const scenes::MeshArrays& a : arrays) {
    bodies.push_back(std::make_shared<CollisionMesh>(sortedInSpace(*scenes::build(a)), BuildStrategy::kSah));
  }
  return bodies;
}

/// Three quarters of the pairs overlap by 2% of the distance at which they touch, one quarter is 0.4% apart.
std::vector<Query> batchQueries(const std::vector<std::shared_ptr<const CollisionMesh>>& bodies, int pairs) {
  Random random(2);
  Workspace workspace;
  std::vector<Query> queries;
  for (int i = 0; i < pairs; ++i) {
    Query query;
    query.a = bodies[random.below(bodies.size())].get();
    query.b = bodies[random.below(bodies.size())].get();
    query.options.maxContacts = kBatchContacts;
    const Transformd turned = turn(random.direction(), random.uniform(0, 3));
    const Vec3d way = random.direction();
    double inside = 0, outside = 2.5;
    query.bInA = turned;
    for (int step = 0; step < 11; ++step) {
      const double middle = 0.5 * (inside + outside);
      query.bInA.t = otgScale(way, middle);
      findIntersectingPairs(query, workspace);
      (workspace.intersecting.empty() ? outside : inside) = middle;
    }
    query.bInA.t = otgScale(way, outside * (i % 4 != 0 ? 0.98 : 1.004));
    queries.push_back(query);
  }
  return queries;
}

/// Every query by one of `threads` threads; the contacts of each.
double collideOnThreads(const std::vector<Query>& queries, unsigned threads,
                        std::vector<std::vector<Contact>>& contacts) {
  contacts.assign(queries.size(), {});
  return timeOnce([&] {
    std::atomic<std::size_t> next{0};
    std::vector<std::thread> team;
    for (unsigned t = 0; t < threads; ++t) {
      team.emplace_back([&] {
        constexpr std::size_t kAtOnce = 8;
        Workspace workspace;
        for (std::size_t begin = next.fetch_add(kAtOnce); begin < queries.size(); begin = next.fetch_add(kAtOnce)) {
          for (std::size_t i = begin; i < std::min(begin + kAtOnce, queries.size()); ++i) {
            collide(queries[i], workspace);
            contacts[i] = workspace.reduced;
          }
        }
      });
    }
    for (std::thread& thread : team) thread.join();
  });
}

Json batchRows(const BenchOptions& options, opencl::Backend* backend) {
  const int repeat = options.repeat > 0 ? std::min(options.repeat, kRepeat) : 5;
  progress(fmt::format("placing {} pairs", options.pairs));
  const auto bodies = batchBodies();
  const std::vector<Query> queries = batchQueries(bodies, options.pairs);
  Json rows = Json::array();
  std::string hash;
  std::vector<std::uint8_t> intersects;
  const auto add = [&](const char* work, const char* backendName, int threads, std::vector<double> times,
                       const std::string& result, const std::string& answers) {
    const double ms = median(std::move(times));
    rows.push_back({{"work", work},
                    {"pairs", queries.size()},
                    {"backend", backendName},
                    {"threads", threads},
                    {"ms", ms},
                    {"us_per_pair", 1e3 * ms / static_cast<double>(queries.size())},
                    {"answers", answers},
                    {"hash", result}});
  };
  const unsigned all = std::max(1u, std::thread::hardware_concurrency());
  for (const unsigned threads : all > 1 ? std::vector<unsigned>{1, all} : std::vector<unsigned>{1}) {
    std::vector<std::vector<Contact>> contacts;
    std::vector<double> times;
    for (int i = 0; i < repeat; ++i) times.push_back(collideOnThreads(queries, threads, contacts));
    std::vector<Contact> whole;
    for (const auto& some : contacts) whole.insert(whole.end(), some.begin(), some.end());
    hash = hashOf(whole);
    add("contacts", "cpu", static_cast<int>(threads), times, hash, "same");
  }
  {
    Workspace workspace;
    for (const Query& query : queries) {
      findIntersectingPairs(query, workspace);
      intersects.push_back(!workspace.intersecting.empty());
    }
  }
  if (backend == nullptr) return rows;
  opencl::BatchAnswer answer;
  backend->collideBatch(queries, answer);
  std::vector<double> times;
  for (int i = 0; i < repeat; ++i) times.push_back(timeOnce([&] { backend->collideBatch(queries, answer); }));
  const std::string found = hashOf(answer.contacts);
  add("contacts", "opencl", 1, times, found, sameOrNot(found == hash));
  std::vector<std::uint8_t> yes;
  times.clear();
  backend->intersectBatch(queries, yes);
  for (int i = 0; i < repeat; ++i) times.push_back(timeOnce([&] { backend->intersectBatch(queries, yes); }));
  Fnv1a bits;
  bits.add(yes.data(), yes.size());
  add("yes_or_no", "opencl", 1, times, bits.hex(), sameOrNot(yes == intersects));
  return rows;
}

}  // namespace

int benchBatch(const BenchOptions& options) {
  const std::vector<opencl::DeviceInfo> devices = findDevices();
  const int index = opencl::defaultDevice(devices);
  const std::shared_ptr<opencl::Backend> backend = index < 0 ? nullptr : opencl::Backend::open(index);
  if (!backend) progress("note: no OpenCL device can be used; the tables have the CPU alone");
  Json single = Json::array();
  for (const BenchMesh& entry : benchMeshes(options)) {
    for (const char* scene : {"touch", "deep", "deep10", "nearmiss"}) {
      progress(fmt::format("{}: {}", entry.name, scene));
      single.push_back(singleRow(options, scene, entry, backend.get()));
    }
  }
  const Json batch = batchRows(options, backend.get());
  printBench({{"bench", "batch"},
              {"device", backend ? Json(backend->device().name) : Json()},
              {"tables", {{"single", single}, {"batch", batch}}}},
             options.json);
  return kOk;
}

}  // namespace otg::cli
