// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/escape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <list>
#include <optional>

#include "base/flat_map.h"
#include "base/insertion_sort.h"
#include "base/vectors.h"
#include "collide/inside_test.h"
#include "collide/simd/surface_kernels.h"
#include "collide/solid/edge_pair.h"
#include "collide/solid/region_contacts.h"
#include "collide/solid/support_point.h"
#include "shared/contacts/escape_turns.h"

namespace otg {
namespace {

/// The directions of a cube's faces, edges and corners.
std::array<Vec3d, 26> axes26() {
  std::array<Vec3d, 26> out{};
  std::size_t count = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x || y || z) out[count++] = unit({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
      }
    }
  }
  return out;
}

/// Up to six mean directions of the region's faces of one mesh, in the sense in which they push A; faces first that
/// have the most area.
std::pmr::vector<Vec3d> faceDirections(const OverlapRegions& all, const Region& region, int mesh) {
  struct Cluster {
    Vec3d first, sum;
    double area;
  };
  struct Place {
    double area;
    std::uint32_t triangle, piece;
  };
  std::pmr::vector<Place> order(all.memory);
  order.reserve(region.pieceEnd - region.pieceBegin);
  for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
    const Piece& p = all.pieces[i];
    if (p.mesh == mesh) order.push_back({p.area, p.triangle, i});
  }
  std::sort(order.begin(), order.end(), [](const Place& x, const Place& y) {
    if (x.area != y.area) return x.area > y.area;
    // Regular meshes have equal pieces, and those of two vertices may go by one triangle.
    return x.triangle != y.triangle ? x.triangle < y.triangle : x.piece < y.piece;
  });
  std::pmr::vector<Cluster> clusters(all.memory);
  for (const Place& place : order) {
    const Piece& p = all.pieces[place.piece];
    const Vec3d n = mesh == 0 ? p.normal * -1.0 : p.normal;
    auto it = std::find_if(clusters.begin(), clusters.end(),
                           [&](const Cluster& c) { return otgDot(c.first, n) >= OTG_SOLID_FACE_COSINE; });
    if (it == clusters.end()) {
      if (clusters.size() == OTG_SOLID_FACE_CLUSTERS) continue;
      clusters.push_back({n, {0, 0, 0}, 0});
      it = clusters.end() - 1;
    }
    it->sum = it->sum + n * p.area;
    it->area += p.area;
  }
  const double least = 0.01 * (region.areaA + region.areaB);
  insertionSort(clusters.begin(), clusters.end(), [](const Cluster& x, const Cluster& y) { return x.area > y.area; });
  std::pmr::vector<Vec3d> out(all.memory);
  for (const Cluster& c : clusters) {
    if (c.area > least && out.size() < OTG_SOLID_DEEP_FACES) out.push_back(unit(c.sum));
  }
  return out;
}

/// How far A must go along a direction until the region is gone, by the planes of its pieces: for a convex overlap that
/// is exact. (The region's extent would not do: a spike is thin sideways, and yet only its tip is the way out.)
class WayOutByPlanes {
 public:
  WayOutByPlanes(const OverlapRegions& all, const Region& region, double far)
      : all_(all),
        far_(far),
        planes_(all.memory),
        ahead_{std::pmr::vector<Barrier>(all.memory), std::pmr::vector<Barrier>(all.memory)},
        points_(all.memory) {
    collectPlanes(region);
    const std::uint32_t count = region.pointEnd - region.pointBegin;
    const std::uint32_t stride = std::max(1u, count / OTG_SOLID_DEEP_POINTS);
    points_.reserve(count / stride + 1);
    for (std::uint32_t i = region.pointBegin; i < region.pointEnd; i += stride) points_.add(all.points[i].position);
  }

  /// Stops when the result is at least `enough`.
  double along(const Vec3d& d, double enough) {
    for (std::pmr::vector<Barrier>& ahead : ahead_) ahead.clear();
    for (const Plane& plane : planes_) {
      const double cosine = plane.mesh == 1 ? otgDot(plane.normal, d) : -otgDot(plane.normal, d);
      if (cosine > 0.05) ahead_[plane.mesh].push_back({plane.normal * (1 / cosine), plane.offset / cosine});
    }
    return points_.farthestWay(ahead_[0], ahead_[1], far_, enough);
  }

