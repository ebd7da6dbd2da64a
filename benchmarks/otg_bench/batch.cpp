// SPDX-License-Identifier: BSD-3-Clause
// `otg bench batch`: single pairs and batches of pairs, an OpenCL device beside the CPU, every result compared.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <map>
#include <sstream>
#include <thread>

#include "cli/contact_hash.h"
#include "cli/progress.h"
#include "cli/query_options.h"
#include "collide/query.h"
#include "dispatch/dispatcher.h"
#include "dispatch/threads/thread_pool.h"
#include "opencl/backend.h"
#include "otg_bench/api_steps.h"
#include "otg_bench/batch_scenes.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

constexpr int kSingleContacts = 64;
constexpr int kRepeat = 100;

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
      {"unevenGroup", &Tuning::unevenGroup},
      {"unevenFaces", &Tuning::unevenFaces},
      {"solidRegisters", &Tuning::solidRegisters},
      {"arenaUnits", &Tuning::arenaUnits},
      {"overlapHits", &Tuning::overlapHits},
      {"overlapUnits", &Tuning::overlapUnits},
      {"overlapGroup", &Tuning::overlapGroup},
      {"overlapContacts", &Tuning::overlapContacts},
      {"overlapLanes", &Tuning::overlapLanes},
      {"overlapGroupsPerUnit", &Tuning::overlapGroupsPerUnit},
      {"leastOverlaps", &Tuning::leastOverlaps},
      {"overlapPairs", &Tuning::overlapPairs},
      {"meanwhile", &Tuning::meanwhile},
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
      for (const auto& [name, member] : tuningKeys()) all.append(" ").append(name);
      throw UsageError(fmt::format("--tune {}: keys are {}", option, all));
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
        {"fill_ms", &StageTimes::fill},
        {"write_ms", &StageTimes::write},
        {"top_ms", &StageTimes::top},
        {"levels_ms", &StageTimes::levels},
        {"main_ms", &StageTimes::main},
        {"contacts_ms", &StageTimes::contacts},
        {"regions_ms", &StageTimes::regions},
        {"select_ms", &StageTimes::select},
        {"weigh_ms", &StageTimes::weigh},
        {"ways_ms", &StageTimes::ways},
        {"candidates_ms", &StageTimes::candidates},
        {"choose_ms", &StageTimes::choose},
        {"read_back_ms", &StageTimes::readBack},
        {"host_ms", &StageTimes::host},
        {"reduction_ms", &StageTimes::reduction},
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
  std::size_t intersectingPairs = 0;  ///< of triangles, in the first of `pairs`
};

BatchVersions makeBatchVersions(const BenchOptions& options, const std::string& batch) {
  constexpr int kVersions = 8;
  BatchVersions scene;
  const bool stacks = batch == "stacks";
  if (stacks) {
    scene.of = " of stacks";
    scene.bodies = stackBodies();
    scene.queries = stackQueries(scene.bodies, options.pairs);
  } else if (batch == "terrain") {
    scene.of = " on a terrain";
    scene.bodies = terrainBodies();
    scene.queries = terrainQueries(scene.bodies, options.pairs);
  } else if (batch == "overlaps") {
    scene.of = " of large overlaps";
    scene.bodies = overlapBodies();
    scene.queries = batchQueries(scene.bodies, options.pairs, 0.8);
  } else if (batch == "nut_bolt") {
    scene.of = " of nut and bolt";
    scene.bodies = nutAndBolt();
    scene.queries = nutBoltQueries(scene.bodies, options.pairs);
  } else {
    const bool dense = batch == "dense";
    if (dense) scene.of = " of dense bodies";
    scene.bodies = dense ? denseBodies() : batchBodies();
    for (const BenchMesh& file : bodyMeshes(options)) {
      scene.bodies.push_back(std::make_shared<CollisionMesh>(sortedForLocality(*file.mesh), BuildStrategy::kSah));
      scene.of += (scene.of.empty() ? " of generated bodies, " : ", ") + file.name;
    }
    scene.queries = dense ? batchQueries(scene.bodies, options.pairs, 0.15) : batchQueries(scene.bodies, options.pairs);
  }
  for (const auto& body : scene.bodies) scene.meshes.push_back(body.get());
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
    std::atomic<std::size_t> intersectingPairs{0};
    pool.run(pairs.size(), 16, [&](std::size_t begin, std::size_t end) {
      Workspace workspace;
      for (std::size_t i = begin; i < end; ++i) {
        Query moved = scene.queries[i];
        moved.bInA = pairs[i].bInA;
        collide(moved, workspace);
        contacts[i] = workspace.reduced;
        intersects[i] = !workspace.intersecting.empty();
        intersectingPairs += workspace.intersecting.size();
      }
    });
    std::vector<Contact> whole;
    for (const auto& some : contacts) whole.insert(whole.end(), some.begin(), some.end());
    if (version == 0) scene.intersectingPairs = intersectingPairs;
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
          {"intersecting_pairs", scene.intersectingPairs},
          {"backend", backend},
          {"threads", threads},
          {"ms", ms},
          {"us_per_pair", 1e3 * ms / static_cast<double>(scene.queries.size())},
          {"hash", hash},
          {"answers", sameOrNot(same)}};
}

