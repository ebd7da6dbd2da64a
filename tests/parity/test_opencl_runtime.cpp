// SPDX-License-Identifier: BSD-3-Clause
// Devices, the cache of programs, resident meshes, and what happens when calls fail.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <thread>
#include <type_traits>

#include "opencl/meshes/mesh_store.h"
#include "opencl/meshes/pack_mesh.h"
#include "opencl/runtime/call.h"
#include "opencl/runtime/context.h"
#include "opencl/runtime/given.h"
#include "opencl/runtime/kernel_source.h"
#include "opencl/runtime/log.h"
#include "opencl/runtime/program_cache.h"
#include "shared/layout/pairwise_given.h"
#include "support/opencl.h"
#include "support/part_of.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;
using opencl::FaultInjection;
namespace fs = std::filesystem;

// A buffer of other elements, a buffer that is only read where one is written, and a field that was forgotten do not
// compile.
static_assert(std::is_convertible_v<BufferOf<otg_counter>, BufferOf<const otg_counter>>);
static_assert(!std::is_convertible_v<BufferOf<const otg_counter>, BufferOf<otg_counter>>);
static_assert(!std::is_convertible_v<BufferOf<otg_counter>, BufferOf<otg_chosen_word>>);
static_assert(!std::is_convertible_v<BufferOf<otg_hit>, BufferOf<const otg_node_pair>>);
static_assert(!std::is_convertible_v<cl_mem, BufferOf<otg_counter>>);
static_assert(!std::is_default_constructible_v<BufferOf<otg_counter>>);
static_assert(!std::is_default_constructible_v<ValueOf<otg_uint>> &&
              !std::is_default_constructible_v<LocalOf<otg_hit>>);
static_assert(!std::is_default_constructible_v<given::PlaceContacts>);

namespace {

std::vector<fs::path> cacheFiles() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(std::getenv("OTG_CACHE_DIR"))) files.push_back(entry.path());
  return files;
}

