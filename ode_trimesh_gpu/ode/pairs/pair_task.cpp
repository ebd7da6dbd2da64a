// SPDX-License-Identifier: BSD-3-Clause
// From two geoms to a query in mesh A's frame, and from its contacts back to ODE's.
#include "ode/pairs/pair_task.h"

#include <ode/objects.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>

#include "base/vectors.h"
#include "collide/inward_body.h"
#include "collide/pair_history.h"
#include "collide/shell/shell_roles.h"
#include "dispatch/dispatcher.h"
#include "ode/base/status.h"
#include "ode/geom/joined_sides.h"
#include "ode/pairs/contact_data.h"
#include "ode/pairs/pair_roles.h"

namespace otg {
namespace {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

struct Side {
  const MeshGeom& side;
  WorldPose& pose;
};

/// Velocity of A's body relative to B's at the middle of B's mesh, in A's frame. ODE's velocities are the world's.
/// Where the program gives last transforms of its geoms, it is what they moved since then. Only the direction is used.
Vec3d relativeVelocity(const Side& a, const Side& b) {
  const bool lastOfA = hasLastTransform(a.side), lastOfB = hasLastTransform(b.side);
  const dBodyID bodyA = dGeomGetBody(a.side.geom), bodyB = dGeomGetBody(b.side.geom);
  if (!lastOfA && !lastOfB && bodyA == nullptr && bodyB == nullptr) return {0, 0, 0};
  const Vec3f& c = b.side.mesh->mesh().center();
  const Vec3d point = otgTransform(b.pose.transform, Vec3d{c.x, c.y, c.z});
  const bool byTransforms = (lastOfA || lastOfB) && (lastOfA || bodyA == nullptr) && (lastOfB || bodyB == nullptr);
  const auto velocityAt = [&](const Side& s, bool hasLast, dBodyID body) {
    if (byTransforms) {
      if (!hasLast) return Vec3d{0, 0, 0};
      const Vec3d own = otgRotateBack(s.pose.transform, otgSub(point, s.pose.transform.t));
      return otgSub(point, otgTransform(lastPoseOf(s.side), own));
    }
    if (body == nullptr) return Vec3d{0, 0, 0};
    dVector3 v;
    dBodyGetPointVel(body, static_cast<dReal>(point.x), static_cast<dReal>(point.y), static_cast<dReal>(point.z), v);
    return Vec3d{v[0], v[1], v[2]};
  };
  const Vec3d v = otgRotateBack(a.pose.transform, otgSub(velocityAt(a, lastOfA, bodyA), velocityAt(b, lastOfB, bodyB)));
  return std::isfinite(v.x + v.y + v.z) ? v : Vec3d{0, 0, 0};
}

void count(GeomStats& to, const PairCounts& from, std::size_t contacts) {
  const auto add = [](std::atomic<std::uint64_t>& sum, std::uint64_t n) {
    if (n != 0) sum.fetch_add(n, std::memory_order_relaxed);
  };
  add(to.boxTests, from.boxTests);
  add(to.candidatePairs, from.candidatePairs);
  add(to.intersectingPairs, from.intersectingPairs);
  add(to.decidedByDouble, from.decidedByDouble);
  add(to.decidedExactly, from.decidedExactly);
  add(to.contactsBeforeReduction, from.contactsBeforeReduction);
  add(to.contacts, contacts);
}

/// Anywhere for pieces of something.
WorldBox boxOf(const MeshGeom& side, const Transformd& pose) {
  // Of two pieces the triangles determine both.
  if (side.join != nullptr) return {};
  const Vec3f &low = side.mesh->mesh().boundsMin(), &high = side.mesh->mesh().boundsMax();
  return worldBox({low.x, low.y, low.z}, {high.x, high.y, high.z}, pose);
}

}  // namespace

bool isFarApart(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  const Vec3d centerA = toDouble(a.mesh().center());
  const Vec3d centerB = otgTransform(bInA, toDouble(b.mesh().center()));
  double stretch = 0;  // Frobenius: no less than the factor by which bInA can stretch, should it not be a rotation
  for (const double r : bInA.r) stretch += r * r;
  // Of both, so that it is the same whichever is A.
  const double reach =
      std::sqrt(stretch) * (static_cast<double>(a.mesh().radius()) + static_cast<double>(b.mesh().radius()));
  const double slack =
      1e-9 * (reach + norm(centerA) + norm(bInA.t) + std::sqrt(stretch) * norm(toDouble(b.mesh().center())));
  const double distance = norm(otgSub(centerB, centerA));
  return !(distance <= reach + slack) || !(reach + slack <= 1e30);
}

WorldBox boxOfSolid(const MeshGeom& side, const Transformd& pose) {
  return isSolid(side.mesh->mesh()) ? boxOf(side, pose) : WorldBox{};
}

void writeContact(const Contact& from, const ContactFrame& frame, void* to) {
  const bool first = frame.first;
  const auto within = [](double x, double low, double high) { return low <= high ? std::clamp(x, low, high) : x; };
  Vec3d position = otgTransform(frame.poseOfA, from.position);
  position = {within(position.x, frame.within.low.x, frame.within.high.x),
              within(position.y, frame.within.low.y, frame.within.high.y),
              within(position.z, frame.within.low.z, frame.within.high.z)};
  Vec3d normal = otgRotate(frame.poseOfA, from.normal);
  // ODE lets rotation matrices drift a little; the contact joint takes the length of the normal for granted.
  const double scale = (first ? 1.0 : -1.0) / norm(normal);
  normal = otgScale(normal, scale);
  const auto fill = [&](dContactGeom& contact) {
    contact.pos[0] = static_cast<dReal>(position.x);
    contact.pos[1] = static_cast<dReal>(position.y);
    contact.pos[2] = static_cast<dReal>(position.z);
    contact.normal[0] = static_cast<dReal>(normal.x);
    contact.normal[1] = static_cast<dReal>(normal.y);
    contact.normal[2] = static_cast<dReal>(normal.z);
    contact.depth = static_cast<dReal>(std::max(from.depth, 0.0));
    contact.g1 = frame.o1;
    contact.g2 = frame.o2;
    contact.side1 = static_cast<int>(first ? from.triangleA : from.triangleB);
    contact.side2 = static_cast<int>(first ? from.triangleB : from.triangleA);
  };
  if (std::bit_cast<std::uintptr_t>(to) % alignof(dContactGeom) == 0) {
    fill(*new (to) dContactGeom{});
    return;
  }
  dContactGeom contact{};
  fill(contact);
  std::memcpy(to, &contact, sizeof(contact));
}

bool isUnimportant(int flags) {
  return (static_cast<unsigned>(flags) & CONTACTS_UNIMPORTANT) != 0;
}

Transformd relativePose(const Transformd& a, const Transformd& b) {
  Transformd result{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      result.r[3 * i + j] = a.r[i] * b.r[j] + a.r[3 + i] * b.r[3 + j] + a.r[6 + i] * b.r[6 + j];
    }
  }
  result.t = otgRotateBack(a, otgSub(b.t, a.t));
  return result;
}

