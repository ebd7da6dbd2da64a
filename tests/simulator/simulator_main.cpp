// SPDX-License-Identifier: BSD-3-Clause
// For tests on a simulated OpenCL device, Oclgrind (Debian: oclgrind), which says of every access to memory whether it
// is within bounds and whether two work-items race. What it says fails the program. Without it the program exits with
// 77, which ctest reports as skipped.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "opencl/runtime/context.h"
#include "opencl/runtime/launch.h"
#include "simulator/simulator_reports.h"
#include "support/catch_runner.h"

namespace {

namespace fs = std::filesystem;
using namespace otg;

/// Where packages and builds of the simulator have its driver; empty if nowhere. OTG_SIMULATOR names another place.
std::string simulatorLibrary() {
  const char* requested = std::getenv("OTG_SIMULATOR");
  for (const char* path :
       {requested, "/usr/lib/oclgrind/liboclgrind-rt-icd.so", "/usr/lib64/oclgrind/liboclgrind-rt-icd.so",
        "/usr/local/lib/oclgrind/liboclgrind-rt-icd.so"}) {
    std::error_code ignored;
    if (path != nullptr && fs::exists(path, ignored)) return path;
  }
  return {};
}

void set(const char* name, const std::string& value) {
  setenv(name, value.c_str(), 1);
}

/// The simulator is the only device, with a cache of programs of its own.
void chooseSimulator(const fs::path& folder, const std::string& library) {
  std::ofstream(folder / "simulator.icd") << library << '\n';
  set("OCL_ICD_VENDORS", folder.string());
  set("OTG_CACHE_DIR", (folder / "cache").string());
  set("OTG_OPENCL_DEVICE", "0");
  // Its interpreter knows neither what its compiler's optimiser makes of kernels nor what inlining leaves behind.
  set("OCLGRIND_BUILD_OPTIONS", "-cl-opt-disable -DOTG_NOT_INLINED");
  // As most GPUs have it; others have less.
  const char* const localMemory = std::getenv("OTG_SIMULATOR_LOCAL_MEMORY");
  set("OCLGRIND_LOCAL_MEM_SIZE", localMemory != nullptr ? localMemory : "49152");
  set("OCLGRIND_DATA_RACES", "1");
  set("OCLGRIND_MAX_ERRORS", "1000000");  // those that are meant must not hide others
  // OCLGRIND_UNINITIALIZED is of no use here: a write to a part of a buffer makes it forget the rest. So it takes
  // nearly all that kernels read for uninitialised.
}

/// Runs it in a child process, whose stderr is the file: so all is written when it ends, even if the simulator ends it.
/// A log of the simulator's own would begin anew with each context. -> exit status.
int runApart(const fs::path& errors, const std::function<int()>& run) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (std::freopen(errors.c_str(), "w", stderr) == nullptr) std::exit(1);
    std::exit(run());
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) return 1;
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  std::puts("ended by a signal");
  return 1;
}

std::vector<std::string> reportsIn(const fs::path& errors) {
  std::ifstream in(errors);
  return test::unexpectedReports(std::string((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>()));
}

/// A kernel that races and writes out of bounds.
int runFaultyKernel(const fs::path& folder) {
  std::ofstream(folder / "faulty.cl") << "__kernel void faulty(__global uint* out) {\n"
                                         "  __local uint last;\n"
                                         "  last = get_local_id(0);\n"
                                         "  out[get_global_id(0) + 1] = last;\n"
                                         "}\n";
  set("OTG_KERNEL_DIR", folder.string());
  const std::vector<opencl::FoundDevice> devices = opencl::findDevices();
  if (devices.size() != 1) return 1;
  opencl::Context context(devices[0], opencl::ProgramCache(""));
  const opencl::QueueHandle queue = context.makeQueue(false);
  opencl::Kernel kernel = context.makeKernel("faulty.cl", "", "faulty");
  constexpr std::size_t kLanes = 8;
  const opencl::BufferHandle out = context.makeBuffer(CL_MEM_READ_WRITE, kLanes * sizeof(cl_uint));
  const cl_mem memory = out.get();
  kernel.begin();
  kernel.set(0, sizeof memory, &memory);
  opencl::launch(queue.get(), kernel, kLanes, 1);
  cl_uint words[kLanes];
  opencl::readBlocking(queue.get(), memory, sizeof words, words);
  return 0;
}

/// Whether faults are seen at all.
bool seesFaults(const fs::path& folder) {
  const int status = runApart(folder / "seen", [&] { return runFaultyKernel(folder); });
  bool race = false, beyond = false;
  for (const std::string& report : reportsIn(folder / "seen")) {
    race = race || report.find("data race at local memory") != std::string::npos;
    beyond = beyond || report.find("Invalid write") != std::string::npos;
  }
  if (race && beyond && status == 0) return true;
  std::printf("the simulator does not see%s%s of a kernel that has both\n", race ? "" : " the race",
              beyond ? "" : " the write out of bounds");
  return false;
}

int runTests(const fs::path& folder, int argc, char* argv[]) {
  constexpr std::size_t kMostShown = 20;
  if (!seesFaults(folder)) return 1;
  const int status = runApart(folder / "errors", [&] { return test::runCatch(argc, argv); });
  const std::vector<std::string> reports = reportsIn(folder / "errors");
  if (reports.empty()) return status;
  std::printf("%zu reports of the simulator's, or other lines on stderr:\n", reports.size());
  for (std::size_t i = 0; i < std::min(kMostShown, reports.size()); ++i) std::printf("\n%s", reports[i].c_str());
  return 1;
}

}  // namespace

int main(int argc, char* argv[]) {
  const std::string library = simulatorLibrary();
  if (library.empty()) {
    std::puts("skipped: no simulator of OpenCL devices (Debian: oclgrind)");
    return 77;
  }
  std::string folder = (fs::temp_directory_path() / "otg_simulated_XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 1;
  chooseSimulator(folder, library);
  const int status = runTests(folder, argc, argv);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return status;
}