opencl::Bytes readAll(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void writeAll(const fs::path& path, const opencl::Bytes& bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// Collects what is logged while it lives.
class LogCapture {
 public:
  LogCapture() {
    opencl::forgetFailures();
    opencl::setLogSink([this](const std::string& line) { lines.push_back(line); });
  }
  ~LogCapture() { opencl::setLogSink({}); }
  std::vector<std::string> lines;
};

Query lumpQuery(const CollisionMesh& a, const CollisionMesh& b) {
  return makeQuery(a, b, makePose({0.48, 0.6, 0.64}, 0.7, {1.1, 0.4, 0.1}));
}

}  // namespace

TEST_CASE("devices are numbered, described and chosen by the environment") {
  const std::vector<opencl::DeviceInfo> devices = opencl::listDevices();
  REQUIRE(!devices.empty());
  for (std::size_t i = 0; i < devices.size(); ++i) {
    CHECK(devices[i].index == static_cast<int>(i));
    CHECK(!devices[i].name.empty());
    CHECK(devices[i].computeUnits > 0);
    CHECK(devices[i].globalMemory >= devices[i].largestAllocation);
  }
  const auto chosen = [&](const char* request) {
    setenv("OTG_OPENCL_DEVICE", request, 1);
    const int index = opencl::defaultDevice(devices);
    unsetenv("OTG_OPENCL_DEVICE");
    return index;
  };
  const opencl::DeviceInfo& first = devices[0];
  CHECK(chosen("0") == (first.available ? 0 : -1));
  std::string upper = first.name;
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  CHECK(chosen(upper.c_str()) == chosen(first.name.c_str()));
  CHECK(chosen(first.name.c_str()) >= 0);
  CHECK(chosen("none") == -1);
  CHECK(chosen("12345") == -1);
  CHECK(chosen("") == opencl::defaultDevice(devices));
  CHECK(opencl::Backend::open(12345) == nullptr);
}

TEST_CASE("a kernel's text has its includes in it, and a missing file is an error") {
  const std::string source = opencl::kernelSource("walk/pair_query.cl");
  CHECK(source.find("otgBoxGapA") != std::string::npos);
  CHECK(source.find("\n#include \"") == std::string::npos);
  CHECK(source.find("#line 1 \"shared/tests/box_test.h\"") != std::string::npos);
  CHECK_THROWS_AS(opencl::kernelSource("no_such.cl"), std::runtime_error);
}

TEST_CASE("programs come from the cache, and a damaged or foreign cache file is built anew") {
  const auto counts = [] {
    const auto backend = openBackend();
    REQUIRE(backend);
    return backend->counts();
  };
  for (const fs::path& path : cacheFiles()) fs::remove(path);
  const opencl::BackendCounts first = counts();
  CHECK(first.programsFromSource > 0);
  CHECK(first.programsFromCache == 0);
  const opencl::BackendCounts second = counts();
  CHECK(second.programsFromSource == 0);
  CHECK(second.programsFromCache == first.programsFromSource);

  const std::vector<fs::path> files = cacheFiles();
  REQUIRE(files.size() == static_cast<std::size_t>(first.programsFromSource));
  std::map<fs::path, opencl::Bytes> good;
  for (const fs::path& path : files) good[path] = readAll(path);
  const auto damaged = [&](auto&& change) {
    for (const fs::path& path : files) {
      opencl::Bytes bytes = good[path];
      change(bytes);
      writeAll(path, bytes);
    }
    const auto backend = openBackend();
    REQUIRE(backend);
    CHECK(backend->counts().programsFromSource == first.programsFromSource);
    const auto lump = collisionMesh(makeLump(1, 3, 0.2, 3));
    checkParity(*backend, lumpQuery(*lump, *lump));
    // What was built took the place of the damaged file.
    CHECK(counts().programsFromCache == first.programsFromSource);
  };
  damaged([](opencl::Bytes& b) { b.clear(); });
  damaged([](opencl::Bytes& b) { b.resize(20); });
  damaged([](opencl::Bytes& b) { b.resize(std::max<std::size_t>(b.size(), 1) - 1); });
  damaged([](opencl::Bytes& b) { b.push_back(0); });
  damaged([](opencl::Bytes& b) { b[0] ^= 1; });   // another format
  damaged([](opencl::Bytes& b) { b[60] ^= 1; });  // another key
  damaged([](opencl::Bytes& b) { b[b.size() / 2] ^= 16; });
  damaged([](opencl::Bytes& b) { b[b.size() - 1] ^= 1; });
  damaged([](opencl::Bytes& b) {  // sizes beyond all memory
    for (std::size_t i = 16; i < 40; ++i) b[i] = 0xff;
  });
}

TEST_CASE("a binary that the driver does not take is built from source") {
  // A file that is sound in itself but holds nonsense.
  const opencl::ProgramCache cache(std::getenv("OTG_CACHE_DIR"));
  for (const fs::path& path : cacheFiles()) {
    const opencl::Bytes bytes = readAll(path);
    std::uint64_t keySize = 0;
    std::copy_n(bytes.data() + 16, 8, reinterpret_cast<unsigned char*>(&keySize));
    const std::string key(reinterpret_cast<const char*>(bytes.data() + 40), static_cast<std::size_t>(keySize));
    REQUIRE(cache.pathOf(key) == path.string());
    REQUIRE(cache.store(key, opencl::Bytes(1000, 7)));
    REQUIRE(cache.load(key).has_value());
  }
  const auto backend = openBackend();
  REQUIRE(backend);
  CHECK(backend->counts().programsFromCache == 0);
  const auto lump = collisionMesh(makeLump(1, 3, 0.2, 3));
  checkParity(*backend, lumpQuery(*lump, *lump));
}

TEST_CASE("a cache that cannot be written is no cache") {
  const opencl::ProgramCache none(""), impossible("/dev/null/folder");
  for (const opencl::ProgramCache* cache : {&none, &impossible}) {
    CHECK(!cache->store("key", {1, 2, 3}));
    CHECK(!cache->load("key").has_value());
  }
}

TEST_CASE("meshes are uploaded once, evicted when memory runs out, and uploaded again") {
  std::vector<std::shared_ptr<const CollisionMesh>> lumps;
  for (std::uint32_t seed = 0; seed < 24; ++seed) lumps.push_back(collisionMesh(makeLump(1, 4, 0.2, seed)));
  {
    const auto backend = openBackend();
    REQUIRE(backend);
    for (int round = 0; round < 3; ++round) {
      for (std::size_t i = 0; i < 6; ++i) checkParity(*backend, lumpQuery(*lumps[i], *lumps[(i + 1) % 6]));
    }
    CHECK(backend->counts().meshUploads == 6);
    CHECK(backend->counts().meshEvictions == 0);
    CHECK(backend->counts().meshBytes > 6 * 5120 * 48);
  }
  opencl::Tuning tuning;
  tuning.meshBudget = 10 << 20;  // some ten lumps
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < lumps.size(); ++i) {
      checkParity(*backend, lumpQuery(*lumps[i], *lumps[(i + 1) % lumps.size()]));
    }
  }
  CHECK(backend->counts().onHost == 0);
  CHECK(backend->counts().meshEvictions > 10);
  CHECK(backend->counts().meshBytes <= tuning.meshBudget);

  // Meshes that are gone make room, without anything being evicted.
  const std::uint64_t evictions = backend->counts().meshEvictions;
  lumps.clear();
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    const auto a = collisionMesh(makeLump(1, 4, 0.2, seed)), b = collisionMesh(makeLump(1, 4, 0.2, seed + 1));
    checkParity(*backend, lumpQuery(*a, *b));
  }
  CHECK(backend->counts().meshEvictions == evictions);
}

