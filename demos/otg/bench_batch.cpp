// SPDX-License-Identifier: BSD-3-Clause
// `otg bench batch`: single pairs and batches of pairs, an OpenCL device beside the CPU, every answer compared.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <map>
#include <sstream>
#include <thread>

#include "collide/query.h"
#include "dispatch/thread_pool.h"
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

/// What --tune can set.
const std::map<std::string, std::uint32_t opencl::Tuning::*>& tuningKeys() {
  using opencl::Tuning;
  static const std::map<std::string, std::uint32_t Tuning::*> keys = {
      {"leafTriangles", &Tuning::leafTriangles},
      {"group", &Tuning::group},
      {"groupsPerUnit", &Tuning::groupsPerUnit},
      {"batchGroup", &Tuning::batchGroup},
      {"batchPairs", &Tuning::batchPairs},
      {"pairPlaces", &Tuning::pairPlaces},
      {"leafPlaces", &Tuning::leafPlaces},
      {"hitPlaces", &Tuning::hitPlaces},
      {"recordGroup", &Tuning::recordGroup},
      {"chooseGroup", &Tuning::chooseGroup},
      {"batchChooseGroup", &Tuning::batchChooseGroup},
      {"keptPlaces", &Tuning::keptPlaces},
      {"batchKeptPlaces", &Tuning::batchKeptPlaces},
      {"contactPlaces", &Tuning::contactPlaces},
      {"hostAnswers", &Tuning::hostAnswers},
      {"flushes", &Tuning::flushes},
      {"levels", &Tuning::levels},
      {"levelTriangles", &Tuning::levelTriangles},
      {"fewHits", &Tuning::fewHits},
      {"fewGroup", &Tuning::fewGroup},
      {"pieces", &Tuning::pieces},
      {"leastPiece", &Tuning::leastPiece},
      {"smallHits", &Tuning::smallHits},
      {"mediumHits", &Tuning::mediumHits},
      {"smallGroup", &Tuning::smallGroup},
      {"mediumGroup", &Tuning::mediumGroup},
      {"stackRoom", &Tuning::stackRoom},
      {"solidGroup", &Tuning::solidGroup},
      {"solidHits", &Tuning::solidHits},
      {"solidSizes", &Tuning::solidSizes},
      {"solidLargeGroup", &Tuning::solidLargeGroup},
      {"solidPoints", &Tuning::solidPoints},
      {"solidFaces", &Tuning::solidFaces},
      {"solidLargeHits", &Tuning::solidLargeHits},
      {"solidRegisters", &Tuning::solidRegisters},
      {"arenaUnits", &Tuning::arenaUnits},
      {"overlapHits", &Tuning::overlapHits},
      {"overlapUnits", &Tuning::overlapUnits},
      {"overlapGroup", &Tuning::overlapGroup},
      {"overlapGroupsPerUnit", &Tuning::overlapGroupsPerUnit},
      {"recordsExpected", &Tuning::recordsExpected}};
  return keys;
}

struct TuningVariant {
  std::string name;
  opencl::Tuning tuning;
};

