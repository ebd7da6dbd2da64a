// SPDX-License-Identifier: BSD-3-Clause
// Which way a convex shape leaves the surface of a mesh that is convex where they overlap.
#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "primitives/convex_contacts.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;

TEST_CASE("the end of a cylinder leaves the tip of a cone along the axis, however many faces meet there") {
  constexpr double kDepth = 1e-3;
  const std::shared_ptr<const ConvexShape> cylinder = cylinderShape(0.2, 0.15);
  REQUIRE(cylinder);
  for (const int sides : {5, 12, 13, 40}) {
    scenes::MeshArrays cone = scenes::makeCylinder(0.8, 1, sides, 1);
    for (Vec3f& v : cone.vertices) {
      if (v.z > 0 && v.x * v.x + v.y * v.y > 0.1f) v.z = 0;  // the rim of the upper end: its middle becomes the tip
    }
    const CollisionMesh mesh(scenes::build(cone), BuildStrategy::kSah);
    for (const double lean : {0.0, 0.3}) {
      // Its lower end is about the tip, and not in its middle.
      const double c = std::cos(lean), s = std::sin(lean);
      const Vec3d axis{s, 0, c};
      Query query;
      query.a = &mesh;
      query.b = cylinder->mesh.get();
      const Vec3d middle = Vec3d{0, 0, 0.5} + axis * (0.15 - kDepth) + Vec3d{c, 0, -s} * 0.05;
      query.bInA = {{c, 0, s, 0, 1, 0, -s, 0, c}, middle};
      query.options.contacts = ContactModel::kSolid;
      Workspace workspace;
      convexContacts(query, *cylinder, workspace);
      CAPTURE(sides, lean);
      REQUIRE(!workspace.reduced.empty());
      double deepest = 0;
      for (const Contact& contact : workspace.reduced) {
        CHECK(otgDot(contact.normal, axis) < -0.999999);
        deepest = std::max(deepest, contact.depth);
      }
      CHECK(deepest == Approx(kDepth).epsilon(1e-3));
    }
  }
}
