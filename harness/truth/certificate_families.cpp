// SPDX-License-Identifier: BSD-3-Clause
#include "truth/certificate_families.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "collide/query.h"
#include "scenes/concave_meshes.h"
#include "truth/certificate_bodies.h"
#include "truth/fitting_bodies.h"
#include "truth/nests.h"
#include "truth/profile_bodies.h"
#include "truth/separation_search.h"
#include "truth/tessellated_bodies.h"
#include "truth/wild_bodies.h"

namespace otg::truth {
namespace {

constexpr Transformd kUnmoved{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
constexpr double kPi = std::numbers::pi;

/// Deeper than a surface moves where it is subdivided in float.
constexpr double kLeastDepth = 1e-6;

using MakeHost = Host (*)(Random&);

double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

Vec3d sidesFor(Random& random, const Nest& nest) {
  return {random.uniform(nest.leastSides.x, nest.mostSides.x), random.uniform(nest.leastSides.y, nest.mostSides.y),
          random.uniform(nest.leastSides.z, nest.mostSides.z)};
}

void drawNested(Random& random, MakeHost make, MoverKind kind, bool shape, PairDraft& draft) {
  const Host host = make(random);
  const Nest& nest = host.nests[static_cast<std::size_t>(random.below(static_cast<int>(host.nests.size())))];
  const Settling settling = drawSettling(random);
  draft.host.mesh = host.mesh;
  draft.mover = makeMover(random, kind, shape, sidesFor(random, nest));
  // Cylinders and capsules are made along z; most of them stand here, the others lie.
  if ((kind == MoverKind::kCylinder || kind == MoverKind::kCapsule) && random.below(3) > 0) {
    draft.mover.pose = {{1, 0, 0, 0, 0, 1, 0, -1, 0}, {0, 0, 0}};
  }
  const Pressed pressed = press(random, nest, settling, draft.overlaps, draft.mover);
  draft.depth = pressed.depth;
  draft.aligned = settling == Settling::kAligned;
  draft.what = fmt::format("{}, {} of {} walls", nameOf(settling), pressed.walls, nest.walls.size());
}

MoverKind meshMover(Random& random) {
  const int draw = random.below(10);
  return draw < 6    ? MoverKind::kBox
         : draw == 6 ? MoverKind::kCylinder
         : draw == 7 ? MoverKind::kPrism
         : draw == 8 ? MoverKind::kTetrahedron
                     : MoverKind::kL;
}

CertificateFamily nestFamily(const std::string& name, const std::string& what, MakeHost make) {
  return {name, what, [make](Random& random, PairDraft& draft) {
            const MoverKind kind = meshMover(random);
            drawNested(random, make, kind, false, draft);
            return true;
          }};
}

constexpr MakeHost kHosts[] = {profileL, profileU, profileT, room, tray, slot, steps, wedgeSlot, vBlock, bin};
constexpr const char* kHostNames[] = {"L", "U", "T", "room", "tray", "slot", "step", "wedge", "vblock", "bin"};

CertificateFamily shapeFamily(const std::string& name, const std::string& what, std::vector<MoverKind> kinds) {
  return {name, what, [kinds = std::move(kinds)](Random& random, PairDraft& draft) {
            const auto host = static_cast<std::size_t>(random.below(std::size(kHosts)));
            const MoverKind kind = kinds[static_cast<std::size_t>(random.below(static_cast<int>(kinds.size())))];
            drawNested(random, kHosts[host], kind, true, draft);
            draft.what = std::string("in ") + kHostNames[host] + ", " + draft.what;
            return true;
          }};
}

/// Two meshes that are moved until they touch, by their exact intersection.
class Pusher {
 public:
  Pusher(const PairBody& host, const PairBody& mover)
      : host_(scenes::build(host.mesh), BuildStrategy::kSah),
        mover_(scenes::build(mover.mesh), BuildStrategy::kSah),
        pose_(relativePose(host.pose, mover.pose)) {}

  bool touches(const Transformd& pose) {
    Query query;
    query.a = &host_;
    query.b = &mover_;
    query.bInA = pose;
    findIntersectingPairs(query, workspace_);
    return !workspace_.intersecting.empty();
  }
  bool clear() { return !touches(pose_); }

  /// Moves the mover up to `most` along a direction, to just before it touches; whether it came to touch after `least`
  /// at least.
  bool push(const Vec3d& direction, double least, double most) {
    double free = 0, hit = 0;
    for (int i = 1; i <= 60; ++i) {
      hit = most * i / 60;
      if (touches(moved(direction, hit))) break;
      free = hit;
    }
    if (free == hit) return false;
    while (hit - free > 1e-8 * most) {
      const double middle = 0.5 * (hit + free);
      (touches(moved(direction, middle)) ? hit : free) = middle;
    }
    if (free < least) return false;
    pose_ = moved(direction, free);
    return true;
  }
  void sink(const Vec3d& by) { pose_.t = otgAdd(pose_.t, by); }
  const Transformd& pose() const { return pose_; }

 private:
  Transformd moved(const Vec3d& direction, double length) const {
    Transformd pose = pose_;
    pose.t = otgAdd(pose.t, otgScale(direction, length));
    return pose;
  }
  CollisionMesh host_, mover_;
  Transformd pose_;
  Workspace workspace_;
};

/// From where it is clear, pushed in one to three directions until it touches, then in by a little more.
bool pushIn(Random& random, PairDraft& draft, std::optional<Vec3d> first, double most) {
  const Vec3d sides = extentOf(draft.mover.mesh);
  const double size = std::min({sides.x, sides.y, sides.z});
  Pusher pusher(draft.host, draft.mover);
  if (!pusher.clear()) return false;
  draft.depth = size * std::pow(10.0, random.uniform(draft.overlaps.leastPower, draft.overlaps.mostPower));
  Vec3d way{0, 0, 0};
  int touched = 0;
  const int wanted = 1 + random.below(3);
  for (int tries = 0; tries < 12 && touched < wanted; ++tries) {
    const Vec3d d = first && tries == 0 ? *first : random.direction();
    if (!pusher.push(d, touched == 0 ? 0 : 1e-3 * size, touched == 0 ? most : 0.5 * size)) {
      if (touched == 0 && first) return false;
      continue;
    }
    ++touched;
    way = otgAdd(way, otgScale(d, random.uniform(0.2, 1)));
  }
  if (touched == 0 || !(norm(way) > 0.1)) return false;
  pusher.sink(otgScale(way, draft.depth / norm(way)));
  draft.mover.pose = pusher.pose();
  draft.what += fmt::format(", pushed {} times", touched);
  return true;
}

bool drawBowl(Random& random, PairDraft& draft) {
  const double radius = 1, thick = random.uniform(0.05, 0.2);
  const int segments = 16 + 4 * random.below(5), rings = 4 + random.below(5);
  draft.host.mesh = scenes::makeBowl(radius, thick, segments, rings);
  const double side = random.uniform(0.2, 0.5);
  const int kind = random.below(3);
  const Vec3d sides{side, side * random.uniform(0.7, 1.3), side * random.uniform(0.7, 1.3)};
  draft.mover = makeMover(random,
                          kind == 0   ? MoverKind::kBox
                          : kind == 1 ? MoverKind::kSphere
                                      : MoverKind::kCylinder,
                          false, sides);
  draft.mover.pose = random.rotation();
  draft.mover.pose.t = {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), -0.1};
  draft.what = "inside";
  return pushIn(random, draft, Vec3d{0, 0, -1}, 1);
}

bool drawGears(Random& random, PairDraft& draft) {
  const int teeth = 10 + 2 * random.below(5);
  const double tooth = random.uniform(0.15, 0.25), width = random.uniform(0.2, 0.4);
  draft.host.mesh = draft.mover.mesh = scenes::makeGear(teeth, 1, tooth, width, 0.3);
  const Settling settling = drawSettling(random);
  draft.aligned = settling == Settling::kAligned;
  // A gap of the one at a tooth of the other, with play on all sides.
  Transformd mesh = turnAbout({0, 0, 1}, kPi / teeth);
  if (settling != Settling::kAligned) {
    const Vec3d axis = random.direction();
    mesh = product(turnAbout(axis, std::pow(10.0, random.uniform(-5, -2.5))), mesh);
  }
  draft.mover.pose = mesh;
  draft.mover.pose.t = {2 + random.uniform(0.005, 0.3 * tooth), random.uniform(-0.01, 0.01), random.uniform(-0.1, 0.1)};
  draft.what = fmt::format("{} teeth", teeth);
  const double angle = random.uniform(-0.6, 0.6);
  return pushIn(random, draft, Vec3d{-std::cos(angle), std::sin(angle), 0}, 0.3);
}

bool drawScrew(Random& random, PairDraft& draft) {
  const double pitch = random.uniform(0.3, 0.5), clearance = random.uniform(0.02, 0.05);
  const int segments = 6 * (2 + random.below(3));
  draft.host.mesh = scenes::makeBolt(1, pitch, 4 * pitch, segments);
  draft.mover.mesh = scenes::makeNut(1, pitch, 2 * pitch, clearance, segments);
  const Settling settling = drawSettling(random);
  draft.aligned = settling == Settling::kAligned;
  Transformd pose = kUnmoved;
  if (!draft.aligned) {
    const Vec3d axis = random.direction();
    pose = turnAbout(axis, std::pow(10.0, random.uniform(-5, -3)));
  }
  pose.t = {0, 0, pitch};
  draft.mover.pose = pose;
  draft.what = fmt::format("{} segments", segments);
  const Vec3d d = random.below(3) == 0 ? Vec3d{0, 0, -1} : random.direction();
  return pushIn(random, draft, d, 0.3);
}

/// Two bodies in one of the settlings, from outside.
bool pushFromOutside(Random& random, PairDraft& draft) {
  const Settling settling = drawSettling(random);
  draft.aligned = settling == Settling::kAligned;
  draft.mover.pose = settled(random, settling, kUnmoved);
  const Vec3d way = random.direction();
  const Vec3d a = extentOf(draft.host.mesh), b = extentOf(draft.mover.mesh);
  const double away = 0.55 * (norm(a) + norm(b));
  draft.mover.pose.t = otgAdd(otgScale(way, -away), otgScale(random.direction(), 0.3 * std::min(norm(a), norm(b))));
  draft.what = nameOf(settling);
  return pushIn(random, draft, way, 2 * away);
}

bool drawDented(Random& random, PairDraft& draft) {
  for (PairBody* body : {&draft.host, &draft.mover}) {
    if (random.below(3) == 0) {
      const double radius = random.uniform(0.3, 0.6), amplitude = random.uniform(0.2, 0.6);
      body->mesh = scenes::makeLump(radius, 2, amplitude, static_cast<std::uint32_t>(random.below(1 << 30)));
    } else {
      const Vec3d sides{random.uniform(0.5, 1), random.uniform(0.5, 1), random.uniform(0.5, 1)};
      const int cells = 2 + random.below(5);
      const double amplitude = random.uniform(0.01, 0.08);
      body->mesh = dentedBox(random, sides, cells, amplitude);
    }
  }
  return pushFromOutside(random, draft);
}

bool drawCells(Random& random, PairDraft& draft) {
  const auto cells = [&](int least, double smallest, double largest) {
    const int perSide = least + random.below(2);
    const double size = random.uniform(smallest, largest), share = random.uniform(0.3, 0.6);
    return randomCells(random, perSide, size, share);
  };
  draft.host.mesh = cells(3, 0.8, 1.2);
  if (random.below(2) == 0) {
    draft.mover.mesh = cells(2, 0.4, 0.8);
  } else {
    const MoverKind kind = meshMover(random);
    draft.mover.mesh = makeMover(random, kind, false, {0.3, 0.25, 0.2}).mesh;
  }
  return pushFromOutside(random, draft);
}

void drawTwoProfiles(Random& random, PairDraft& draft) {
  ProfileBody host = randomProfile(random), mover = randomProfile(random);
  draft.host.mesh = std::move(host.mesh);
  draft.mover.mesh = std::move(mover.mesh);
  draft.what = fmt::format("{} on {}", mover.what, host.what);
}

bool drawProfiles(Random& random, PairDraft& draft) {
  drawTwoProfiles(random, draft);
  const std::string what = draft.what;
  const bool touches = pushFromOutside(random, draft);
  draft.what = what + ", " + draft.what;
  return touches;
}

/// Each within the other's bounds, as a comb in a comb, a hook in an eye, a spiral in a spiral.
bool drawInterlocked(Random& random, PairDraft& draft) {
  drawTwoProfiles(random, draft);
  const Settling settling = drawSettling(random);
  draft.aligned = settling == Settling::kAligned;
  draft.what += std::string(", ") + nameOf(settling);
  for (int tries = 0; tries < 40; ++tries) {
    const Vec3d axis = random.below(2) == 0 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    draft.mover.pose = settled(random, settling, turnAbout(axis, 0.5 * kPi * random.below(4)));
    draft.mover.pose.t = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.2, 0.2)};
    if (Pusher(draft.host, draft.mover).clear()) return pushIn(random, draft, {}, 0.5);
  }
  return false;
}

