// SPDX-License-Identifier: BSD-3-Clause
// One pair of meshes among many: what is requested, where it may be computed, and the result.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "collide/query.h"

namespace otg {

/// Where a phase of a query runs. kAuto: where the other phase is said to run; if neither is, where it is expected to
/// be done sooner.
enum class Place : std::uint8_t { kAuto, kCpu, kOpencl };

/// Aligned to its size: only then does Clang make std::atomic of it without calls into libatomic.
struct alignas(2) Placement {
  Place middle = Place::kAuto, near = Place::kAuto;
  friend bool operator==(const Placement&, const Placement&) = default;
};

/// Whether either side may do it.
constexpr bool isOpenToAll(const Placement& place) {
  return place.middle == Place::kAuto && place.near == Place::kAuto;
}

/// Has a say in which triangles collide. Called by the thread that collides the pair.
class PairFilter {
 public:
  virtual ~PairFilter() = default;
  /// Between the near phase and the contacts: may take pairs out of workspace.intersecting. Returns whether it did.
  virtual bool dropPairs(const Query& query, Workspace& workspace) = 0;
  /// At the end, when workspace.reduced is numbered as callers number triangles: may take contacts out and give them
  /// other numbers.
  virtual void finish(const Query& query, Workspace& workspace) = 0;
};

struct PairJob {
  /// query.history, if any, is this job's alone.
  Query query;
  /// The first contacts found, without choosing between them: ODE's CONTACTS_UNIMPORTANT.
  bool any = false;
  Placement place;
  /// Null: none. Jobs that have one are not for batches, whose threads are not the caller's.
  PairFilter* filter = nullptr;
  /// A middle phase on a device is that of the published traversal by levels, one pair at a time.
  bool byLevels = false;
};

/// CollideStats without what only profiles need.
struct PairCounts {
  std::uint64_t boxTests = 0, candidatePairs = 0, intersectingPairs = 0, decidedByDouble = 0, decidedExactly = 0,
                contactsBeforeReduction = 0;
  PairCounts() = default;
  explicit PairCounts(const CollideStats& s)
      : boxTests(s.boxTests),
        candidatePairs(s.candidatePairs),
        intersectingPairs(s.intersectingPairs),
        decidedByDouble(s.decidedByDouble),
        decidedExactly(s.decidedExactly),
        contactsBeforeReduction(s.contactsBeforeReduction) {}
  PairCounts& operator+=(const PairCounts& o) {
    boxTests += o.boxTests;
    candidatePairs += o.candidatePairs;
    intersectingPairs += o.intersectingPairs;
    decidedByDouble += o.decidedByDouble;
    decidedExactly += o.decidedExactly;
    contactsBeforeReduction += o.contactsBeforeReduction;
    return *this;
  }
};

struct PairResult {
  std::span<const Contact> contacts;   ///< as otg::collide leaves them in Workspace::reduced
  std::shared_ptr<const void> memory;  ///< what they lie in; null for none, and where they lie in a batch's memory
  PairCounts counts;                   ///< of what a device did in a batch only what it counts for each pair
  enum class Outcome : std::uint8_t { kDone, kRefused, kNoMemory } outcome = Outcome::kDone;
  bool onDevice = false;      ///< a device did its middle phase, near phase or both
  bool deviceFailed = false;  ///< one was to, and failed: the CPU did it
};

/// A job of a batch, and where its result goes.
struct PairWork {
  const PairJob* job;
  PairResult* result;
};

/// What a batch leaves besides its results.
struct BatchEnd {
  PairCounts counts;  ///< of all jobs together
  /// What contacts of results lie in that have no memory of their own: one share of it for all of them, because
  /// counting thousands of shares keeps threads waiting for each other. To be kept as long as they are read.
  std::vector<std::shared_ptr<const void>> memory;
};

/// Gives the result contacts of its own: copies of these, which may be those that it has.
inline void keepContacts(PairResult& result, std::span<const Contact> contacts) {
  std::shared_ptr<const std::vector<Contact>> own;
  if (!contacts.empty()) own = std::make_shared<const std::vector<Contact>>(contacts.begin(), contacts.end());
  result.contacts = own ? std::span<const Contact>(*own) : std::span<const Contact>();
  result.memory = std::move(own);
}

}  // namespace otg
