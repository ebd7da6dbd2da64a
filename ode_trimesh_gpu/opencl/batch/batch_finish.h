// SPDX-License-Identifier: BSD-3-Clause
// What is made of the pairs of a batch that a device has been through, and the CPU's share of the work.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "collide/consistent_contacts.h"
#include "collide/pair_history.h"
#include "collide/solid/look_ahead.h"
#include "collide/stages.h"
#include "opencl/backend.h"
#include "opencl/batch/routing.h"
#include "opencl/batch/workspace_pool.h"
#include "opencl/lanes/batch_lane.h"
#include "opencl/lanes/take_answer.h"
#include "opencl/results/take_records.h"
#include "opencl/run_parts.h"

namespace otg::opencl {

inline void addStats(CollideStats& sums, const CollideStats& s) {
  sums.boxTests += s.boxTests;
  sums.candidatePairs += s.candidatePairs;
  sums.decidedByDouble += s.decidedByDouble;
  sums.intersectingPairs += s.intersectingPairs;
  sums.decidedExactly += s.decidedExactly;
  sums.contactsBeforeReduction += s.contactsBeforeReduction;
}

/// Contacts of pairs, most of them where the device put them.
struct ContactFinish {
  Backend& backend;
  std::atomic<std::uint64_t>& queries;
  BatchAnswer& answer;
  WorkspacePool& workspaces;
  Workspace workspace{};
  const RunParts* onHost = nullptr;  ///< does the CPU's work, if it is there

  void chunk(std::size_t begin, std::size_t count, const BatchFound& found) {
    answer.addQueries(count);
    for (const BatchFound::Contacts& part : found.contacts) {
      answer.addPart(begin, count, part.places, part.contacts, part.memory);
    }
    if (found.counters == nullptr) return;
    CollideStats device;
    const Answer counted{found.counters, nullptr, 0, 0};
    takeCounts(counted, device);
    device.intersectingPairs = found.counters[OTG_COUNT_INTERSECTING];
    device.contactsBeforeReduction = found.counters[OTG_COUNT_CONTACTS];
    device.decidedExactly = found.decidedExactly;
    addStats(answer.stats, device);
  }

  void refuse(std::size_t i) { answer.refused.push_back(i); }