bool drawSpikes(Random& random, PairDraft& draft) {
  draft.host.mesh = scenes::makeBowl(1, random.uniform(0.05, 0.2), 16 + 4 * random.below(5), 4 + random.below(5));
  const double side = random.uniform(0.2, 0.5);
  const Vec3d sides{side * random.uniform(0.05, 0.3), side, side * random.uniform(0.05, 0.3)};
  draft.mover = makeMover(random, MoverKind::kTetrahedron, false, sides);
  draft.mover.pose = random.rotation();
  draft.mover.pose.t = {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), -0.1};
  draft.what = "spike";
  return pushIn(random, draft, Vec3d{0, 0, -1}, 1) && draft.depth > kLeastDepth;
}

using MakeBody = scenes::MeshArrays (*)(Random&);

scenes::MeshArrays ringOfOne(Random& random) {
  return randomRing(random, 0.5);
}

constexpr MakeBody kWild[] = {ringOfOne, randomSpring, turnedBody, spikyBall, roughGround, barFrame, thinBox};

/// A body of one kind, and another one of that or any kind.
CertificateFamily wildFamily(const std::string& name, const std::string& what, MakeBody make) {
  return {name, what, [make](Random& random, PairDraft& draft) {
            draft.host.mesh = make(random);
            draft.mover.mesh = random.below(3) == 0 ? makeMover(random, meshMover(random), false, {0.3, 0.25, 0.2}).mesh
                               : random.below(2) == 0 ? make(random)
                                                      : kWild[random.below(std::size(kWild))](random);
            return pushFromOutside(random, draft) && draft.depth > kLeastDepth;
          }};
}

