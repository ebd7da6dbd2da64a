// SPDX-License-Identifier: BSD-3-Clause
// Devices that are opened in the background: calls return at once, the CPU computes meanwhile, and a process may end,
// close or fork whatever is under way.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <thread>

#include "dispatch/cost/calibration.h"
#include "dispatch/cost/rehearsal.h"
#include "dispatch/dispatcher.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/device_info.h"
#include "opencl/runtime/log.h"
#include "opencl/runtime/stop.h"
#include "support/opencl.h"
#include "support/pile_world.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;
using opencl::FaultInjection;

extern char** environ;

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Holds back the opening of devices until it is let go.
class Gate {
 public:
  Gate() {
    dispatcher().setOpeningHook([this] {
      std::unique_lock lock(mutex_);
      isThere_ = true;
      changed_.notify_all();
      changed_.wait_for(lock, std::chrono::seconds(10), [this] { return isOpen_; });
    });
  }
  ~Gate() {
    open();
    dispatcher().stopOpening();
    dispatcher().setOpeningHook({});
    dGpuTriMeshCloseDevices();
    dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU);
  }
  Gate(const Gate&) = delete;
  Gate& operator=(const Gate&) = delete;
  void waitForOpener() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return isThere_; });
  }
  void open() {
    const std::lock_guard lock(mutex_);
    isOpen_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool isThere_ = false, isOpen_ = false;
};

/// Lines of the log while it lives.
class Lines {
 public:
  Lines() {
    opencl::forgetFailures();
    opencl::setLogSink([this](const std::string& line) { lines_.push_back(line); });
  }
  ~Lines() { opencl::setLogSink({}); }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;
  const std::vector<std::string>& get() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

/// Some steps of a small world. -> all that they led to.
std::vector<unsigned char> stepped(std::uint64_t* onDevice = nullptr) {
  PileWorld::Choices choices;
  choices.bodies = 5;
  PileWorld world(choices);
  world.step(12, [&] { dGpuTriMeshPrefetch(world.space()); });
  if (onDevice != nullptr) *onDevice = world.stats().on_device;
  CHECK(world.stats().device_failures == 0);
  return world.bytes();
}

}  // namespace

TEST_CASE("auto returns at once, and the CPU computes until the device is ready") {
  const OdeSession session;
  const std::vector<unsigned char> expected = stepped();
  Gate gate;
  CHECK(dGpuTriMeshWaitForDevices(0) == dGPUTRIMESH_NO_DEVICE);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);  // the opener is held back
  CHECK(dGpuTriMeshGetBackend() == dGPUTRIMESH_BACKEND_AUTO);
  CHECK(dGpuTriMeshGetDeviceCount() == 0);
  CHECK(dGpuTriMeshWaitForDevices(0) == dGPUTRIMESH_OPENING);
  const Clock::time_point start = Clock::now();
  CHECK(dGpuTriMeshWaitForDevices(50) == dGPUTRIMESH_OPENING);
  CHECK(secondsSince(start) >= 0.05);
  std::uint64_t onDevice = 1;
  CHECK(stepped(&onDevice) == expected);
  CHECK(onDevice == 0);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);  // it is under way already
  gate.open();
  CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshGetDeviceCount() == 1);
  CHECK(stepped() == expected);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  CHECK(stepped(&onDevice) == expected);
  CHECK(onDevice > 0);
}

TEST_CASE("auto opens no device of type CPU, and opencl does") {
  const std::vector<opencl::DeviceInfo> devices = opencl::listDevices();
  if (devices[static_cast<std::size_t>(opencl::defaultDevice(devices))].kind != opencl::DeviceKind::kCpu) return;
  const OdeSession session;
  const bool before = letCpusTakeAuto(false);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_NO_DEVICE);
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshGetDeviceCount() == 1);
  letCpusTakeAuto(before);
  dGpuTriMeshCloseDevices();
  dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU);
}

TEST_CASE("opencl waits for the device that is being opened") {
  const OdeSession session;
  Gate gate;
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
  gate.waitForOpener();
  const std::uint64_t before = FaultInjection::callCount();
  std::uint64_t whileHeld = 1;
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    whileHeld = FaultInjection::callCount() - before;
    gate.open();
  });
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_OPENCL) == dGPUTRIMESH_OK);
  later.join();
  CHECK(whileHeld == 0);  // it opened none of its own
  CHECK(dGpuTriMeshWaitForDevices(0) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshGetDeviceCount() == 1);
}

