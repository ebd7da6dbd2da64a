// SPDX-License-Identifier: BSD-3-Clause
// ODE's shapes in inner corners: a point of a shape that is in two walls has to leave both of them.
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "scenes/concave_meshes.h"
#include "scenes/simulation.h"
#include "support/catch.h"
#include "truth/certificate.h"
#include "truth/certificate_bodies.h"
#include "truth/certificate_families.h"
#include "truth/certificate_verdict.h"
#include "truth/nests.h"
#include "truth/pair_in_ode.h"
#include "truth/separation_search.h"
#include "truth/tessellated_bodies.h"

using namespace otg;
using namespace otg::truth;

namespace {

constexpr Transformd kUnmoved{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
constexpr double kWall = 0.3;
constexpr int kHardMembers = 60;
constexpr Transformd kUpright{{1, 0, 0, 0, 0, 1, 0, -1, 0}, {0, 0, 0}};  // z to -y: a cylinder stands

/// A profile of an L along z, inner corner at (kWall, kWall).
PairBody makeL(int levels, double scale) {
  PairBody body;
  body.mesh =
      scenes::subdivided(extruded({{0, 0}, {1, 0}, {1, kWall}, {kWall, kWall}, {kWall, 1}, {0, 1}}, 0.8), levels);
  body.mesh = scaled(body.mesh, scale);
  body.pose = kUnmoved;
  return body;
}

PairBody makeShape(MoverKind kind, double scale) {
  Random random(5);
  PairBody body = makeMover(random, kind, true, {0.3, 0.25, 0.2});
  body.mesh = scaled(body.mesh, scale);
  ConvexBody& shape = *body.shape;
  shape.half = otgScale(shape.half, scale);
  shape.radius *= scale;
  shape.length *= scale;
  if (shape.kind == ConvexBody::Kind::kPolyhedron) shape = polyhedronBody(body.mesh);
  return body;
}

/// Placed so that it is as deep in the wall (-x) and the floor (-y) as given.
void pushInto(PairBody& body, double scale, double wall, double floor, double along) {
  ConvexBody placed = *body.shape;
  placed.pose = body.pose;
  placed.pose.t = {0, 0, 0};
  body.pose.t = {scale * kWall + placed.reach({-1, 0, 0}) - wall, scale * kWall + placed.reach({0, -1, 0}) - floor,
                 along};
}

double deepestAlong(const std::vector<JudgedContact>& contacts, const Vec3d& way) {
  double deepest = 0;
  for (const JudgedContact& c : contacts) {
    const double cosine = otgDot(c.normal, way);
    if (cosine > 0.9999) deepest = std::max(deepest, cosine * c.depth);
  }
  return deepest;
}

using MakeHost = Host (*)(Random&);

/// What makes a pair hard, other than that it is in a corner.
enum class Hardship { kTiny, kNeedles, kFine, kNeedlesAndTiny };

scenes::MeshArrays stretchedAlongZ(scenes::MeshArrays mesh, float factor) {
  for (Vec3f& v : mesh.vertices) v.z *= factor;
  return mesh;
}

/// A shape in a corner of a host that is hard for its size or triangles; none where it is not in shallow overlap.
std::optional<CertificateMember> drawHard(Random& random, Hardship hardship, MoverKind kind) {
  const bool needles = hardship == Hardship::kNeedles || hardship == Hardship::kNeedlesAndTiny;
  const bool tiny = hardship == Hardship::kTiny || hardship == Hardship::kNeedlesAndTiny;
  constexpr MakeHost kProfiles[] = {profileL, profileU, profileT, steps}, kAll[] = {profileL, profileT, room, tray};
  const Host host = (needles ? kProfiles : kAll)[random.below(4)](random);
  const Nest& nest = host.nests[static_cast<std::size_t>(random.below(static_cast<int>(host.nests.size())))];
  PairBody ground, mover;
  ground.mesh = needles ? stretchedAlongZ(host.mesh, 100) : host.mesh;
  if (hardship == Hardship::kFine) ground.mesh = scenes::subdivided(ground.mesh, 4);
  ground.pose = kUnmoved;
  const double side = tiny ? 0.01 : 0.2;
  const auto draw = [&] { return side * random.uniform(1, 2); };
  const double x = draw(), y = draw();
  mover = makeMover(random, kind, true, {x, y, draw()});
  if (kind == MoverKind::kCylinder && random.below(3) > 0) mover.pose = kUpright;
  const double depth = press(random, nest, drawSettling(random), kShallowOverlaps, mover).depth;
  CertificateMember member;
  member.plainA = mover;
  member.plainB = ground;
  if (hardship == Hardship::kFine) member.plainB.mesh = host.mesh;
  member.a = mover;
  member.b = ground;
  const Vec3d sides = extentOf(mover.mesh);
  member.size = std::min({sides.x, sides.y, sides.z});
  const auto oracle = makeOracle(member.plainA, member.plainB, 1e-3 * depth);
  if (!oracle->overlapped({0, 0, 0})) return {};
  const std::optional<Vec3d> shortest = shortestSeparation(*oracle, 0.3 * depth, 10 * depth, {});
  // Less than 1e-5 of the shape is within the rounding of the host's vertices where these are far larger.
  if (!shortest || std::sqrt(otgDot(*shortest, *shortest)) < 1e-5 * member.size) return {};
  member.shortest = *shortest;
  return member;
}

}  // namespace

TEST_CASE("Shapes in corners of needles, of fine triangles and of triangles far larger than they are leave all walls") {
  const scenes::OdeSession session;
  for (const Hardship hardship : {Hardship::kTiny, Hardship::kNeedles, Hardship::kFine, Hardship::kNeedlesAndTiny}) {
    for (const MoverKind kind : {MoverKind::kBox, MoverKind::kCylinder, MoverKind::kPrism, MoverKind::kTetrahedron}) {
      Random random(41);
      FamilyVerdict found;
      for (int i = 0; found.members < kHardMembers; ++i) {
        REQUIRE(i < 10 * kHardMembers);
        const std::optional<CertificateMember> member = drawHard(random, hardship, kind);
        if (member) add(found, judge(*member, found.members, {}));
      }
      CAPTURE(static_cast<int>(hardship), static_cast<int>(kind), found.worst.number, found.worst.badness());
      CHECK(found.none == 0);
      CHECK(found.uncertified() <= 1);  // three of all that are drawn here
      CHECK(found.tooLong == 0);
      CHECK(found.longer <= kHardMembers / 20);
      CHECK(found.tooDeep == 0);
      CHECK(found.call == 0);
    }
  }
}

TEST_CASE("A shape in the corner of an L has a contact for each wall, as deep as it is in that wall") {
  const scenes::OdeSession session;
  const auto kind = GENERATE(MoverKind::kBox, MoverKind::kCylinder, MoverKind::kPrism, MoverKind::kTetrahedron);
  const int levels = GENERATE(0, 2);
  const double scale = GENERATE(1e-2, 1.0, 1e2);
  const bool stands = GENERATE(false, true);
  const PairBody corner = makeL(levels, scale);
  for (const auto& [wall, floor] : {std::pair{1e-5, 1e-5}, {1e-4, 1e-6}, {1e-6, 1e-4}, {3e-3, 1e-4}}) {
    for (const double along : {0.0, 0.13, 0.37}) {  // the last overhangs the end
      PairBody shape = makeShape(kind, scale);
      if (stands && kind == MoverKind::kCylinder) shape.pose = kUpright;
      pushInto(shape, scale, wall * scale, floor * scale, along * scale);
      CAPTURE(static_cast<int>(kind), levels, scale, stands, wall, floor, along);
      const std::vector<JudgedContact> contacts = contactsInOde(shape, corner, {});
      CHECK(deepestAlong(contacts, {1, 0, 0}) > 0.97 * wall * scale);
      CHECK(deepestAlong(contacts, {0, 1, 0}) > 0.97 * floor * scale);
      for (const JudgedContact& c : contacts) CHECK(c.depth < 1.1 * scale * std::hypot(wall, floor));
    }
  }
}

TEST_CASE("ODE's shapes leave all walls of a dTriMesh that the library has taken over") {
  const scenes::OdeSession session;
  REQUIRE(dGpuTriMeshOverrideTriMeshWith(dGPUTRIMESH_OVERRIDE_ALL) == dGPUTRIMESH_OK);
  int families = 0;
  for (const CertificateFamily& family : certificateFamilies()) {
    if (!family.name.starts_with('d') || family.name == "dented") continue;
    ++families;
    const FamilyVerdict found = judgeAll(family, {1, 0, kHardMembers}, {.asTriMesh = true});
    CAPTURE(family.name, found.worst.number);
    CHECK(found.members == kHardMembers);
    CHECK(found.uncertified() == 0);
    CHECK(found.tooLong == 0);
    CHECK(found.longer <= kHardMembers / 20);
    CHECK(found.tooDeep == 0);
  }
  CHECK(families == 5);
}