/// One of ODE's shapes on such a body. No balls: their contacts lie on the mesh's edges, and not in the middle
/// of the overlap, as the judge takes it.
bool drawShapeOn(Random& random, scenes::MeshArrays host, PairDraft& draft) {
  constexpr MoverKind kShapes[] = {MoverKind::kBox, MoverKind::kCylinder, MoverKind::kCapsule, MoverKind::kPrism,
                                   MoverKind::kTetrahedron};
  draft.host.mesh = std::move(host);
  const double size = random.uniform(0.1, 0.4);
  draft.mover = makeMover(random, kShapes[random.below(std::size(kShapes))], true, {size, 0.8 * size, 0.6 * size});
  return pushFromOutside(random, draft) && draft.depth > kLeastDepth;
}

bool drawShapeOnWild(Random& random, PairDraft& draft) {
  return drawShapeOn(random, kWild[random.below(std::size(kWild))](random), draft);
}
bool drawShapeOnBlocks(Random& random, PairDraft& draft) {
  return drawShapeOn(random, blockPile(random), draft);
}
bool drawShapeOnFlush(Random& random, PairDraft& draft) {
  return drawShapeOn(random, flushBlocks(random), draft);
}
bool drawShapeOnBumpy(Random& random, PairDraft& draft) {
  return drawShapeOn(random, bumpyBall(random), draft);
}
bool drawShapeOnRough(Random& random, PairDraft& draft) {
  return drawShapeOn(random, roughGround(random), draft);
}