Json cpuBatchRows(const BenchOptions& options, const BatchVersions& scene) {
  constexpr double kLongest = 10e3;  // milliseconds; slow batches are run less often
  const int repeat = options.repeat > 0 ? std::min(options.repeat, 5) : 5;
  const unsigned all = std::max(1u, std::thread::hardware_concurrency());
  Json rows = Json::array();
  for (const unsigned threads : all > 1 ? std::vector<unsigned>{1, all} : std::vector<unsigned>{1}) {
    std::vector<std::vector<Contact>> contacts;
    std::vector<double> times;
    double spent = 0;
    for (int i = 0; i < repeat && spent < kLongest; ++i) {
      times.push_back(collideOnThreads(scene.queries, threads, contacts));
      spent += times.back();
    }
    std::vector<Contact> whole;
    for (const auto& some : contacts) whole.insert(whole.end(), some.begin(), some.end());
    rows.push_back(batchRow(scene, "contacts", "cpu", threads, times, hashOf(whole), hashOf(whole) == scene.hashes[0]));
  }
  return rows;
}

void addDeviceBatchRows(const BenchOptions& options, const BatchVersions& scene, const TuningVariant& variant,
                        opencl::Backend& backend, Json& rows) {
  const int repeat = options.repeat > 0 ? options.repeat : kRepeat;
  opencl::NumberedPairs batch{scene.meshes, {}, {}};
  batch.options.maxContacts = kBatchContacts;
  batch.options.contacts = modelOf(options);
  opencl::BatchAnswer answer;
  // What the device leaves to the CPU is done by all its threads.
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
  Fnv1a bits;
  bits.add(scene.intersects[0].data(), scene.intersects[0].size());
  add(
      "yes_or_no", [&](opencl::StageTimes* times) { backend.intersectBatch(batch, yes, times); },
      [&](std::size_t i) { return yes == scene.intersects[i]; }, bits.hex());
  // The same from an array of queries, each with options of its own.
  std::vector<double> times;
  backend.collideBatch(scene.queries, answer, nullptr, onHost);
  const bool same = hashInOrder(answer) == scene.hashes[0];
  times.reserve(static_cast<std::size_t>(repeat));
  for (int i = 0; i < repeat; ++i) {
    times.push_back(timeOnce([&] { backend.collideBatch(scene.queries, answer, nullptr, onHost); }));
  }
  Json row = batchRow(scene, "contacts, queries", "opencl", 1, times, scene.hashes[0], same);
  row["tuning"] = variant.name;
  rows.push_back(row);
}

