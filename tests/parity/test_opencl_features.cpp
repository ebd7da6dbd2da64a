// SPDX-License-Identifier: BSD-3-Clause
// A kernel that cannot be built takes its feature away and not the device.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "dispatch/cost/rehearsal.h"
#include "dispatch/device_slot.h"
#include "dispatch/dispatcher.h"
#include "opencl/runtime/log.h"
#include "support/opencl.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;
namespace fs = std::filesystem;

namespace {

/// The kernels with one that has an error, or other text in one place, while it lives. Reported on stderr once for
/// each, which is caught.
class BrokenKernel {
 public:
  explicit BrokenKernel(const std::string& name, const std::string& right = "", const std::string& wrong = "") {
    std::string made = (fs::temp_directory_path() / "otg_kernels_XXXXXX").string();
    REQUIRE(mkdtemp(made.data()) != nullptr);
    folder_ = made;
    fs::copy(OTG_KERNEL_FOLDER, folder_, fs::copy_options::recursive);
    if (right.empty()) {
      std::ofstream(folder_ / name, std::ios::app) << "\n#error broken\n";
    } else {
      std::ifstream in(folder_ / name);
      std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
      const std::size_t at = text.find(right);
      REQUIRE(at != std::string::npos);
      std::ofstream(folder_ / name) << text.replace(at, right.size(), wrong);
    }
    setenv("OTG_KERNEL_DIR", folder_.c_str(), 1);
    opencl::forgetFailures();
    opencl::setLogSink([this](const std::string& line) { lines.push_back(line); });
  }
  ~BrokenKernel() {
    opencl::setLogSink({});
    unsetenv("OTG_KERNEL_DIR");
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  BrokenKernel(const BrokenKernel&) = delete;
  BrokenKernel& operator=(const BrokenKernel&) = delete;
  std::vector<std::string> lines;

 private:
  fs::path folder_;
};

const std::shared_ptr<const CollisionMesh>& lump() {
  static const auto made = collisionMesh(makeLump(1, 3, 0.2, 1));
  return made;
}

Query crossing(ContactModel model) {
  Query query = makeQuery(*lump(), *lump(), makePose({0.6, 0, 0.8}, 0.7, {1.1, 0.2, 0.1}));
  query.options.contacts = model;
  return query;
}

/// How many of ten points are answered.
std::size_t pointsAnswered(opencl::Backend& backend) {
  return backend.askPoints(
      *lump(), {true, true}, 10,
      [](std::size_t b, std::size_t e, Vec3d* to) {
        std::fill(to, to + (e - b), Vec3d{2, 0, 0});
      },
      [](std::size_t, std::size_t, const Vec3d*, const otg_uint*) {});
}

}  // namespace

TEST_CASE("without the kernel of rays there are points, distances and contacts") {
  BrokenKernel broken("queries/ray_query.cl");
  const auto backend = openBackend();  // builds it
  REQUIRE(backend);
  if (!backend->device().doubles) return;
  CHECK_FALSE(backend->answersRays());
  CHECK(backend->answersPoints());
  CHECK(backend->answersDistances());
  CHECK(backend->failedPrograms() == 1);
  CHECK(broken.lines.size() == 1);
  CHECK(pointsAnswered(*backend) == 10);
  checkParity(*backend, crossing(ContactModel::kPairwise));
  CHECK(rehearse(*backend) == Rehearsed::kGood);  // so that it is not closed again
  CHECK(backend->failedPrograms() == 1);
}

TEST_CASE("a device that gives other answers than the CPU is not used") {
  const std::string right = "if (answer == OTG_DISJOINT) continue;";
  const std::string wrong = "if (answer == OTG_DISJOINT || t % 3 == 0) continue;";
  for (const bool isWrong : {true, false}) {
    BrokenKernel broken("walk/batch_walk.cl", right, isWrong ? wrong : right);
    const int index = opencl::defaultDevice(opencl::listDevices());
    for (const Costs request : {Costs::kIfStored, Costs::kMeasured}) {
      Dispatcher dispatcher;
      CHECK(dispatcher.open({&index, 1}, {}, request) == (isWrong ? 0 : 1));
    }
    CHECK(broken.lines.size() == (isWrong ? 2 : 0));
    for (const std::string& line : broken.lines) CHECK(line.find("other answers than the CPU") != std::string::npos);
  }
}

TEST_CASE("without the kernels of distances or solids the host does these, and nothing fails after the first time") {
  for (const char* const name : {"queries/batch_distance.cl", "solid/small/ways.cl"}) {
    INFO(name);
    BrokenKernel broken(name);
    opencl::Tuning tuning;
    tuning.warmUp = false;
    const auto backend = openBackend(tuning);
    REQUIRE(backend);
    if (!backend->device().doubles) return;
    if (std::string(name).starts_with("queries")) {
      CHECK(backend->answersDistances());
      const Query apart = makeQuery(*lump(), *lump(), makeMove({3, 0, 0}));
      TrianglePair nearest;
      const opencl::RunParts run = [](std::size_t count, const auto& work) { work(0, count); };
      CHECK(backend->nearestTriangles({&apart, 1}, 1e9, {&nearest, 1}, run) == 0);
      CHECK_FALSE(backend->answersDistances());
    } else {
      const Query query = crossing(ContactModel::kSolid);
      Workspace host;
      collide(query, host);
      for (int round = 0; round < 3; ++round) {
        opencl::BatchAnswer answer;
        CHECK(backend->collideBatch(std::vector<Query>(3, query), answer) == (round > 0));
        for (std::size_t i = 0; i < 3; ++i) CHECK(sameBytes(answer.of(i), host.reduced));
      }
    }
    CHECK(backend->failedPrograms() == 1);
    CHECK(broken.lines.size() == 1);
    CHECK(pointsAnswered(*backend) == 10);
    checkParity(*backend, crossing(ContactModel::kPairwise));
  }
}
