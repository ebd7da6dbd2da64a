// SPDX-License-Identifier: BSD-3-Clause
// The short scenes of the contact model `solid`, with the limits of the physics suite.
#include "physics/report.h"
#include "physics/suite.h"
#include "support/catch.h"

using namespace otg::physics;

namespace {

/// Whether this build is meant to have the model: then it must, and all scenes below must meet their limits. Otherwise
/// the model must be refused, so that this constant is changed together with the library.
constexpr bool kHasSolid = true;

struct ShortScene {
  const char* name;
  Stepping stepping;
};

/// Not here because they miss their limits still, as the suite shows: cliff_1cm and the nut at 5 ms.
constexpr ShortScene kShortScenes[] = {
    {"box_on_ground_2", kW},
    {"box_on_ground_800", kW},
    {"box_on_box", kW},
    {"box_on_box", kQ20},
    {"box_on_box_turned", kQ20},
    {"box_on_box_overhang", kW},
    {"stack2", kQ20},
    {"stack5", kQ20},
    {"cliff_inside", kW},
    {"cliff_outside", kW},
    {"bounce", kW},
    {"slope_2", kW},
    {"slope_800", kW},
    {"slide_800", kW},
    {"peg_mu0", kW},
    {"overlapped_boxes_30", kW},
    {"overlapped_boxes_50", kW},
    {"contained", kW},
    {"chain", kQ20},
    {"rolling_sphere", kW},
    {"sphere_contacts", kW},
    {"tori", kQ20},
};

Row rowOf(const Scene& scene, const ShortScene& shortScene, Form form) {
  Case run = runsOf(scene, form, Model::kSolid, Extent::kPlain).front();
  run.stepping = shortScene.stepping;
  return {&scene, form == Form::kNative ? nativeOf(run) : run, {}, {}, false, false, 0};
}

}  // namespace

TEST_CASE("The library has the contact model solid when it is meant to") {
  const OdeSession session;
  CHECK(isAccepted(Model::kPairwise));
  CHECK(isAccepted(Model::kSolid) == kHasSolid);
}

TEST_CASE("Short scenes meet their limits with the contact model solid") {
  for (const ShortScene& shortScene : kShortScenes) {
    const Scene* scene = findScene(shortScene.name);
    REQUIRE(scene);
    if (!kHasSolid) continue;
    Row row = rowOf(*scene, shortScene, Form::kOurs), native = rowOf(*scene, shortScene, Form::kNative);
    {
      const OdeSession session;
      row.result = runCase(*scene, row.run);
    }
    if (scene->hasNative) {
      const OdeSession session;
      native.result = runCase(*scene, native.run);
    }
    judge(row, scene->hasNative ? &native : nullptr);
    INFO(lineOf(row));
    CHECK(row.pass);
  }
}
