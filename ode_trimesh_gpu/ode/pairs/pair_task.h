// SPDX-License-Identifier: BSD-3-Clause
// Two geoms of our class as a query, and the way of its contacts back to ODE: what every way in to a collision shares.
#pragma once

#include <ode/collision.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dispatch/pair_job.h"
#include "ode/geom/mesh_join.h"
#include "ode/geom/mesh_side.h"
#include "ode_trimesh_gpu/contact_data.h"

namespace otg {

/// Where the contacts of a query go.
struct ContactArray {
  dContactGeom* first = nullptr;
  int skip = 0;                            ///< bytes from one element to the next
  dGpuTriMeshContactData* data = nullptr;  ///< null: the data of contacts go nowhere
  int dataSkip = 0;
};

/// How a contact in mesh A's frame becomes one of ODE's.
struct ContactFrame {
  Transformd poseOfA;  ///< A's frame to the world
  bool first;          ///< mesh A is o1's
  dGeomID o1, o2;
  /// Positions go to the nearest place of this, as far as it is not empty: the middle of an overlap may lie beside
  /// both bodies, outside of the box that one of them has in the world.
  WorldBox within{};
};

/// All of the world for shells, whose contacts may lie in the margin around them, and for pieces of something.
WorldBox boxOfSolid(const MeshGeom& side, const Transformd& pose);

/// Writes a dContactGeom as a whole structure of its own. So any skip and any alignment will do, and the caller's bytes
/// in between stay as they are. Triangles are the caller's numbers; kNone becomes -1.
void writeContact(const Contact& from, const ContactFrame& frame, void* to);

/// A pair of geoms at one moment. It stays as it is when they move; the objects have to live on.
struct PairTask {
  enum class State {
    kNothing,  ///< they cannot touch: a geom without triangles, or far apart
    kBadPose,  ///< a pose is not finite or not rigid
    kBusy,     ///< a geom or its data are being changed
    kReady     ///< `job` is to be done
  };
  MeshGeom side1, side2;
  State state = State::kNothing;
  bool first = false;       ///< mesh A is o1's
  Transformd poseOfA{};     ///< A's frame to the world
  Transformd poseOfB{};     ///< likewise
  PairJob job;              ///< maxContacts is what the geoms allow; job.query.history: see recallPair()
  std::uint64_t stamp = 0;  ///< of what was remembered, 0 for nothing
  bool remembers = false;   ///< both geoms remember pairs with the other's class
  bool isOutside = false;   ///< of the larger mesh, which turnInward() has turned round
  std::optional<SolidHistory::State> sideBefore;  ///< where a mesh is wound inward: what turnInward() has decided by
  bool hasLeftOut = false;  ///< the query had contacts that belong to other geoms: see keepOwnContacts()

  PairTask() = default;
  PairTask(const PairTask&) = delete;
  PairTask& operator=(const PairTask&) = delete;

  const MeshGeom& sideA() const { return first ? side1 : side2; }
  const MeshGeom& sideB() const { return first ? side2 : side1; }
  /// A geom is a piece of something, which the query is about.
  bool isJoined() const { return side1.join != nullptr || side2.join != nullptr; }
  /// Of the geom that was created first, and of the other one, which keeps what belongs to the pair.
  GeomObject& older() const { return side1.object->serial < side2.object->serial ? *side1.object : *side2.object; }
  GeomObject& younger() const { return side1.object->serial < side2.object->serial ? *side2.object : *side1.object; }
  bool isOlderA() const { return sideA().object == &older(); }
  /// What the query has made of what is remembered; null if nothing.
  const SolidHistory* usedHistory() const {
    const SolidHistory* const history = job.query.history;
    return history != nullptr && history->used ? history : nullptr;
  }
};

/// The lower 16 bits of the flags of dCollide: the number of places (ODE's own name for it is private). The flags as a
/// whole are negative when CONTACTS_UNIMPORTANT is set.
constexpr int capacityOf(int flags) {
  return flags & 0xffff;
}
bool isUnimportant(int flags);

/// Where b's frame lies in a's: R = Ra^T Rb, t = Ra^T (xb - xa), in double.
Transformd relativePose(const Transformd& a, const Transformd& b);

/// The choices for a pair out of those of its geoms; symmetric but for the traversal, which is `first`'s.
CollideOptions pairOptions(const dGpuTriMeshParams& first, const dGpuTriMeshParams& second);

/// Where the phases of a pair run: as both geoms want it, or else as the process does.
Placement pairPlacement(const dGpuTriMeshParams& first, const dGpuTriMeshParams& second, Placement process);

/// Reads poses, velocities and parameters of two geoms; sets everything but the history and what depends on the call:
/// `any` and `filter`.
void preparePair(MeshGeom&& side1, MeshGeom&& side2, PairTask& task) noexcept;
/// With poses that were read before. Pieces of a whole get the pose of that.
struct PairPoses {
  WorldPose first, second;
  bool areNear = false;  ///< the pair is known not to be far apart
};
void preparePair(MeshGeom&& side1, MeshGeom&& side2, PairPoses& poses, PairTask& task) noexcept;

/// Whether the bounding spheres are so far apart that nothing can touch. Keeps numbers that single precision can't hold
/// away from the filters, and decides far pairs (dCollide called without a space) at once.
bool isFarApart(const CollisionMesh& a, const CollisionMesh& b, const Transformd& bInA);

/// Whether a prepared pair has to be given a history by recallPair().
bool needsHistory(const PairTask& task);
/// What is remembered of the pair, which the query goes on with, in place of nothing: the object has to live as long as
/// the task is used.
void recallPair(PairTask& task, SolidHistory& history);
/// Puts the bodies that they are in place of meshes wound inward (inward_body.h). After recallPair(). The smaller one
/// is no room. Of the model `solid` alone. May throw std::bad_alloc.
void turnInward(PairTask& task);

/// What every collision leaves with its geoms, of contacts found or not: the history and the statistics. Returns the
/// stamp of what is remembered now, 0 for nothing. May throw std::bad_alloc.
std::uint64_t rememberPair(const PairTask& task, bool hasContacts);
void countPair(const PairTask& task, const PairCounts& counts, std::size_t contacts, bool onDevice,
               bool deviceFailed) noexcept;
/// Prefetches the statistics that countPair() changes.
void fetchStats(const PairTask& task) noexcept;
/// A query that found nothing because it failed; the status becomes the thread's last error.
void countFailure(const PairTask& task, int status) noexcept;

/// Of a pair that isJoined(): takes out what belongs to other geoms.
void keepOwnContacts(PairTask& task, std::vector<Contact>& contacts);

/// To ODE's contacts, in the world, in the order of the call.
void writeContacts(const PairTask& task, std::span<const Contact> contacts, const ContactArray& to);

}  // namespace otg
