// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shell/shell_contacts.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <numbers>

#include "base/vectors.h"
#include "collide/consistent_contacts.h"
#include "collide/first_copies.h"
#include "collide/pair_history.h"
#include "collide/pairwise/reduction.h"
#include "collide/shell/clip_triangle.h"
#include "collide/shell/shell_approach.h"
#include "collide/shortest_translation.h"
#include "shared/tests/point_test.h"

namespace otg {
namespace {

// In radii of the visitor.
constexpr double kDeepest = 0.06;     ///< no contact is deeper
constexpr double kThroughMost = 0.2;  ///< how far behind a ground without an inside a visitor may be that is through

constexpr double kShorter = 0.5;             ///< of one way, for the other to be taken
constexpr double kPastRim = 2;               ///< times as deep as the rim
constexpr double kShallow = 0.02;            ///< of the deepest corner of a clipped triangle: others say nothing
constexpr std::size_t kMostVertices = 4096;  ///< beyond those of triangles that intersect

/// Contacts of one pair, with A for the visitor and B for the ground.
class ShellContacts {
 public:
  ShellContacts(const ShellRoles& roles, const GroundSurface& surface, ShellScratch& scratch)
      : roles_(roles), surface_(surface), scratch_(scratch), links_(roles.visitor->adjacency()) {
    scratch_.candidates.clear();
    scratch_.seen.reset(roles.visitor->mesh().vertices().size());
  }

  void ofMeeting() {
    for (const TrianglePair& pair : scratch_.pairs) {
      for (const std::uint32_t v : roles_.visitor->mesh().triangles()[pair.a].v) add(v, pair.b);
    }
    const std::size_t most = scratch_.candidates.size() + kMostVertices;
    for (std::size_t i = 0; i < scratch_.candidates.size(); ++i) {
      const auto [vertex, hint] = scratch_.candidates[i];
      std::uint32_t nearest = hint;
      if (!addVertex(vertex, roles_.size, nearest)) continue;
      for (std::uint32_t k = links_.first[vertex]; k < links_.first[vertex + 1]; ++k) {
        if (scratch_.candidates.size() < most) add(links_.spokes[k].vertex, nearest);
      }
    }
    for (const TrianglePair& pair : scratch_.pairs) addClipped(pair);
    const double rim = shortestWayOfRim();
    std::erase_if(scratch_.contacts, [&](const Contact& c) { return c.depth > kPastRim * rim; });
  }

  void ofThrough() {
    const double limit = roles_.kind == GroundKind::kSolid ? std::numeric_limits<double>::max()  //
                                                           : kThroughMost * roles_.size;
    const std::size_t count = roles_.visitor->mesh().vertices().size();
    std::uint32_t nearest = kNone;
    std::size_t left = kMostVertices;
    for (std::uint32_t v = 0; v < count && left > 0; ++v) {
      if (links_.first[v] == links_.first[v + 1]) continue;  // unused, or the place of a smaller one
      addVertex(v, limit, nearest);
      --left;
    }
  }

  /// Takes points of clipped triangles to the surface; drops those that are in front of it.
  void refine(std::vector<Contact>& contacts) const {
    std::erase_if(contacts, [&](Contact& c) { return c.element == kNone && !refine(c); });
    for (Contact& c : contacts) cutDepth(c, kDeepest * roles_.size);
  }

 private:
  void add(std::uint32_t vertex, std::uint32_t hint) {
    const std::uint32_t v = roles_.visitor->mesh().topology().weld[vertex];
    if (scratch_.seen.has(v)) return;
    scratch_.seen.set(v, 0);
    scratch_.candidates.push_back({v, hint});
  }

  /// Whether it lies behind the ground and not beside it. `nearest`: a triangle near it, before and after.
  bool addVertex(std::uint32_t vertex, double limit, std::uint32_t& nearest) {
    const Vec3d point = roles_.vertex(vertex);
    GroundDepth at;
    if (!surface_.measure(point, limit, nearest, at)) return false;
    nearest = at.place.triangle;
    if (!at.isBehind || at.isBeside) return false;
    Contact contact{};
    contact.position = point;
    contact.normal = at.way;
    contact.depth = at.place.distance <= surface_.slack() ? 0 : at.place.distance;
    contact.triangleA = links_.halfEdges[links_.first[vertex]] / 3;
    contact.triangleB = at.place.triangle;
    contact.feature = ContactFeature::kVertexA;
    contact.flags = kContactInside;
    contact.element = vertex;
    scratch_.contacts.push_back(contact);
    return true;
  }

