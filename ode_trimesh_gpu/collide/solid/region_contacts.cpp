// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/region_contacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "base/flat_map.h"
#include "base/vectors.h"
#include "collide/inside_test.h"
#include "collide/simd/surface_kernels.h"
#include "collide/solid/deepest_pass.h"
#include "collide/solid/facing_pieces.h"
#include "collide/solid/leaving.h"
#include "collide/solid/region_planes.h"
#include "collide/solid/support_point.h"
#include "shared/contacts/uneven_model.h"

namespace otg {
namespace {

/// A support point on its way to a contact.
struct Candidate {
  const SupportPoint* point;
  Vec3d at;     ///< the point's place; on a stretch where that is deepest
  Vec3d probe;  ///< where it is measured: moved a little into the region
  Vec3d normal;
  double depth;       ///< estimated, later measured
  double rank;        ///< depth weighted by kind
  double out, back;   ///< how far it is out of B along the normal, and out of A against it
  double shift;       ///< of the middle of the overlap from the point, along the normal
  double passes = 0;  ///< how far a stretch must go along the normal past one of the other mesh
  int step = 0;       ///< rank below the highest, in steps of OTG_SOLID_RANK_STEP
  int way = 0;        ///< its number, where one point leaves by several
};

class RegionSolver {
 public:
  explicit RegionSolver(const RegionTask& task)
      : task_(task),
        region_(task.region),
        all_(task.all),
        memory_(task.all.memory),
        surface_{PlaneSet(memory_), PlaneSet(memory_)},
        triangles_(memory_),
        candidates_(memory_),
        stretches_{std::pmr::vector<const SupportPoint*>(memory_), std::pmr::vector<const SupportPoint*>(memory_)} {}

  bool run(std::vector<Contact>& out) {
    gathered_ = region_.cellEnd > region_.cellBegin;
    center_ = centroid();
    isUneven_ = isUneven(region_, task_.normals, task_.extent);
    if (isUneven_) {
      triangles_.collect(task_.meshes, all_, region_);
    } else if (collectPlanes(all_, region_, surface_)) {
      gathered_ = true;
    }
    collectCandidates();
    filterAndMerge();
    const auto most = static_cast<std::size_t>(task_.maxContacts);
    if (gathered_) {
      chooseSpread(OTG_SOLID_MEASURED_PER_CONTACT * most);
      for (Candidate& c : candidates_) measureByRays(c);
      bringDeepestFirst();
    }
    chooseSpread(most);
    if (!gathered_ && !isUneven_) {
      for (Candidate& c : candidates_) measureByRays(c);
    }
    eraseShallow(1);
    raiseDeepest();
    if (!isUneven_ && region_.cellEnd == region_.cellBegin) addDeepestPass(most);
    emit(out);
    return isUneven_;
  }

 private:
  static constexpr double kWithin = OTG_UNEVEN_WITHIN;
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  static constexpr double kEstimated = 0.5;  ///< of the fractions at which depths are shallow: estimates err
  static constexpr double kGrain = 1e-9;     ///< of the region's diagonal: rounding
  Vec3d centroid() const {
    Vec3d sum{0, 0, 0};
    for (std::uint32_t i = region_.pointBegin; i < region_.pointEnd; ++i) sum = otgAdd(sum, all_.points[i].position);
    const std::uint32_t n = region_.pointEnd - region_.pointBegin;
    return n ? otgScale(sum, 1.0 / n) : otgScale(otgAdd(region_.lo, region_.hi), 0.5);
  }

  /// Way out of mesh m through the nearest of its planes that faces along the direction and has its surface there;
  /// where none has, through the nearest plane of all, which is right for convex bodies.
  double planeExit(int m, const Vec3d& p, const Vec3d& direction) const {
    return surface_[m].wayOut(p, direction, OTG_SOLID_PIECE_SLACK * region_.diagonal).either();
  }

