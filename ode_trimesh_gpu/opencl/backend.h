// SPDX-License-Identifier: BSD-3-Clause
// Queries on one OpenCL device. Free of OpenCL's types, for layers above.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "collide/query.h"
#include "collide/traversal.h"
#include "opencl/array_types.h"
#include "opencl/run_parts.h"
#include "opencl/runtime/device_info.h"
#include "opencl/stage_times.h"
#include "opencl/tuning.h"

namespace otg::opencl {

struct BackendState;
class PublishedDesign;

struct BackendCounts {
  std::uint64_t queries = 0;  ///< pairs of meshes requested, in batches or not
  std::uint64_t onHost = 0;   ///< of these, done by the CPU because a call failed
  std::uint64_t repeats = 0;  ///< runs that were repeated because a list was too short
  /// Single pairs whose contacts of the model `pairwise` the CPU finished although the device was to; and pairs of
  /// triangles of any single pairs that the CPU decided in exact arithmetic.
  std::uint64_t leftToHost = 0, decidedOnHost = 0;
  /// Pairs of solids whose overlap the device described, alone or in batches; and those that it left to the CPU after
  /// all.
  std::uint64_t described = 0, describedInVain = 0;
  /// Of those described, those whose contacts of large regions the device made; and those that it left to the CPU.
  std::uint64_t contactsMade = 0, contactsLeft = 0;
  /// Meshes sent whole, changes sent of meshes that were there, meshes that made room; bytes of the first two; bytes
  /// that meshes take now.
  std::uint64_t meshUploads = 0, meshUpdates = 0, meshEvictions = 0, meshBytesSent = 0, meshBytes = 0;
  /// Bytes of all buffers: meshes, lists and results, of queries under way and of those to come.
  std::uint64_t memory = 0;
  int programsFromSource = 0, programsFromCache = 0;
  /// Points queried and rays cast; of either, those that were left to the caller because a call failed.
  std::uint64_t points = 0, pointsOnHost = 0, rays = 0, raysOnHost = 0;
  /// The same of pairs whose nearest triangles were requested.
  std::uint64_t distances = 0, distancesOnHost = 0;
};

/// Two meshes by their places in a list, and where B is in A's frame (as Query::bInA).
struct MeshPair {
  std::uint32_t a = 0, b = 0;
  Transformd bInA{};
};

/// Two meshes, and B in A's frame as Query::bInA: as much of a query as it takes to find whether they meet. Nothing is
/// set at first.
struct PosedMeshes {
  const CollisionMesh* a;
  const CollisionMesh* b;
  Transformd bInA;
};
inline Query queryOf(const PosedMeshes& pair) {
  Query query;
  query.a = pair.a;
  query.b = pair.b;
  query.bInA = pair.bInA;
  return query;
}

/// Many pairs of few meshes, all with the same options: what is sent for a pair is its MeshPair, and no more is read
/// here. No relative velocities, no histories.
struct NumberedPairs {
  std::span<const CollisionMesh* const> meshes;
  std::span<const MeshPair> pairs;
  CollideOptions options;
};

/// The pairs of a batch as a caller has them: queries side by side, queries that lie anywhere, or numbered meshes.
using CollideBatch = std::variant<std::span<const Query>, std::span<const Query* const>, NumberedPairs>;
/// The same only to find whether they meet.
using IntersectBatch = std::variant<std::span<const Query>, std::span<const PosedMeshes* const>, NumberedPairs>;

/// What a batch gives. Contacts stay where the device left them: a span is good until the result is given to another
/// batch or goes away (it may go later than the backend).
class BatchAnswer {
 public:
  std::vector<std::size_t> refused;  ///< ascending: queries whose pose otg::collide refuses; they have no contacts
  CollideStats stats;                ///< sums
  std::size_t leftToHost = 0;        ///< pairs that the device left to the CPU, other than by failing
  std::size_t madeAgain = 0;         ///< of these, those with contacts of the device that the CPU made again
  std::vector<std::size_t> byHost;   ///< of these, those in which the device had no part

  std::size_t size() const { return size_; }  ///< queries
  /// The contacts of query `i`.
  std::span<const Contact> of(std::size_t i) const;
  std::size_t contactCount() const;

  /// For those who make it.
  void clear();
  /// Contacts of the queries begin to begin + count - 1: two words for each, the place of the first one in `contacts`
  /// and how many there are. `memory` holds both. A query has contacts in one part at most.
  void addPart(std::size_t begin, std::size_t count, const std::uint32_t* places, const Contact* contacts,
               std::shared_ptr<const void> memory);
  void addQueries(std::size_t count) { size_ += count; }
  /// Contacts of one query, in place of those in parts.
  void add(std::size_t i, const std::vector<Contact>& contacts) { apart_[i] = contacts; }

 private:
  struct Part {
    std::size_t begin, count;
    const std::uint32_t* places;
    const Contact* contacts;
    std::shared_ptr<const void> memory;
  };
  std::size_t size_ = 0;
  std::vector<Part> parts_;
  std::map<std::size_t, std::vector<Contact>> apart_;
};

/// Any number of threads. Every function gives what the CPU gives, byte for byte, whatever the device, its scheduling
/// and the tuning. It returns false when the device failed and the CPU did all or part of the work, which is logged
/// once and counted. It throws what the CPU throws.
class Backend {
 public:
  /// Opens device `index` of listDevices() and, for Tuning::warmUp, builds the usual programs. Null when that fails,
  /// which is logged. This and every query throw Stopped on a thread that has to stop: see stop.h.
  static std::shared_ptr<Backend> open(int index, const Tuning& tuning = {});
  ~Backend();
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  const DeviceInfo& device() const;