/// Keys with one value hold for all variants; those with several are varied one at a time.
std::vector<TuningVariant> tuningVariants(const std::vector<std::string>& options) {
  opencl::Tuning base;
  std::vector<std::pair<std::string, std::vector<std::uint32_t>>> sweeps;
  std::string fixed;
  for (const std::string& option : options) {
    const std::size_t equals = option.find('=');
    const std::string key = option.substr(0, equals);
    std::vector<std::uint32_t> values;
    if (equals != std::string::npos) {
      std::stringstream list(option.substr(equals + 1));
      for (std::string value; std::getline(list, value, ',');) {
        char* end = nullptr;
        values.push_back(static_cast<std::uint32_t>(std::strtoul(value.c_str(), &end, 10)));
        if (value.empty() || *end != '\0') throw UsageError("--tune " + option + ": values are whole numbers");
      }
    }
    if (values.empty()) throw UsageError("--tune " + option + ": write KEY=VALUE");
    if (key == "reduce") {
      base.reduce = values[0] != 0;
      fixed += option + " ";
      continue;
    }
    if (!tuningKeys().contains(key)) {
      std::string all = "reduce";
      for (const auto& [name, member] : tuningKeys()) all += " " + name;
      throw UsageError("--tune " + option + ": keys are " + all);
    }
    if (values.size() == 1) {
      base.*tuningKeys().at(key) = values[0];
      fixed += option + " ";
    } else {
      sweeps.emplace_back(key, values);
    }
  }
  std::vector<TuningVariant> variants;
  for (const auto& [key, values] : sweeps) {
    for (const std::uint32_t value : values) {
      variants.push_back({fmt::format("{}{}={}", fixed, key, value), base});
      variants.back().tuning.*tuningKeys().at(key) = value;
    }
  }
  if (variants.empty()) variants.push_back({fixed, base});
  return variants;
}

/// Medians of the stages of several runs.
class StageMedians {
 public:
  void add(const opencl::StageTimes& times) { all_.push_back(times); }
  void addTo(Json& row) const {
    using opencl::StageTimes;
    static constexpr std::pair<const char*, double StageTimes::*> kStages[] = {
        {"fill_ms", &StageTimes::fill},       {"write_ms", &StageTimes::write},
        {"top_ms", &StageTimes::top},         {"levels_ms", &StageTimes::levels},
        {"main_ms", &StageTimes::main},       {"contacts_ms", &StageTimes::contacts},
        {"regions_ms", &StageTimes::regions}, {"select_ms", &StageTimes::select},
        {"choose_ms", &StageTimes::choose},   {"read_back_ms", &StageTimes::readBack},
        {"host_ms", &StageTimes::host},       {"reduction_ms", &StageTimes::reduction},
        {"profiled_ms", &StageTimes::total}};
    for (const auto& [name, member] : kStages) {
      std::vector<double> values;
      for (const StageTimes& times : all_) values.push_back(times.*member);
      row[name] = median(values);
    }
  }

 private:
  std::vector<opencl::StageTimes> all_;
};

/// Of all contacts, in the order of the queries.
std::string hashInOrder(const opencl::BatchAnswer& answer) {
  std::vector<Contact> all;
  for (std::size_t i = 0; i < answer.size(); ++i) {
    const std::span<const Contact> some = answer.of(i);
    all.insert(all.end(), some.begin(), some.end());
  }
  return hashOf(all);
}

std::string sameOrNot(bool same) {
  return same ? "same" : "DIFFERENT";
}

ContactModel modelOf(const BenchOptions& options) {
  return options.contacts == "solid" ? ContactModel::kSolid : ContactModel::kPairwise;
}

/// One pair at a time: the pose differs a little in every query, as it does in a simulation.
struct SingleScene {
  std::string scene;
  const BenchMesh& entry;
  std::shared_ptr<const CollisionMesh> mesh;
  std::vector<Query> queries;
  std::vector<std::string> hashes;
  Json row;
};

SingleScene makeSingleScene(const BenchOptions& options, const std::string& scene, const BenchMesh& entry,
                            std::shared_ptr<const CollisionMesh> mesh) {
  BenchOptions where = options;
  where.scene = scene;
  SingleScene single{scene, entry, std::move(mesh), {}, {}, {}};
  const Transformd pose = benchPose(where, *single.mesh);
  const int repeat = options.repeat > 0 ? options.repeat : kRepeat;
  Random random(1);
  for (int i = 0; i < repeat; ++i) {
    Query query;
    query.a = query.b = single.mesh.get();
    query.bInA = pose;
    query.bInA.t =
        otgAdd(pose.t, otgScale(random.direction(), 1e-5 * static_cast<double>(single.mesh->mesh().radius())));
    query.options.maxContacts = kSingleContacts;
    query.options.contacts = modelOf(options);
    single.queries.push_back(query);
  }
  Workspace workspace;
  std::vector<double> cpu;
  collide(single.queries[0], workspace);
  for (const Query& query : single.queries) {
    cpu.push_back(timeOnce([&] { collide(query, workspace); }));
    single.hashes.push_back(hashOf(workspace.reduced));
  }
  single.row = {{"mesh", entry.name},
                {"triangles", single.mesh->mesh().triangleCount()},
                {"scene", scene},
                {"intersecting_pairs", workspace.stats.intersectingPairs},
                {"contacts", workspace.reduced.size()},
                {"cpu_ms", median(cpu)}};
  return single;
}