  template <class QueryOf, class RecordsOf>
  void records(const std::vector<std::size_t>& which, const Answer& found, const QueryOf& queryOf,
               const RecordsOf& recordsOf) {
    answer.leftToHost += which.size();
    // Those with most to do first, so that in the end no thread is long at work alone.
    std::vector<std::size_t> order = which;
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return recordsOf(i).size(); });
    share(order, [&](std::size_t k, Workspace& own) {
      collideFromRecords(queryOf(order[k]), found, recordsOf(order[k]), own);
      return true;
    });
  }

  /// Whether there are threads that have nothing to do while the device is at work.
  bool hasThreads() const { return onHost != nullptr; }
  /// So many of the CPU's pairs are for withoutDevice() at the end.
  void putOff(std::size_t count) { answer.leftToHost += count; }
  /// What the CPU makes of a pair.
  struct Done {
    bool good = false;
    std::vector<Contact> contacts{};
    CollideStats stats{};
  };
  /// Pairs that the device will leave, while it does the others.
  template <class QueryOf>
  std::vector<Done> meanwhile(const std::vector<std::size_t>& which, const QueryOf& queryOf) {
    return make(which.size(), [&](std::size_t k, Workspace& own) {
      collide(queryOf(which[k]), own);
      return true;
    });
  }
  void keepLeft(std::size_t i, const Done& done) {
    ++answer.leftToHost;
    answer.byHost.push_back(i);
    keep(i, done.stats, done.contacts);
  }

  static constexpr bool kTakesDescriptions = true;
  static constexpr bool kLargeAlone = true;
  /// Those that the CPU sees in another way than the device.
  template <class QueryOf, class FoundOf>
  std::vector<std::size_t> described(const std::vector<std::size_t>& which, const QueryOf& queryOf,
                                     const FoundOf& foundOf) {
    return share(which,
                 [&](std::size_t k, Workspace& own) { return takeDescribed(queryOf(which[k]), foundOf(k), own); });
  }

  /// The same where contacts of large regions are made; and those that were left.
  template <class QueryOf, class FoundOf>
  std::vector<std::size_t> made(const std::vector<std::size_t>& which, const QueryOf& queryOf, const FoundOf& foundOf) {
    return share(which, [&](std::size_t k, Workspace& own) { return takeMade(queryOf(which[k]), foundOf(k), own); });
  }

  /// Devices make contacts of `solid` of what is touched. The device finds which of such pairs (`waiting`) meet more on
  /// the way that their contacts request; of these the CPU looks ahead. Where there was no room for all contacts,
  /// their way is not known, and the CPU makes them again. False if the device failed.
  template <class QueryOf>
  bool lookAhead(const std::vector<std::size_t>& waiting, const QueryOf& queryOf) {
    std::vector<PosedMeshes> ahead(waiting.size());
    std::vector<Way> ways(waiting.size());
    inParts(waiting.size(), [&](std::size_t begin, std::size_t end) {
      const WorkspacePool::Lease own(workspaces);
      for (std::size_t k = begin; k < end; ++k) {
        const Query query = queryOf(waiting[k]);
        const std::span<const Contact> contacts = answer.of(waiting[k]);
        const std::optional<Transformd> pose = poseAhead(query, contacts, *own);
        const bool isWhole = contacts.size() < static_cast<std::size_t>(query.options.maxContacts);
        ways[k] = !isWhole ? Way::kUnknown : pose ? Way::kKnown : Way::kNone;
        ahead[k] = {query.a, query.b, pose.value_or(query.bInA)};
      }
    });
    std::vector<std::size_t> asked, again;
    std::vector<const PosedMeshes*> pairs;
    for (std::size_t k = 0; k < waiting.size(); ++k) {
      if (ways[k] == Way::kUnknown) again.push_back(k);
      if (ways[k] != Way::kKnown) continue;
      asked.push_back(k);
      pairs.push_back(&ahead[k]);
    }
    std::vector<std::uint8_t> meets;
    const bool good = backend.intersectBatch(std::span<const PosedMeshes* const>(pairs), meets, nullptr,
                                             onHost ? *onHost : RunParts{});
    queries -= pairs.size();  // no caller requested these
    for (std::size_t j = 0; j < asked.size(); ++j) {
      if (meets[j] != 0) again.push_back(asked[j]);
    }
    const std::vector<Done> done = make(again.size(), [&](std::size_t j, Workspace& own) {
      const std::size_t i = waiting[again[j]];
      if (ways[again[j]] == Way::kKnown) {
        addAhead(queryOf(i), answer.of(i), own);
      } else {
        collide(queryOf(i), own);
      }
      return true;
    });
    // The device's counts of these pairs stay: it had all but what lies on the way.
    for (std::size_t j = 0; j < again.size(); ++j) {
      answer.stats.contactsBeforeReduction += done[j].stats.contactsAhead;
      answer.add(waiting[again[j]], done[j].contacts);
    }
    answer.leftToHost += again.size();
    answer.madeAgain += again.size();
    return good;
  }

  /// Whether settle() has nothing to do with its contacts. Remembers how deep they are.
  bool isSettled(const Query& query, std::size_t i) const {
    const MotionLimit limit(query);
    keepDeepest(query, limit.deepest(answer.of(i)));
    return !limit.exceeds(answer.of(i)) && !contradict(answer.of(i), smallerRadius(query));
  }
  /// As finishPair() for pairs whose contacts the device made, after lookAhead(). It leaves those to the CPU that are
  /// jammed, or of whose contacts it had to drop some, unless they agree.
  template <class QueryOf>
  void settle(const std::vector<std::size_t>& which, const QueryOf& queryOf) {
    std::vector<std::size_t> again;
    for (const std::size_t i : which) {
      const Query query = queryOf(i);
      const MotionLimit limit(query);
      const std::span<const Contact> made = answer.of(i);
      if (limit.exceeds(made) && made.size() >= static_cast<std::size_t>(query.options.maxContacts)) {
        again.push_back(i);  // some may be missing
        continue;
      }
      std::vector<Contact> contacts(made.begin(), made.end());
      limit.cut(contacts);
      if (cutContradictions(query, contacts)) {
        again.push_back(i);
        continue;
      }
      answer.add(i, limitContactsOfCaller(query, contacts, query.options.maxContacts));
    }
    const std::vector<Done> done = make(again.size(), [&](std::size_t k, Workspace& own) {
      collide(queryOf(again[k]), own);
      return true;
    });
    for (std::size_t k = 0; k < again.size(); ++k) answer.add(again[k], done[k].contacts);
    answer.leftToHost += again.size();
    answer.madeAgain += again.size();
  }

  bool alone(std::size_t i, const Query& query) {
    --queries;  // counted again there
    const bool good = backend.collide(query, workspace);
    keep(i, workspace.stats, workspace.reduced);
    return good;
  }
  template <class QueryOf>
  void withoutDevice(const std::vector<std::size_t>& which, const QueryOf& queryOf) {
    share(which, [&](std::size_t k, Workspace& own) {
      collide(queryOf(which[k]), own);
      return true;
    });
    answer.byHost.insert(answer.byHost.end(), which.begin(), which.end());
  }

  /// work(begin, end) for parts of `count` pairs with little to do for each.
  template <class Work>
  void inParts(std::size_t count, const Work& work) const {
    runParts(onHost, count, work);
  }

  void keep(std::size_t i, const CollideStats& stats, const std::vector<Contact>& contacts) {
    addStats(answer.stats, stats);
    if (!contacts.empty()) answer.add(i, contacts);
  }

  void end() { std::sort(answer.refused.begin(), answer.refused.end()); }

 private:
  /// Of what is known of the way that a pair's contacts request.
  enum class Way : std::uint8_t { kNone, kKnown, kUnknown };

  /// As make(), and keeps that; the pairs for which `work` returned false are returned.
  template <class Work>
  std::vector<std::size_t> share(const std::vector<std::size_t>& which, const Work& work) {
    const std::vector<Done> done = make(which.size(), work);
    std::vector<std::size_t> bad;
    for (std::size_t k = 0; k < which.size(); ++k) {
      if (done[k].good) {
        keep(which[k], done[k].stats, done[k].contacts);
      } else {
        bad.push_back(which[k]);
      }
    }
    return bad;
  }

  /// work(k, workspace) for each of `count`, by the caller's threads if he lends them, and what it left there.
  template <class Work>
  std::vector<Done> make(std::size_t count, const Work& work) {
    std::vector<Done> done(count);
    const auto some = [&](std::size_t begin, std::size_t end) {
      const WorkspacePool::Lease own(workspaces);
      for (std::size_t k = begin; k < end; ++k) {
        const bool good = work(k, *own);
        done[k] = {good, (*own).reduced, (*own).stats};
      }
    };
    if (onHost && count > 1) {
      (*onHost)(count, some);
    } else {
      some(0, count);
    }
    return done;
  }
};

