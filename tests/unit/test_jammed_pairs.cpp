// SPDX-License-Identifier: BSD-3-Clause
// Solids that are deep in each other with contacts from all sides: they leave along one direction, and nobody throws
// them.
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/vectors.h"
#include "collide/consistent_contacts.h"
#include "collide/pair_history.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"
#include "support/make_query.h"
#include "support/mesh_samples.h"
#include "support/slot_mesh.h"

using namespace otg;
using namespace otg::test;

namespace {

/// A bar along x, in the middle of the slot's height.
struct BarInSlot {
  explicit BarInSlot(double width)
      : slot(scenes::build(makeSlot()), BuildStrategy::kSah),
        bar(scenes::build(scenes::makeBox({width, 0.6, 0.6}, 1)), BuildStrategy::kSah) {
    query = makeQuery(bar, slot, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, -0.6}});
    query.options.contacts = ContactModel::kSolid;
    query.options.solid.convexPath = true;
  }
  CollisionMesh slot, bar;
  Query query;
};

double deepestOf(const std::vector<Contact>& contacts) {
  double deepest = 0;
  for (const Contact& c : contacts) deepest = std::max(deepest, c.depth);
  return deepest;
}

bool haveOneNormal(const std::vector<Contact>& contacts) {
  return std::all_of(contacts.begin(), contacts.end(),
                     [&](const Contact& c) { return c.normal == contacts.front().normal; });
}

/// Moves A a third of the way that its contacts request, or of the depth of the deepest if that is less, until it is
/// free. How many queries that takes; `most` if it is not free then.
int leave(Query query, int most) {
  SolidHistory history;
  query.history = &history;
  Workspace workspace;
  for (int k = 0; k < most; ++k) {
    collide(query, workspace);
    if (workspace.reduced.empty()) return k;
    Vec3d way{0, 0, 0};
    for (int round = 0; round < 20; ++round) {
      for (const Contact& c : workspace.reduced) {
        const double missing = c.depth - otgDot(c.normal, way);
        if (missing > 0) way = way + c.normal * missing;
      }
    }
    if (history.current.isJammed) CHECK(deepestOf(workspace.reduced) < 0.021 * smallerSize(query));
    const double step = std::min(norm(way), deepestOf(workspace.reduced)) / 3 + 1e-4;
    query.bInA.t = query.bInA.t - unit(way) * step;
  }
  return most;
}

}  // namespace

TEST_CASE("a bar that is jammed between two walls leaves the slot where it is open") {
  BarInSlot scene(1.3);
  Workspace workspace;
  collide(scene.query, workspace);
  REQUIRE(workspace.reduced.size() >= 3);
  CHECK(haveOneNormal(workspace.reduced));
  CHECK(workspace.reduced.front().normal.z > 0.9);
  CHECK(deepestOf(workspace.reduced) == Approx(SolidHistory::kClampedDepth * smallerSize(scene.query)));
  for (const Contact& c : workspace.reduced) CHECK((c.flags & kContactClamped) != 0);
  CHECK(leave(scene.query, 200) < 120);
}

TEST_CASE("what a jammed pair remembers") {
  BarInSlot scene(1.3);
  SolidHistory history;
  scene.query.history = &history;
  Workspace workspace;
  collide(scene.query, workspace);
  const std::vector<Contact> first = workspace.reduced;
  CHECK(history.current.isJammed);
  CHECK_FALSE(history.before.isJammed);
  const SolidHistory::State state = history.current;
  collide(scene.query, workspace);  // the same pose again
  REQUIRE(workspace.reduced.size() == first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    CHECK(workspace.reduced[i].position == first[i].position);
    CHECK(workspace.reduced[i].depth == first[i].depth);
  }
  CHECK(history.current.isJammed);
  CHECK(history.current.escape == state.escape);
  CHECK(history.current.escapeLeft == state.escapeLeft);
  // It goes on, wherever contacts of a new query would lead.
  scene.query.bInA.t = scene.query.bInA.t - first.front().normal * 0.02 + Vec3d{0.004, 0, 0};
  collide(scene.query, workspace);
  REQUIRE_FALSE(workspace.reduced.empty());
  CHECK(workspace.reduced.front().normal == first.front().normal);
  // Until it is hardly in the slot any more.
  double last = 0;
  while (scene.query.bInA.t.z > -1.28) {
    scene.query.bInA.t.z -= 0.02;
    collide(scene.query, workspace);
    if (history.current.isJammed) last = scene.query.bInA.t.z;
  }
  CHECK(last < -1.2);
  CHECK_FALSE(workspace.reduced.empty());
  CHECK_FALSE(history.current.isJammed);
  scene.query.bInA.t = {0, 0, -1.4};
  collide(scene.query, workspace);
  CHECK(workspace.reduced.empty());
  CHECK_FALSE(history.current.isJammed);
}

TEST_CASE("a bar that is pressed into a slot stays there") {
  BarInSlot scene(1.01);
  Workspace workspace;
  SolidHistory history;
  scene.query.history = &history;
  collide(scene.query, workspace);
  REQUIRE_FALSE(workspace.reduced.empty());
  CHECK(deepestOf(workspace.reduced) == 0);
  CHECK_FALSE(haveOneNormal(workspace.reduced));
  CHECK_FALSE(history.current.isJammed);
}

TEST_CASE("bodies that are jammed in random poses come apart, a little each time") {
  const CollisionMesh bowl(scenes::build(scenes::makeBowl(1, 0.1, 16, 8)), BuildStrategy::kSah);
  const CollisionMesh gear(scenes::build(scenes::makeGear(12, 1, 0.2, 0.4, 0.3)), BuildStrategy::kSah);
  const CollisionMesh* const meshes[] = {&bowl, &gear};
  Draw draw(5);
  Workspace workspace;
  int jammed = 0, stuck = 0;
  for (int i = 0; i < 3000; ++i) {
    const CollisionMesh &a = *meshes[draw.below(2)], &b = *meshes[draw.below(2)];
    const Vec3d turn = draw.direction(), way = draw.direction();
    const double angle = draw.uniform(0, 3), far = draw.uniform(0.1, 1.2);
    Query query = makeQuery(a, b, makePose(turn, angle, otgScale(way, far)));
    query.options.contacts = ContactModel::kSolid;
    findIntersectingPairs(query, workspace);
    if (!solidContacts(query, workspace) || !cutContradictions(query, workspace.contacts)) continue;
    ++jammed;
    collide(query, workspace);
    REQUIRE_FALSE(workspace.reduced.empty());
    CHECK_FALSE(contradict(workspace.reduced, smallerRadius(query)));
    CHECK(deepestOf(workspace.reduced) > 0);
    stuck += leave(query, 500) == 500 ? 1 : 0;
  }
  INFO(jammed << " jammed, " << stuck << " stuck");
  CHECK(jammed > 20);
  CHECK(stuck == 0);
}
