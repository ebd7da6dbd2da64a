// SPDX-License-Identifier: BSD-3-Clause
// One collision query between two meshes: what goes in, what comes out. Everything geometric is in mesh A's frame.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "bvh/collision_mesh.h"
#include "collide/convex/clip_scratch.h"
#include "collide/pair_limit.h"
#include "collide/solid_options.h"
#include "collide/traversal.h"

namespace otg {

enum class NearPhase { kExact };
enum class ContactModel { kPairwise, kSolid };
enum class Reduction { kNone, kBinning, kCone };

struct MiddleOptions {
  Traversal traversal = Traversal::kWide;
  DescentRule descent = DescentRule::kLargerFirst;
  int axes = 6;                        ///< 6 face axes, or 15 with the edge axes
  int maxPairs = kMostCandidatePairs;  ///< candidates, 1 or more; with more of them the query throws TooManyPairs
  friend bool operator==(const MiddleOptions&, const MiddleOptions&) = default;
};

struct ReductionOptions {
  Reduction method = Reduction::kBinning;
  /// Bins per axis: position x, y, z, then normal x, y, z; each 1 to 64.
  std::array<int, 6> bins{3, 3, 3, 3, 3, 3};
  friend bool operator==(const ReductionOptions&, const ReductionOptions&) = default;
};

struct CollideOptions {
  MiddleOptions middle;
  ContactModel contacts = ContactModel::kPairwise;
  ReductionOptions reduction;
  SolidOptions solid;
  int maxContacts = 64;        ///< 1 to 65,535
  bool timings = false;        ///< fill CollideStats::*Ms (reads the clock a few times)
  bool countPerDepth = false;  ///< fill CollideStats::boxTestsPerDepth
  friend bool operator==(const CollideOptions&, const CollideOptions&) = default;
};

/// What a contact was made from; part of the order of contacts. `pairwise` has the face whose plane gave the normal;
/// `solid` has a vertex, the crossing of an edge with a triangle of the other mesh, or an inside stretch's middle
/// (kNone: the middle of a region without any of these).
enum class ContactFeature : std::uint8_t {
  kNone,
  kFaceA,
  kFaceB,
  kCoplanar,
  kVertexA,
  kVertexB,
  kCrossingA,
  kCrossingB,
  kMiddleA,
  kMiddleB
};

/// Whether it is a vertex or an edge of mesh A.
constexpr bool isOfA(ContactFeature feature) {
  return feature == ContactFeature::kVertexA || feature == ContactFeature::kCrossingA ||
         feature == ContactFeature::kMiddleA;
}

/// Facts about a contact, added up.
enum ContactFlag : std::uint8_t {
  kContactInside = 1,     ///< its vertex or middle lies inside the other solid (else on the other surface)
  kContactContained = 2,  ///< a whole component of one mesh lies inside the other
  kContactClamped = 4     ///< this depth was cut: the pair is entangled or jammed, or cannot have moved so far
};

inline constexpr std::uint32_t kOrdinalOfPart = 1U << 20;

struct Contact {
  Vec3d position;  ///< frame A
  Vec3d normal;    ///< unit, frame A; moving A along it by `depth` separates (it points out of B, into A)
  double depth;    ///< >= 0
  std::uint32_t triangleA, triangleB;
  std::uint32_t
      region;  ///< contacts of one connected overlap share it; 0-based in the order of its smallest intersecting pair
  ContactFeature feature;
  std::uint8_t flags = 0;         ///< ContactFlag
  std::uint32_t element = kNone;  ///< number of the feature's vertex (welded) or edge in its mesh; kNone for faces
  /// Of an edge, whose inside stretches are counted k = 0, 1, ... from Topology::Edge::a: crossings have 2 k where the
  /// stretch begins and 2 k + 1 where it ends, middles have k. Else 0. With a mesh of parts (CollisionMesh::parts())
  /// the number of the part that it is in, times kOrdinalOfPart, comes on top.
  std::uint32_t ordinal = 0;
  double coherence = -1;  ///< of the region (solid/overlap_regions.h); -1 where the model has none
};

inline void cutDepth(Contact& contact, double most) {
  if (!(contact.depth > most)) return;
  contact.depth = most;
  contact.flags |= kContactClamped;
}

struct CollideStats {
  std::uint64_t boxTests = 0;
  std::uint64_t triangleBoxTests = 0;  ///< no-leaf traversal only
  std::uint64_t candidatePairs = 0;
  std::uint64_t intersectingPairs = 0;
  std::uint64_t decidedByDouble = 0;  ///< candidate pairs that the float filter left open
  std::uint64_t decidedExactly = 0;   ///< of those, the ones that double arithmetic left open
  std::uint64_t contactsBeforeReduction = 0;
  std::uint64_t contactsAhead = 0;  ///< of these, the ones of surfaces on the way (solid/look_ahead.h)
  std::uint64_t unevenRegions = 0;  ///< of solids, whose parts leave each by its own face, or through another surface
  double middleMs = 0, nearMs = 0, contactsMs = 0, reductionMs = 0;
  std::vector<std::uint64_t> boxTestsPerDepth;  ///< by depth of the pair: sum of both nodes' depths
};

class RegionRefiner;
struct Query {
  const CollisionMesh* a = nullptr;
  const CollisionMesh* b = nullptr;
  /// Takes B's points to A's frame; used as given, so that its defect (rotation_tolerance.h) enters the result. One
  /// that is not finite or whose defect is above kRelativeRotationTolerance is refused.
  Transformd bInA{};
  Vec3d relativeVelocity{0, 0,
                         0};  ///< of A's material relative to B's where they meet, frame A, units/s; zero if unknown
  SolidHistory* history = nullptr;   ///< of this pair, in this order, or null; read and written by ContactModel::kSolid
  RegionRefiner* refiner = nullptr;  ///< or null: corrects the regions of ContactModel::kSolid
  bool isOffSurface = false;         ///< collideSurfacePair() is known to be false
  bool isJammed = false;             ///< two solids whose contacts contradict each other: see finishPair()
  CollideOptions options;
};

/// Scratch memory and results; reuse it between queries to save allocations. One thread at a time.
struct SolidScratch;
struct ShellScratch;
struct AheadScratch;
struct Workspace {
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  /// No results.
  void clear();
  std::vector<TrianglePair> candidates;    ///< of the last query, in the order of traversal
  std::vector<TrianglePair> undecided;     ///< scratch of the narrow phase: candidates that float cannot decide
  std::vector<TrianglePair> intersecting;  ///< ascending
  std::vector<Contact> contacts;           ///< before reduction, by (triangleA, triangleB)
  std::vector<Contact> reduced;            ///< the result
  CollideStats stats;
  ConvexScratch convex;
  std::unique_ptr<SolidScratch> solid;
  std::unique_ptr<ShellScratch> shell;
  std::unique_ptr<AheadScratch> ahead;
};

/// The pairs of triangles whose boxes overlap (a superset of the intersecting ones) -> workspace.candidates. Of meshes
/// with thin triangles some that are apart are left out (leavesOutThin()). Throws
/// std::invalid_argument for a pose that is refused (see Query::bInA), after which the workspace holds no results, and
/// TooManyPairs.
void middlePhase(const Query& query, Workspace& workspace);
/// Decides workspace.candidates -> workspace.intersecting. The set does not depend on traversal, order or backend: it
/// is the exact result for A's float vertices and B's vertices as otgTransform places them in double; touching counts.
void nearPhase(const Query& query, Workspace& workspace);
/// workspace.intersecting -> workspace.contacts by the published per-pair construction.
void pairwiseContacts(const Query& query, Workspace& workspace);
/// workspace.contacts -> workspace.reduced: the chosen reduction, then at most options.maxContacts.
void reduceContacts(const Query& query, Workspace& workspace);

/// Pairs in the numbers of the callers who built the meshes (TriMesh::callerTriangle), ascending.
std::vector<TrianglePair> pairsOfCaller(const Query& query, const std::vector<TrianglePair>& pairs);

/// All of the above. The same query gives the same bytes. Triangles in workspace.reduced carry their callers' numbers;
/// everything else in the workspace is in the meshes' own. Throws std::bad_alloc, and what middlePhase throws.
void collide(const Query& query, Workspace& workspace);
/// middlePhase and nearPhase alone.
void findIntersectingPairs(const Query& query, Workspace& workspace);

}  // namespace otg