 private:
  struct Plane {
    Vec3d normal;
    double offset;
    std::uint8_t mesh;
  };

  /// Every piece, or for very many one plane for each mesh and small range of normals. None may be left out: a missing
  /// plane makes the way through it look long, and the way through those that are there would win.
  void collectPlanes(const Region& region) {
    const bool gather = region.pieceEnd - region.pieceBegin > OTG_SOLID_DEEP_PIECES;
    FlatMap index(all_.memory);
    for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
      const Piece& p = all_.pieces[i];
      auto slot = static_cast<std::uint32_t>(planes_.size());
      if (gather) slot = index.insert(std::uint64_t{p.mesh} << 32 | cellOf(p.normal), slot);
      if (slot == planes_.size()) planes_.push_back({{0, 0, 0}, 0, p.mesh});
      planes_[slot].normal = planes_[slot].normal + p.normal * p.area;
      planes_[slot].offset += p.offset * p.area;
    }
    for (Plane& plane : planes_) {
      const double length = std::sqrt(otgDot(plane.normal, plane.normal));
      if (!(length > 0)) continue;
      plane.normal = plane.normal * (1 / length);
      plane.offset /= length;
    }
  }

  /// Cell of a direction on the faces of a cube; the first one of no direction, which a piece of a thin triangle may
  /// have.
  static std::uint32_t cellOf(const Vec3d& n) {
    const double v[3] = {n.x, n.y, n.z};
    std::uint32_t axis = 0;
    for (std::uint32_t k = 1; k < 3; ++k) {
      if (std::fabs(v[k]) > std::fabs(v[axis])) axis = k;
    }
    if (!(std::fabs(v[axis]) > 0)) return 0;
    const auto cell = [&](double x) {
      return static_cast<std::uint32_t>((x / std::fabs(v[axis]) + 1) * (0.5 * OTG_SOLID_NORMAL_CELLS));
    };
    const std::uint32_t face = 2 * axis + (v[axis] < 0 ? 1 : 0);
    return face << 16 | cell(v[(axis + 1) % 3]) << 8 | cell(v[(axis + 2) % 3]);
  }

  const OverlapRegions& all_;
  double far_;
  std::pmr::vector<Plane> planes_;
  std::pmr::vector<Barrier> ahead_[2];  ///< of each mesh, scaled so that a plane's value is the way to it along d
  PointSet points_;
};

/// How far A must go along d until nothing is left of the overlap on lines through the region: through its middle where
/// one body is wholly inside the other, else through some of its points, too. Rays see both meshes whole. So a body
/// that pierces the other one is not taken for as short as what is in the other one.
class WayOutByRays {
 public:
  /// `behind`: the way out of a sheet where no surface of it is ahead.
  WayOutByRays(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region, double behind = 0)
      : meshes_(meshes),
        noneAhead_{meshes.isSolid(0) ? 0 : behind, meshes.isSolid(1) ? 0 : behind},
        far_(4 * static_cast<double>(meshes.mesh(0).radius() + meshes.mesh(1).radius())),
        origins_(all.memory) {
    const Vec3d middle = (region.lo + region.hi) * 0.5;
    origins_.push_back(all.origin + middle);
    const std::uint32_t count = region.pointEnd - region.pointBegin;
    const std::uint32_t chosen = std::min<std::uint32_t>(count, kPoints);
    for (std::uint32_t i = 0; i < chosen; ++i) {
      const std::uint32_t k = region.pointBegin + static_cast<std::uint32_t>(std::uint64_t{i} * count / chosen);
      // From a little inside: the points themselves lie on the surfaces.
      const Vec3d& p = all.points[k].position;
      origins_.push_back(all.origin + (p + (middle - p) * OTG_ESCAPE_INWARDS));
    }
  }

  /// Stops when the result is at least `enough`.
  double along(const Vec3d& d, double enough) const {
    double most = 0;
    for (const Vec3d& p : origins_) {
      most = std::max(most, out(1, p, d) + out(0, p, d * -1.0));
      if (most >= enough) break;
    }
    return most;
  }