TEST_CASE("what is being opened is dropped when devices are closed or others are opened") {
  const OdeSession session;
  Lines lines;
  Gate gate;
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
  gate.waitForOpener();
  SECTION("closed") {
    dGpuTriMeshCloseDevices();  // does not wait
    gate.open();
    CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_NO_DEVICE);
    CHECK(dGpuTriMeshGetDeviceCount() == 0);
    CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);  // and opened again
    CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_OK);
  }
  SECTION("closed, and opened again while the opener is still held back") {
    dGpuTriMeshCloseDevices();
    CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
    gate.open();
    CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_OK);
    CHECK(dGpuTriMeshGetDeviceCount() == 1);
  }
  SECTION("others are opened") {
    const std::vector<int> twice(2, opencl::defaultDevice(opencl::listDevices()));
    CHECK(dGpuTriMeshOpenDevices(twice.data(), 2) == 2);
    gate.open();
    CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_OK);
    CHECK(dGpuTriMeshGetDeviceCount() == 2);
  }
  SECTION("the library is closed") {
    std::thread later([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      gate.open();
    });
    dGpuTriMeshClose();  // waits for the opener
    CHECK(dGpuTriMeshWaitForDevices(0) == dGPUTRIMESH_NO_DEVICE);
    later.join();
    // Initialised again it goes on with what was asked for.
    CHECK(dGpuTriMeshInit() == 1);
    CHECK(dGpuTriMeshGetBackend() == dGPUTRIMESH_BACKEND_AUTO);
    CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_OK);
  }
  SECTION("the library is closed, and something else is asked for before it is initialised again") {
    gate.open();
    dGpuTriMeshClose();
    CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_CPU) == dGPUTRIMESH_OK);
    CHECK(dGpuTriMeshInit() == 1);
    CHECK(dGpuTriMeshWaitForDevices(0) == dGPUTRIMESH_NO_DEVICE);
  }
  CHECK(lines.get().empty());
}

TEST_CASE("what fails in the background is reported once, and leaves the CPU") {
  const OdeSession session;
  const std::vector<unsigned char> expected = stepped();
  for (const std::uint64_t n : {1, 12, 60, 200}) {
    INFO("call " << n << " and all after it fail");
    Lines lines;
    Gate gate;
    gate.open();
    FaultInjection::failAt(n, CL_OUT_OF_RESOURCES, 1000000000);
    CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
    CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_NO_DEVICE);
    CHECK(stepped() == expected);
    FaultInjection::failAt(0);
    const std::vector<std::string> reported = lines.get();
    CHECK(!reported.empty());
    for (std::size_t i = 0; i < reported.size(); ++i)
      CHECK(std::count(reported.begin(), reported.end(), reported[i]) == 1);
  }
}

TEST_CASE("costs that were measured while the program was at work are not kept") {
  if (defaultThreadCount() < 2) return;  // seen where several threads are timed
  const OdeSession session;
  const std::vector<opencl::DeviceInfo> devices = opencl::listDevices();
  const opencl::DeviceInfo& device = devices[static_cast<std::size_t>(opencl::defaultDevice(devices))];
  const std::string file = opencl::ProgramCache::standard().pathOf(costKey(device));
  std::filesystem::remove(file);
  {
    Gate gate;
    gate.open();
    std::atomic<bool> stop{false};
    std::vector<std::thread> busy;
    for (unsigned i = 0; i < 4 * defaultThreadCount(); ++i) {
      busy.emplace_back([&] {
        while (!stop) {
        }
      });
    }
    CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
    CHECK(dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_OK);
    stop = true;
    for (std::thread& thread : busy) thread.join();
    CHECK(!std::filesystem::exists(file));
    CHECK(dispatcher().devices()[0]->knowsCosts);
  }
  const int index = device.index;
  REQUIRE(dGpuTriMeshOpenDevices(&index, 1) == 1);  // these are
  CHECK(std::filesystem::exists(file));
  dGpuTriMeshCloseDevices();
}

TEST_CASE("a thread that is asked to stop begins no program more, which is no failure") {
  Lines lines;
  std::atomic<bool> stop{false};
  int loaded = 0;
  const int device = opencl::defaultDevice(opencl::listDevices());
  {
    const opencl::StopScope scope(stop, [&] { stop = ++loaded == 2; });  // the compiler is there
    CHECK_THROWS_AS(opencl::Backend::open(device), opencl::Stopped);
    CHECK(loaded == 2);
    stop = false;
    const auto backend = opencl::Backend::open(device);
    REQUIRE(backend);
    CHECK(rehearse(*backend) == Rehearsed::kGood);
    stop = true;
    CHECK_THROWS_AS(rehearse(*backend), opencl::Stopped);
  }
  CHECK(opencl::Backend::open(device));
  CHECK(lines.get().empty());
}