CollideOptions pairOptions(const dGpuTriMeshParams& first, const dGpuTriMeshParams& second) {
  CollideOptions options;
  switch (first.traversal) {
    case dGPUTRIMESH_TRAVERSAL_QUANTIZED:
      options.middle.traversal = Traversal::kQuantized;
      break;
    case dGPUTRIMESH_TRAVERSAL_NO_LEAF:
      options.middle.traversal = Traversal::kNoLeaf;
      break;
    case dGPUTRIMESH_TRAVERSAL_STANDARD:
      options.middle.traversal = Traversal::kStandard;
      break;
    default:
      options.middle.traversal = Traversal::kWide;
      break;
  }
  switch (first.descent) {
    case dGPUTRIMESH_DESCENT_FIRST_TREE:
      options.middle.descent = DescentRule::kFirstTreeFirst;
      break;
    case dGPUTRIMESH_DESCENT_ALTERNATING:
      options.middle.descent = DescentRule::kAlternating;
      break;
    case dGPUTRIMESH_DESCENT_BOTH:
      options.middle.descent = DescentRule::kBoth;
      break;
    default:
      options.middle.descent = DescentRule::kLargerFirst;
      break;
  }
  options.middle.axes = first.box_axes;
  options.middle.maxPairs = std::min(first.max_pairs, second.max_pairs);
  // AUTO gives way to the other's choice; it stands for `solid`, which has shells beside solids.
  const bool pairwise =
      first.contact_model == dGPUTRIMESH_CONTACTS_PAIRWISE || second.contact_model == dGPUTRIMESH_CONTACTS_PAIRWISE;
  options.contacts = pairwise ? ContactModel::kPairwise : ContactModel::kSolid;
  switch (std::min(first.reduction, second.reduction)) {
    case dGPUTRIMESH_REDUCTION_NONE:
      options.reduction.method = Reduction::kNone;
      break;
    case dGPUTRIMESH_REDUCTION_CONE:
      options.reduction.method = Reduction::kCone;
      break;
    default:
      options.reduction.method = Reduction::kBinning;
      break;
  }
  for (std::size_t i = 0; i < 6; ++i) options.reduction.bins[i] = std::max(first.bins[i], second.bins[i]);
  options.maxContacts = std::min(first.max_contacts, second.max_contacts);
  options.solid.contactsPerRegion = std::min(first.contacts_per_region, second.contacts_per_region);
  options.solid.regionMerge = std::min(first.region_merge, second.region_merge);
  options.solid.convexPath = true;
  return options;
}

