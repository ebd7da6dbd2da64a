// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shell/shell_approach.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"

namespace otg {
namespace {

// In radii of the visitor.
constexpr double kFar = 2.5;           ///< from a sheet or shell that nothing is remembered of
constexpr double kFlush = 0.05;        ///< nearer than that a point shows no side
constexpr double kJustThrough = 0.05;  ///< at the first query
constexpr double kFrontHeight = 0.5;   ///< of the front point over the visitor's middle

constexpr std::size_t kFew = 4, kMany = 64;  ///< samples

}  // namespace

ShellApproach::ShellApproach(const Query& query, const ShellRoles& roles, const SolidHistory::State& before,
                             GroundSides& sides, std::vector<double>& crossings)
    : query_(query),
      roles_(roles),
      before_(before),
      sides_(sides),
      crossings_(crossings),
      surface_(*roles.ground, sides, 1e-9 * roles.size),
      velocity_(roles.groundIsA ? otgScale(query.relativeVelocity, -1.0)
                                : otgRotateBack(query.bInA, query.relativeVelocity)) {}

/// Some vertices of the visitor, far from each other as a rule. Ends when `visit` returns true.
template <class Visit>
void ShellApproach::forSamples(std::size_t most, const Visit& visit) const {
  const TriMesh& mesh = roles_.visitor->mesh();
  const std::size_t count = mesh.triangleCount();
  for (std::size_t k = 0; k < most; ++k) {
    const std::size_t t = k * (count - 1) / (most - 1);
    if (visit(roles_.vertex(mesh.triangles()[t].v[k % 3]))) return;
  }
}

/// The first that does not lie beside a rim, or else the first.
ShellApproach::Sample ShellApproach::sampleNear() const {
  Sample best;
  forSamples(kFew, [&](const Vec3d& point) {
    Sample sample{point, {}, true};
    if (!surface_.measure(point, kFar * roles_.size, kNone, sample.depth)) return false;
    if (!best.isFound || !sample.depth.isBeside) best = sample;
    return !sample.depth.isBeside;
  });
  return best;
}

/// The one that is farthest off; none if that is farther than what is remembered.
ShellApproach::Sample ShellApproach::sampleFar() const {
  Sample best;
  forSamples(kFew, [&](const Vec3d& point) {
    Sample sample{point, {}, true};
    if (!surface_.measure(point, kFar * roles_.size, kNone, sample.depth)) {
      best.isFound = false;
      return true;
    }
    if (!best.isFound || sample.depth.place.distance > best.depth.place.distance) best = sample;
    return false;
  });
  return best;
}

bool ShellApproach::crosses(const Vec3d& from, const Vec3d& to) const {
  return crossesOddly(*roles_.ground, from, to, 0, crossings_);
}

ShellState ShellApproach::decide(bool meets) {
  switch (roles_.kind) {
    case GroundKind::kSolid:
      return besideSolid(meets);
    case GroundKind::kSheet:
      return besideSheet(meets);
    default:
      return besideShell(meets);
  }
}

ShellState ShellApproach::besideSolid(bool meets) {
  if (roles_.ground->mesh().meshClass() == MeshClass::kSolid) {
    sides_.setWinding(1);
  } else {
    sides_.setEach(roles_.ground->outwardSides());
  }
  if (meets) return ShellState::kMeeting;
  const TriMesh& mesh = roles_.ground->mesh();
  bool isInside = false;
  forSamples(kFew, [&](const Vec3d& p) {
    const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
    if (p.x < lo.x || p.y < lo.y || p.z < lo.z || p.x > hi.x || p.y > hi.y || p.z > hi.z) return false;
    GroundDepth depth;
    isInside = surface_.measure(p, std::numeric_limits<double>::max(), kNone, depth) && depth.isBehind;
    return isInside;
  });
  return isInside ? ShellState::kThrough : ShellState::kApart;
}

/// Of a sheet that is met before it was seen from afar: a terrain's winding decides, and where the rest is flush the
/// motion.
int ShellApproach::sideOfMeeting() const {
  if (roles_.isTerrain || roles_.visitor->mesh().meshClass() == MeshClass::kSolid) return 1;
  GroundDepth depth;
  if (!surface_.measure(roles_.middle(), kFar * roles_.size, kNone, depth)) return 1;
  if (std::fabs(depth.height) > kFlush * roles_.size) return depth.height < 0 ? -1 : 1;
  return otgDot(velocity_, depth.out) > 1e-3 * norm(velocity_) ? -1 : 1;
}

/// By the winding; 0 if the sample lies in the surface's plane, beside its rim.
int ShellApproach::sideOfApart(const Sample& sample) const {
  const GroundDepth& depth = sample.depth;
  if (depth.isBeside && std::fabs(depth.height) < 0.3 * depth.place.distance) return 0;
  return depth.height < 0 ? -1 : 1;
}

/// A body that touches the front lies a little behind it with one side. One between two storeys of a sheet is behind
/// the upper one.
bool ShellApproach::isPartlyInFront() const {
  bool inFront = false;
  forSamples(std::clamp(roles_.visitor->mesh().triangleCount(), kFew, kMany), [&](const Vec3d& point) {
    GroundDepth depth;
    inFront = surface_.measure(point, kFar * roles_.size, kNone, depth) && !depth.isBeside && depth.height > 0;
    return inFront;
  });
  return inFront;
}

/// Of a solid that lies behind: 1 if it has come through the front, which it touched at the last query.
int ShellApproach::sideOfBehind() const {
  return before_.side != 0 ? before_.side : before_.deepest > 0 ? 1 : -1;
}

ShellState ShellApproach::besideSheet(bool meets) {
  sides_.setWinding(1);
  side_ = before_.side;
  if (meets) {
    if (side_ == 0) side_ = sideOfMeeting();
    sides_.setWinding(side_);
    return ShellState::kMeeting;
  }
  const Sample sample = sampleNear();
  if (!sample.isFound) {
    side_ = 0;
    return ShellState::kApart;
  }
  const GroundDepth& depth = sample.depth;
  const int now = sideOfApart(sample);
  if (roles_.visitor->mesh().meshClass() == MeshClass::kSolid) {
    // Contacts of solids need no memory, but where they would be drawn to the front.
    if (!depth.isBeside) side_ = now < 0 && !isPartlyInFront() ? sideOfBehind() : 0;
    return ShellState::kApart;
  }
  const bool isBefore = side_ != 0;
  if (!isBefore) {
    side_ = now;
    // The first query comes a step too late: it has just passed the surface, and goes on.
    const bool isLate =
        roles_.isTerrain && now < 0 && -depth.height < kJustThrough * roles_.size && otgDot(velocity_, depth.out) < 0;
    if (!isLate) return ShellState::kApart;
    side_ = 1;
  }
  if (now == side_ || now == 0) return ShellState::kApart;
  if (depth.isBeside) {  // it has gone round
    side_ = now;
    return ShellState::kApart;
  }
  sides_.setWinding(side_);
  return ShellState::kThrough;
}

/// In front of a ground that is met at the first query: on the side that most of the visitor is on, or that it comes
/// from.
Vec3d ShellApproach::frontOfMeeting() const {
  const Sample far = sampleFar();
  if (far.isFound && far.depth.place.distance > kFlush * roles_.size) return far.point;
  const double speed = norm(velocity_);
  const Vec3d from = speed > 0 ? otgScale(velocity_, -1 / speed) : far.depth.out;
  return otgAdd(roles_.middle(), otgScale(from, roles_.size));
}

/// Off the visitor and farther from the ground, where nothing is in between.
Vec3d ShellApproach::frontOfApart(const Sample& sample) const {
  const Vec3d off = otgSub(sample.point, sample.depth.place.point);
  if (norm(off) > kFlush * roles_.size || !(norm(off) > 0)) return sample.point;
  const Vec3d farther = otgAdd(sample.point, otgScale(unit(off), kFrontHeight * roles_.size));
  return crosses(sample.point, farther) ? sample.point : farther;
}

/// The front point goes with the visitor as long as nothing comes in between.
void ShellApproach::carryFront() {
  if (!before_.hasPose) return;
  Query last = query_;
  last.bInA = before_.pose;
  const Vec3d moved = otgAdd(front_, otgSub(roles_.middle(), shellRoles(last).middle()));
  if (!crosses(front_, moved)) front_ = moved;
}

ShellState ShellApproach::besideShell(bool meets) {
  sides_.setWinding(1);
  const bool isKnown = before_.side != 0;
  side_ = 1;
  front_ = before_.front;
  if (meets) {
    if (isKnown) {
      carryFront();
    } else {
      front_ = frontOfMeeting();
    }
    sides_.setFront(*roles_.ground, front_, roles_.middle(), surface_.slack());
    return ShellState::kMeeting;
  }
  const Sample sample = sampleFar();
  if (!sample.isFound) {
    side_ = 0;
    return ShellState::kApart;
  }
  if (isKnown && crosses(sample.point, front_)) {
    sides_.setFront(*roles_.ground, front_, roles_.middle(), surface_.slack());
    return ShellState::kThrough;
  }
  front_ = frontOfApart(sample);
  return ShellState::kApart;
}

void ShellApproach::finish(ShellState state, bool hasContacts, const Vec3d& sum, SolidHistory::State& after) {
  if (state == ShellState::kThrough && !hasContacts) {  // too far behind to have come from there
    side_ = roles_.kind == GroundKind::kSheet ? -side_ : 0;
  }
  if (roles_.kind == GroundKind::kSheet && roles_.visitor->mesh().meshClass() == MeshClass::kSolid) {
    if (state == ShellState::kMeeting) side_ = before_.side;
  }
  if (roles_.kind == GroundKind::kShell && state == ShellState::kMeeting && norm(sum) > 0) {
    const Vec3d over = otgAdd(roles_.middle(), otgScale(unit(sum), kFrontHeight * roles_.size));
    if (!crosses(front_, over)) front_ = over;
  }
  after.side = side_;
  after.front = roles_.kind == GroundKind::kShell && side_ != 0 ? front_ : Vec3d{0, 0, 0};
}

int sideBehind(const Query& query, const SolidHistory::State& before) {
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  if (a.meshClass() == b.meshClass() || areShells(a, b)) return before.side;
  const ShellRoles roles = shellRoles(query);
  GroundSides sides;
  std::vector<double> crossings;
  SolidHistory::State state = before;
  ShellApproach approach(query, roles, before, sides, crossings);
  approach.decide(false);
  approach.finish(ShellState::kApart, false, {0, 0, 0}, state);
  return state.side;
}

}  // namespace otg
