// SPDX-License-Identifier: BSD-3-Clause
// From dCollide to a query in mesh A's frame, and from its contacts back to ODE's.
#include "ode/mesh_collider.h"

#include <ode/objects.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "ode/class_registration.h"
#include "ode/geom_class.h"
#include "ode/status.h"

namespace otg {
namespace {

/// The lower 16 bits of the flags are the number of places in the caller's array (ODE's own name for it is private).
/// The flags as a whole are negative when CONTACTS_UNIMPORTANT is set.
constexpr int kCapacityMask = 0xffff;

/// Workspaces that the calling thread has made so far. More than one is in use only where a collision runs inside
/// another one of the same thread.
struct ThreadScratch {
  std::vector<std::unique_ptr<Workspace>> workspaces;
  std::size_t inUse = 0;
};
thread_local ThreadScratch scratch;

class WorkspaceLease {
 public:
  WorkspaceLease() {
    if (scratch.inUse == scratch.workspaces.size()) scratch.workspaces.push_back(std::make_unique<Workspace>());
    workspace_ = scratch.workspaces[scratch.inUse++].get();
  }
  ~WorkspaceLease() { --scratch.inUse; }
  WorkspaceLease(const WorkspaceLease&) = delete;
  WorkspaceLease& operator=(const WorkspaceLease&) = delete;
  Workspace& operator*() const { return *workspace_; }