 private:
  static constexpr std::uint32_t kPoints = OTG_ESCAPE_ORIGINS - 1;
  double out(int mesh, const Vec3d& p, const Vec3d& d) const {
    const double distance = exitDistance(meshes_, mesh, p, d, far_, 0);
    return distance < 0 ? noneAhead_[mesh] : distance;
  }
  const PlacedMeshes& meshes_;
  double noneAhead_[2];
  double far_;
  std::pmr::vector<Vec3d> origins_;
};

/// The shortest way out among many directions, those that undo the approach made cheaper by up to half.
class Escape {
 public:
  Escape(const PairMotion& motion, std::pmr::memory_resource* memory) : back_(motion.back), parts_(memory) {}

  /// A region that has to leave.
  void add(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region, RegionExtent& extent) {
    const bool isThin = !region.contained && !otgIsLump(region.thickness, region.diagonal);
    parts_.push_back({&region, &extent, isThin, WayOutByRays(meshes, all, region)});
    areThin_ = areThin_ && isThin;
  }

  /// What is looked at first, in this order, and then around the best of it.
  void search(const Transformd& bInA) {
    for (const Vec3d& d : axes26()) offer(d);
    for (const Part& part : parts_) offer(unit(part.region->push));
    offer(back_);
    const double* r = bInA.r;
    for (int k = 0; k < 3; ++k) {
      const Vec3d axis{r[k], r[3 + k], r[6 + k]};
      offer(axis);
      offer(axis * -1.0);
    }
    refine();
  }
  const Vec3d& best() const { return best_; }

 private:
  struct Part {
    const Region* region;
    RegionExtent* extent;
    bool isThin;  ///< surfaces that run along each other all around, as those of a nut and its bolt: no side is out
    WayOutByRays rays;
  };

  void offer(const Vec3d& d) {
    if (!(otgDot(d, d) > 0)) return;
    const double factor = 1 - 0.5 * std::max(0.0, otgDot(d, back_));
    const double cost = factor * along(d, least_ / factor);
    if (cost < least_) {
      least_ = cost;
      best_ = d;
    }
  }
  /// Sideways from the best so far, by ever smaller steps.
  void refine() {
    if (areThin_) return;
    for (const double step : kEscapeSteps) {
      const Vec3d d = best_;
      const Vec3d s = unit(otgCross(d, std::fabs(d.x) < 0.8 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})), t = otgCross(d, s);
      for (int k = 0; k < OTG_ESCAPE_SIDES; ++k) {
        offer(unit(d + (s * (step * kEscapeCosines[k]) + t * (step * kEscapeSines[k]))));
      }
    }
  }
  /// Of the last one that is out. Stops when the result is at least `enough`.
  double along(const Vec3d& d, double enough) {
    double most = 0;
    for (const Part& part : parts_) {
      most = std::max(most, along(part, d, enough));
      if (most >= enough) break;
    }
    return most;
  }
  double along(const Part& part, const Vec3d& d, double enough) const {
    if (part.region->contained) return part.rays.along(d, enough);
    // An extent does not distinguish d from -d; the push does, as far as there is one.
    const double extent = part.extent->along(d) * (otgDot(d, part.region->push) < 0 ? 1.1 : 1.0);
    return part.isThin || extent >= enough ? extent : std::max(extent, part.rays.along(d, enough));
  }

  Vec3d back_;
  std::pmr::vector<Part> parts_;
  bool areThin_ = true;
  double least_ = std::numeric_limits<double>::infinity();
  Vec3d best_{0, 0, 1};
};

Vec3d escapeDirection(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                      const PairMotion& motion, RegionExtent& extent) {
  if (otgDot(motion.escape, motion.escape) > 0) return motion.escape;
  Escape escape(motion, all.memory);
  escape.add(meshes, all, region, extent);
  escape.search(meshes.query().bInA);
  return escape.best();
}

