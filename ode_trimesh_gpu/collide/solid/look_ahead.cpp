// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/look_ahead.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <tuple>

#include "base/vectors.h"
#include "collide/pair_frame.h"
#include "collide/shortest_translation.h"
#include "collide/simd/wide_kernels.h"
#include "collide/solid/ahead_scratch.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"

namespace otg {
namespace {

/// Sine of the angle by which a face may look along the way and is in the way all the same.
constexpr double kAlong = 0.02;
/// Of both meshes together. Larger ones are what devices are for, which do not look ahead.
constexpr std::size_t kMostTriangles = 16384;

struct Asked {
  double depth;
  Vec3d normal;
  auto key() const { return std::make_tuple(-depth, normal.x, normal.y, normal.z); }
};

/// Its direction is one of many, or it is deeper than it says.
bool tellsNoWay(const Contact& contact) {
  return (contact.flags & (kContactContained | kContactClamped)) != 0;
}

/// How long the way that contacts request may be.
double longestWay(std::span<const Contact> contacts) {
  double deepest = 0;
  for (const Contact& c : contacts) deepest = std::max(deepest, c.depth);
  return kLongestAhead * deepest;
}

/// What contacts request, however they are ordered. None where they do not give the way.
std::optional<ShortestTranslation> askedBy(std::span<const Contact> contacts, std::pmr::memory_resource* memory) {
  if (contacts.empty()) return std::nullopt;
  std::pmr::vector<Asked> all(memory);
  all.reserve(contacts.size());
  for (const Contact& c : contacts) {
    if (tellsNoWay(c)) return std::nullopt;
    all.push_back({c.depth, c.normal});
  }
  std::sort(all.begin(), all.end(), [](const Asked& x, const Asked& y) { return x.key() < y.key(); });
  std::optional<ShortestTranslation> t(std::in_place, memory);
  const double longest = longestWay(contacts);
  for (const Asked& h : all) {
    if (!t->add(h.normal, h.depth, longest)) return std::nullopt;
  }
  return t;
}

Vec3d wayOf(const ShortestTranslation& t) {
  return otgScale(t.value(), kFartherAhead);
}

/// The pair after A has moved, without a past.
Query movedBy(const Query& query, const Vec3d& way) {
  Query moved = query;
  moved.bInA.t = otgSub(query.bInA.t, way);
  moved.relativeVelocity = {0, 0, 0};
  moved.history = nullptr;
  moved.options.timings = moved.options.countPerDepth = false;
  return moved;
}

/// Which pairs of triangles show that something is in the way. Of all that intersect after the way these are few. Which
/// they are depends on the meshes alone, and not on how pairs are found.
class InTheWay {
 public:
  InTheWay(const Query& query, const Vec3d& way)
      : query_(query),
        way_(way),
        wayOfB_(otgRotateBack(query.bInA, way)),
        normals_{query.a->adjacency().normal.data(), query.b->adjacency().normal.data()},
        least_(kAlong * norm(way)),
        frame_{} {
    for (int k = 0; k < 9; ++k) {
      frame_.r[k] = query.bInA.r[k];
      frame_.absR[k] = std::fabs(query.bInA.r[k]);
    }
    frame_.t = query.bInA.t;
  }

  /// B's triangle looks against the way, and A's along it.
  bool faces(const TrianglePair& p) const {
    return otgDot(normals_[1][p.b], wayOfB_) < least_ && otgDot(normals_[0][p.a], way_) > -least_;
  }

  /// Before the way the triangles' boxes overlap, along the axes of either mesh. So do those of any tree.
  bool areNear(const TrianglePair& p) const {
    const Box a = boxOf(query_.a->mesh(), p.a), b = boxOf(query_.b->mesh(), p.b);
    const Vec3d d = otgSub(otgBoxCenterInA(frame_, b.center), a.center);
    return otgBoxGapA(d, a.extent, otgBoxExtentInA(frame_, b.extent)) <= 0 &&
           otgBoxGapB(frame_, d, a.extent, b.extent) <= 0;
  }

 private:
  struct Box {
    Vec3d center, extent;
  };
  static Box boxOf(const TriMesh& mesh, std::uint32_t triangle) {
    Vec3d corner[3];
    cornersOfA(mesh, triangle, corner);
    const Vec3d low = minimum(corner[0], minimum(corner[1], corner[2]));
    const Vec3d high = maximum(corner[0], maximum(corner[1], corner[2]));
    return {otgScale(otgAdd(low, high), 0.5), otgScale(otgSub(high, low), 0.5)};
  }