  /// Clamps both ways out and their sum, which is returned, to the region's extent along n. That is worked out only
  /// when the few points that the region keeps do not reach as far.
  double clampToLimit(const Vec3d& n, double& out, double& back) {
    if (region_.cellEnd > region_.cellBegin && out + back <= task_.extent.ofPoints(n)) return out + back;
    const double limit = std::isfinite(task_.mostDepth) ? task_.mostDepth : task_.extent.along(n) + task_.extraDepth;
    out = std::min(out, limit);
    back = std::min(back, limit);
    return std::min(out + back, limit);
  }

  /// Which points to look at: all; of a very large region, in each cell of a grid, the deepest of each kind and mesh
  /// along the mean direction.
  std::pmr::vector<std::uint32_t> thinned() {
    std::pmr::vector<std::uint32_t> looked(memory_), chosen(memory_);
    looked.reserve(region_.pointEnd - region_.pointBegin);
    const bool withoutFlat = isUneven_ && hasCorners();
    for (std::uint32_t i = region_.pointBegin; i < region_.pointEnd; ++i) {
      if (!withoutFlat || !all_.points[i].flat) looked.push_back(i);
    }
    if (looked.size() <= OTG_SOLID_MOST_POINTS) return looked;
    const double cell = region_.diagonal / OTG_SOLID_POINT_CELLS;
    FlatMap index(memory_);
    for (const std::uint32_t i : looked) {
      const SupportPoint& p = all_.points[i];
      const auto coordinate = [&](double x, double lo) {
        return static_cast<std::uint64_t>(std::max(0.0, (x - lo) / cell));
      };
      const std::uint64_t key = coordinate(p.position.x, region_.lo.x) | coordinate(p.position.y, region_.lo.y) << 8 |
                                coordinate(p.position.z, region_.lo.z) << 16 |
                                static_cast<std::uint64_t>(p.kind) << 24 | std::uint64_t{p.mesh} << 32;
      bool inserted = false;
      std::uint32_t& slot = index.insert(key, static_cast<std::uint32_t>(chosen.size()), &inserted);
      if (inserted) {
        chosen.push_back(i);
      } else if (depthHint(p) > depthHint(all_.points[chosen[slot]])) {
        chosen[slot] = i;
      }
    }
    return chosen;
  }

  /// Larger for a point that lies deeper in the other mesh as far as the region's mean direction can show.
  double depthHint(const SupportPoint& p) const {
    return (p.mesh == 0 ? -1 : 1) * otgDot(task_.normals.mean(), p.position);
  }

  /// The corners of an overlap are never flat points, as long as anything is not flat.
  bool hasCorners() const {
    const auto first = all_.points.begin() + region_.pointBegin, last = all_.points.begin() + region_.pointEnd;
    return std::count_if(first, last, [](const SupportPoint& p) { return !p.flat; }) >= 3;
  }

  void collectCandidates() {
    const std::pmr::vector<std::uint32_t> points = thinned();
    candidates_.reserve(points.size());
    if (isUneven_) {
      collectUneven(points);
    } else {
      // Between curved bodies flat ones still help to come near to the deepest place, which is at no corner.
      const bool withoutFlat = task_.normals.isFlat() && hasCorners();
      for (const std::uint32_t i : points) {
        if (!withoutFlat || !all_.points[i].flat) collectEven(all_.points[i]);
      }
    }
    if (candidates_.empty()) {
      fallback_.position = center_;
      fallback_.kind = PointKind::kCrossing;
      fallback_.feature = fallback_.rank = fallback_.triangleA = fallback_.triangleB = kNone;
      Candidate c{&fallback_, center_, center_, task_.normals.at(center_), 0, 0, 0, 0, 0};
      // Of an uneven region nothing is below a face: surfaces that lie on each other to rounding.
      if (!isUneven_) estimate(c);
      candidates_.push_back(c);
    }
  }

  Candidate candidateAt(const SupportPoint& p) const {
    Candidate c{&p, p.position, p.position, {}, 0, 0, 0, 0, 0};
    c.probe = otgProbe(p.position, p.along, p.reach, p.surfaceNormal, static_cast<int>(p.kind), region_.diagonal,
                       region_.thickness);
    return c;
  }

