// SPDX-License-Identifier: BSD-3-Clause
// `otg batch SCENE.json`: many pairs of meshes in one submission.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <new>

#include "cli/pose.h"
#include "cli/query_options.h"
#include "cli/query_profile.h"
#include "cli/times.h"
#include "collide/stages.h"
#include "mesh_io/mesh_file.h"
#include "otg/commands.h"

namespace otg::cli {
namespace {

struct BatchOptions {
  QueryOptions query;
  std::string scene;
  int repeat = 1;
  bool json = false;
};

struct BatchScene {
  std::vector<std::shared_ptr<const CollisionMesh>> meshes;
  std::vector<Query> queries;
};

std::vector<double> numbersOf(const nlohmann::json& value) {
  if (value.is_number()) return {value.get<double>()};
  std::vector<double> numbers;
  if (!value.is_array()) return numbers;
  for (const auto& element : value) {
    const std::vector<double> more = numbersOf(element);
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  return numbers;
}

/// A string or seven numbers as --pose takes it, or 16 numbers.
Transformd poseOf(const nlohmann::json& value, const std::string& where) {
  if (value.is_string()) return parsePose(value.get<std::string>());
  const std::vector<double> numbers = numbersOf(value);
  if (numbers.size() == 16) return poseFromMatrix(numbers.data(), where);
  if (numbers.size() != 7) throw InputError(where + ": a pose is tx,ty,tz,qw,qx,qy,qz or a 4x4 matrix");
  return parsePose(fmt::format("{}", fmt::join(numbers, ",")));
}

BatchScene readScene(const BatchOptions& options) {
  std::ifstream stream(options.scene, std::ios::binary);
  if (!stream) throw InputError(options.scene + ": cannot be opened");
  nlohmann::json document;
  try {
    document = nlohmann::json::parse(stream, nullptr, true, true);  // with comments, as in scenes
  } catch (const nlohmann::json::exception& error) {  // parse_error, or out_of_range for a number that no double is
    throw InputError(options.scene + ": not valid JSON: " + error.what());
  }
  if (!document.is_object()) throw InputError(options.scene + ": is no JSON object");
  for (const auto& item : document.items()) {
    if (item.key() != "meshes" && item.key() != "pairs") {
      throw InputError(fmt::format("{}: unknown key '{}'; there are meshes and pairs", options.scene, item.key()));
    }
  }
  const auto list = [&](const char* key) -> const nlohmann::json& {
    if (!document.contains(key) || !document[key].is_array()) {
      throw InputError(fmt::format("{}: has no array '{}'", options.scene, key));
    }
    return document[key];
  };
  BatchScene scene;
  for (const auto& file : list("meshes")) {
    if (!file.is_string()) throw InputError(options.scene + ": meshes are paths of files");
    const std::filesystem::path path =
        std::filesystem::path(options.scene).parent_path() / file.get<std::string>();  // an absolute one stays as it is
    scene.meshes.push_back(std::make_shared<CollisionMesh>(mesh_io::loadTriMesh(path.string(), {}, MeshOrder::kBySize),
                                                           options.query.buildStrategy()));
  }
  const CollideOptions how = options.query.collideOptions();
  for (const auto& pair : list("pairs")) {
    const std::string where = fmt::format("{}: pairs[{}]", options.scene, scene.queries.size());
    if (!pair.is_array() || pair.size() != 3) throw InputError(where + ": a pair is [i, j, pose]");
    const auto mesh = [&](const nlohmann::json& index) -> const CollisionMesh* {
      if (!index.is_number_integer() || index.get<std::int64_t>() < 0 ||
          index.get<std::int64_t>() >= static_cast<std::int64_t>(scene.meshes.size())) {
        throw InputError(where + ": there is no such mesh");
      }
      return scene.meshes[index.get<std::size_t>()].get();
    };
    Query query;
    query.a = mesh(pair[0]);
    query.b = mesh(pair[1]);
    query.bInA = poseOf(pair[2], where);
    query.options = how;
    scene.queries.push_back(query);
  }
  return scene;
}

int runBatch(const BatchOptions& options) {
  const BatchScene scene = readScene(options);
  const std::unique_ptr<Dispatcher> dispatcher = options.query.openDispatcher();
  std::vector<PairJob> jobs;
  jobs.reserve(scene.queries.size());
  for (const Query& query : scene.queries) jobs.push_back({query, false, options.query.placement()});
  std::vector<const PairJob*> list;
  list.reserve(jobs.size());
  for (const PairJob& job : jobs) list.push_back(&job);
  std::vector<PairResult> results;
  BatchEnd end;
  const auto run = [&] {
    results.assign(jobs.size(), {});
    end = dispatcher->collideBatch(list, results);
  };
  run();  // warm-up: meshes are uploaded, lists find their sizes
  std::vector<double> total;
  total.reserve(static_cast<std::size_t>(options.repeat));
  for (int i = 0; i < options.repeat; ++i) total.push_back(timeOnce(run));
  std::vector<Contact> contacts;
  std::size_t onDevice = 0;
  std::uint64_t intersecting = end.counts.intersectingPairs;  // and those of pairs that needed no triangles
  for (const PairResult& result : results) {
    if (result.outcome == PairResult::Outcome::kNoMemory) {
      throw InputError(fmt::format("{}: pair {} has too many pairs of triangles for the memory or --max-pairs",
                                   options.scene, &result - results.data()));
    }
    contacts.insert(contacts.end(), result.contacts.begin(), result.contacts.end());
    onDevice += result.onDevice ? 1 : 0;
    const Query& query = scene.queries[static_cast<std::size_t>(&result - results.data())];
    if (result.outcome == PairResult::Outcome::kDone && mayNeedNoTriangles(query) &&
        result.counts.candidatePairs == 0) {
      intersecting += countsOf(query, {}).intersectingPairs;
    }
  }
  std::vector<std::string> computers;
  Json devices = Json::array();
  std::uint64_t failed = 0;
  for (const auto& slot : dispatcher->devices()) {
    computers.push_back(slot->backend->device().name);
    failed += slot->failedQueries;
    devices.push_back({{"index", slot->backend->device().index},
                       {"name", slot->backend->device().name},
                       {"block_pairs", slot->blockPairs.load()},
                       {"expected_ms", slot->knowsCosts ? Json(slot->blockExpectedMs.load()) : Json()},
                       {"ms", slot->blockMs.load()}});
  }
  if (onDevice < jobs.size() || jobs.empty()) {
    computers.push_back(fmt::format("host CPU, {} threads", dispatcher->threadCount()));
  }

  Json perPair = Json::array();
  for (const PairResult& result : results) perPair.push_back(result.contacts.size());
  const Json document = {{"pairs", scene.queries.size()},
                         {"meshes", scene.meshes.size()},
                         {"total_contacts", contacts.size()},
                         {"intersecting_pairs", intersecting},
                         {"contacts_before_reduction", end.counts.contactsBeforeReduction},
                         {"timings_ms", {{"total", median(total)}}},
                         {"per_pair_contacts", perPair},
                         {"backend", onDevice == 0             ? "cpu"
                                     : onDevice == jobs.size() ? "opencl"
                                                               : "cpu and opencl"},
                         {"pairs_on_devices", onDevice},
                         {"device", fmt::format("{}", fmt::join(computers, " + "))},
                         {"devices", devices},
                         {"repeat", options.repeat},
                         {"hash", hashOf(contacts)}};
  if (failed > 0) progress("note: an OpenCL device failed; the CPU did what it left");
  if (options.json) {
    printJson(document);
    return kOk;
  }
  for (const char* key : {"pairs", "meshes", "intersecting_pairs", "contacts_before_reduction", "total_contacts"}) {
    fmt::print("{:<26} {:>12}\n", key, document[key].get<std::uint64_t>());
  }
  fmt::print("{:<26} {:>12.4f} ms\n", "total", median(total));
  fmt::print("{:<26} {} ({})\n", "backend", document["backend"].get<std::string>(),
             document["device"].get<std::string>());
  fmt::print("{:<26} {}\n", "hash", document["hash"].get<std::string>());
  if (!devices.empty()) printTable("blocks of the devices, in the last run", devices);
  return kOk;
}

}  // namespace

void addBatchCommand(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("batch", "Collide many pairs of meshes in one submission");
  auto options = std::make_shared<BatchOptions>();
  command->add_option("SCENE", options->scene, "JSON file: {\"meshes\": [file], \"pairs\": [[i, j, pose]]}")
      ->required();
  options->query.addBackendOptions(*command);
  options->query.addThreadOption(*command);
  options->query.addContactOptions(*command);
  command->add_option("--repeat", options->repeat, "The time is the median over this many runs, after one to warm up")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return runBatch(*options); }; });
}

}  // namespace otg::cli
