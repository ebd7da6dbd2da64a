// SPDX-License-Identifier: BSD-3-Clause
// `otg bench threads`: dCollide() called from several threads at once, and batches worked on by several threads.
#include <fmt/format.h>
#include <ode/ode.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <chrono>
#include <thread>

#include "cli/contact_hash.h"
#include "cli/progress.h"
#include "otg_bench/bench.h"
#include "otg_bench/geoms.h"
#include "scenes/simulation.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

constexpr int kCallPlaces = 64;
constexpr int kThreadRounds = 5;

struct ThreadsOptions {
  BenchOptions bench;
  std::vector<unsigned> threads;  ///< empty: 1, 2, 4, ... and as many as there are cores
  std::string contacts = "solid";
};

std::vector<unsigned> threadCounts(const ThreadsOptions& options) {
  std::vector<unsigned> counts = options.threads;
  if (counts.empty()) {
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    for (unsigned n = 2; n < cores; n *= 2) counts.push_back(n);
    counts.push_back(cores);
  }
  counts.push_back(1);  // what the others are compared with
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  return counts;
}

/// The mesh with its copy, in each query in a pose of its own that differs a little from the scene's.
std::vector<Query> nearbyQueries(const ThreadsOptions& options, const CollisionMesh& mesh) {
  Query query;
  query.a = query.b = &mesh;
  query.options.contacts = options.contacts == "solid" ? ContactModel::kSolid : ContactModel::kPairwise;
  query.options.maxContacts = kCallPlaces;
  const Transformd scene = benchPose(options.bench, mesh);
  truth::Random random(1);
  std::vector<Query> queries;
  for (int i = 0; i < options.bench.pairs; ++i) {
    query.bInA = scene;
    query.bInA.t = otgAdd(scene.t, otgScale(random.direction(), 1e-4 * static_cast<double>(mesh.mesh().radius())));
    queries.push_back(query);
  }
  return queries;
}

/// The contacts of every query of a run, each with as many places.
struct CallAnswers {
  std::vector<dContactGeom> contacts;
  std::vector<int> counts;
  std::vector<double> callUs;  ///< of each query by itself

  explicit CallAnswers(std::size_t queries) : contacts(queries * kCallPlaces), counts(queries), callUs(queries) {}
  std::string hash() const {
    Fnv1a hash;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      hash.add(counts[i]);
      for (int k = 0; k < counts[i]; ++k) {
        const dContactGeom& contact = contacts[i * kCallPlaces + static_cast<std::size_t>(k)];
        addToHash(hash, contact);
        hash.add(contact.side1);
        hash.add(contact.side2);
      }
    }
    return hash.hex();
  }
};

/// Every query by one of `threads` threads that run already. Milliseconds from the first one's begin to the last one's
/// end, by their own clocks: the calling thread may wake later than they do.
double callOnThreads(const std::vector<dGpuTriMeshPair>& pairs, unsigned threads, CallAnswers& answers) {
  using Clock = std::chrono::steady_clock;
  std::atomic<std::size_t> next{0};
  std::barrier<> together(static_cast<std::ptrdiff_t>(threads));
  std::vector<Clock::time_point> begins(threads), ends(threads);
  std::vector<std::thread> team;
  for (unsigned t = 0; t < threads; ++t) {
    team.emplace_back([&, t] {
      dAllocateODEDataForThread(dAllocateMaskAll);
      together.arrive_and_wait();
      begins[t] = Clock::now();
      for (std::size_t i = next.fetch_add(1); i < pairs.size(); i = next.fetch_add(1)) {
        const auto begin = Clock::now();
        answers.counts[i] =
            dCollide(pairs[i].o1, pairs[i].o2, kCallPlaces, &answers.contacts[i * kCallPlaces], sizeof(dContactGeom));
        answers.callUs[i] = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
      }
      ends[t] = Clock::now();
    });
  }
  for (std::thread& thread : team) thread.join();
  const auto first = *std::min_element(begins.begin(), begins.end());
  return std::chrono::duration<double, std::milli>(*std::max_element(ends.begin(), ends.end()) - first).count();
}

double collideAsBatch(const std::vector<dGpuTriMeshPair>& pairs, unsigned threads, CallAnswers& answers) {
  dGpuTriMeshSetThreadCount(static_cast<int>(threads));
  int status = 0;
  const double ms = timeOnce([&] {
    status = dGpuTriMeshCollidePairs(pairs.data(), static_cast<int>(pairs.size()), kCallPlaces, answers.contacts.data(),
                                     sizeof(dContactGeom), answers.counts.data());
  });
  if (status < 0) throw std::runtime_error(dGpuTriMeshErrorString(status));
  return ms;
}