/// Yes or no.
struct AnyFinish {
  std::vector<std::uint8_t>& answer;
  Workspace workspace{};
  const RunParts* onHost = nullptr;  ///< helps to fill in what is sent, if it is there

  void chunk(std::size_t begin, std::size_t count, const BatchFound& found) {
    if (found.flags == nullptr) return;
    for (std::size_t k = 0; k < count; ++k) answer[begin + k] = (found.flags[k] & OTG_PAIR_INTERSECTS) != 0;
  }
  void refuse(std::size_t) {}
  /// work(begin, end) for parts of `count` pairs with little to do for each.
  template <class Work>
  void inParts(std::size_t count, const Work& work) const {
    runParts(onHost, count, work);
  }
  static constexpr bool kTakesDescriptions = false;
  /// Whether large meshes intersect is as a rule soon known, and it takes many of them to keep the device busy.
  static constexpr bool kLargeAlone = false;
  template <class QueryOf, class RecordsOf>
  void records(const std::vector<std::size_t>& which, const Answer& found, const QueryOf& queryOf,
               const RecordsOf& recordsOf) {
    for (const std::size_t i : which) {
      const Query query = queryOf(i);
      const PairFrame frame = makePairFrame(query);
      const std::span<const std::uint32_t> some = recordsOf(i);
      answer[i] = std::any_of(some.begin(), some.end(),
                              [&](std::uint32_t r) { return recordIntersects(query, frame, found, r); });
    }
  }
  template <class QueryOf>
  void withoutDevice(const std::vector<std::size_t>& which, const QueryOf& queryOf) {
    for (const std::size_t i : which) {
      findIntersectingPairs(queryOf(i), workspace);
      answer[i] = !workspace.intersecting.empty();
    }
  }
};

}  // namespace otg::opencl