/// Whether a part of one body reaches far into the other one and is thin: its surfaces cancel each other, and the push
/// is that of the small piece of the other surface that it has gone through.
bool isPierced(const Region& region, const RegionNormals& normals, RegionExtent& extent) {
  return region.cellEnd == region.cellBegin && region.coherence >= OTG_SOLID_COHERENT &&
         otgIsPierced(norm(region.push), region.areaA, region.areaB) != 0 &&
         otgIsUneven(extent.along(normals.mean()), region.thickness) != 0;
}

/// The surface that it has to leave may be another one than that piece: a plate may be below the top of a body, beside
/// its edge. Then it leaves by one of its own faces' directions, if rays find that far shorter.
void leavePierced(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region, const PairMotion& motion,
                  RegionNormals& normals, RegionExtent& extent, RegionDirection& answer) {
  const WayOutByRays way(meshes, all, region, std::numeric_limits<double>::infinity());
  double least = OTG_SOLID_PIERCED_SHARE * extent.along(normals.mean());
  const auto offer = [&](const Vec3d& d, double factor) {
    const double length = way.along(d, least / factor);
    // The overlap is as thick as this. Rays that find less have missed it.
    if (!(factor * length < least) || length < region.thickness) return;
    least = factor * length;
    answer.deep = answer.pierced = true;
    answer.direction = d;
    answer.depth = length;
  };
  if (otgDot(motion.deepNormal, motion.deepNormal) > 0) offer(motion.deepNormal, OTG_SOLID_LAST_SHARE);
  for (int m = 0; m < 2; ++m) {
    for (const Vec3d& d : faceDirections(all, region, m)) offer(d, 1.0);
  }
  if (answer.deep) normals.fix(answer.direction);
}

}  // namespace

void addContained(const PlacedMeshes& meshes, const InsideFlags& inside, OverlapRegions& regions) {
  for (int m = 0; m < 2; ++m) {
    for (const std::uint32_t component : inside.contained[m]) {
      const Adjacency& adjacency = meshes.adjacency(m);
      const TriMesh& mesh = meshes.mesh(m);
      if (regions.regions.empty()) {
        regions.origin = meshes.vertex(m, adjacency.componentVertex[component]);
      }
      Region region{};
      region.contained = true;
      const double inf = std::numeric_limits<double>::infinity();
      region.lo = {inf, inf, inf};
      region.hi = {-inf, -inf, -inf};
      const auto index = static_cast<std::uint32_t>(regions.regions.size());
      region.pointBegin = static_cast<std::uint32_t>(regions.points.size());
      region.pieceBegin = region.pieceEnd = static_cast<std::uint32_t>(regions.pieces.size());
      FlatMap seen(regions.memory);
      for (std::uint32_t i = adjacency.componentFirst[component]; i < adjacency.componentFirst[component + 1]; ++i) {
        const std::uint32_t t = adjacency.componentTriangles[i];
        for (const std::uint32_t corner : mesh.triangles()[t].v) {
          const std::uint32_t v = mesh.topology().weld[corner];
          bool inserted = false;
          seen.insert(v, 1, &inserted);
          if (!inserted) continue;
          const Vec3d p = meshes.vertex(m, v) - regions.origin;
          region.lo = {std::min(region.lo.x, p.x), std::min(region.lo.y, p.y), std::min(region.lo.z, p.z)};
          region.hi = {std::max(region.hi.x, p.x), std::max(region.hi.y, p.y), std::max(region.hi.z, p.z)};
          SupportPoint point{};
          point.position = p;
          point.region = index;
          point.mesh = static_cast<std::uint8_t>(m);
          point.kind = PointKind::kVertex;
          point.feature = v;
          point.rank = rankOfVertex(meshes, m, v);
          point.triangleA = point.triangleB = kNone;
          (m == 0 ? point.triangleA : point.triangleB) = t;
          regions.points.push_back(point);
        }
      }
      region.pointEnd = static_cast<std::uint32_t>(regions.points.size());
      const Vec3d d = region.hi - region.lo;
      region.diagonal = norm(d);
      const double volume = std::fabs(mesh.topology().componentVolume[component]);
      region.volume = volume;
      region.areaA = region.areaB = std::cbrt(volume) * std::cbrt(volume);
      region.thickness = std::cbrt(volume);
      regions.regions.push_back(region);
    }
  }
}

