// SPDX-License-Identifier: BSD-3-Clause
// What two meshes are to each other, and what their pair remembers from query to query.
#pragma once

#include <span>

#include "collide/query.h"

namespace otg {

/// Closed and oriented: it has an inside.
bool isSolid(const TriMesh& mesh);
/// A shell whose triangles agree in their winding and share edges by twos at most.
bool isSheet(const TriMesh& mesh);
/// Whether two meshes have contacts of the model `solid`, as long as their contour closes: two solids, or a solid with
/// a sheet.
bool haveSolidContacts(const TriMesh& a, const TriMesh& b);

/// How far A has moved relative to B since it was in a pose. In A's frame of now, at the middle of the smaller mesh:
/// where that turns, the middle of the other one would move far.
Vec3d motionSince(const Query& query, const Transformd& before);
/// Of the smaller mesh, and twice that.
double smallerRadius(const Query& query);
double smallerSize(const Query& query);

/// What a query starts from: what the pair remembers, as far as it still holds.
SolidHistory::State stateBefore(const Query& query);
/// The same with another size: what moves by a quarter of it has jumped.
SolidHistory::State stateBefore(const Query& query, double size);
/// The same where B is no mesh: by its middle in its own frame, and the size of the smaller one.
SolidHistory::State stateBefore(const SolidHistory& history, const Transformd& bInA, const Vec3d& middle, double size);
/// What is left of it one query later, if that finds nothing.
SolidHistory::State oneQueryLater(const SolidHistory::State& before);
/// Leaves what the query found in query.history, if there is one.
void keepState(const Query& query, const SolidHistory::State& before, SolidHistory::State state);

/// A number that changes with either of the two, the other one being given by its own.
std::uint64_t contentOf(const TriMesh& mesh, std::uint64_t other);

/// How deep a contact of `solid` can be, by what the pair remembers. Where a mesh has no inside, a contact may lead all
/// through the other one, as at a rim. The way back is shorter: it is no longer than the deepest contact of the last
/// query, and what the place of the contact has moved against its normal since.
class MotionLimit {
 public:
  /// No limit.
  MotionLimit() = default;
  explicit MotionLimit(const Query& query);
  /// Of a pair with what is no mesh: B's pose, and contentOf() the two.
  MotionLimit(const SolidHistory::State& before, const Transformd& bInA, std::uint64_t content);
  /// Infinity for two solids, and where the last query says nothing.
  double operator()(const Contact& contact) const;
  void cut(std::span<Contact> contacts) const;
  /// What cut() leaves as the largest depth, 0 without contacts.
  double deepest(std::span<const Contact> contacts) const;
  /// Whether cut() changes something.
  bool exceeds(std::span<const Contact> contacts) const;

 private:
  Transformd pose_{}, poseBefore_{};
  double deepestBefore_ = 0;
  bool isKnown_ = false;
};
/// Leaves MotionLimit::deepest() of the contacts in query.history, for the next query. After keepState(). Not of those
/// that are less deep because they contradict others: that may be over with the next query.
void keepDeepest(const Query& query, double deepest);
/// Cuts the contacts by MotionLimit, and keeps how deep the deepest is then.
void limitByMotion(const Query& query, std::span<Contact> contacts);

}  // namespace otg