Json singleRow(const SingleScene& single, const TuningVariant& variant, opencl::Backend* backend) {
  Json row = single.row;
  if (backend == nullptr) return row;
  Workspace workspace;
  bool same = true;
  std::vector<double> device;
  for (int i = 0; i < 3; ++i) backend->collide(single.queries[0], workspace);
  for (std::size_t i = 0; i < single.queries.size(); ++i) {
    device.push_back(timeOnce([&] { backend->collide(single.queries[i], workspace); }));
    same = same && hashOf(workspace.reduced) == single.hashes[i];
  }
  StageMedians stages;
  for (const Query& query : single.queries) {
    opencl::StageTimes times;
    backend->collideProfiled(query, workspace, times);
    stages.add(times);
  }
  row["opencl_ms"] = median(device);
  stages.addTo(row);
  row["answers"] = sameOrNot(same);
  row["hash"] = single.hashes[0];
  row["tuning"] = variant.name;
  return row;
}

/// Bodies of radius about 1 and 200 to 6,000 triangles, those of files last.
std::vector<std::shared_ptr<const CollisionMesh>> batchBodies(const std::vector<BenchMesh>& files) {
  std::vector<scenes::MeshArrays> arrays = {scenes::makeSphere(0.9, 2),
                                            scenes::makeTorus(0.7, 0.25, 24, 12),
                                            scenes::makeCylinder(0.5, 1.4, 64, 6),
                                            scenes::makeGear(20, 0.9, 0.2, 0.4, 0.2),
                                            scenes::makeBox({1, 1.2, 1.4}, 6),
                                            scenes::makeBowl(0.9, 0.15, 24, 8)};
  for (std::uint32_t seed = 1; seed <= 6; ++seed) arrays.push_back(scenes::makeLump(0.9, 3, 0.25, seed));
  for (std::uint32_t seed = 7; seed <= 10; ++seed) arrays.push_back(scenes::makeLump(0.9, 4, 0.25, seed));
  std::vector<std::shared_ptr<const CollisionMesh>> bodies;
  const auto add = [&](const TriMesh& mesh) {
    bodies.push_back(std::make_shared<CollisionMesh>(sortedInSpace(mesh), BuildStrategy::kSah));
  };
  for (const scenes::MeshArrays& a : arrays) add(*scenes::build(a));
  for (const BenchMesh& file : files) add(*file.mesh);
  return bodies;
}

/// Three quarters of the pairs overlap by 2% of the distance at which they touch, one quarter is 0.4% apart.
std::vector<Query> batchQueries(const std::vector<std::shared_ptr<const CollisionMesh>>& bodies, int pairs) {
  Random random(2);
  std::vector<Query> queries;
  std::vector<Vec3d> ways;
  for (int i = 0; i < pairs; ++i) {
    Query query;
    query.a = bodies[random.below(bodies.size())].get();
    query.b = bodies[random.below(bodies.size())].get();
    query.options.maxContacts = kBatchContacts;
    const double angle = random.uniform(0, 3);
    query.bInA = turn(random.direction(), angle);
    ways.push_back(random.direction());
    queries.push_back(query);
  }
  ThreadPool(defaultThreadCount()).run(queries.size(), 16, [&](std::size_t begin, std::size_t end) {
    Workspace workspace;
    for (std::size_t i = begin; i < end; ++i) {
      Query& query = queries[i];
      double inside = 0, outside = 2.5;
      for (int step = 0; step < 11; ++step) {
        const double middle = 0.5 * (inside + outside);
        query.bInA.t = otgScale(ways[i], middle);
        findIntersectingPairs(query, workspace);
        (workspace.intersecting.empty() ? outside : inside) = middle;
      }
      query.bInA.t = otgScale(ways[i], outside * (i % 4 != 0 ? 0.98 : 1.004));
    }
  });
  return queries;
}

