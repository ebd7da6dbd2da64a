// SPDX-License-Identifier: BSD-3-Clause
// Arrays of points, rays and distances on a simulated device, and meshes whose vertices move: the answers are the
// host's.
#include <limits>

#include "dispatch/array_run.h"
#include "dispatch/distance_run.h"
#include "queries/mesh_overlap.h"
#include "simulator/simulated_device.h"
#include "support/distance_samples.h"
#include "support/ray_samples.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::uint64_t bits(double x) {
  return std::bit_cast<std::uint64_t>(x);
}

/// How many items have the host's answers on the simulated device. `same(x, y)`: whether two answers are the same.
template <class Job, class Same>
std::size_t sameAnswers(const Job& job, const std::vector<typename Job::Item>& items, const Same& same) {
  DeviceSlot slot;
  slot.backend = openSimulated(simulated());
  ThreadPool pool(1);
  std::size_t count = 0;
  const ArraySource<Job> source = [&](std::size_t begin, std::size_t end, auto* to) {
    std::copy(&items[begin], &items[begin] + (end - begin), to);
  };
  const ArraySink<Job> sink = [&](std::size_t begin, std::size_t end, const auto*, const auto* answers) {
    for (std::size_t i = begin; i < end; ++i) count += same(answers[i - begin], answerOne(job, items[i])) ? 1 : 0;
  };
  answerOnDevice(slot, pool, job, items.size(), source, sink);
  CHECK(slot.failedCalls == 0);
  return count;
}

}  // namespace

TEST_CASE("points have the host's answers on the simulated device") {
  const auto mesh = collisionMesh(makeLump(1, 2, 0.3, 7));
  Draw draw(1);
  std::vector<Vec3d> points;
  for (int i = 0; i < 100; ++i) points.push_back(draw.inBox(1.5));
  for (const Vec3f& v : mesh->mesh().vertices()) points.push_back({v.x, v.y, v.z});
  const PointJob job{mesh.get(), true, true, Place::kOpencl};
  CHECK(sameAnswers(job, points, [](const PointAnswer& x, const PointAnswer& y) {
          return x.nearest.triangle == y.nearest.triangle && bits(x.nearest.distance) == bits(y.nearest.distance) &&
                 x.inside == y.inside;
        }) == points.size());
}

TEST_CASE("rays have the host's hits on the simulated device") {
  const auto mesh = collisionMesh(makeTorus(0.8, 0.3, 14, 8));
  const std::vector<LongRay> rays = samples::raysFor(mesh->mesh(), 1, 160);
  const RayJob job{mesh.get(), false, Place::kOpencl};
  CHECK(sameAnswers(job, rays, [](const RayHit& x, const RayHit& y) {
          return x.triangle == y.triangle && bits(x.distance) == bits(y.distance) && x.back == y.back;
        }) == rays.size());
}

TEST_CASE("pairs have the host's distances on the simulated device") {
  DeviceSlot slot;
  slot.backend = openSimulated(simulated());
  ThreadPool pool(1);
  std::vector<std::shared_ptr<const CollisionMesh>> meshes;
  for (const auto& [name, mesh] : samples::meshesForDistances()) {
    if (mesh->triangleCount() < 150) meshes.push_back(std::make_shared<CollisionMesh>(mesh, BuildStrategy::kSah));
  }
  REQUIRE(meshes.size() >= 3);
  std::vector<OverlapJob> jobs;
  std::vector<std::size_t> which;
  Draw draw(4);
  for (int i = 0; i < 8; ++i) {
    const CollisionMesh& a = *meshes[draw.below(static_cast<std::uint32_t>(meshes.size()))];
    const CollisionMesh& b = *meshes[draw.below(static_cast<std::uint32_t>(meshes.size()))];
    jobs.push_back({{&a, &b, samples::poseForDistance(a.mesh(), b.mesh(), draw, i)}, Place::kOpencl});
    which.push_back(which.size());
  }
  std::vector<MeshDistance> answers(jobs.size());
  measureOnDevice(slot, pool, jobs, which, kInfinity, answers);
  CHECK(slot.failedCalls == 0);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const MeshDistance &x = answers[i], y = meshDistance(queryOf(jobs[i].pair), kInfinity);
    CHECK(x.found == y.found);
    CHECK(bits(x.distance) == bits(y.distance));
    CHECK(x.triangleA == y.triangleA);
    CHECK(x.triangleB == y.triangleB);
  }
}

TEST_CASE("what has moved of a mesh is put where it belongs on the simulated device") {
  const auto mesh = std::make_shared<CollisionMesh>(build(makeLump(1, 3, 0.2, 3)), BuildStrategy::kSah);
  const auto box = collisionMesh(makeBox({1, 1, 1}, 1));
  const auto backend = openSimulated(simulated());
  const Query query = makeQuery(*mesh, *box, makePose({0.48, 0.6, 0.64}, 1, {0.2, 0.1, 1.2}));
  for (int step = 0; step < 3; ++step) {
    const Vec3f& v = mesh->mesh().vertices()[7];
    const std::vector<MovedVertex> moved = {{7, {v.x * 1.01f, v.y, v.z * 1.02f}}};
    REQUIRE(mesh->moveSome(moved));
    checkParity(*backend, query);
  }
  CHECK(backend->counts().meshUpdates == 2);  // the first time it is sent whole
}