 private:
  Workspace* workspace_;
};

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
double length(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}

/// Whether the bounding spheres are so far apart that nothing can touch. Keeps numbers that single precision can't hold
/// away from the filters, and answers far pairs (dCollide called without a space) at once.
bool isFarApart(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA) {
  const Vec3d centerA = toDouble(a.mesh().center());
  const Vec3d centerB = otgTransform(bInA, toDouble(b.mesh().center()));
  double norm = 0;  // Frobenius: no less than the factor by which bInA can stretch, should it not be a rotation
  for (const double r : bInA.r) norm += r * r;
  const double reach =
      static_cast<double>(a.mesh().radius()) + std::sqrt(norm) * static_cast<double>(b.mesh().radius());
  const double slack =
      1e-9 * (reach + length(centerA) + length(bInA.t) + std::sqrt(norm) * length(toDouble(b.mesh().center())));
  const double distance = length(otgSub(centerB, centerA));
  return !(distance <= reach + slack) || !(reach + slack <= 1e30);
}

struct Side {
  dGeomID geom;
  GeomObject* object;
  WorldPose pose;
};

/// Velocity of A's body relative to B's at the middle of B's mesh, in A's frame. ODE's velocities are the world's.
Vec3d relativeVelocity(const Side& a, const Side& b) {
  const Vec3f& c = b.object->mesh()->mesh().center();
  const Vec3d point = otgTransform(b.pose.transform, Vec3d{c.x, c.y, c.z});
  const auto velocityAt = [&](dGeomID geom) {
    const dBodyID body = dGeomGetBody(geom);
    if (body == nullptr) return Vec3d{0, 0, 0};
    dVector3 v;
    dBodyGetPointVel(body, static_cast<dReal>(point.x), static_cast<dReal>(point.y), static_cast<dReal>(point.z), v);
    return Vec3d{v[0], v[1], v[2]};
  };
  const Vec3d v = otgRotateBack(a.pose.transform, otgSub(velocityAt(a.geom), velocityAt(b.geom)));
  return std::isfinite(v.x + v.y + v.z) ? v : Vec3d{0, 0, 0};
}

/// Runs the query and leaves the contacts, best first and at most `capacity`, in the workspace.
std::span<const Contact> run(const Query& query, bool unimportant, int capacity, Workspace& workspace) {
  if (!unimportant) {
    collide(query, workspace);
    return workspace.reduced;
  }
  // "Just generate any contacts": the first ones, without choosing.
  findIntersectingPairs(query, workspace);
  pairwiseContacts(query, workspace);
  if (workspace.contacts.empty() && query.options.contacts == ContactModel::kSolid) {  // perhaps one inside the other
    collide(query, workspace);
    return workspace.reduced;
  }
  const std::size_t count = std::min(workspace.contacts.size(), static_cast<std::size_t>(capacity));
  const std::span<Contact> any = std::span<Contact>(workspace.contacts).first(count);
  for (Contact& contact : any) {  // collide() does this for its own
    contact.triangleA = query.a->mesh().callerTriangle(contact.triangleA);
    contact.triangleB = query.b->mesh().callerTriangle(contact.triangleB);
  }
  return any;
}

/// `first` says whether mesh A is o1. Elements are written as whole structures of their own, so that any skip and any
/// alignment will do and the caller's bytes in between stay as they are.
void writeContact(const Contact& from, const Side& a, bool first, dGeomID o1, dGeomID o2, char* to) {
  const Vec3d position = otgTransform(a.pose.transform, from.position);
  Vec3d normal = otgRotate(a.pose.transform, from.normal);
  // ODE lets rotation matrices drift a little; the contact joint takes the length of the normal for granted.
  const double scale = (first ? 1.0 : -1.0) / length(normal);
  normal = otgScale(normal, scale);
  dContactGeom contact{};
  contact.pos[0] = static_cast<dReal>(position.x);
  contact.pos[1] = static_cast<dReal>(position.y);
  contact.pos[2] = static_cast<dReal>(position.z);
  contact.normal[0] = static_cast<dReal>(normal.x);
  contact.normal[1] = static_cast<dReal>(normal.y);
  contact.normal[2] = static_cast<dReal>(normal.z);
  contact.depth = static_cast<dReal>(std::max(from.depth, 0.0));
  contact.g1 = o1;
  contact.g2 = o2;
  contact.side1 = static_cast<int>(first ? from.triangleA : from.triangleB);
  contact.side2 = static_cast<int>(first ? from.triangleB : from.triangleA);
  std::memcpy(to, &contact, sizeof(contact));
}

bool remembers(const dGpuTriMeshParams& params) {
  return params.history == dGPUTRIMESH_HISTORY_ON;
}

void count(GeomStats& to, const CollideStats& from, std::size_t contacts) {
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

}  // namespace

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
  // AUTO gives way to the other's choice; it stands for `solid`, which falls back to `pairwise` for shells by itself.
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
  return options;
}

int collideMeshMesh(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip) noexcept {
  return collideMeshes(o1, o2, flags, contact, skip, {});
}

int collideMeshes(dGeomID o1, dGeomID o2, int flags, dContactGeom* contact, int skip,
                  const ContactDataArray& data) noexcept {
  GeomObject* const object1 = objectOf(o1);
  GeomObject* const object2 = objectOf(o2);
  if (object1 == nullptr || object2 == nullptr) {
    answerProbe();
    return 0;
  }
  int capacity = flags & kCapacityMask;
  if (contact == nullptr || capacity == 0) return 0;
  // A skip that makes elements overlap is an error of the caller's; the first element is there in any case.
  if (skip < static_cast<int>(sizeof(dContactGeom))) capacity = 1;

  for (GeomObject* object : {object1, object2}) object->stats.queries.fetch_add(1, std::memory_order_relaxed);
  const auto failed = [&](int status) {
    noteStatus(status);
    for (GeomObject* object : {object1, object2}) object->stats.failedQueries.fetch_add(1, std::memory_order_relaxed);
    return 0;
  };
  const CollisionMesh* const mesh1 = object1->mesh();
  const CollisionMesh* const mesh2 = object2->mesh();
  if (mesh1 == nullptr || mesh2 == nullptr || mesh1->tree().nodes.empty() || mesh2->tree().nodes.empty()) return 0;
  const Side side1{o1, object1, readPose(o1)};
  const Side side2{o2, object2, readPose(o2)};
  // Each by itself: a scale of 2 and one of 1/2 make a relative pose that looks rigid.
  if (!side1.pose.rigid || !side2.pose.rigid) return failed(dGPUTRIMESH_ERROR_POSE);

  try {
    const bool first = object1->serial < object2->serial;  // mesh A is o1
    const Side& a = first ? side1 : side2;
    const Side& b = first ? side2 : side1;
    Query query;
    query.a = a.object->mesh();
    query.b = b.object->mesh();
    query.bInA = relativePose(a.pose.transform, b.pose.transform);
    if (isFarApart(*query.a, *query.b, query.bInA)) return 0;
    query.options = pairOptions(a.object->params, b.object->params);
    capacity = std::min(capacity, query.options.maxContacts);
    query.options.maxContacts = capacity;

    query.relativeVelocity = relativeVelocity(a, b);
    SolidHistory history;
    if (remembers(a.object->params) && remembers(b.object->params)) {
      history = b.object->memory.recall(a.object->serial);
      query.history = &history;
    } else {
      b.object->memory.forget(a.object->serial);
    }

    const WorkspaceLease lease;
    Workspace& workspace = *lease;
    const bool unimportant = (static_cast<unsigned>(flags) & CONTACTS_UNIMPORTANT) != 0;
    const std::span<const Contact> contacts = run(query, unimportant, capacity, workspace);
    if (contacts.empty()) {
      if (history.used) b.object->memory.forget(a.object->serial);
    } else if (history.used) {
      b.object->memory.store(a.object->serial, history);
    }
    char* to = reinterpret_cast<char*>(contact);
    char* dataTo = reinterpret_cast<char*>(data.first);
    for (const Contact& from : contacts) {
      writeContact(from, a, first, o1, o2, to);
      to += skip;
      if (dataTo == nullptr) continue;
      const dGpuTriMeshContactData known = contactData(query, from, first);
      std::memcpy(dataTo, &known, sizeof known);
      dataTo += data.skip;
    }
    for (GeomObject* object : {object1, object2}) count(object->stats, workspace.stats, contacts.size());
    return static_cast<int>(contacts.size());
  } catch (...) {
    // Only want of memory throws: the query's pose is made of two that were found rigid. ODE's space would stay locked
    // for ever if we let it through.
    return failed(dGPUTRIMESH_ERROR_MEMORY);
  }
}

void freeThreadScratch() noexcept {
  if (scratch.inUse == 0) scratch.workspaces.clear();
}

}  // namespace otg
