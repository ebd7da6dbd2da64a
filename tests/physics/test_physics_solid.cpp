// SPDX-License-Identifier: BSD-3-Clause
// The short scenes of the contact model `solid`, with the limits of the physics suite.
#include <algorithm>
#include <cmath>

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
  double timeStep = 0;  ///< 0: the scene's own
};

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
    {"cliff_1cm", kW},
    {"cliff_1cm", kQ20},
    {"cliff_outside", kW},
    {"bounce", kW},
    {"slope_2", kW},
    {"slope_800", kW},
    {"slide_800", kW},
    {"peg_mu0", kW},
    {"nut_5ms", kW},
    {"bowls", kW},
    {"bowls", kQ20},
    {"overlapped_boxes_30", kW},
    {"overlapped_boxes_50", kW},
    {"contained", kW},
    {"chain", kQ20},
    {"rolling_sphere", kW},
    {"sphere_contacts", kW},
    {"tori", kQ20},
    {"plate", kW, 1.0 / 60},
    {"plate", kQ20, 1.0 / 60},
};

Row rowOf(const Scene& scene, const ShortScene& shortScene, Form form) {
  Case run = runsOf(scene, form, Model::kSolid, Extent::kPlain).front();
  run.stepping = shortScene.stepping;
  if (shortScene.timeStep > 0) run.dt = shortScene.timeStep;
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

TEST_CASE("A box over an edge is carried by the four corners of the overlap, straight up, on any tessellation") {
  const int n = GENERATE(1, 7);
  const double depth = GENERATE(0.001, 0.0245);
  CAPTURE(n, depth);
  const OdeSession session;
  Case run;
  run.model = Model::kSolid;
  Rig rig(run);
  rig.addStatic(boxShape({4, 4, 1}, n), {-2, 0, -0.5});
  rig.addBody(boxShape({1, 1, 1}, n), {-0.05, 0, 0.5 - depth});
  const std::vector<Contact> contacts = rig.contactsNow();
  CHECK(contacts.size() == 4);
  for (const Contact& contact : contacts) {
    CHECK(contact.depth == Approx(depth).epsilon(1e-3));
    // The end of the slab lies in the overlap too, and is no way out.
    CHECK(contact.normal.head<2>().norm() < 0.003);
    CHECK(std::min(std::abs(contact.position.x()), std::abs(contact.position.x() + 0.55)) < 2e-3);
    CHECK(std::abs(std::abs(contact.position.y()) - 0.5) < 2e-3);
  }
}

TEST_CASE("Contacts all around the rim of a bowl point into the bowl") {
  const OdeSession session;
  Case run;
  run.model = Model::kSolid;
  Rig rig(run);
  // The rim of the upper one (radius 1) sits in the lower one's wall, a little deeper on one side.
  const ShapePointer bowl = makeStaticShape(otg::scenes::makeBowl(1, 0.05, 48, 12));
  rig.addStatic(bowl, {0, 0, 0});
  Vec center;
  const ShapePointer inner = makeShape(otg::scenes::makeBowl(0.9505, 0.05, 48, 12), {}, &center);
  rig.addBody(inner, center + Vec(0, 0, 0.001));
  const std::vector<Contact> contacts = rig.contactsNow();
  REQUIRE_FALSE(contacts.empty());
  for (const Contact& contact : contacts) {
    // The inner bowl must be pushed to the axis, which lies at the origin; the wall is 5 cm thick.
    CHECK(std::abs(contact.normal.dot(contact.position.normalized())) > 0.9);
    CHECK(contact.depth < 0.01);
  }
}
