// SPDX-License-Identifier: BSD-3-Clause
// The contact model `solid` between two fine meshes of convex bodies, against the bodies by formula.
#include <algorithm>
#include <cmath>

#include "bvh/collision_mesh.h"
#include "collide/query.h"
#include "support/catch.h"
#include "truth/tessellated_bodies.h"

using namespace otg;
using truth::TessellatedBody;
using truth::TessellatedErrors;

namespace {

const TessellatedBody& named(const std::vector<TessellatedBody>& bodies, const std::string& name) {
  const auto it = std::find_if(bodies.begin(), bodies.end(), [&](const TessellatedBody& b) { return b.name == name; });
  REQUIRE(it != bodies.end());
  return *it;
}

bool isRound(const TessellatedBody& body) {
  return body.name == "sphere" || body.name == "capsule";
}

std::vector<Contact> contactsOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA,
                                SolidHistory* history) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = bInA;
  query.options.contacts = ContactModel::kSolid;
  query.history = history;
  Workspace workspace;
  collide(query, workspace);
  return workspace.reduced;
}

}  // namespace

TEST_CASE("meshes of convex bodies that overlap a little touch as the bodies do") {
  truth::TessellatedRange range;
  range.poses = 40;
  TessellatedErrors errors;
  for (const TessellatedBody& a : truth::largeBodies()) {
    for (const TessellatedBody& b : truth::smallBodies()) {
      errors = truth::compareMeshes(a, b, range);
      INFO(a.name << " and " << b.name << ": " << errors.ambiguous << " ambiguous, degrees "
                  << errors.degrees.quantile(0.5) << " / " << errors.degrees.quantile(0.9) << " / "
                  << errors.degrees.largest() << ", depth " << errors.depth.quantile(0.5) << " / "
                  << errors.depth.quantile(0.9) << " / " << errors.depth.largest());
      CHECK(errors.missed == 0);
      CHECK(errors.degrees.count() >= 36);
      const bool round = isRound(a) && isRound(b);
      CHECK(errors.degrees.quantile(0.5) < (round ? 1.5 : 4));
      CHECK(errors.degrees.quantile(0.9) < (round ? 5 : 12));
      CHECK(errors.degrees.largest() < (round ? 8 : 25));
      // The meshes' depths are those of their edges where they cross.
      CHECK(errors.depth.quantile(0.5) < a.sagitta + b.sagitta + 1.1e-4);
      CHECK(errors.depth.quantile(0.9) < 5e-3);
      CHECK(errors.depth.largest() < 0.02);
    }
  }
}

TEST_CASE("bodies that go right through each other are pushed out on a short way") {
  truth::TessellatedRange range;
  range.least = 0.2;
  range.most = 0.6;
  range.poses = 60;
  const auto large = truth::largeBodies(), small = truth::smallBodies();
  for (const char* other : {"capsule", "box", "cylinder"}) {
    const TessellatedErrors errors = truth::compareMeshes(named(large, "box"), named(small, other), range);
    INFO(other << ": " << errors.degrees.count() << " poses, degrees " << errors.degrees.quantile(0.5) << " / "
               << errors.degrees.quantile(0.9) << " / " << errors.degrees.largest() << ", way longer "
               << errors.longer.largest());
    CHECK(errors.missed == 0);
    CHECK(errors.degrees.count() >= 20);
    CHECK(errors.degrees.quantile(0.9) < 35);
    CHECK(errors.degrees.largest() < 75);
    CHECK(errors.longer.quantile(0.9) < 0.12);
    CHECK(errors.longer.largest() < 0.25);
  }
}

TEST_CASE("a body that was turned since the last query does not go on where it was leaving") {
  const auto large = truth::largeBodies(), small = truth::smallBodies();
  const CollisionMesh box(scenes::build(named(large, "box").mesh), BuildStrategy::kSah);
  const CollisionMesh capsule(scenes::build(named(small, "capsule").mesh), BuildStrategy::kSah);
  // The capsule's axis along z, through the box's thin side, then along y: in the same place.
  const Transformd upright{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.21, 0.03, 0.02}};
  const Transformd lying{{1, 0, 0, 0, 0, -1, 0, 1, 0}, {0.21, 0.03, 0.02}};
  SolidHistory history;
  const auto first = contactsOf(box, capsule, upright, &history);
  REQUIRE_FALSE(first.empty());
  REQUIRE((first[0].flags & kContactClamped) != 0);
  REQUIRE(history.current.escapeLeft > 0);
  const auto with = contactsOf(box, capsule, lying, &history), without = contactsOf(box, capsule, lying, nullptr);
  REQUIRE_FALSE(without.empty());
  REQUIRE(with.size() == without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    CHECK(with[i].normal == without[i].normal);
    CHECK(with[i].position == without[i].position);
  }
  // While a body turns slowly it is kept.
  const Transformd slowly{{1, 0, 0, 0, 0.995, -0.0998749, 0, 0.0998749, 0.995}, {0.21, 0.03, 0.02}};
  SolidHistory kept;
  contactsOf(box, capsule, upright, &kept);
  const Vec3d escape = kept.current.escape;
  contactsOf(box, capsule, slowly, &kept);
  CHECK(kept.current.escape == escape);
}