Vec3d EscapeOfAll::direction(const PairMotion& motion) const {
  std::list<RegionExtent> extents;
  Escape escape(motion, std::pmr::get_default_resource());
  for (const Overlap& overlap : overlaps_) {
    const OverlapRegions& all = overlap.regions;
    for (const Region& region : all.regions) {
      escape.add(overlap.meshes, all, region, extents.emplace_back(all, region));
    }
  }
  if (extents.empty()) return {0, 0, 0};
  escape.search(overlaps_.front().meshes.query().bInA);
  return escape.best();
}

RegionDirection directRegion(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                             const PairMotion& motion, RegionNormals& normals, RegionExtent& regionExtent) {
  RegionDirection answer;
  if (motion.isJammed) {
    answer.entangled = answer.escaping = true;
    answer.direction = motion.escape;
    normals.fix(answer.direction);
    return answer;
  }
  const std::pmr::vector<EdgePair> pairs = edgePairsOf(meshes, all, region);
  if (const EdgePair* const whole = wholePair(pairs)) {
    answer.deep = true;
    answer.direction = whole->direction;
    answer.depth = whole->depth;
    normals.fix(whole->direction);
    return answer;
  }
  answer.entangled = !region.contained && (region.bad || contradictsItself(region));
  if (region.contained || contradictsItself(region)) {
    answer.direction = escapeDirection(meshes, all, region, motion, regionExtent);
    answer.escaping = true;
    if (region.contained || region.thickness > 0.05 * region.diagonal) {
      normals.fix(answer.direction);
    } else {
      normals.setEscape(answer.direction);
    }
    return answer;
  }
  if (!region.bad && isPierced(region, normals, regionExtent)) {
    leavePierced(meshes, all, region, motion, normals, regionExtent, answer);
    return answer;
  }
  if (region.bad || !otgIsThick(region.thickness, region.diagonal)) return answer;
  // Deep: the shortest way out, which the mean direction need not be once the overlap is thicker than wide. The last
  // direction is kept while it is nearly as short, so that a body does not waver on its way out.
  answer.deep = true;
  answer.direction = normals.mean();
  WayOutByPlanes way(all, region, static_cast<double>(meshes.mesh(0).radius() + meshes.mesh(1).radius()));
  // Both bound the way from below: the planes miss what lies between the points that are looked at, the extent misses
  // what the other body has beyond the region.
  const auto cost = [&](const Vec3d& d, double enough) {
    const double extent = regionExtent.along(d);
    return extent >= enough ? extent : std::max(extent, way.along(d, enough));
  };
  double least = OTG_SOLID_PUSH_SHARE * cost(normals.mean(), std::numeric_limits<double>::infinity());
  std::optional<Vec3d> shortest;
  const auto offer = [&](const Vec3d& d, double factor) {
    if (otgDot(d, normals.mean()) < OTG_SOLID_DEEP_AGAINST) return;
    const double extent = factor * cost(d, least / factor);
    if (extent >= least) return;
    least = extent;
    shortest = d;
  };
  if (otgDot(motion.deepNormal, motion.deepNormal) > 0) offer(motion.deepNormal, OTG_SOLID_LAST_SHARE);
  for (int m = 0; m < 2; ++m) {
    for (const Vec3d& d : faceDirections(all, region, m)) offer(d, 1.0);
  }
  // The vector area of two edges' overlap points across both, as long as no third face is in it: without a bias
  // towards the mean.
  const double acrossFactor = shortest ? 1.0 : OTG_SOLID_ACROSS_SHARE;
  for (const EdgePair& pair : pairs) offer(pair.direction, acrossFactor);
  // Round an inner corner the best direction may be along its walls. Then each part leaves by its own face.
  if (!shortest || (isUneven(region, normals, regionExtent) && otgIsLongWayOut(least, region.thickness))) return answer;
  answer.direction = *shortest;
  normals.fix(*shortest);
  return answer;
}

}  // namespace otg