/// What programs get, from geoms of ODE to arrays of dContactGeom, and whether pairs overlap: by all threads of the
/// CPU, and on the device with them. `steps`: where the time of these calls goes.
void addApiRows(const BenchOptions& options, const BatchVersions& scene, bool withDevice, Json& rows, Json& steps) {
  const scenes::OdeSession session;
  const int repeat = options.repeat > 0 ? options.repeat : kRepeat;
  const GeomPairs pairs(scene.queries);
  std::vector<dContactGeom> contacts(scene.queries.size() * kBatchContacts);
  std::vector<int> counts(scene.queries.size());
  std::vector<unsigned char> yes(scene.queries.size());
  const auto collidePairs = [&] {
    dGpuTriMeshCollidePairs(pairs.all().data(), pairs.count(), kBatchContacts, contacts.data(), sizeof(dContactGeom),
                            counts.data());
  };
  const auto hashContacts = [&] {
    Fnv1a hash;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      for (int k = 0; k < counts[i]; ++k) addToHash(hash, contacts[i * kBatchContacts + static_cast<std::size_t>(k)]);
    }
    return hash.hex();
  };
  const auto ask = [&] { dGpuTriMeshOverlaps(pairs.all().data(), pairs.count(), yes.data()); };
  const auto hashYes = [&] {
    Fnv1a hash;
    hash.add(yes.data(), yes.size());
    return hash.hex();
  };
  const auto threads = [] { return static_cast<unsigned>(dGpuTriMeshGetThreadCount()); };
  const auto add = [&](const char* work, const auto& run, const auto& hash, const auto& addSteps) {
    std::string expected;
    for (const bool onDevice : {false, true}) {
      if (onDevice ? !withDevice : !options.cpu) continue;
      pairs.setBackend(onDevice ? dGPUTRIMESH_BACKEND_OPENCL : dGPUTRIMESH_BACKEND_CPU);
      // With history the contacts of pairs that stay where they are would be kept, where the CPU computes them.
      pairs.setHistory(onDevice ? dGPUTRIMESH_HISTORY_ON : dGPUTRIMESH_HISTORY_OFF);
      // All cores are the CPU's where no device has work.
      dGpuTriMeshSetThreadCount(onDevice ? 0 : static_cast<int>(defaultThreadCount()));
      run();
      if (expected.empty()) expected = hash();
      const bool same = expected == hash();
      std::vector<double> times;
      times.reserve(static_cast<std::size_t>(repeat));
      for (int i = 0; i < repeat; ++i) times.push_back(timeOnce(run));
      rows.push_back(batchRow(scene, work, onDevice ? "opencl" : "cpu", threads(), times, hash(), same));
      addSteps(onDevice);
    }
  };
  add("dGpuTriMeshCollidePairs()", collidePairs, hashContacts, [&](bool onDevice) {
    Json row = {{"work", rows.back()["work"]}, {"backend", rows.back()["backend"]}, {"threads", threads()}};
    row.update(collideSteps(pairs.all(), kBatchContacts, repeat, onDevice));
    steps.push_back(row);
  });
  add("dGpuTriMeshOverlaps()", ask, hashYes, [](bool) {});
  dGpuTriMeshSetThreadCount(0);
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
    const auto mesh = std::make_shared<CollisionMesh>(sortedForLocality(*entry.mesh), BuildStrategy::kSah);
    for (const std::string& scene : options.scenes) {
      progress(fmt::format("{}: {}", entry.name, scene));
      singles.push_back(makeSingleScene(options, scene, entry, mesh));
    }
  }
  progress(fmt::format("placing {} pairs", options.pairs));
  std::vector<std::string> names = options.batches;
  if (names.empty()) names = {"bodies"};
  if (options.batches.empty() && modelOf(options) == ContactModel::kSolid) names.emplace_back("stacks");
  std::vector<BatchVersions> batches;
  batches.reserve(names.size());
  for (const std::string& name : names) batches.push_back(makeBatchVersions(options, name));
  Json single = Json::array(), batch = Json::array(), steps = Json::array();
  Progress all(2 * batches.size() + variants.size() * (singles.size() + batches.size()));
  for (const BatchVersions& scene : batches) {
    if (!options.cpu) break;
    for (const Json& row : cpuBatchRows(options, scene)) batch.push_back(row);
    all.step();
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
    for (const SingleScene& one : singles) {
      single.push_back(singleRow(one, variant, backend.get()));
      all.step();
    }
    for (const BatchVersions& scene : batches) {
      if (backend) addDeviceBatchRows(options, scene, variant, *backend, batch);
      all.step();
    }
    if (backend && backend->counts().onHost > 0) progress("note: the OpenCL device failed; the CPU did what it left");
  }
  const bool opened = index >= 0 && dispatcher().open(std::vector<int>{index}, variants.back().tuning) > 0;
  for (const BatchVersions& scene : batches) {
    addApiRows(options, scene, opened, batch, steps);
    all.step();
  }
  printBench({{"bench", "batch"},
              {"device", device.empty() ? Json() : Json(device)},
              {"tables", {{"single", single}, {"batch", batch}, {"steps", steps}}}},
             options.json);
  return kOk;
}

}  // namespace otg::cli