  void collectEven(const SupportPoint& p) {
    Candidate c = candidateAt(p);
    c.normal = task_.normals.at(c.probe);
    if (otgEndsAt(p.faceNormal, c.normal, p.mesh)) return;
    if (const SupportPoint* other = passed(c)) {
      const StretchPass<double> pass = passOf(p, *other, c.normal);
      const Vec3d moved = otgScale(p.along, pass.at);
      c.passes = pass.way;
      c.at = otgAdd(c.at, moved);
      c.probe = otgAdd(c.probe, moved);
      c.normal = task_.normals.at(c.probe);
    }
    estimate(c);
    if (p.kind >= PointKind::kMiddle && (isShallow(c, kEstimated, deepestEven_) || saysNothingNew(c))) return;
    candidates_.push_back(c);
    deepestEven_ = std::max(deepestEven_, c.depth);
  }

  /// Whether a candidate is dropped for its depth, beside the deepest times `share`.
  static bool isShallow(const Candidate& c, double share, double deepest) {
    return !(c.depth >= otgLeastOfKind(static_cast<int>(c.point->kind), share * deepest));
  }

  StretchPass<double> passOf(const SupportPoint& p, const SupportPoint& q, const Vec3d& normal) const {
    return otgPassOfStretches(otgSub(q.position, p.position), p.along, p.reach, q.along, q.reach,
                              p.mesh == 0 ? normal : otgScale(normal, -1.0));
  }

  /// Where two edges cross each other, seen along the normal, they are deepest, and not in their middles: the stretch
  /// of the other mesh that this one passes deepest, or null. Regions described by cells keep no stretches.
  const SupportPoint* passed(const Candidate& c) {
    const SupportPoint& p = *c.point;
    if (p.kind < PointKind::kMiddle || region_.cellEnd > region_.cellBegin) return nullptr;
    if (!hasStretches_) collectStretches();
    const SupportPoint* deepest = nullptr;
    double most = 0;
    for (const SupportPoint* q : stretches_[1 - p.mesh]) {
      if (otgAreBeside(otgSub(q->position, p.position), p.reach, q->reach, c.normal) != 0) continue;
      const double way = passOf(p, *q, c.normal).way;
      if (!(way > most)) continue;
      most = way;
      deepest = q;
    }
    return deepest;
  }

  void collectStretches() {
    hasStretches_ = true;
    for (std::uint32_t i = region_.pointBegin; i < region_.pointEnd; ++i) {
      const SupportPoint& p = all_.points[i];
      if (p.kind >= PointKind::kMiddle) stretches_[p.mesh].push_back(&p);
    }
  }

  void estimate(Candidate& c) {
    c.out = planeExit(1, c.probe, c.normal);
    c.back = planeExit(0, c.probe, otgScale(c.normal, -1.0));
    c.depth = clampToLimit(c.normal, c.out, c.back);
    c.shift = 0.5 * (c.out - c.back);
    // By what the planes say, not by the limit, to which whole patches of a thick region are cut.
    c.rank = otgRankOfKind(static_cast<int>(c.point->kind), c.out + c.back);
  }

  /// An uneven region goes round a corner: its vertices and stretches of edges leave it each by its own face. Crossings
  /// are no part of what has to leave. They show how far contacts reach, by a direction of one of the others and no
  /// deeper than that.
  void collectUneven(const std::pmr::vector<std::uint32_t>& points) {
    const SupportPoint* last = nullptr;
    int number = 0;
    for (const Leave& leave : leavesOf(triangles_, all_, points)) {
      Candidate c{leave.point, leave.at, leave.at, leave.normal, 0, 0, 0, 0, 0};
      c.way = number = leave.point == last ? number + 1 : 0;
      last = leave.point;
      double depth = std::min(leave.depth, task_.extent.along(leave.normal));
      const Vec3d local = leave.curved ? task_.normals.at(leave.at) : leave.normal;
      if (const double cosine = otgDot(local, c.normal); leave.curved && cosine >= OTG_SOLID_ONE_WAY) {
        c.normal = local;
        depth /= cosine;
      }
      (leave.point->mesh == 0 ? c.out : c.back) = depth;
      addMeasured(c);
    }
    const std::pmr::vector<Way> ways = waysOfCandidates();
    double deepest = 0;
    WaySet set(memory_);
    for (const Way& way : ways) {
      deepest = std::max(deepest, way.depth);
      set.add(way.normal, way.depth);
    }
    for (const std::uint32_t i : points) {
      if (all_.points[i].kind != PointKind::kCrossing || ways.empty()) continue;
      Candidate c = candidateAt(all_.points[i]);
      const Vec3d ending = otgScale(c.point->faceNormal, c.point->mesh == 0 ? 1.0 : -1.0);
      const auto shortest = triangles_.shortestWay(c.probe, set, kWithin * deepest, ending);
      if (!shortest) continue;
      c.normal = ways[shortest->way].normal;
      c.out = shortest->out;
      c.back = shortest->back;
      addMeasured(c);
    }
  }

