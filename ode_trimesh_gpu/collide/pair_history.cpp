// SPDX-License-Identifier: BSD-3-Clause
#include "collide/pair_history.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hash.h"
#include "base/same_bits.h"
#include "base/vectors.h"

namespace otg {
namespace {

/// By more than 60 degrees.
bool hasTurnedFar(const Transformd& from, const Transformd& to) {
  double trace = 0;  // of the rotation between the two: 1 + 2 cos
  for (int i = 0; i < 9; ++i) trace += from.r[i] * to.r[i];
  return trace < 2;
}

/// In A's frame.
Vec3d motionOfB(const Transformd& before, const Transformd& now, const Vec3d& middle) {
  return otgTransform(now, middle) - otgTransform(before, middle);
}

SolidHistory::State rememberedAt(const SolidHistory& history, const Transformd& bInA) {
  return sameBits(history.current.pose, bInA) ? history.before : history.current;
}

/// A pair that jumped was put there, it did not move: what it did before says nothing. The direction of a deep overlap
/// is worth keeping only while the overlap is nearly the same.
void forgetAfter(double moved, double size, const Transformd& bInA, SolidHistory::State& state) {
  if (moved > 0.05 * size) state.deepNormal = {0, 0, 0};
  if (moved > 0.25 * size || hasTurnedFar(state.pose, bInA)) state = {};
}

std::uint64_t contentOf(const Query& query) {
  return contentOf(query.a->mesh(), query.b->mesh().contentHash());
}

bool isLimitedByMotion(const Query& query) {
  return query.history != nullptr && query.options.contacts == ContactModel::kSolid &&
         !(isSolid(query.a->mesh()) && isSolid(query.b->mesh()));
}

}  // namespace

std::uint64_t contentOf(const TriMesh& mesh, std::uint64_t other) {
  return spreadBits(mesh.contentHash()) ^ other;
}

bool isSolid(const TriMesh& mesh) {
  return mesh.meshClass() == MeshClass::kSolid;
}

Vec3d motionSince(const Query& query, const Transformd& before) {
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  const Transformd& now = query.bInA;
  const Vec3f& middle = b.radius() <= a.radius() ? b.center() : a.center();
  const Vec3d c{middle.x, middle.y, middle.z};
  if (b.radius() <= a.radius()) return motionOfB(before, now, c) * -1.0;
  const Vec3d was = otgRotateBack(before, c - before.t), is = otgRotateBack(now, c - now.t);
  return otgRotate(now, is - was);
}

double smallerRadius(const Query& query) {
  return std::min(query.a->mesh().radius(), query.b->mesh().radius());
}

double smallerSize(const Query& query) {
  return 2 * smallerRadius(query);
}

SolidHistory::State stateBefore(const Query& query) {
  return stateBefore(query, smallerSize(query));
}

SolidHistory::State stateBefore(const Query& query, double size) {
  if (!query.history || !query.history->used) return {};
  SolidHistory::State state = rememberedAt(*query.history, query.bInA);
  if (state.hasPose) forgetAfter(norm(motionSince(query, state.pose)), size, query.bInA, state);
  return state;
}

SolidHistory::State stateBefore(const SolidHistory& history, const Transformd& bInA, const Vec3d& middle, double size) {
  if (!history.used) return {};
  SolidHistory::State state = rememberedAt(history, bInA);
  if (state.hasPose) forgetAfter(norm(motionOfB(state.pose, bInA, middle)), size, bInA, state);
  return state;
}

SolidHistory::State oneQueryLater(const SolidHistory::State& before) {
  SolidHistory::State state = before;
  state.escapeLeft = std::max(0, state.escapeLeft - 1);
  state.isJammed = state.isJammed && state.escapeLeft > 0;
  state.clampLeft = std::max(0, state.clampLeft - 1);
  state.deepNormal = {0, 0, 0};
  return state;
}

void keepState(const Query& query, const SolidHistory::State& before, SolidHistory::State state) {
  if (!query.history) return;
  state.pose = query.bInA;
  state.hasPose = true;
  state.deepest = -1;
  state.content = 0;
  query.history->before = before;
  query.history->current = state;
  query.history->used = true;
}

MotionLimit::MotionLimit(const Query& query) {
  if (isLimitedByMotion(query)) *this = MotionLimit(stateBefore(query), query.bInA, contentOf(query));
}

MotionLimit::MotionLimit(const SolidHistory::State& before, const Transformd& bInA, std::uint64_t content)
    : pose_(bInA),
      poseBefore_(before.pose),
      deepestBefore_(before.deepest),
      isKnown_(before.hasPose && before.deepest >= 0 && before.content == content) {}

double MotionLimit::operator()(const Contact& contact) const {
  if (!isKnown_) return std::numeric_limits<double>::infinity();
  const Vec3d ofB = otgRotateBack(pose_, otgSub(contact.position, pose_.t));
  const Vec3d moved = otgSub(contact.position, otgTransform(poseBefore_, ofB));
  return deepestBefore_ + std::max(0.0, otgDot(contact.normal, moved));
}

void MotionLimit::cut(std::span<Contact> contacts) const {
  if (!isKnown_) return;
  for (Contact& contact : contacts) cutDepth(contact, (*this)(contact));
}

double MotionLimit::deepest(std::span<const Contact> contacts) const {
  double deepest = 0;
  for (const Contact& contact : contacts) deepest = std::max(deepest, std::min(contact.depth, (*this)(contact)));
  return deepest;
}

bool MotionLimit::exceeds(std::span<const Contact> contacts) const {
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& c) { return c.depth > (*this)(c); });
}

void keepDeepest(const Query& query, double deepest) {
  if (!isLimitedByMotion(query)) return;
  query.history->current.deepest = deepest;
  query.history->current.content = contentOf(query);
}

void limitByMotion(const Query& query, std::span<Contact> contacts) {
  const MotionLimit limit(query);
  keepDeepest(query, limit.deepest(contacts));
  limit.cut(contacts);
}

bool isSheet(const TriMesh& mesh) {
  return !isSolid(mesh) && mesh.triangleCount() > 0 && mesh.report().inconsistentEdges == 0 &&
         mesh.report().nonManifoldEdges == 0;
}

bool haveSolidContacts(const TriMesh& a, const TriMesh& b) {
  return (isSolid(a) && (isSolid(b) || isSheet(b))) || (isSheet(a) && isSolid(b));
}

}  // namespace otg