/// One through the other, as links of a chain are, or within it.
bool drawEntwined(Random& random, PairDraft& draft) {
  const int kind = random.below(3);
  draft.host.mesh = kind == 0 ? ringOfOne(random) : kind == 1 ? randomSpring(random) : barFrame(random);
  draft.mover.mesh = random.below(2) == 0   ? randomRing(random, random.uniform(0.2, 0.5))
                     : random.below(2) == 0 ? randomSpring(random)
                                            : thinBox(random);
  const double size = norm(extentOf(draft.host.mesh)) / 3;
  for (int tries = 0; tries < 60; ++tries) {
    draft.mover.pose = random.rotation();
    draft.mover.pose.t = otgScale(random.direction(), random.uniform(0, size));
    if (Pusher(draft.host, draft.mover).clear()) return pushIn(random, draft, {}, 0.5) && draft.depth > kLeastDepth;
  }
  return false;
}

/// Put on from above: first straight down, where the two fit.
CertificateFamily fittingFamily(const std::string& name, const std::string& what, FittingPair (*make)(Random&)) {
  return {name, what, [make](Random& random, PairDraft& draft) {
            FittingPair pair = make(random);
            draft.host.mesh = std::move(pair.host);
            draft.mover.mesh = std::move(pair.mover);
            const Settling settling = random.below(2) == 0 ? Settling::kAligned : Settling::kSettled;
            draft.aligned = settling == Settling::kAligned;
            draft.mover.pose = settled(random, settling, kUnmoved);
            draft.mover.pose.t = {0, pair.along, 0.05};
            draft.what = pair.what + ", " + nameOf(settling);
            return pushIn(random, draft, Vec3d{0, 0, -1}, 0.2) && draft.depth * std::sin(pair.angle) > kLeastDepth;
          }};
}