  void addClipped(const TrianglePair& pair) {
    const Triangle& triangle = roles_.visitor->mesh().triangles()[pair.a];
    const Vec3d corners[3] = {roles_.vertex(triangle.v[0]), roles_.vertex(triangle.v[1]), roles_.vertex(triangle.v[2])};
    Vec3d of[3];
    surface_.corners(pair.b, of);
    const Vec3d front = surface_.front(pair.b);
    const ClippedTriangle clipped = clipBehind(corners, of, front);
    double heights[ClippedTriangle::kMost], most = 0;
    for (int i = 0; i < clipped.count; ++i) {
      heights[i] = std::max(0.0, otgDot(front, otgSub(of[0], clipped.corners[std::size_t(i)].point)));
      most = std::max(most, heights[i]);
    }
    if (isRim(pair.b) && addRim(pair, corners, of, most)) return;
    const auto addPoint = [&](const Vec3d& point, double height, int ordinal) {
      if (most > surface_.slack() && height < kShallow * most) return;
      Contact contact{};
      contact.position = point;
      contact.normal = front;
      contact.depth = height;
      contact.triangleA = pair.a;
      contact.triangleB = pair.b;
      contact.feature = ContactFeature::kFaceB;
      contact.ordinal = static_cast<std::uint32_t>(ordinal);
      scratch_.contacts.push_back(contact);
    };
    Vec3d sum{0, 0, 0};
    double sumOfHeights = 0;
    int cutCount = 0;
    for (int i = 0; i < clipped.count; ++i) {
      const ClippedTriangle::Corner& corner = clipped.corners[std::size_t(i)];
      sum = otgAdd(sum, corner.point);
      sumOfHeights += heights[i];
      if (!corner.isCut) continue;
      ++cutCount;
      addPoint(corner.point, heights[i], i);
    }
    // All corners may lie at the rim of what faces that way, where the surface beside it is near.
    if (cutCount > 2 && cutCount == clipped.count) {
      addPoint(otgScale(sum, 1.0 / clipped.count), sumOfHeights / clipped.count, 2 * ClippedTriangle::kMost);
    }
  }

  /// Where the rim of the ground sticks through the visitor, how far in the direction in which it is least: others lead
  /// past it. Infinity where it does not.
  double shortestWayOfRim() const {
    constexpr double kAlike = 0.9;
    struct Way {
      Vec3d normal;
      double depth;
    };
    std::vector<Way> ways;
    for (const Contact& c : scratch_.contacts) {
      if (c.feature != ContactFeature::kFaceA) continue;
      const auto same =
          std::find_if(ways.begin(), ways.end(), [&](const Way& way) { return otgDot(way.normal, c.normal) > kAlike; });
      if (same == ways.end()) {
        ways.push_back({c.normal, c.depth});
      } else {
        same->depth = std::max(same->depth, c.depth);
      }
    }
    double least = std::numeric_limits<double>::infinity();
    for (const Way& way : ways) least = std::min(least, way.depth);
    return least;
  }

  /// Whether a triangle has an edge at the rim of a vessel: a sheet with walls around, as a box without lid. Visitors
  /// lie on such a rim; on others, as the seams of a terrain in pieces, they lie by the faces beside it.
  bool isRim(std::uint32_t triangle) {
    if (!isVessel()) return false;
    const SharedArray<std::uint32_t>& twin = surface_.mesh().topology().twin;
    const std::size_t first = 3 * std::size_t{triangle};
    return twin[first] == kNone || twin[first + 1] == kNone || twin[first + 2] == kNone;
  }

  bool isVessel() {
    if (vessel_ < 0) {
      const bool isSheet = roles_.kind == GroundKind::kSheet || roles_.isScattered;
      vessel_ = isSheet && !roles_.isTerrain && !facesOneWay(*roles_.ground) ? 1 : 0;
    }
    return vessel_ > 0;
  }

  /// Contacts where the ground's triangle `of` sticks through the visitor's by less than the visitor's is behind the
  /// ground. False if it does not.
  bool addRim(const TrianglePair& pair, const Vec3d corners[3], const Vec3d of[3], double behind) {
    Vec3d front = otgRotate(roles_.visitorInGround, links_.normal[pair.a]);
    double least = kShorter * behind;
    ClippedTriangle tip;
    Vec3d way{};
    for (const double side : {1.0, -1.0}) {
      const Vec3d normal = otgScale(front, side);
      const ClippedTriangle through = clipBehind(of, corners, normal);
      double most = 0;
      for (int i = 0; i < through.count; ++i) {
        most = std::max(most, otgDot(normal, otgSub(corners[0], through.corners[std::size_t(i)].point)));
      }
      if (!(most > surface_.slack()) || most >= least) continue;
      least = most;
      tip = through;
      way = otgScale(normal, -1.0);
    }
    if (tip.count == 0) return false;
    for (int i = 0; i < tip.count; ++i) {
      const Vec3d& point = tip.corners[std::size_t(i)].point;
      const double height = otgDot(way, otgSub(point, corners[0]));
      if (height < kShorter * least) continue;
      Contact contact{};
      contact.position = point;
      contact.normal = way;
      contact.depth = height;
      contact.triangleA = pair.a;
      contact.triangleB = pair.b;
      contact.feature = ContactFeature::kFaceA;
      contact.ordinal = static_cast<std::uint32_t>(ClippedTriangle::kMost + i);
      scratch_.contacts.push_back(contact);
    }
    return true;
  }