  /// A direction in which candidates leave, and the deepest of them.
  struct Way {
    Vec3d normal;
    double depth;
  };

  std::pmr::vector<Way> waysOfCandidates() const {
    std::pmr::vector<Way> ways(memory_);
    for (const Candidate& c : candidates_) {
      const auto same = std::find_if(ways.begin(), ways.end(), [&](const Way& w) {
        return w.normal.x == c.normal.x && w.normal.y == c.normal.y && w.normal.z == c.normal.z;
      });
      if (same == ways.end()) {
        ways.push_back({c.normal, c.depth});
      } else {
        same->depth = std::max(same->depth, c.depth);
      }
    }
    return ways;
  }

  void addMeasured(Candidate& c) {
    limitToNeighbourhood(c);
    c.depth = c.out + c.back;
    c.shift = 0.5 * (c.out - c.back);
    c.rank = otgRankOfKind(static_cast<int>(c.point->kind), c.depth);
    if (c.depth > 0) candidates_.push_back(c);
  }

  /// A contact is no deeper than three times the distance of its point from the surface that faces its way. More is
  /// requested where a point lies in one face and below the next.
  void limitToNeighbourhood(Candidate& c) const {
    const auto limit = [&](int m, double& way, const Vec3d& direction) {
      way = otgNeighbourhood(way, triangles_.distanceToFacing(m, c.at, direction, otgEnoughToGo(way)));
    };
    if (c.out > 0) limit(1, c.out, c.normal);
    if (c.back > 0) limit(0, c.back, otgScale(c.normal, -1.0));
  }

  /// Whether a middle of a stretch is hardly deeper than its ends are on average: then they hold it.
  bool saysNothingNew(const Candidate& c) {
    double ends = 0;
    const double reach = otgReachOfEnds(c.point->reach, region_.diagonal);
    const Vec3d middle = otgAdd(c.probe, otgSub(c.point->position, c.at));
    for (const double side : {-1.0, 1.0}) {
      const Vec3d p = otgAdd(middle, otgScale(c.point->along, side * reach));
      double out = planeExit(1, p, c.normal), back = planeExit(0, p, otgScale(c.normal, -1.0));
      ends += 0.5 * clampToLimit(c.normal, out, back);
      if (c.depth <= OTG_SOLID_DEEPER_THAN_ENDS * ends) return true;
    }
    return false;
  }

  static bool sameFeatureOrder(const Candidate& x, const Candidate& y) {
    const SupportPoint &p = *x.point, &q = *y.point;
    if (p.kind != q.kind) return p.kind < q.kind;
    if (p.mesh != q.mesh) return p.mesh < q.mesh;
    if (p.rank != q.rank) return p.rank < q.rank;
    return p.ordinal != q.ordinal ? p.ordinal < q.ordinal : x.way < y.way;
  }

  /// Where the contact would be: the middle of the overlap, beside the point and not beside the probe.
  static Vec3d middle(const Candidate& c) {
    const double moved = otgDot(otgSub(c.probe, c.at), c.normal);
    return otgAdd(c.at, otgScale(c.normal, moved + c.shift));
  }

  double deepest() const {
    double d = 0;
    for (const Candidate& c : candidates_) d = std::max(d, c.depth);
    return d;
  }

