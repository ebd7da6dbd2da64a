// SPDX-License-Identifier: BSD-3-Clause
// `otg soak`: worlds, batches and queries for hours, each result twice, with the memory of the process watched.
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <chrono>
#include <cstdarg>
#include <fstream>

#include "ode_trimesh_gpu/ode_trimesh_gpu.h"
#include "opencl/runtime/log.h"
#include "otg/commands.h"
#include "otg/soak_rounds.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

/// Memory is read after so many rounds. What the library keeps for later calls has grown to the largest of many by
/// then.
constexpr int kRoundsPerSample = 50;
/// Exit status where results differ or memory grows.
constexpr int kFailed = 3;
constexpr double kMostGrowth = 0.01;
/// Growth below this is that of the allocator's own lists.
constexpr double kGrain = 256 * 1024;

struct SoakOptions {
  double hours = 1;
  std::uint64_t seed = 1, rounds = 0;
  bool onDevice = false, json = false;
};

/// Bytes that the process has from its allocator now.
double heapBytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

double residentBytes() {
  malloc_trim(0);
  std::ifstream in("/proc/self/statm");
  double size = 0, resident = 0;
  in >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

struct MemorySamples {
  std::vector<double> heap, resident;
  void take() {
    heap.push_back(heapBytes());
    resident.push_back(residentBytes());
  }
  /// The median of the last quarter over that of the second: in the first buffers grow to their sizes. 0 where samples
  /// are too few to judge.
  static double growth(const std::vector<double>& samples) {
    if (samples.size() < 16) return 0;
    const auto quarter = static_cast<std::ptrdiff_t>(samples.size() / 4);
    const double early = median({samples.begin() + quarter, samples.begin() + 2 * quarter});
    const double late = median({samples.end() - quarter, samples.end()});
    return late - early <= kGrain ? 0 : late / early - 1;
  }
};

void dropMessage(int, const char*, va_list) {}

int runSoak(const SoakOptions& options) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const scenes::OdeSession session;
  dSetMessageHandler(&dropMessage);  // its solver's: random bodies begin inside each other
  dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU);
  opencl::setLogSink([](const std::string&) {});  // calls fail on purpose
  MemorySamples memory;
  SoakCounts counts;
  {
    SoakRounds rounds(options.onDevice);
    double reported = 0;
    const auto isOver = [&](std::uint64_t i) {
      return options.rounds > 0 ? i >= options.rounds : seconds() >= 3600 * options.hours;
    };
    for (std::uint64_t i = 0; !isOver(i); ++i) {
      rounds.run(options.seed + i);
      if ((i + 1) % kRoundsPerSample == 0) {
        rounds.settle();
        memory.take();
      }
      if (seconds() - reported < 60) continue;
      reported = seconds();
      progress(fmt::format("{:.0f} s: {} rounds, {} queries, {} differences, {:.1f} MB", reported, i + 1,
                           rounds.counts().queries, rounds.counts().differences, residentBytes() / 1e6));
    }
    counts = rounds.counts();
  }
  opencl::setLogSink({});
  const double heapGrowth = MemorySamples::growth(memory.heap);
  const Json row{{"rounds", counts.rounds},
                 {"worlds", counts.worlds},
                 {"steps", counts.steps},
                 {"queries", counts.queries},
                 {"compared", counts.compared},
                 {"differences", counts.differences},
                 {"first_difference", counts.firstDifference},
                 {"devices_opened", counts.devicesOpened},
                 {"calls_failed", counts.callsFailed},
                 {"heap_mb", memory.heap.empty() ? 0 : memory.heap.back() / 1e6},
                 {"heap_growth", heapGrowth},
                 {"resident_mb", memory.resident.empty() ? 0 : memory.resident.back() / 1e6},
                 {"resident_growth", MemorySamples::growth(memory.resident)},
                 {"seconds", seconds()}};
  if (options.json) {
    printJson({{"soak", row}, {"rounds_per_sample", kRoundsPerSample}, {"heap_bytes", memory.heap}});
  } else {
    for (const auto& [key, value] : row.items()) fmt::print("{:18} {}\n", key, value.dump());
  }
  return counts.differences > 0 || heapGrowth > kMostGrowth ? kFailed : kOk;
}

}  // namespace

void addSoakCommand(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("soak",
                         "Worlds, batches and queries for hours, each answer twice; memory is watched (exit status 3: "
                         "answers differ, or the memory in use grew by more than 1 %)");
  auto options = std::make_shared<SoakOptions>();
  command->add_option("--hours", options->hours, "How long")->check(CLI::Range(0.0, 10000.0))->capture_default_str();
  command->add_option("--rounds", options->rounds, "Instead: so many rounds")->check(CLI::Range(1, 1000000000));
  command->add_option("--seed", options->seed, "Of the first round; each has the next one");
  command->add_flag("--device", options->onDevice,
                    "The default OpenCL device, too: opened, closed, and with calls that fail");
  command->add_flag("--json", options->json, "One JSON document on stdout");
  command->callback([options, &action] { action = [options] { return runSoak(*options); }; });
}

}  // namespace otg::cli