/// Halvings of the edges.
int levelsFor(const scenes::MeshArrays& mesh) {
  return mesh.triangles.size() <= 200 ? 2 : mesh.triangles.size() <= 2000 ? 1 : 0;
}

/// Subdivides, scales, turns and moves a pair, and gives either body the part of A.
CertificateMember finished(Random& random, PairDraft draft) {
  CertificateMember member;
  const int subdivision = random.below(6), scale = random.below(4);
  const double factor = scale == 0 ? 1e-2 : scale == 1 ? 1e2 : 1;
  if (factor != 1) {
    for (PairBody* body : {&draft.host, &draft.mover}) {
      body->mesh = scaled(body->mesh, factor);
      body->pose.t = otgScale(body->pose.t, factor);
      if (!body->shape) continue;
      ConvexBody& shape = *body->shape;
      shape.half = otgScale(shape.half, factor);
      shape.radius *= factor;
      shape.length *= factor;
      if (shape.kind == ConvexBody::Kind::kPolyhedron) shape = polyhedronBody(body->mesh);
    }
    draft.what += fmt::format(", scaled by {:g}", factor);
  }
  const Vec3d sides[2] = {extentOf(draft.host.mesh), extentOf(draft.mover.mesh)};
  member.size = std::min({sides[0].x, sides[0].y, sides[0].z, sides[1].x, sides[1].y, sides[1].z});
  Transformd world = kUnmoved;
  if (!draft.aligned && random.below(2) == 0) {
    world = random.rotation();
    draft.what += ", turned";
  }
  if (random.below(4) == 0) {
    world.t = otgScale(random.direction(), 1e4 * std::max(norm(sides[0]), norm(sides[1])));
    draft.what += ", far";
  }
  for (PairBody* body : {&draft.host, &draft.mover}) body->pose = product(world, body->pose);
  const bool swapped = random.below(2) == 0;
  member.plainA = swapped ? draft.mover : draft.host;
  member.plainB = swapped ? draft.host : draft.mover;
  member.a = member.plainA;
  member.b = member.plainB;
  if (subdivision < 2) {
    for (PairBody* body : {&member.a, &member.b}) {
      if (!body->shape && (subdivision == 0 || body == &member.a))
        body->mesh = scenes::subdivided(body->mesh, levelsFor(body->mesh));
    }
    draft.what += subdivision == 0 ? ", subdivided" : ", A subdivided";
  }
  member.what = draft.what + (swapped ? ", mover is A" : "");
  return member;
}