/// Boxes upon each other, ten to a stack, as simulations begin and as solvers leave them: most of them aligned, some
/// beside the middle, some turned, sunk in by a hundredth of a millimetre, a third of them trembling.
std::vector<Query> stackQueries(const std::vector<std::shared_ptr<const CollisionMesh>>& boxes, int pairs) {
  Random random(4);
  std::vector<Query> queries;
  for (int i = 0; i < pairs; ++i) {
    Query query;
    query.a = boxes[i % 10 == 0 ? boxes.size() - 1 : random.below(boxes.size() - 1)].get();
    query.b = boxes[random.below(boxes.size() - 1)].get();
    query.options.maxContacts = kBatchContacts;
    query.bInA = i % 4 == 0 ? turn({0, 0, 1}, random.uniform(0, 3)) : Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
    if (i % 3 == 0) {
      const Transformd shaken = turn(random.direction(), 1e-6);
      query.bInA = i % 4 == 0 ? query.bInA : shaken;
    }
    const auto z = [](float x) { return static_cast<double>(x); };
    query.bInA.t = {i % 2 != 0 ? random.uniform(-0.2, 0.2) : 0, 0,
                    z(query.a->mesh().boundsMax().z) - z(query.b->mesh().boundsMin().z) - 1e-5};
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

/// A batch, and the same with poses that differ a little, so that no run repeats the one before.
struct BatchVersions {
  std::string of;  ///< which batch
  std::vector<std::shared_ptr<const CollisionMesh>> bodies;
  std::vector<const CollisionMesh*> meshes;
  std::vector<Query> queries;
  std::vector<std::vector<opencl::MeshPair>> pairs;
  std::vector<std::string> hashes;  ///< of the contacts of each of `pairs`
  std::vector<std::vector<std::uint8_t>> intersects;
};

BatchVersions makeBatchVersions(const BenchOptions& options, bool stacks) {
  constexpr int kVersions = 8;
  BatchVersions scene;
  if (stacks) {
    scene.of = " of stacks";
    for (const scenes::MeshArrays& box : {scenes::makeBox({1, 1, 1}, 1), scenes::makeBox({1, 0.8, 0.5}, 1),
                                          scenes::makeBox({0.8, 0.8, 0.8}, 2), scenes::makeBox({20, 20, 1}, 1)}) {
      scene.bodies.push_back(std::make_shared<CollisionMesh>(sortedInSpace(*scenes::build(box)), BuildStrategy::kSah));
    }
  } else {
    const std::vector<BenchMesh> files = bodyMeshes(options);
    scene.bodies = batchBodies(files);
    for (const BenchMesh& file : files) scene.of += (scene.of.empty() ? " of generated bodies, " : ", ") + file.name;
  }
  for (const auto& body : scene.bodies) scene.meshes.push_back(body.get());
  scene.queries = stacks ? stackQueries(scene.bodies, options.pairs) : batchQueries(scene.bodies, options.pairs);
  for (Query& query : scene.queries) query.options.contacts = modelOf(options);
  Random random(3);
  ThreadPool pool(defaultThreadCount());
  for (int version = 0; version < kVersions; ++version) {
    std::vector<opencl::MeshPair> pairs;
    for (const Query& query : scene.queries) {
      const auto number = [&](const CollisionMesh* mesh) {
        return static_cast<std::uint32_t>(std::find(scene.meshes.begin(), scene.meshes.end(), mesh) -
                                          scene.meshes.begin());
      };
      Transformd moved = query.bInA;
      if (stacks) {
        moved.t.z -= 1e-7 * version;
      } else if (version > 0) {
        moved.t = otgAdd(moved.t, otgScale(random.direction(), 1e-5));
      }
      pairs.push_back({number(query.a), number(query.b), moved});
    }
    std::vector<std::vector<Contact>> contacts(pairs.size());
    std::vector<std::uint8_t> intersects(pairs.size());
    pool.run(pairs.size(), 16, [&](std::size_t begin, std::size_t end) {
      Workspace workspace;
      for (std::size_t i = begin; i < end; ++i) {
        Query moved = scene.queries[i];
        moved.bInA = pairs[i].bInA;
        collide(moved, workspace);
        contacts[i] = workspace.reduced;
        intersects[i] = !workspace.intersecting.empty();
      }
    });
    std::vector<Contact> whole;
    for (const auto& some : contacts) whole.insert(whole.end(), some.begin(), some.end());
    scene.pairs.push_back(std::move(pairs));
    scene.hashes.push_back(hashOf(whole));
    scene.intersects.push_back(std::move(intersects));
  }
  return scene;
}

Json batchRow(const BatchVersions& scene, const char* work, const std::string& backend, unsigned threads,
              const std::vector<double>& times, const std::string& hash, bool same) {
  const double ms = median(times);
  return {{"work", work + scene.of},
          {"pairs", scene.queries.size()},
          {"backend", backend},
          {"threads", threads},
          {"ms", ms},
          {"us_per_pair", 1e3 * ms / static_cast<double>(scene.queries.size())},
          {"hash", hash},
          {"answers", sameOrNot(same)}};
}

Json cpuBatchRows(const BenchOptions& options, const BatchVersions& scene) {
  const int repeat = options.repeat > 0 ? std::min(options.repeat, 5) : 5;
  const unsigned all = std::max(1u, std::thread::hardware_concurrency());
  Json rows = Json::array();
  for (const unsigned threads : all > 1 ? std::vector<unsigned>{1, all} : std::vector<unsigned>{1}) {
    std::vector<std::vector<Contact>> contacts;
    std::vector<double> times;
    for (int i = 0; i < repeat; ++i) times.push_back(collideOnThreads(scene.queries, threads, contacts));
    std::vector<Contact> whole;
    for (const auto& some : contacts) whole.insert(whole.end(), some.begin(), some.end());
    rows.push_back(batchRow(scene, "contacts", "cpu", threads, times, hashOf(whole), hashOf(whole) == scene.hashes[0]));
  }
  return rows;
}

void addDeviceBatchRows(const BenchOptions& options, const BatchVersions& scene, const TuningVariant& variant,
                        opencl::Backend& backend, Json& rows) {
  const int repeat = options.repeat > 0 ? options.repeat : kRepeat;
  opencl::PairBatch batch{scene.meshes, {}, {}};
  batch.options.maxContacts = kBatchContacts;
  batch.options.contacts = modelOf(options);
  opencl::BatchAnswer answer;
  // What the device leaves to the host is done by all its threads.
  ThreadPool pool(defaultThreadCount());
  const opencl::RunParts onHost = [&](std::size_t count, const ThreadPool::Work& work) { pool.run(count, 1, work); };
  std::vector<std::uint8_t> yes;
  const auto add = [&](const char* work, auto&& run, auto&& isSame, const std::string& hash) {
    bool same = true;
    for (std::size_t i = 0; i < scene.pairs.size(); ++i) {  // warms up, too
      batch.pairs = scene.pairs[i];
      run(nullptr);
      same = same && isSame(i);
    }
    std::vector<double> times;
    for (int i = 0; i < repeat; ++i) {
      batch.pairs = scene.pairs[static_cast<std::size_t>(i) % scene.pairs.size()];
      times.push_back(timeOnce([&] { run(nullptr); }));
    }
    StageMedians stages;
    for (int i = 0; i < repeat; ++i) {
      opencl::StageTimes stage;
      batch.pairs = scene.pairs[static_cast<std::size_t>(i) % scene.pairs.size()];
      run(&stage);
      stages.add(stage);
    }
    Json row = batchRow(scene, work, "opencl", 1, times, hash, same);
    stages.addTo(row);
    row["tuning"] = variant.name;
    rows.push_back(row);
  };
  add(
      "contacts", [&](opencl::StageTimes* times) { backend.collideBatch(batch, answer, times, onHost); },
      [&](std::size_t i) { return hashInOrder(answer) == scene.hashes[i]; }, scene.hashes[0]);
  rows.back()["contacts"] = answer.contactCount();
  rows.back()["left_to_host"] = answer.leftToHost;
  rows.back()["intersecting_pairs"] = answer.stats.intersectingPairs;
  Fnv1a bits;
  bits.add(scene.intersects[0].data(), scene.intersects[0].size());
  add(
      "yes_or_no", [&](opencl::StageTimes* times) { backend.intersectBatch(batch, yes, times); },
      [&](std::size_t i) { return yes == scene.intersects[i]; }, bits.hex());
  // The same from an array of queries, each with options of its own.
  std::vector<double> times;
  backend.collideBatch(scene.queries, answer);
  const bool same = hashInOrder(answer) == scene.hashes[0];
  for (int i = 0; i < repeat; ++i) times.push_back(timeOnce([&] { backend.collideBatch(scene.queries, answer); }));
  Json row = batchRow(scene, "contacts, queries", "opencl", 1, times, scene.hashes[0], same);
  row["tuning"] = variant.name;
  rows.push_back(row);
}

}  // namespace

int benchBatch(const BenchOptions& options) {
  const std::vector<TuningVariant> variants = tuningVariants(options.tune);
  const std::vector<opencl::DeviceInfo> devices = findDevices();
  const int index = opencl::defaultDevice(devices);
  std::vector<SingleScene> singles;
  std::vector<BenchMesh> meshes;
  if (options.scenes != std::vector<std::string>{"none"}) meshes = benchMeshes(options);
  for (const BenchMesh& entry : meshes) {
    const auto mesh = std::make_shared<CollisionMesh>(sortedInSpace(*entry.mesh), BuildStrategy::kSah);
    for (const std::string& scene : options.scenes) {
      progress(fmt::format("{}: {}", entry.name, scene));
      singles.push_back(makeSingleScene(options, scene, entry, mesh));
    }
  }
  progress(fmt::format("placing {} pairs", options.pairs));
  std::vector<BatchVersions> batches{makeBatchVersions(options, false)};
  if (modelOf(options) == ContactModel::kSolid) batches.push_back(makeBatchVersions(options, true));
  Json single = Json::array(), batch = Json::array();
  for (const BatchVersions& scene : batches) {
    if (!options.cpu) break;
    for (const Json& row : cpuBatchRows(options, scene)) batch.push_back(row);
  }
  std::string device;
  for (const TuningVariant& variant : variants) {
    const std::shared_ptr<opencl::Backend> backend = index < 0 ? nullptr : opencl::Backend::open(index, variant.tuning);
    if (!variant.name.empty()) progress(variant.name);
    if (backend) {
      device = backend->device().name;
    } else {
      progress("note: no OpenCL device can be used; the tables have the CPU alone");
    }
    for (const SingleScene& one : singles) single.push_back(singleRow(one, variant, backend.get()));
    for (const BatchVersions& scene : batches) {
      if (backend) addDeviceBatchRows(options, scene, variant, *backend, batch);
    }
    if (backend && backend->counts().onHost > 0) progress("note: the OpenCL device failed; the CPU did what it left");
  }
  printBench({{"bench", "batch"},
              {"device", device.empty() ? Json() : Json(device)},
              {"tables", {{"single", single}, {"batch", batch}}}},
             options.json);
  return kOk;
}

}  // namespace otg::cli