  /// Drops what is shallow for its kind, then of points that lie together and agree in direction all but the first.
  void filterAndMerge() {
    eraseShallow(kEstimated);
    double highest = 0;
    for (const Candidate& c : candidates_) highest = std::max(highest, c.rank);
    for (Candidate& c : candidates_) {
      c.step = otgRankStep(c.rank, highest);
    }
    std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& x, const Candidate& y) {
      return x.step != y.step ? x.step < y.step : sameFeatureOrder(x, y);
    });
    // Where the bodies are round the deepest is one point, and it is the first; where they are flat many tremble about
    // it.
    if (!task_.normals.isFlat() && !candidates_.empty()) {
      const auto first =
          std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& c) { return c.rank >= highest; });
      std::rotate(candidates_.begin(), first, first + 1);
    }
    std::pmr::vector<Candidate> kept(memory_);
    kept.reserve(candidates_.size());
    const double reach = OTG_SOLID_MERGE_DISTANCE * region_.diagonal;
    std::pmr::vector<Vec3d> middles(memory_);  // of those kept
    middles.reserve(candidates_.size());
    for (const Candidate& c : candidates_) {
      const Vec3d at = middle(c);
      bool taken = false;
      for (std::size_t k = 0; k < kept.size() && !taken; ++k) {
        const Vec3d d = otgSub(at, middles[k]);
        taken = otgDot(d, d) <= reach * reach && otgDot(c.normal, kept[k].normal) >= OTG_SOLID_MERGE_COSINE;
      }
      if (taken) continue;
      kept.push_back(c);
      middles.push_back(at);
    }
    candidates_.swap(kept);
    if (!gathered_ || candidates_.empty()) return;
    // Estimates from gathered planes err by a few percent. Of those that they cannot distinguish the farthest in of
    // either mesh are measured, and the deeper one is first.
    const double enough = (1 - OTG_SOLID_GATHERED_ERROR) * highest;
    auto deepest = candidates_.end();
    for (const std::uint8_t m : {0, 1}) {
      auto best = candidates_.end();
      for (auto c = candidates_.begin(); c != candidates_.end(); ++c) {
        if (c->point->mesh != m || c->rank < enough) continue;
        if (best == candidates_.end() || depthHint(*c->point) > depthHint(*best->point)) best = c;
      }
      if (best == candidates_.end()) continue;
      measureByRays(*best);
      if (deepest == candidates_.end() || best->depth > deepest->depth) deepest = best;
    }
    if (deepest != candidates_.end()) std::rotate(candidates_.begin(), deepest, deepest + 1);
  }

  /// The deepest, then again and again the one farthest from those chosen, in position and normal, its square weighted
  /// by depth: where a body is held counts as much as how firmly, or the shallow rim of a ring would take every place.
  void chooseSpread(std::size_t most) {
    struct Spot {
      Vec3d at, normal;
      double depth, spread;  ///< spread: distance from the chosen ones so far
      std::size_t place;     ///< among the candidates
    };
    std::pmr::vector<Spot> spots(memory_);
    spots.reserve(candidates_.size());
    for (const Candidate& c : candidates_) spots.push_back({c.at, c.normal, c.depth, kFar, spots.size()});
    const double scale = region_.diagonal > 0 ? 1 / (region_.diagonal * region_.diagonal) : 0;
    const double deep = deepest();
    const std::size_t count = std::min(most, spots.size());
    for (std::size_t i = 1; i < count; ++i) {
      const Spot& last = spots[i - 1];
      std::size_t best = i;
      double mostWorth = 0;
      for (std::size_t j = i; j < spots.size(); ++j) {
        Spot& s = spots[j];
        s.spread = std::min(s.spread, otgApart(s.at, s.normal, last.at, last.normal, scale));
        const double worth = otgWorth(s.spread, s.depth, deep);
        if (j > i && !(worth > OTG_SOLID_FARTHER * mostWorth)) continue;
        mostWorth = worth;
        best = j;
      }
      std::rotate(spots.begin() + static_cast<std::ptrdiff_t>(i), spots.begin() + static_cast<std::ptrdiff_t>(best),
                  spots.begin() + static_cast<std::ptrdiff_t>(best) + 1);
    }
    std::pmr::vector<Candidate> chosen(memory_);
    chosen.reserve(count);
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(candidates_[spots[i].place]);
    candidates_.swap(chosen);
  }

  void measureByRays(Candidate& c) {
    // Looked for as far as the meshes reach: a point inside finds its way out in every direction, so nothing ahead
    // means outside.
    const double far = 4 * static_cast<double>(task_.meshes.mesh(0).radius() + task_.meshes.mesh(1).radius());
    const double skin = 1e-9 * std::max(task_.meshes.mesh(0).radius(), task_.meshes.mesh(1).radius());
    const Vec3d origin = otgAdd(c.probe, all_.origin);
    double out = std::max(0.0, exitDistance(task_.meshes, 1, origin, c.normal, far, skin));
    double back = std::max(0.0, exitDistance(task_.meshes, 0, origin, otgScale(c.normal, -1.0), far, skin));
    const double depth = clampToLimit(c.normal, out, back);
    if (otgLeavesBeside(depth, c.depth, c.passes)) return;
    c.depth = depth;
    c.shift = 0.5 * (out - back);
  }

  void bringDeepestFirst() {
    const auto deepest = deepestCandidate();
    if (deepest != candidates_.end()) std::rotate(candidates_.begin(), deepest, deepest + 1);
  }

  /// Drops what is shallow for its kind, beside the deepest times `share`. Where a region goes round a corner only
  /// points that push the same way count: an overlap may be far deeper in one wall than in the other.
  void eraseShallow(double share) {
    std::pmr::vector<double> least(candidates_.size(), share * deepest(), memory_);
    if (isUneven_) {
      std::pmr::vector<const Candidate*> deepestFirst(memory_);
      deepestFirst.reserve(candidates_.size());
      for (const Candidate& c : candidates_) deepestFirst.push_back(&c);
      std::sort(deepestFirst.begin(), deepestFirst.end(),
                [](const Candidate* x, const Candidate* y) { return x->depth > y->depth; });
      std::transform(candidates_.begin(), candidates_.end(), least.begin(), [&](const Candidate& c) {
        const auto first = std::find_if(deepestFirst.begin(), deepestFirst.end(), [&](const Candidate* x) {
          return otgDot(x->normal, c.normal) >= OTG_SOLID_MERGE_COSINE;
        });
        return first == deepestFirst.end() ? 0 : share * (*first)->depth;
      });
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (!isShallow(candidates_[i], 1, least[i])) candidates_[kept++] = candidates_[i];
    }
    candidates_.resize(kept);
  }

  std::pmr::vector<Candidate>::iterator deepestCandidate() {
    return std::max_element(candidates_.begin(), candidates_.end(),
                            [](const Candidate& x, const Candidate& y) { return x.depth < y.depth; });
  }

  /// Edges that cross each other may be deepest beyond the stretches that are inside.
  void raiseDeepest() {
    const auto deepest = deepestCandidate();
    if (deepest != candidates_.end()) deepest->depth = std::max(deepest->depth, task_.leastDepth);
  }

  /// Few facets are deepest where two of their edges pass each other, and not all edges are candidates.
  void addDeepestPass(std::size_t most) {
    const auto deepest = deepestCandidate();
    if (deepest == candidates_.end() || std::isfinite(task_.mostDepth) || contradictsItself(region_)) return;
    const std::optional<EdgePass> pass =
        deepestPass(task_.meshes, all_, region_, deepest->normal, OTG_SOLID_DEEPER_THAN_ENDS * deepest->depth);
    if (!pass) return;
    if (pass->point == nullptr) {
      const Vec3d span = otgScale(pass->along, pass->reach);
      passing_ = supportPoint(
          task_.meshes, {pass->middle, span, 0, pass->edge, pass->ordinal, kNone, 0, PointKind::kMiddle, false}, kNone);
    }
    const SupportPoint* const point = pass->point != nullptr ? pass->point : &passing_;
    const Vec3d at = otgAdd(pass->middle, otgScale(pass->along, pass->at));
    const Candidate added{point, at, at, deepest->normal, pass->way, 0, pass->way, 0, 0.5 * pass->way};
    const auto same =
        std::find_if(candidates_.begin(), candidates_.end(), [&](const Candidate& c) { return c.point == point; });
    if (same != candidates_.end()) {
      *same = added;
    } else if (candidates_.size() < most) {
      candidates_.push_back(added);
    } else {
      candidates_.back() = added;
    }
  }

  void emit(std::vector<Contact>& out) {
    std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& x, const Candidate& y) {
      return x.depth != y.depth ? x.depth > y.depth : sameFeatureOrder(x, y);
    });
    const FacingPieces facing(all_, region_);
    for (const Candidate& c : candidates_) {
      const Vec3d position = otgAdd(middle(c), all_.origin);
      const std::uint32_t a = c.point->triangleA, b = c.point->triangleB;
      Contact contact{position,
                      c.normal,
                      c.depth,
                      a != kNone ? a : facing.triangleOf(0, c.probe, otgScale(c.normal, -1.0)),
                      b != kNone ? b : facing.triangleOf(1, c.probe, c.normal),
                      task_.regionIndex,
                      c.point->feature == kNone ? ContactFeature::kNone : featureOf(*c.point)};
      if (c.point->feature == kNone || c.point->kind != PointKind::kCrossing) contact.flags |= kContactInside;
      if (region_.contained) contact.flags |= kContactContained;
      contact.element = c.point->feature;
      contact.ordinal = c.point->ordinal;
      contact.coherence = region_.coherence;
      if (contact.feature == ContactFeature::kNone) {  // nothing of its own sets it apart from another such region
        contact.ordinal = static_cast<std::uint32_t>(std::count_if(out.begin(), out.end(), [&](const Contact& x) {
          return x.feature == contact.feature && x.triangleA == contact.triangleA && x.triangleB == contact.triangleB;
        }));
      }
      assert(!isUneven_ || keepsNeighbourhood(c));
      out.push_back(contact);
    }
  }

  /// Whether an uneven region's contact is no deeper than limitToNeighbourhood() lets it be.
  [[maybe_unused]] bool keepsNeighbourhood(const Candidate& c) const {
    const auto isNear = [&](int m, double way, const Vec3d& direction) {
      const double most = OTG_SOLID_NEIGHBOURHOOD * triangles_.distanceToFacing(m, c.at, direction, kFar);
      return way <= most + kGrain * region_.diagonal;
    };
    return isNear(1, c.depth / 2 + c.shift, c.normal) && isNear(0, c.depth / 2 - c.shift, otgScale(c.normal, -1.0));
  }

  const RegionTask& task_;
  const Region& region_;
  const OverlapRegions& all_;
  std::pmr::memory_resource* memory_;
  Vec3d center_{};
  PlaneSet surface_[2];
  bool gathered_ = false;  ///< planes stand for several pieces each
  bool isUneven_ = false;  ///< each point leaves by the faces nearest to it, and is measured on the triangles
  RegionTriangles triangles_;
  std::pmr::vector<Candidate> candidates_;
  double deepestEven_ = 0;                              ///< of what collectEven() has added
  std::pmr::vector<const SupportPoint*> stretches_[2];  ///< in the order of the points
  bool hasStretches_ = false;
  SupportPoint fallback_{}, passing_{};
};

}  // namespace

bool contradictsItself(const Region& region) {
  if (region.coherence >= OTG_SOLID_COHERENT) return false;
  return region.cellEnd > region.cellBegin || region.contained ||
         (!region.bad && !otgIsLayered(region.thickness, region.diagonal, region.areaA, region.areaB));
}

bool isUneven(const Region& region, const RegionNormals& normals, RegionExtent& extent) {
  if (region.cellEnd > region.cellBegin || normals.isFixed()) return false;
  if (region.bad || region.coherence < OTG_SOLID_COHERENT) return !contradictsItself(region);
  return region.roundCorner || otgIsUneven(extent.along(normals.mean()), region.thickness) != 0;
}

bool contactsOfRegion(const RegionTask& task, std::vector<Contact>& out) {
  return RegionSolver(task).run(out);
}

}  // namespace otg