std::uint32_t mixed(std::uint32_t seed, const std::string& name, int number) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](std::uint64_t byte) { hash = (hash ^ (byte & 0xff)) * 0x100000001b3u; };
  for (const char c : name) add(static_cast<unsigned char>(c));
  for (int shift = 0; shift < 32; shift += 8) {
    add(seed >> shift);
    add(static_cast<std::uint32_t>(number) >> shift);
  }
  return static_cast<std::uint32_t>(hash ^ (hash >> 32));
}

}  // namespace

double CertificateMember::grain() const {
  return 2e-3 * norm(shortest);
}

std::vector<CertificateFamily> certificateFamilies() {
  std::vector<CertificateFamily> all{
      nestFamily("L", "a small body in the inner corner of an L profile", profileL),
      nestFamily("U", "in an inner corner of a U profile", profileU),
      nestFamily("T", "in an inner corner of a T profile", profileT),
      nestFamily("room", "in the corner of a hollow, closed or with a skylight", room),
      nestFamily("tray", "in the corner of a tray", tray),
      nestFamily("slot", "in a groove with 0.01 to 5 % clearance", slot),
      nestFamily("step", "on a stair, against the next step", steps),
      nestFamily("wedge", "in a groove whose walls lean outward", wedgeSlot),
      nestFamily("vblock", "in a groove of 90 degrees", vBlock),
      nestFamily("bin", "between the boxes of a row on a floor, one mesh", bin),
      {"cylinder", "a cylinder of 12 to 32 sides in an inner corner",
       [](Random& random, PairDraft& draft) {
         const MakeHost host = kHosts[random.below(std::size(kHosts))];
         drawNested(random, host, MoverKind::kCylinder, false, draft);
         return true;
       }},
      fittingFamily("acute", "a wedge in a groove of its own acute angle", wedgeInGroove),
      fittingFamily("ridge", "a tile of two boards on a ridge", tileOnRidge),
      fittingFamily("hat", "a hollow pyramid on a pyramid", hatOnPyramid),
      {"gears", "two gears in mesh", drawGears},
      {"screw", "a nut on its bolt", drawScrew},
      {"bowl", "a body in a bowl", drawBowl},
      {"dented", "boxes with dents and lumps on each other", drawDented},
      {"cells", "random unions of boxes on each other", drawCells},
      {"profiles", "stars, combs, hooks and spirals on each other", drawProfiles},
      {"interlocked", "stars, combs, hooks and spirals in each other", drawInterlocked},
      {"spikes", "a thin tetrahedron in a bowl", drawSpikes},
      wildFamily("rings", "bent rings and others", ringOfOne),
      wildFamily("springs", "springs and others", randomSpring),
      wildFamily("turned", "turned parts and others", turnedBody),
      wildFamily("spiky", "spiky balls and others", spikyBall),
      wildFamily("rough", "rough ground and others", roughGround),
      wildFamily("bumpy", "smooth balls of many triangles with bumps, and others", bumpyBall),
      wildFamily("frames", "frames of bars and others", barFrame),
      wildFamily("thin", "plates, needles and others", thinBox),
      wildFamily("blocks", "piles of blocks that reach into each other, and others", blockPile),
      wildFamily("flush", "blocks with flush faces in one mesh, and others", flushBlocks),
      {"entwined", "rings and springs through each other", drawEntwined},
      {"shapes", "ODE's shapes on rings, springs, turned parts and others", drawShapeOnWild},
      {"on_blocks", "ODE's shapes on piles of blocks that reach into each other", drawShapeOnBlocks},
      {"on_flush", "ODE's shapes on blocks with flush faces in one mesh", drawShapeOnFlush},
      {"on_bumpy", "ODE's shapes on smooth balls of many triangles with bumps", drawShapeOnBumpy},
      {"on_rough", "ODE's shapes on rough ground", drawShapeOnRough},
      shapeFamily("dBox", "ODE's box in inner corners", {MoverKind::kBox}),
      shapeFamily("dCylinder", "ODE's cylinder in inner corners", {MoverKind::kCylinder}),
      shapeFamily("dCapsule", "ODE's capsule in inner corners", {MoverKind::kCapsule}),
      shapeFamily("dSphere", "ODE's sphere in inner corners", {MoverKind::kSphere}),
      shapeFamily("dConvex", "ODE's convex in inner corners", {MoverKind::kPrism, MoverKind::kTetrahedron})};
  return all;
}