TEST_CASE("no query builds programs once a device was rehearsed") {
  const auto backend = openBackend();
  REQUIRE(backend);
  REQUIRE(rehearse(*backend) == Rehearsed::kGood);
  const auto built = [&] {
    const opencl::BackendCounts counts = backend->counts();
    return counts.programsFromSource + counts.programsFromCache;
  };
  const int before = built();
  CHECK(before > 5);
  const auto lump = collisionMesh(makeLump(1, 5, 0.2, 3)), other = collisionMesh(makeLump(1, 5, 0.2, 8)),
             box = collisionMesh(makeBox({1, 1, 1}, 1));
  std::vector<Query> queries;
  for (const double distance : {0.4, 1.2, 1.9, 3.0}) {
    queries.push_back(makeQuery(*lump, *other, makePose({0.48, 0.6, 0.64}, 0.7, {distance, 0.1, 0.1})));
    queries.push_back(makeQuery(*lump, *box, makePose({0.48, 0.6, 0.64}, 0.7, {distance, 0.1, 0.1})));
  }
  // Faces in one plane, of few triangles and of many.
  const auto boxes = collisionMesh(makeBox({1, 1, 1}, 12));
  for (const auto& mesh : {box, boxes}) {
    queries.push_back(makeQuery(*mesh, *mesh, makePose({0, 0, 1}, 0, {0.25, 0.5, 1})));
    queries.push_back(queries.back());
    queries.back().options.reduction.method = Reduction::kCone;
  }
  if (mayDoSolids(*backend)) {
    const auto count = queries.size();
    for (std::size_t i = 0; i < count; ++i) {
      queries.push_back(queries[i]);
      queries.back().options.contacts = ContactModel::kSolid;
    }
  }
  for (int round = 0; round < 2; ++round) {
    for (const Query& query : queries) checkParity(*backend, query);
  }
  opencl::BatchAnswer answer;
  std::vector<std::uint8_t> meet;
  for (const std::size_t copies : {1, 40}) {
    std::vector<Query> many;
    for (std::size_t i = 0; i < copies; ++i) many.insert(many.end(), queries.begin(), queries.end());
    CHECK(backend->collideBatch(many, answer));
    CHECK(backend->intersectBatch(many, meet));
  }
  if (backend->answersPoints()) {
    constexpr std::size_t kCount = 70000;  // several pieces
    const auto points = [](std::size_t begin, std::size_t end, Vec3d* to) {
      for (std::size_t i = begin; i < end; ++i) to[i - begin] = {1e-5 * static_cast<double>(i), 0.2, 1};
    };
    const auto rays = [](std::size_t begin, std::size_t end, LongRay* to) {
      for (std::size_t i = begin; i < end; ++i)
        to[i - begin] = {{{3, 1e-5 * static_cast<double>(i), 0}, {-1, 0, 0}}, 9};
    };
    CHECK(backend->askPoints(*box, {true, true}, kCount, points, [](auto...) {}) == kCount);
    CHECK(backend->castRays(*box, false, kCount, rays, [](auto...) {}) == kCount);
    std::vector<TrianglePair> nearest(2);
    const std::vector<Query> apart(2, makeQuery(*lump, *box, makePose({0, 0, 1}, 0.7, {4, 0.1, 0.1})));
    CHECK(backend->nearestTriangles(apart, 1e9, nearest, [](std::size_t count, const auto& work) { work(0, count); }) ==
          2);
  }
  CHECK(built() == before);
}

// Of a process of its own, by the next test.
TEST_CASE("a process ends while a device is opened", "[.]") {
  const char* const wait = std::getenv("OTG_TEST_WAIT");
  REQUIRE(wait != nullptr);
  dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO);
  std::this_thread::sleep_for(std::chrono::milliseconds(std::atoi(wait)));
  std::exit(42);
}

TEST_CASE("a process may end while a device is opened") {
  for (const int wait : {0, 3, 30, 300, 1000}) {
    INFO("after " << wait << " ms");
    setenv("OTG_TEST_WAIT", std::to_string(wait).c_str(), 1);
    const char* const words[] = {"test", "a process ends while a device is opened", nullptr};
    posix_spawn_file_actions_t actions;
    REQUIRE(posix_spawn_file_actions_init(&actions) == 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    REQUIRE(posix_spawn(&child, "/proc/self/exe", &actions, nullptr, const_cast<char* const*>(words), environ) == 0);
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 42);
  }
}

TEST_CASE("a child process does not wait for what its parent opens") {
  const OdeSession session;
  Gate gate;
  CHECK(dGpuTriMeshSetBackend(dGPUTRIMESH_BACKEND_AUTO) == dGPUTRIMESH_OK);
  gate.waitForOpener();
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);  // seconds, after which it is ended by a signal
    const bool done = dGpuTriMeshWaitForDevices(-1) == dGPUTRIMESH_NO_DEVICE;
    dGpuTriMeshCloseDevices();
    dGpuTriMeshClose();
    _exit(done ? 0 : 1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}