  /// As otg::collide. Everything for the model `pairwise` on the device (where it has no doubles, or finds more than it
  /// has room for: mid and narrow phase), and for the model `solid` as far as the overlap is described; the rest of
  /// that model and the reduction `cone` on the CPU. Only workspace.reduced and workspace.stats are set for certain;
  /// stats.candidatePairs counts pairs of triangles that were tested.
  bool collide(const Query& query, Workspace& workspace);
  /// The same in lanes of its own that take times; `times` is unchanged where the CPU did all.
  bool collideProfiled(const Query& query, Workspace& workspace, StageTimes& times);
  /// As otg::findIntersectingPairs, with the same exceptions.
  bool findIntersectingPairs(const Query& query, Workspace& workspace);
  /// The published design, for those who measure it: opencl/published/published_design.h. Made at its first use, as by
  /// the functions that follow.
  PublishedDesign& published();
  /// The same two by the published traversal, one level of both trees after the other.
  bool collideByLevels(const Query& query, Workspace& workspace);
  bool findPairsByLevels(const Query& query, Workspace& workspace);
  /// One phase on the device, the other one is the caller's: as otg::middlePhase, with pairs of triangles of the
  /// device's leaves, in any order;
  bool findCandidates(const Query& query, Workspace& workspace);
  /// the same by the published traversal;
  bool findCandidatesByLevels(const Query& query, Workspace& workspace);
  /// as otg::nearPhase, for candidates from anywhere; and all that follows a mid phase, with contacts of the model
  /// `pairwise` made there.
  bool decideCandidates(const Query& query, Workspace& workspace);
  bool collideCandidates(const Query& query, Workspace& workspace);

  /// otg::collide for every query, in one submission (several if there are very many or their meshes do not fit at
  /// once; pairs of very large meshes by themselves). A query with a SolidHistory must not be there twice. Where all
  /// pairs may have contacts of the model `solid` the device makes those of pairs of solids, as a rule.
  /// With `times` in lanes of its own that take times. `onHost` does the pairs that the device leaves to the CPU, and
  /// contacts of pairs whose overlaps it describes. Without it they are done one after the other.
  bool collideBatch(const CollideBatch& pairs, BatchAnswer& answer, StageTimes* times = nullptr,
                    const RunParts& onHost = {});
  /// Whether the two meshes of each pair have triangles that intersect: 1 or 0 (0 for a pose that is refused).
  /// `onHost` helps to fill in what is sent.
  bool intersectBatch(const IntersectBatch& pairs, std::vector<std::uint8_t>& answer, StageTimes* times = nullptr,
                      const RunParts& onHost = {});

  /// Whether the device can compute these: it has doubles, and their program could be built.
  bool answersPoints() const;
  bool answersRays() const;
  bool answersDistances() const;
  /// Programs that could not be built. What they are for is done by the CPU from then on, and is no failure any more.
  std::size_t failedPrograms() const;
  /// Queries `count` points and hands the results over in pieces, in their order, on the calling thread. The mesh
  /// has triangles; `request.inside` is for solids. Returns how many were computed, from the first one on: fewer than
  /// `count` when a call failed (which is logged once and counted). Throws what `fill` and `take` throw.
  std::size_t askPoints(const CollisionMesh& mesh, PointRequest request, std::size_t count, const FillPoints& fill,
                        const TakePoints& take);
  /// The same for rays: the triangle that each hits first; with `cullBack` those hit from behind do not count.
  std::size_t castRays(const CollisionMesh& mesh, bool cullBack, std::size_t count, const FillRays& fill,
                       const TakeRays& take);
  /// The nearest triangles of pairs of meshes that are apart and have triangles: as otg::distanceApart finds them,
  /// {kNone, kNone} where nothing is within the limit, kLeftToHost where the device cannot decide. `run` puts the pairs
  /// together. Only where answersDistances(). Returns how many have their results, from the first one on: fewer than
  /// all when a call failed (which is logged once and counted). Throws what `run` throws.
  std::size_t nearestTriangles(std::span<const Query> queries, double limit, std::span<TrianglePair> answers,
                               const RunParts& run);
  static constexpr TrianglePair kLeftToHost{kNone - 1, kNone - 1};

  /// Gives back the lists and results of queries that are done, and meshes if no query has any. How many bytes.
  std::uint64_t releaseMemory();

  BackendCounts counts() const;

 private:
  template <class Source, class Finish>
  class Batch;
  template <class Source>
  bool collideFrom(const Source& source, BatchAnswer& answer, StageTimes* times, const RunParts& onHost);
  template <class Source>
  bool intersectFrom(const Source& source, std::vector<std::uint8_t>& answer, StageTimes* times,
                     const RunParts& onHost);
  bool collideIn(bool profile, const Query& query, Workspace& workspace, StageTimes& times);
  bool collideTriangles(bool profile, const Query& query, Workspace& workspace, StageTimes& times);
  void addPublishedCounts(BackendCounts& counts) const;
  explicit Backend(std::unique_ptr<BackendState> state);
  std::unique_ptr<BackendState> state_;
};

}  // namespace otg::opencl