TEST_CASE("a budget that cannot hold the two meshes leaves the query to the host") {
  const LogCapture log;
  opencl::Tuning tuning;
  tuning.meshBudget = 300 << 10;
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  const auto lump = collisionMesh(makeLump(1, 4, 0.2, 1)), small = collisionMesh(makeLump(1, 2, 0.2, 2));
  Workspace device, host;
  for (int i = 0; i < 3; ++i) CHECK(!backend->collide(lumpQuery(*lump, *small), device));
  collide(lumpQuery(*lump, *small), host);
  checkSame(device, host);
  CHECK(backend->counts().onHost == 3);
  CHECK(log.lines.size() == 1);  // reported once
  checkParity(*backend, lumpQuery(*small, *small));
}

TEST_CASE("meshes in use are not evicted") {
  opencl::Context context(opencl::findDevices().at(0), opencl::ProgramCache(""));
  const auto a = collisionMesh(makeLump(1, 4, 0.2, 1)), b = collisionMesh(makeLump(1, 4, 0.2, 2));
  const std::size_t units = opencl::packMesh(*a, opencl::MeshLayout::kEightWide, 4).units.size();
  const auto roomForOne = std::make_shared<opencl::MemoryBudget>(units * sizeof(opencl::MeshUnit) * 3 / 2);
  opencl::MeshStore store(context, roomForOne, 4);
  const CollisionMesh* first[] = {a.get()};
  const CollisionMesh* second[] = {b.get()};
  {
    const auto pinned = store.acquire(first);
    CHECK_THROWS_AS(store.acquire(second), opencl::ClError);
    CHECK(store.acquire(first)[0].nodes == pinned[0].nodes);
  }
  CHECK(store.acquire(second)[0].cutCount > 0);
  CHECK(store.counts().evictions == 1);
  CHECK(store.counts().uploads == 2);
}

TEST_CASE("whichever call fails, the contacts are the same") {
  const auto a = collisionMesh(makeLump(1, 3, 0.2, 1)), b = collisionMesh(makeTorus(1, 0.3, 31, 17));
  const Query query = lumpQuery(*a, *b);
  Workspace host;
  collide(query, host);
  REQUIRE(host.reduced.size() > 10);
  const std::uint64_t before = FaultInjection::callCount();
  std::uint64_t opening = 0;
  {
    const auto backend = openBackend();
    opening = FaultInjection::callCount() - before;
    Workspace device;
    CHECK(backend->collide(query, device));
    CHECK(backend->collide(query, device));
  }
  const std::uint64_t calls = FaultInjection::callCount() - before;
  CHECK(calls > opening + 20);
  const LogCapture log;
  int opened = 0, failed = 0;
  for (const cl_int code : {CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE}) {
    for (const std::uint64_t more : {std::uint64_t{0}, std::uint64_t{1000000}}) {  // one call, or all from there on
      for (std::uint64_t n = 1; n <= calls; ++n) {
        if (more > 0 ? n % 3 != 0 : !isInPart(n + (code == CL_OUT_OF_RESOURCES))) continue;
        INFO("call " << n << " fails with " << code << (more > 0 ? " and all after it" : ""));
        FaultInjection::failAt(n, code, more);
        const auto backend = openBackend();
        if (backend) {
          ++opened;
          for (int i = 0; i < 2; ++i) {
            Workspace device;
            if (!backend->collide(query, device)) ++failed;
            REQUIRE(sameBytes(device.reduced, host.reduced));
          }
          FaultInjection::failAt(0);
          Workspace device;  // the backend is as good as new
          REQUIRE(backend->collide(query, device));
          REQUIRE(sameBytes(device.reduced, host.reduced));
        }
        FaultInjection::failAt(0);
      }
    }
  }
  CHECK(opened > 50);
  CHECK(failed > 50);
  std::set<std::string> distinct(log.lines.begin(), log.lines.end());
  CHECK(distinct.size() == log.lines.size());
  CHECK(log.lines.size() > 10);
  for (const std::string& line : log.lines) CHECK(line.find("ode_trimesh_gpu: cl") == 0);
}

TEST_CASE("several threads query one backend at once") {
  const auto a = collisionMesh(makeLump(1, 4, 0.2, 1)), b = collisionMesh(makeTorus(1, 0.3, 41, 19));
  opencl::Tuning tuning;
  tuning.meshBudget = 2 << 20;  // meshes come and go meanwhile
  const auto backend = openBackend(tuning);
  REQUIRE(backend);
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0}, done{0};
  for (unsigned t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      Draw draw(t);
      const auto own = collisionMesh(makeLump(1, 3, 0.2, 10 + t));
      for (int i = 0; i < 25; ++i) {
        const Transformd pose = makePose(draw.direction(), draw.uniform(0, 3), draw.inBox(0.8));
        const Query query = i % 3 == 0 ? makeQuery(*own, *a, pose) : makeQuery(*a, *b, pose);
        Workspace device, host;
        backend->collide(query, device);
        collide(query, host);
        if (!sameBytes(device.reduced, host.reduced)) ++wrong;
        ++done;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(done == 100);
  CHECK(wrong == 0);
}