  const Query& query_;
  Vec3d way_, wayOfB_;
  const Vec3d* normals_[2];
  double least_;
  BoxFrame<double> frame_;
};

/// Whether workspace.candidates are all pairs whose boxes overlap along the axes of either mesh.
bool hasCandidates(const Query& query, const Workspace& workspace) {
  return !workspace.candidates.empty() && query.options.middle.axes == 6 &&
         query.options.middle.traversal != Traversal::kNoLeaf && !leavesOutThin(query);
}

/// By all pairs that intersect after the way.
bool meetsByTrees(const Query& query, const Vec3d& way, Workspace& ahead) {
  const InTheWay inTheWay(query, way);
  findIntersectingPairs(movedBy(query, way), ahead);
  const PairFrame frame = makePairFrame(query);
  return std::any_of(ahead.intersecting.begin(), ahead.intersecting.end(), [&](const TrianglePair& p) {
    return inTheWay.areNear(p) && (inTheWay.faces(p) || decidePair(query, frame, p, ahead.stats));
  });
}

/// The same by the pairs that were near before it.
bool meetsByCandidates(const Query& query, const Vec3d& way, const Workspace& before, Workspace& ahead) {
  const InTheWay inTheWay(query, way);
  ahead.clear();
  for (const TrianglePair& p : before.candidates) {
    if (inTheWay.faces(p)) ahead.candidates.push_back(p);
  }
  ahead.candidates.insert(ahead.candidates.end(), before.intersecting.begin(), before.intersecting.end());
  nearPhase(movedBy(query, way), ahead);
  return std::any_of(ahead.intersecting.begin(), ahead.intersecting.end(),
                     [&](const TrianglePair& p) { return inTheWay.areNear(p); });
}

/// A contact of the pair after A has moved by `way`, as one before: in the middle between the feature and what it
/// meets, along the normal. One that is met only on the way has no depth yet.
Contact beforeWay(const Contact& met, const Vec3d& way) {
  Contact c = met;
  const double depth = met.depth + otgDot(met.normal, way);
  const Vec3d half = otgScale(met.normal, 0.5 * (depth - met.depth));
  c.position = isOfA(met.feature) ? otgAdd(met.position, half) : otgAdd(met.position, otgSub(way, half));
  c.depth = std::max(depth, 0.0);
  if (!(depth > 0)) c.flags &= static_cast<std::uint8_t>(~kContactInside);
  return c;
}

void addContactsAhead(const Query& query, Workspace& workspace) {
  std::optional<ShortestTranslation> t = askedBy(workspace.contacts, emptyMemory(workspace));
  if (!t) return;
  Workspace& ahead = scratchAhead(workspace);
  const bool byTrees = !hasCandidates(query, workspace);
  if (!(byTrees ? meetsByTrees(query, wayOf(*t), ahead) : meetsByCandidates(query, wayOf(*t), workspace, ahead)))
    return;
  const double longest = longestWay(workspace.contacts);
  std::uint32_t regions = 0;
  for (const Contact& c : workspace.contacts) regions = std::max(regions, c.region + 1);
  bool isNew = true;
  for (int look = 0; look < kLooksAhead && isNew; ++look) {
    const Vec3d way = wayOf(*t);
    const Query moved = movedBy(query, way);
    if (look > 0 || !byTrees) findIntersectingPairs(moved, ahead);
    if (ahead.intersecting.empty() || !solidContacts(moved, ahead)) return;
    std::stable_sort(ahead.contacts.begin(), ahead.contacts.end(),
                     [](const Contact& x, const Contact& y) { return x.depth > y.depth; });
    isNew = false;
    std::uint32_t last = 0;
    for (const Contact& met : ahead.contacts) {
      last = std::max(last, met.region + 1);
      if (tellsNoWay(met)) continue;
      Contact c = beforeWay(met, way);
      if (t->satisfies(c.normal, c.depth) || !t->add(c.normal, c.depth, longest)) continue;
      c.region += regions;
      workspace.contacts.push_back(c);
      isNew = true;
    }
    regions += last;
  }
}

}  // namespace

bool isCornered(const CollisionMesh* mesh) {
  return mesh->adjacency().hollowEdges > 0 || mesh->mesh().topology().componentVolume.size() > 1;
}

bool mayMeetAhead(const Query& query) {
  return query.a->mesh().triangleCount() + query.b->mesh().triangleCount() <= kMostTriangles &&
         (isCornered(query.a) || isCornered(query.b));
}

void lookAhead(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  const std::size_t before = workspace.contacts.size();
  addContactsAhead(query, workspace);
  workspace.stats.contactsAhead = workspace.contacts.size() - before;
  workspace.stats.contactsBeforeReduction = workspace.contacts.size();
  if (query.options.timings) {
    workspace.stats.contactsMs += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
}

std::optional<Transformd> poseAhead(const Query& query, std::span<const Contact> contacts, Workspace& workspace) {
  const std::optional<ShortestTranslation> t = askedBy(contacts, emptyMemory(workspace));
  if (!t) return std::nullopt;
  return movedBy(query, wayOf(*t)).bInA;
}

}  // namespace otg
