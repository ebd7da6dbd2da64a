// SPDX-License-Identifier: BSD-3-Clause
// The physics suite itself: a judge must be judged. ODE's own geoms and closed forms are the truth here.
#include <sys/types.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "bvh/collision_mesh.h"
#include "collide/query.h"
#include "physics/process_pool.h"
#include "physics/report.h"
#include "physics/suite.h"
#include "physics/thread_reference.h"
#include "support/catch.h"

using namespace otg;
using namespace otg::physics;

namespace {

const Scene kScene{
    "scene", "family", "what", {}, {atMost("m", 1.0), ofNative("r", Limit::Kind::kWithinShareOfNative, 0.1)},
    {kW},    kAllAxes};

Row rowWith(Measures measures) {
  measures.emplace("finite", 1);
  return {&kScene, {}, {std::move(measures), {}, {}}, {}, false, false, 0};
}

}  // namespace

TEST_CASE("A run passes if it meets all limits, and none by being not a number or missing") {
  const Row native = rowWith({{"m", 0}, {"r", 2}});
  const auto passes = [&](Measures measures) {
    Row row = rowWith(std::move(measures));
    judge(row, &native);
    return row.pass;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(passes({{"m", 1}, {"r", 2.19}}));
  CHECK(passes({{"m", -5}, {"r", 1.81}}));
  CHECK_FALSE(passes({{"m", 1.01}, {"r", 2}}));
  CHECK_FALSE(passes({{"m", 1}, {"r", 2.21}}));
  CHECK_FALSE(passes({{"m", 1}, {"r", 1.79}}));
  CHECK_FALSE(passes({{"m", nan}, {"r", 2}}));
  CHECK_FALSE(passes({{"m", 1}, {"r", nan}}));
  CHECK_FALSE(passes({{"r", 2}}));
  CHECK_FALSE(passes({{"m", 1}, {"r", 2}, {"finite", 0}}));
  Row crashed = rowWith({{"m", 1}, {"r", 2}});
  crashed.result.error = "ended by a signal";
  judge(crashed, &native);
  CHECK_FALSE(crashed.pass);
}

TEST_CASE("A missed limit is excused only where the native run misses the same one") {
  Row native = rowWith({{"m", 5}, {"r", 2}});
  judge(native, nullptr);
  REQUIRE_FALSE(native.pass);
  Row same = rowWith({{"m", 3}, {"r", 2}}), other = rowWith({{"m", 3}, {"r", 9}});
  judge(same, &native);
  judge(other, &native);
  CHECK(same.nativeFailsToo);
  CHECK_FALSE(other.nativeFailsToo);
}

TEST_CASE("Jobs end with an answer, an exception, a signal or by being too slow") {
  std::vector<JobOutcome> outcomes(5);
  runInProcesses(
      5, 2, 1,
      [](std::size_t i) -> std::string {
        if (i == 0) return std::string(300000, 'x');  // more than a pipe holds
        if (i == 1) throw std::runtime_error("no such mesh");
        if (i == 2) kill(getpid(), SIGKILL);
        if (i == 3) std::this_thread::sleep_for(std::chrono::minutes(5));
        return {};
      },
      [&](std::size_t i, JobOutcome outcome) { outcomes[i] = std::move(outcome); });
  CHECK(outcomes[0].output.size() == 300000);
  CHECK(outcomes[0].error.empty());
  CHECK(outcomes[1].error == "no such mesh");
  CHECK(outcomes[2].error.find("signal 9") != std::string::npos);
  CHECK(outcomes[3].error.find("more than 1 s") != std::string::npos);
  CHECK(outcomes[4].error.empty());
}

TEST_CASE("Energy is constant in free flight, and what is added is seen") {
  const OdeSession session;
  Rig rig({});
  rig.addBody(boxShape({1, 1, 1}), {0, 0, 0});
  rig.setVelocity(0, {3, 0, 5}, {0, 0, 2});
  rig.run(2);
  CHECK(std::abs(rig.measures().at("energy_gain")) < 1e-9);
  // A push upwards of 2 m/s beside whatever it does: the energy that a bad contact would add.
  const Vec v = rig.velocity(0);
  rig.setVelocity(0, v + Vec(0, 4, 0), rig.angularVelocity(0));
  rig.run(0.005);
  CHECK(rig.measures().at("energy_gain") == Approx(8.0).epsilon(1e-6));
}

TEST_CASE("A scene is similar at every size and place") {
  const Scene* scene = findScene("bounce");
  REQUIRE(scene);
  Case run;
  run.form = Form::kNative;
  const auto peak = [&](double size, double offset) {
    const OdeSession session;
    run.size = size;
    run.offset = offset;
    return scene->run(run).measures.at("peak");
  };
  const double plain = peak(1, 0);
  CHECK(plain == Approx(0.75).epsilon(0.01));
  CHECK(peak(0.01, 0) == Approx(plain).epsilon(1e-6));
  CHECK(peak(100, 0) == Approx(plain).epsilon(1e-6));
  CHECK(peak(1, 1e5) == Approx(plain).epsilon(1e-6));
}

TEST_CASE("Every scene runs natively where it says so, and a full run varies every axis") {
  for (const Scene& scene : allScenes()) {
    CAPTURE(scene.name);
    CHECK_FALSE(scene.limits.empty());
    const std::vector<Case> plain = runsOf(scene, Form::kOurs, Model::kAuto, Extent::kPlain);
    CHECK(plain.size() == scene.steppings.size());
    CHECK(runsOf(scene, Form::kOurs, Model::kAuto, Extent::kFull).size() > plain.size());
    for (const Limit& limit : scene.limits)
      if (limit.kind != Limit::Kind::kAtMost && limit.kind != Limit::Kind::kAtLeast) CHECK(scene.hasNative);
  }
}

TEST_CASE("The reference of the nut stands where the exact triangle tests say that it touches") {
  constexpr int kSegments = 24;
  constexpr double kPitch = 0.2, kHeight = 0.6;
  const scenes::MeshArrays bolt = scenes::makeBolt(0.5, kPitch, 1.6, kSegments);
  const scenes::MeshArrays nut = scenes::transformed(scenes::makeNut(0.5, kPitch, 0.4, 0.02, kSegments),
                                                     {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, kHeight}});
  const ThreadSetup setup{bolt, nut, kPitch, kSegments, 0.3, 9.81};
  constexpr int kSamples = 5;
  const std::vector<double> heights = threadHeights(setup, kSamples);
  const CollisionMesh boltMesh(scenes::build(bolt), BuildStrategy::kSah),
      nutMesh(scenes::build(nut), BuildStrategy::kSah);
  Workspace workspace;
  for (int i = 0; i < kSamples; ++i) {
    const double angle = 2 * std::numbers::pi / kSegments * i / kSamples;
    const auto touches = [&](double z) {
      Query query;
      query.a = &boltMesh;
      query.b = &nutMesh;
      const double c = std::cos(angle), s = std::sin(angle);
      query.bInA = {{c, -s, 0, s, c, 0, 0, 0, 1}, {0, 0, z}};
      findIntersectingPairs(query, workspace);
      return !workspace.intersecting.empty();
    };
    const double height = heights[static_cast<std::size_t>(i)];
    CAPTURE(i, height);
    // Float vertices of meshes of this size are good to 1e-7 m.
    CHECK_FALSE(touches(height + 2e-6));
    CHECK(touches(height - 2e-6));
  }
}

TEST_CASE("Without bumps the reference of the nut is the screw's closed form") {
  // The finer the facets, the nearer to a smooth helix: z'' = -g p^2 / (I + p^2), p the rise per radian.
  constexpr int kSegments = 192;
  constexpr double kPitch = 0.2, kInertia = 0.3, kGravity = 9.81, kSeconds = 1;
  const scenes::MeshArrays bolt = scenes::makeBolt(0.5, kPitch, 0.6, kSegments);
  const scenes::MeshArrays nut = scenes::transformed(scenes::makeNut(0.5, kPitch, 0.2, 0.005, kSegments),
                                                     {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0.2}});
  const ThreadSetup setup{bolt, nut, kPitch, kSegments, kInertia, kGravity};
  const ThreadMotion motion = plasticThreadReference(setup, kSeconds);
  const double rise = kPitch / (2 * std::numbers::pi);
  const double start = threadHeights(setup, 1)[0];
  const double smooth = start - 0.5 * kGravity * rise * rise / (kInertia + rise * rise) * kSeconds * kSeconds;
  CAPTURE(motion.travel, start, smooth);
  CHECK(motion.travel == Approx(smooth).epsilon(0.1));
  CHECK(motion.angle < 0);
}