Placement pairPlacement(const dGpuTriMeshParams& first, const dGpuTriMeshParams& second, Placement process) {
  const auto one = [](int phase, int backend, Place ofProcess) {
    switch (phase != dGPUTRIMESH_BACKEND_DEFAULT ? phase : backend) {
      case dGPUTRIMESH_BACKEND_AUTO:
        return Place::kAuto;
      case dGPUTRIMESH_BACKEND_CPU:
        return Place::kCpu;
      case dGPUTRIMESH_BACKEND_OPENCL:
        return Place::kOpencl;
      default:
        return ofProcess;
    }
  };
  const auto both = [](Place x, Place y) {
    for (const Place place : {Place::kCpu, Place::kOpencl}) {
      if (x == place || y == place) return place;
    }
    return Place::kAuto;
  };
  return {
      both(one(first.middle_phase, first.backend, process.middle),
           one(second.middle_phase, second.backend, process.middle)),
      both(one(first.near_phase, first.backend, process.near), one(second.near_phase, second.backend, process.near))};
}

void preparePair(MeshGeom&& from1, MeshGeom&& from2, PairTask& task) noexcept {
  PairPoses poses{readPose(from1.geom), readPose(from2.geom), false};
  preparePair(std::move(from1), std::move(from2), poses, task);
}

void preparePair(MeshGeom&& from1, MeshGeom&& from2, PairPoses& poses, PairTask& task) noexcept {
  task.side1 = std::move(from1);
  task.side2 = std::move(from2);
  task.state = PairTask::State::kNothing;
  const CollisionMesh *const mesh1 = task.side1.mesh, *const mesh2 = task.side2.mesh;
  if (mesh1 == nullptr || mesh2 == nullptr || mesh1->tree().nodes.empty() || mesh2->tree().nodes.empty()) return;
  const Side side1{task.side1, poses.first}, side2{task.side2, poses.second};
  // Each by itself: a scale of 2 and one of 1/2 make a relative pose that looks rigid.
  if (!side1.pose.rigid || !side2.pose.rigid) {
    task.state = PairTask::State::kBadPose;
    return;
  }
  const JoinedPart &part1 = task.side1.object->joined, &part2 = task.side2.object->joined;
  if (part1.join != nullptr || part2.join != nullptr) {
    if (part1.join == part2.join && !part1.join->isBroken) return;  // pieces of one surface
    const auto asks = [](const MeshGeom& side) { return callbacksOf(side.geom, *side.object).asked(); };
    if (!asks(task.side1) && !asks(task.side2)) {
      enterJoin(task.side1, side1.pose);
      enterJoin(task.side2, side2.pose);
    }
  }
  GeomObject &older = task.older(), &younger = task.younger();
  task.remembers = task.side1.object->remembersWith(dGeomGetClass(task.side2.geom)) &&
                   task.side2.object->remembersWith(dGeomGetClass(task.side1.geom));
  task.first = isFirstMeshA(task.side1, side1.pose.transform, task.side2, side2.pose.transform, task.remembers);
  const Side& a = task.first ? side1 : side2;
  const Side& b = task.first ? side2 : side1;
  task.poseOfA = a.pose.transform;
  task.poseOfB = b.pose.transform;
  Query& query = task.job.query;
  query.a = a.side.mesh;
  query.b = b.side.mesh;
  query.bInA = relativePose(a.pose.transform, b.pose.transform);
  if (!poses.areNear && isFarApart(*query.a, *query.b, query.bInA)) return;
  query.options = pairOptions(older.params, younger.params);
  task.job.place = pairPlacement(older.params, younger.params, dispatcher().placement());
  task.job.byLevels = older.params.traversal == dGPUTRIMESH_TRAVERSAL_LEVELS;
  query.relativeVelocity = relativeVelocity(a, b);
  task.stamp = 0;
  query.history = nullptr;
  task.state = PairTask::State::kReady;
}

bool needsHistory(const PairTask& task) {
  if (task.state != PairTask::State::kReady || !task.remembers) return false;
  // The other model makes nothing of it, but leaves what is there as it finds it.
  return task.job.query.options.contacts == ContactModel::kSolid ||
         task.younger().memory.stampOf(task.older().serial) != 0;
}

void recallPair(PairTask& task, SolidHistory& history) {
  task.stamp = task.younger().memory.recall(task.older().serial, history);
  if (task.stamp <= task.older().clearedAt) {  // it had to forget, and the younger one remembers
    history = {};
    task.stamp = 0;
  }
  task.job.query.history = &history;
}