/// One kind of work with one number of threads.
struct TeamWork {
  const char* name;
  double (*run)(const std::vector<dGpuTriMeshPair>&, unsigned, CallAnswers&);
  const std::vector<dGpuTriMeshPair>* pairs;
  unsigned threads;
  std::vector<double> ms, callUs;
  std::string hash;
  bool alwaysSame = true;

  void measure() {
    CallAnswers answers(pairs->size());
    ms.push_back(run(*pairs, threads, answers));
    callUs.push_back(median(answers.callUs));
    const std::string found = answers.hash();
    alwaysSame = alwaysSame && (hash.empty() || hash == found);
    hash = found;
  }
};

Json teamRow(const BenchMesh& entry, const TeamWork& work, const TeamWork& alone) {
  const double ms = median(work.ms), queries = static_cast<double>(work.pairs->size());
  const bool isCall = work.run == &callOnThreads;
  return {{"mesh", entry.name},
          {"triangles", entry.mesh->triangleCount()},
          {"work", work.name},
          {"threads", work.threads},
          {"queries", work.pairs->size()},
          {"ms", ms},
          {"queries_per_second", ms > 0 ? 1e3 * queries / ms : 0.0},
          {"call_us", isCall ? Json(median(work.callUs)) : Json()},
          {"speed_up", ms > 0 ? median(alone.ms) / ms : 0.0},
          {"hash", work.hash},
          {"answers", work.alwaysSame && work.hash == alone.hash ? "same" : "DIFFERENT"}};
}

int benchThreads(const ThreadsOptions& options) {
  const scenes::OdeSession session;
  const std::vector<unsigned> counts = threadCounts(options);
  Json rows = Json::array();
  const std::vector<BenchMesh> meshes = benchMeshes(options.bench);
  Progress all(meshes.size());
  for (const BenchMesh& entry : meshes) {
    progress(fmt::format("{}: {} triangles", entry.name, entry.mesh->triangleCount()));
    const CollisionMesh mesh(entry.mesh, BuildStrategy::kSah);
    const GeomPairs pairs(nearbyQueries(options, mesh));
    pairs.setBackend(dGPUTRIMESH_BACKEND_CPU);
    pairs.setHistory(dGPUTRIMESH_HISTORY_OFF);
    const std::vector<dGpuTriMeshPair> samePair(pairs.all().size(), pairs.all().front());
    std::vector<TeamWork> works;
    for (const auto& [name, run, list] : {std::tuple{"same pair", &callOnThreads, &samePair},
                                          std::tuple{"different pairs", &callOnThreads, &pairs.all()},
                                          std::tuple{"batch", &collideAsBatch, &pairs.all()}}) {
      for (const unsigned threads : counts) works.push_back({name, run, list, threads, {}, {}, {}});
    }
    CallAnswers memory(pairs.all().size());
    callOnThreads(pairs.all(), counts.back(), memory);  // memory of threads
    // In turns, so that a busy moment of the machine hits all of them.
    const int rounds = options.bench.repeat > 0 ? options.bench.repeat : kThreadRounds;
    Progress parts(static_cast<std::size_t>(rounds));
    for (int round = 0; round < rounds; ++round, parts.step()) {
      for (TeamWork& work : works) work.measure();
    }
    for (std::size_t i = 0; i < works.size(); ++i) {
      rows.push_back(teamRow(entry, works[i], works[i - i % counts.size()]));
    }
    all.step();
  }
  dGpuTriMeshSetThreadCount(0);
  printBench({{"bench", "threads"},
              {"scene", options.bench.scene},
              {"contacts", options.contacts},
              {"cores", std::thread::hardware_concurrency()},
              {"tables", {{"threads", rows}}}},
             options.bench.json);
  return kOk;
}

}  // namespace

void addBenchThreads(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand(
      "threads", "Queries from several threads at once, of one pair and of different ones, and batches");
  auto options = std::make_shared<ThreadsOptions>();
  options->bench.pairs = 256;
  options->bench.addTo(*command, true);
  command->add_option("--threads", options->threads, "How many threads (default: 1, 2, 4, ... and one for each core)")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024));
  command->add_option("--pairs", options->bench.pairs, "Pairs of geoms, and queries of one pair")
      ->check(CLI::Range(1, 100000));
  command->add_option("--contacts", options->contacts, "Contact model")->check(CLI::IsMember({"pairwise", "solid"}));
  command->callback([options, &action] { action = [options] { return benchThreads(*options); }; });
}

}  // namespace otg::cli