CertificateFamily bodyFamily(const std::string& name, const std::vector<std::shared_ptr<const TriMesh>>& bodies,
                             std::size_t host) {
  return {name, "this body and others in random poses", [bodies, host](Random& random, PairDraft& draft) {
            const auto mover = static_cast<std::size_t>(random.below(static_cast<int>(bodies.size())));
            draft.host.mesh = scenes::broughtToOrigin(*bodies[host], 0.5f);
            draft.mover.mesh = scenes::broughtToOrigin(*bodies[mover], static_cast<float>(random.uniform(0.2, 0.5)));
            return pushFromOutside(random, draft) && draft.depth > kLeastDepth;
          }};
}

std::optional<CertificateMember> certificateMember(const CertificateFamily& family, std::uint32_t seed, int number,
                                                   const OverlapRange& overlaps) {
  Random random(mixed(seed, family.name, number));
  for (int tries = 0; tries < 50; ++tries) {
    PairDraft draft;
    draft.host.pose = draft.mover.pose = kUnmoved;
    draft.overlaps = overlaps;
    if (!family.draw(random, draft)) continue;
    const double depth = draft.depth, plainSide = extentOf(draft.mover.mesh).x;
    CertificateMember member = finished(random, std::move(draft));
    const PairBody& mover = member.what.ends_with("mover is A") ? member.plainA : member.plainB;
    const double known = depth * extentOf(mover.mesh).x / plainSide;
    const auto oracle = makeOracle(member.plainA, member.plainB, 1e-3 * known);
    if (!oracle->overlapped({0, 0, 0})) continue;
    const std::optional<Vec3d> shortest = shortestSeparation(*oracle, 0.3 * known, 10 * known, {});
    if (!shortest) continue;
    const double part = norm(*shortest) / member.size;
    if (part < overlaps.least || part > overlaps.most) continue;
    member.shortest = *shortest;
    member.what += fmt::format(", overlap {:.1e}", part);
    return member;
  }
  return {};
}

}  // namespace otg::truth