  bool refine(Contact& c) const {
    if (c.feature == ContactFeature::kFaceA) return true;
    if (c.depth <= surface_.slack()) {
      c.depth = 0;
      return true;
    }
    GroundDepth at;
    // By a hair more than the height over the plane, within which the triangle itself is.
    if (!surface_.measure(c.position, c.depth * (1 + 1e-9) + surface_.slack(), c.triangleB, at)) return true;
    if (!at.isBehind) return false;
    if (at.isBeside) return true;  // the plane continues the surface over its rim
    c.depth = at.place.distance <= surface_.slack() ? 0 : at.place.distance;
    c.normal = at.way;
    return true;
  }

  const ShellRoles& roles_;
  const GroundSurface& surface_;
  ShellScratch& scratch_;
  const Adjacency& links_;
  int vessel_ = -1;  ///< isVessel(), once it was called
};

/// Where triangles meet and nothing else is found, as on the tip of a needle, what the two do next is stopped: contacts
/// without depth, in front of the ground.
void addStops(const ShellRoles& roles, const GroundSurface& surface, const std::vector<TrianglePair>& pairs,
              std::vector<Contact>& out) {
  for (const TrianglePair& pair : pairs) {
    Vec3d middle{0, 0, 0}, of[3];
    for (const std::uint32_t v : roles.visitor->mesh().triangles()[pair.a].v) {
      middle = otgAdd(middle, otgScale(roles.vertex(v), 1.0 / 3));
    }
    surface.corners(pair.b, of);
    Contact c{};
    otgNearestOnTriangle(of[0], of[1], of[2], middle, &c.position);
    c.normal = surface.front(pair.b);
    c.triangleA = pair.a;
    c.triangleB = pair.b;
    c.feature = ContactFeature::kFaceB;
    out.push_back(c);
  }
}

std::vector<Contact*> deepestFirst(std::vector<Contact>& contacts) {
  std::vector<Contact*> out(contacts.size());
  std::transform(contacts.begin(), contacts.end(), out.begin(), [](Contact& c) { return &c; });
  std::sort(out.begin(), out.end(),
            [](const Contact* x, const Contact* y) { return x->depth != y->depth ? x->depth > y->depth : x < y; });
  return out;
}

/// A point near the rim of a face is nearer to the face beside it, or lies on that. It leaves by the first face instead
/// if twice the translation that deeper contacts request takes it out there.
void leaveAlike(const GroundSurface& surface, std::vector<Contact>& contacts) {
  ShortestTranslation way;
  for (Contact* const c : deepestFirst(contacts)) {
    const Vec3d twice = otgScale(way.value(), 2.0), point = otgAdd(c->position, twice);
    const double length = norm(twice);
    const bool mayLeave = length > 0 && (c->depth == 0 || !way.satisfies(c->normal, c->depth));
    GroundDepth at;
    if (mayLeave && c->feature != ContactFeature::kFaceA &&
        surface.measure(point, length + surface.slack(), c->triangleB, at) && !at.isBehind) {
      const Vec3d normal = unit(otgSub(point, at.place.point));
      const double depth = otgDot(normal, otgSub(at.place.point, c->position));
      if (depth > 0) {
        c->normal = normal;
        c->depth = depth;
        c->triangleB = at.place.triangle;
      }
    }
    if (c->depth > 0) way.add(c->normal, c->depth);
  }
}

/// Contacts that all but contradict each other, as of a plate under the rim of a hole, request a long way aside: no
/// longer than the deepest contact may be, nor than three walls at right angles would, each as deep as the deepest. One
/// that no way does for beside deeper ones stops the two and does no more.
void limitTogether(double deepest, std::vector<Contact>& contacts) {
  const std::vector<Contact*> ordered = deepestFirst(contacts);
  if (ordered.empty() || !(ordered.front()->depth > 0)) return;
  const double most = std::min(deepest, std::numbers::sqrt3 * ordered.front()->depth);
  ShortestTranslation way;
  for (Contact* const c : ordered) {
    if (!(c->depth > 0) || way.add(c->normal, c->depth)) continue;
    cutDepth(*c, 0);
  }
  const double length = norm(way.value());
  if (length <= most) return;
  for (Contact& c : contacts) cutDepth(c, c.depth * (most / length));
}

void reduce(const CollideOptions& options, const ShellContacts& maker, std::vector<Contact>& contacts) {
  // Most points fall into a bin with others: only what is left is taken to the surface.
  if (options.reduction.method == Reduction::kBinning) contacts = reduceByBinning(contacts, options.reduction.bins);
  maker.refine(contacts);
  if (options.reduction.method == Reduction::kCone) contacts = reduceToCone(contacts);
}

/// From visitor and ground to A and B.
Contact placed(const Query& query, const ShellRoles& roles, Contact c) {
  if (roles.groundIsA) {
    std::swap(c.triangleA, c.triangleB);
    c.feature = c.feature == ContactFeature::kVertexA ? ContactFeature::kVertexB
                : c.feature == ContactFeature::kFaceA ? ContactFeature::kFaceB
                                                      : ContactFeature::kFaceA;
    c.normal = otgScale(c.normal, -1.0);
  } else {
    c.position = otgTransform(query.bInA, c.position);
    c.normal = otgRotate(query.bInA, c.normal);
  }
  return c;
}

void takePairs(const ShellRoles& roles, const std::vector<TrianglePair>& pairs, std::vector<TrianglePair>& out) {
  out = pairs;
  if (!roles.groundIsA) return;
  for (TrianglePair& pair : out) std::swap(pair.a, pair.b);
  std::sort(out.begin(), out.end());
}

void remember(const Query& query, const ShellRoles& roles, const SolidHistory::State& before, ShellApproach& approach,
              ShellState state, const std::vector<Contact>& contacts) {
  if (query.history == nullptr) return;
  SolidHistory::State after = oneQueryLater(before);
  if (roles.kind != GroundKind::kSolid) {
    Vec3d sum{0, 0, 0};
    for (const Contact& c : contacts) sum = otgAdd(sum, c.normal);
    approach.finish(state, !contacts.empty(), sum, after);
  } else if (roles.ground->mesh().meshClass() != MeshClass::kSolid) {
    after.front = before.side != 0 ? before.front : roles.middle();
    after.side = 1;
  }
  keepState(query, before, after);
}

}  // namespace

void shellContacts(const Query& query, Workspace& workspace) {
  using Clock = std::chrono::steady_clock;
  const auto start = query.options.timings ? Clock::now() : Clock::time_point{};
  workspace.contacts.clear();
  workspace.reduced.clear();
  if (query.a->mesh().triangleCount() == 0 || query.b->mesh().triangleCount() == 0) return;
  if (!workspace.shell) workspace.shell = std::make_unique<ShellScratch>();
  ShellScratch& scratch = *workspace.shell;
  const ShellRoles roles = shellRoles(query);
  const SolidHistory::State before = stateBefore(query);
  ShellApproach approach(query, roles, before, scratch.sides, scratch.crossings);
  const ShellState state = approach.decide(!workspace.intersecting.empty());
  scratch.contacts.clear();
  double deepest = 0;
  if (state != ShellState::kApart) {
    ShellContacts maker(roles, approach.surface(), scratch);
    if (state == ShellState::kMeeting) {
      scratch.distinct = workspace.intersecting;
      FirstCopies(query).dropOthers(scratch.distinct);
      takePairs(roles, scratch.distinct, scratch.pairs);
      maker.ofMeeting();
    } else {
      maker.ofThrough();
    }
    workspace.stats.contactsBeforeReduction = scratch.contacts.size();
    reduce(query.options, maker, scratch.contacts);
    leaveAlike(approach.surface(), scratch.contacts);
    const MotionLimit limit(query);
    for (Contact& c : scratch.contacts) {
      cutDepth(c, limit(placed(query, roles, c)));
      deepest = std::max(deepest, c.depth);
    }
    limitTogether(kDeepest * roles.size, scratch.contacts);
    makeConsistent(scratch.contacts, smallerRadius(query));
    if (state == ShellState::kMeeting && scratch.contacts.empty()) {
      addStops(roles, approach.surface(), scratch.pairs, scratch.contacts);
      if (query.options.reduction.method == Reduction::kBinning)
        scratch.contacts = reduceByBinning(scratch.contacts, query.options.reduction.bins);
    }
  }
  remember(query, roles, before, approach, state, scratch.contacts);
  keepDeepest(query, deepest);
  for (const Contact& c : scratch.contacts) workspace.contacts.push_back(placed(query, roles, c));
  limitContacts(workspace.contacts, query.options.maxContacts, workspace.reduced);
  if (query.options.timings) {
    workspace.stats.contactsMs = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
}

}  // namespace otg