void turnInward(PairTask& task) {
  Query& query = task.job.query;
  if (task.isJoined() || query.options.contacts != ContactModel::kSolid) return;
  const CollisionMesh &a = *query.a, &b = *query.b;
  if (a.turned() == nullptr && b.turned() == nullptr) return;
  const bool isGroundA = isGround(a.mesh(), b.mesh());
  const SolidHistory::State& before = task.sideBefore.emplace(stateBefore(query, kFarFromSide * smallerSize(query)));
  const CollisionMesh* ofA = a.turned();
  const CollisionMesh* ofB = b.turned();
  if (isGroundA) {
    ofA = bodyFromOutside(a, before, otgTransform(query.bInA, toDouble(b.mesh().center())));
  } else {
    ofB = bodyFromOutside(b, before, otgRotateBack(query.bInA, otgSub(toDouble(a.mesh().center()), query.bInA.t)));
  }
  task.isOutside = (isGroundA ? ofA : ofB) != nullptr;
  if (ofA != nullptr) (task.first ? task.side1 : task.side2).mesh = query.a = ofA;
  if (ofB != nullptr) (task.first ? task.side2 : task.side1).mesh = query.b = ofB;
}

std::uint64_t rememberPair(const PairTask& task, bool hasContacts) {
  GeomObject &older = task.older(), &younger = task.younger();
  if (task.sideBefore && task.job.query.history != nullptr) {
    if (task.isOutside) rememberOutside(task.job.query.bInA, *task.job.query.history);
    rememberSideBefore(*task.sideBefore, *task.job.query.history);
  }
  const SolidHistory* const history = task.usedHistory();
  // From which side a body comes to a shell is known only while the two are apart.
  const bool isOver = history != nullptr && !hasContacts && !task.hasLeftOut && !history->current.outlastsContacts();
  if (!task.remembers || isOver) {
    younger.memory.forget(older.serial);
    return 0;
  }
  if (history == nullptr) return task.stamp;
  return younger.memory.store(older.serial, *history, {0, 0, 0}, !task.isOlderA());
}

void countPair(const PairTask& task, const PairCounts& counts, std::size_t contacts, bool onDevice,
               bool deviceFailed) noexcept {
  for (GeomObject* object : {task.side1.object, task.side2.object}) {
    count(object->stats, counts, contacts);
    if (onDevice) object->stats.onDevice.fetch_add(1, std::memory_order_relaxed);
    if (deviceFailed) object->stats.deviceFailures.fetch_add(1, std::memory_order_relaxed);
  }
}

void fetchStats(const PairTask& task) noexcept {
  for (const GeomObject* object : {task.side1.object, task.side2.object}) {
    if (object == nullptr) continue;
    constexpr int kToWrite = 1;
    __builtin_prefetch(&object->stats, kToWrite);
    __builtin_prefetch(&object->stats.deviceFailures, kToWrite);
  }
}

void countFailure(const PairTask& task, int status) noexcept {
  noteStatus(status);
  for (GeomObject* object : {task.side1.object, task.side2.object}) {
    object->stats.failedQueries.fetch_add(1, std::memory_order_relaxed);
  }
}

void keepOwnContacts(PairTask& task, std::vector<Contact>& contacts) {
  const MeshGeom &a = task.sideA(), &b = task.sideB();
  const WorldBox boxOfA = boxOf(a, task.poseOfA), boxOfB = boxOf(b, task.poseOfB);
  if (keepOwn(a, 0, task.poseOfA, task.poseOfA, boxOfB, contacts)) task.hasLeftOut = true;
  if (keepOwn(b, 1, task.poseOfA, task.poseOfB, boxOfA, contacts)) task.hasLeftOut = true;
}

void writeContacts(const PairTask& task, std::span<const Contact> contacts, const ContactArray& to) {
  char* place = reinterpret_cast<char*>(to.first);
  char* dataPlace = reinterpret_cast<char*>(to.data);
  if (contacts.empty()) return;
  const WorldBox a = boxOfSolid(task.sideA(), task.poseOfA), b = boxOfSolid(task.sideB(), task.poseOfB);
  const ContactFrame frame{
      task.poseOfA, task.first, task.side1.geom, task.side2.geom, {maximum(a.low, b.low), minimum(a.high, b.high)}};
  for (const Contact& from : contacts) {
    writeContact(from, frame, place);
    place += to.skip;
    if (dataPlace == nullptr) continue;
    const dGpuTriMeshContactData known = contactData(task.job.query, from, task.first, task.isOlderA());
    std::memcpy(dataPlace, &known, sizeof known);
    dataPlace += to.dataSkip;
  }
}

}  // namespace otg
