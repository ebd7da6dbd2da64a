// SPDX-License-Identifier: BSD-3-Clause
// The C API of nearest points, distances, overlap and rays.
#include "base/vectors.h"
#include "ode_trimesh_gpu/queries.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dispatch/dispatcher.h"
#include "dispatch/single_run.h"
#include "ode/base/status.h"
#include "ode/geom/geom_class.h"
#include "ode/geom/geom_part.h"
#include "ode/pairs/mesh_collider.h"
#include "ode/pairs/pair_roles.h"
#include "ode/pairs/pair_task.h"
#include "queries/mesh_distance.h"
#include "queries/mesh_overlap.h"
#include "queries/ray_cast.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

constexpr std::size_t kPairsAtOnce = 1, kPlacedAtOnce = 64, kCheckedAtOnce = 4096;

void write(const Vec3d& from, dReal* to) {
  to[0] = static_cast<dReal>(from.x);
  to[1] = static_cast<dReal>(from.y);
  to[2] = static_cast<dReal>(from.z);
  to[3] = 0;
}

bool isFinite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A geom of our class where it is now, held as long as this lives.
struct Placed {
  std::optional<GeomUse> use;
  Place place = Place::kAuto;           ///< of arrays
  const CollisionMesh* mesh = nullptr;  ///< null: no surface
  Transformd pose{};
};

/// The mesh of an object that is held; null: no surface.
const CollisionMesh* surfaceOf(const GeomObject& object) {
  const CollisionMesh* const mesh = object.mesh();
  return mesh == nullptr || mesh->tree().nodes.empty() ? nullptr : mesh;
}

/// Where arrays are computed that are queried of a geom.
Place placeOf(const GeomObject& object) {
  return settled(pairPlacement(object.params, object.params, dispatcher().placement())).middle;
}

/// Of two that differ the CPU wins over devices, and both over open.
Place both(Place first, Place second) {
  for (const Place which : {Place::kCpu, Place::kOpencl}) {
    if (first == which || second == which) return which;
  }
  return Place::kAuto;
}

/// Returns a status. `object` is the geom's, null for geoms of other classes.
int place(dGeomID g, GeomObject* object, Placed& out) {
  if (object == nullptr) return dGPUTRIMESH_ERROR_CLASS;
  if (!out.use.emplace(object).good()) return dGPUTRIMESH_ERROR_BUSY;
  const WorldPose pose = readPose(g);
  if (!pose.rigid) return dGPUTRIMESH_ERROR_POSE;
  out.mesh = surfaceOf(*object);
  out.pose = pose.transform;
  out.place = placeOf(*object);
  return dGPUTRIMESH_OK;
}

int place(dGeomID g, Placed& out) {
  return place(g, liveObjectOf(g), out);
}

Vec3d toMesh(const Placed& placed, const dReal* p) {
  return otgRotateBack(placed.pose, otgSub(Vec3d{p[0], p[1], p[2]}, placed.pose.t));
}

/// Whether all of an array are good, by all threads: reading a large one takes as long as computing it.
template <class Good>
bool areAll(int count, const Good& good) {
  std::atomic<bool> all{true};
  dispatcher().run(static_cast<std::size_t>(count), kCheckedAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!good(i)) all = false;
    }
  });
  return all;
}

/// Points of a caller, checked.
struct Points {
  const char* first;
  std::size_t stride;
  const dReal* operator[](std::size_t i) const { return reinterpret_cast<const dReal*>(first + i * stride); }
};

int checkPoints(const dReal* points, int stride, int count, const void* out, Points& to) {
  if (count < 0 || stride < static_cast<int>(3 * sizeof(dReal))) return dGPUTRIMESH_ERROR_ARGUMENT;
  if (count > 0 && (points == nullptr || out == nullptr)) return dGPUTRIMESH_ERROR_ARGUMENT;
  to = {reinterpret_cast<const char*>(points), static_cast<std::size_t>(stride)};
  const auto isGood = [&](std::size_t i) {
    const dReal* const p = to[i];
    return isFinite({p[0], p[1], p[2]});
  };
  return areAll(count, isGood) ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_ARGUMENT;
}

void withoutSurface(dGpuTriMeshClosestPoint& out) {
  out = {};
  out.distance = std::numeric_limits<dReal>::infinity();
  out.triangle = -1;
}

void closest(const Placed& placed, const PointAnswer& answer, dGpuTriMeshClosestPoint& out) {
  withoutSurface(out);
  const SurfacePoint& nearest = answer.nearest;
  if (nearest.triangle == kNone) return;
  write(otgTransform(placed.pose, nearest.point), out.pos);
  const Vec3d normal = otgRotate(placed.pose, outwardNormal(*placed.mesh, nearest));
  write(otgScale(normal, 1 / norm(normal)), out.normal);
  out.distance = static_cast<dReal>(answer.inside ? -nearest.distance : nearest.distance);
  out.triangle = static_cast<int>(placed.mesh->mesh().callerTriangle(nearest.triangle));
}

/// Queries points of a geom with a surface.
template <class Sink>
void askPoints(const Placed& placed, const Points& from, int count, bool nearest, const Sink& sink) {
  const PointJob job{placed.mesh, nearest, true, placed.place};
  const auto source = [&](std::size_t begin, std::size_t end, Vec3d* to) {
    for (std::size_t i = begin; i < end; ++i) to[i - begin] = toMesh(placed, from[i]);
  };
  dispatcher().askPoints(
      job, static_cast<std::size_t>(count), source,
      [&](std::size_t begin, std::size_t end, const Vec3d*, const PointAnswer* answers) { sink(begin, end, answers); });
}

/// Two geoms.
struct PlacedPair {
  Placed first, second;
};

/// How a result of a query becomes one of o1 and o2.
struct AnswerFrame {
  Transformd poseOfA;
  bool first;  ///< mesh A is o1's
};

/// The frame of contacts: what is exact in one frame may be off by rounding in the other, and queries about a pair must
/// not contradict each other.
AnswerFrame frameOf(const MeshGeom& side1, const Transformd& pose1, const MeshGeom& side2, const Transformd& pose2) {
  if (side1.mesh == nullptr || side2.mesh == nullptr) return {pose1, true};
  const bool remembers =
      side1.object->remembersWith(dGeomGetClass(side2.geom)) && side2.object->remembersWith(dGeomGetClass(side1.geom));
  const bool first = isFirstMeshA(side1, pose1, side2, pose2, remembers);
  return {first ? pose1 : pose2, first};
}

/// As a query. Returns a status; a null mesh in the query: a geom without a surface.
int placePair(dGeomID o1, dGeomID o2, const LiveObjects& live, PlacedPair& pair, Query& query, AnswerFrame& frame) {
  auto& [first, second] = pair;
  for (const int status : {place(o1, live.of(o1), first), place(o2, live.of(o2), second)}) {
    if (status != dGPUTRIMESH_OK) return status;
  }
  frame = frameOf({o1, live.of(o1), first.mesh}, first.pose, {o2, live.of(o2), second.mesh}, second.pose);
  const Placed &a = frame.first ? first : second, &b = frame.first ? second : first;
  query.a = a.mesh;
  query.b = b.mesh;
  query.bInA = relativePose(a.pose, b.pose);
  return dGPUTRIMESH_OK;
}

void writeDistance(const Query& query, const AnswerFrame& frame, const MeshDistance& found, dGpuTriMeshDistance& out) {
  out = {};
  out.distance = std::numeric_limits<dReal>::infinity();
  out.triangle1 = out.triangle2 = -1;
  if (!found.found) return;
  out.distance = static_cast<dReal>(found.distance);
  const auto numberOf = [](const CollisionMesh& mesh, std::uint32_t triangle) {
    return triangle == kNone ? -1 : static_cast<int>(mesh.mesh().callerTriangle(triangle));
  };
  write(otgTransform(frame.poseOfA, found.pointA), frame.first ? out.pos1 : out.pos2);
  write(otgTransform(frame.poseOfA, found.pointB), frame.first ? out.pos2 : out.pos1);
  (frame.first ? out.triangle1 : out.triangle2) = numberOf(*query.a, found.triangleA);
  (frame.first ? out.triangle2 : out.triangle1) = numberOf(*query.b, found.triangleB);
}

int distanceOf(dGeomID o1, dGeomID o2, dReal limit, dGpuTriMeshDistance& out) {
  PlacedPair pair;
  Query query;
  AnswerFrame frame;
  if (const int status = placePair(o1, o2, LiveObjects(), pair, query, frame)) return status;
  MeshDistance found;
  if (query.a != nullptr && query.b != nullptr) found = meshDistance(query, static_cast<double>(limit));
  writeDistance(query, frame, found, out);
  return dGPUTRIMESH_OK;
}

/// 1, 0 or a negative status.
int overlapOf(dGeomID o1, dGeomID o2) {
  PlacedPair pair;
  Query query;
  AnswerFrame frame;
  if (const int status = placePair(o1, o2, LiveObjects(), pair, query, frame)) return status;
  return query.a != nullptr && query.b != nullptr && overlap(query) ? 1 : 0;
}

int checkPairs(const dGpuTriMeshPair* pairs, int count, const void* out) {
  return count < 0 || (count > 0 && (pairs == nullptr || out == nullptr)) ? dGPUTRIMESH_ERROR_ARGUMENT : dGPUTRIMESH_OK;
}

/// Calls some(begin, end) for parts of the pairs, by all threads; returns the first status that is an error, else the
/// sum of the others.
template <class Some>
int forParts(int count, std::size_t atOnce, const Some& some) {
  std::atomic<int> error{dGPUTRIMESH_OK}, sum{0};
  dispatcher().run(static_cast<std::size_t>(count), atOnce, [&](std::size_t begin, std::size_t end) {
    const int answer = some(begin, end);
    int none = dGPUTRIMESH_OK;
    if (answer < 0)
      error.compare_exchange_strong(none, answer);
    else
      sum += answer;
  });
  return error != dGPUTRIMESH_OK ? error : sum;
}

/// The same with one(i) for each pair.
template <class One>
int forPairs(int count, std::size_t atOnce, const One& one) {
  return forParts(count, atOnce, [&](std::size_t begin, std::size_t end) {
    int sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const int answer = one(i);
      if (answer < 0) return answer;
      sum += answer;
    }
    return sum;
  });
}

/// Pairs of an array as jobs, at the moment when they are read. The meshes are shared as long as this lives.
class PlacedPairs {
 public:
  PlacedPairs(const dGpuTriMeshPair* pairs, int count, bool withFrames)
      : count_(static_cast<std::size_t>(count)),
        jobs_(std::make_unique_for_overwrite<OverlapJob[]>(count_)),
        frames_(withFrames ? std::make_unique_for_overwrite<AnswerFrame[]>(count_) : nullptr),
        meshes_((count_ + kPlacedAtOnce - 1) / kPlacedAtOnce) {
    status_ = forParts(count, kPlacedAtOnce, [&](std::size_t begin, std::size_t end) {
      return placePart(begin, {pairs + begin, end - begin});
    });
  }
  PlacedPairs(const PlacedPairs&) = delete;
  PlacedPairs& operator=(const PlacedPairs&) = delete;
  int status() const { return status_; }
  std::span<const OverlapJob> jobs() const { return {jobs_.get(), count_}; }
  /// Of pair `i`, if frames were requested.
  const AnswerFrame& frame(std::size_t i) const { return frames_[i]; }

 private:
  int placePart(std::size_t begin, std::span<const dGpuTriMeshPair> pairs) {
    GeomPart part(pairs, false);
    constexpr std::size_t kAhead = 4;
    for (std::size_t k = 0; k < kAhead; ++k) part.fetchPoses(k);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      part.fetchPoses(k + kAhead);
      GeomObject *const object1 = part.object1(k), *const object2 = part.object2(k);
      if (object1 == nullptr || object2 == nullptr) return dGPUTRIMESH_ERROR_CLASS;
      if (!part.hold(k)) return dGPUTRIMESH_ERROR_BUSY;
      const WorldPose pose1 = readPose(pairs[k].o1), pose2 = readPose(pairs[k].o2);
      if (!pose1.rigid || !pose2.rigid) return dGPUTRIMESH_ERROR_POSE;
      OverlapJob& job = jobs_[begin + k];
      std::vector<std::shared_ptr<const CollisionMesh>>& meshes = meshes_[begin / kPlacedAtOnce];
      const CollisionMesh *const mesh1 = share(part, *object1, meshes), *const mesh2 = share(part, *object2, meshes);
      const AnswerFrame frame =
          frameOf({pairs[k].o1, object1, mesh1}, pose1.transform, {pairs[k].o2, object2, mesh2}, pose2.transform);
      job.pair.a = frame.first ? mesh1 : mesh2;
      job.pair.b = frame.first ? mesh2 : mesh1;
      job.pair.bInA = relativePose(frame.poseOfA, (frame.first ? pose2 : pose1).transform);
      job.place = both(placeOf(*object1), placeOf(*object2));
      if (frames_ != nullptr) frames_[begin + k] = frame;
    }
    return dGPUTRIMESH_OK;
  }
  /// Null for a geom without a surface.
  static const CollisionMesh* share(GeomPart& part, const GeomObject& object,
                                    std::vector<std::shared_ptr<const CollisionMesh>>& meshes) {
    const CollisionMesh* const mesh = surfaceOf(object);
    if (mesh != nullptr) part.share(object, mesh, meshes);
    return mesh;
  }
  static_assert(kPlacedAtOnce <= GeomPart::kMost);

  std::size_t count_;
  std::unique_ptr<OverlapJob[]> jobs_;
  std::unique_ptr<AnswerFrame[]> frames_;
  std::vector<std::vector<std::shared_ptr<const CollisionMesh>>> meshes_;  ///< of each part
  int status_ = dGPUTRIMESH_OK;
};

bool isUsable(const dGpuTriMeshRay& ray) {
  const Vec3d start{ray.start[0], ray.start[1], ray.start[2]};
  const Vec3d direction{ray.direction[0], ray.direction[1], ray.direction[2]};
  const double l = norm(direction);
  return isFinite(start) && std::isfinite(l) && l > 0 && ray.length >= 0;
}

LongRay rayToMesh(const Placed& placed, const dGpuTriMeshRay& ray) {
  const Vec3d direction{ray.direction[0], ray.direction[1], ray.direction[2]};
  return {{toMesh(placed, ray.start), otgRotateBack(placed.pose, otgScale(direction, 1 / norm(direction)))},
          static_cast<double>(ray.length)};
}

void withoutHit(dGpuTriMeshRayHit& out) {
  out = {};
  out.distance = std::numeric_limits<dReal>::infinity();
  out.triangle = -1;
}

/// Whether there is one.
bool writeHit(const Placed& placed, const MeshRay& ray, const RayHit& hit, dGpuTriMeshRayHit& out) {
  withoutHit(out);
  if (hit.triangle == kNone) return false;
  const Vec3d point = otgAdd(ray.origin, otgScale(ray.direction, hit.distance));
  const Vec3d face = otgRotate(placed.pose, faceNormal(placed.mesh->mesh(), hit.triangle));
  write(otgTransform(placed.pose, point), out.pos);
  write(otgScale(face, (hit.back ? -1 : 1) / norm(face)), out.normal);
  out.distance = static_cast<dReal>(hit.distance);
  out.triangle = static_cast<int>(placed.mesh->mesh().callerTriangle(hit.triangle));
  out.back = hit.back ? 1 : 0;
  return true;
}

/// Casts rays at a geom with a surface; returns how many hit. "Any hit" is the closest one: looking no further saves
/// next to nothing, and which one was found first would depend on who looked.
int castAll(const Placed& placed, const dGpuTriMeshRay* rays, int count, int flags, dGpuTriMeshRayHit* hits) {
  const RayJob job{placed.mesh, (flags & dGPUTRIMESH_RAY_CULL_BACK) != 0, placed.place};
  std::atomic<int> found{0};
  dispatcher().castRays(
      job, static_cast<std::size_t>(count),
      [&](std::size_t begin, std::size_t end, LongRay* to) {
        for (std::size_t i = begin; i < end; ++i) to[i - begin] = rayToMesh(placed, rays[i]);
      },
      [&](std::size_t begin, std::size_t end, const LongRay* cast, const RayHit* answers) {
        int some = 0;
        for (std::size_t i = begin; i < end; ++i) {
          some += writeHit(placed, cast[i - begin].ray, answers[i - begin], hits[i]) ? 1 : 0;
        }
        found += some;
      });
  return found;
}

}  // namespace
}  // namespace otg

int dGeomGpuTriMeshClosestPoint(dGeomID g, const dVector3 point, dGpuTriMeshClosestPoint* out) {
  return otg::guarded([&] {
    otg::Placed placed;
    otg::Points from{};
    if (const int status = otg::place(g, placed)) return status;
    if (const int status = otg::checkPoints(point, sizeof(dVector3), 1, out, from)) return status;
    if (placed.mesh == nullptr) {
      otg::withoutSurface(*out);
    } else {
      otg::closest(placed,
                   otg::answerOne(otg::PointJob{placed.mesh, true, true, otg::Place::kCpu}, otg::toMesh(placed, point)),
                   *out);
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshClosestPoints(dGeomID g, const dReal* points, int stride, int count, dGpuTriMeshClosestPoint* out) {
  return otg::guarded([&] {
    otg::Placed placed;
    otg::Points from{};
    if (const int status = otg::place(g, placed)) return status;
    if (const int status = otg::checkPoints(points, stride, count, out, from)) return status;
    if (placed.mesh == nullptr) {
      for (int i = 0; i < count; ++i) otg::withoutSurface(out[i]);
    } else {
      otg::askPoints(placed, from, count, true,
                     [&](std::size_t begin, std::size_t end, const otg::PointAnswer* answers) {
                       for (std::size_t i = begin; i < end; ++i) otg::closest(placed, answers[i - begin], out[i]);
                     });
    }
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGeomGpuTriMeshPointsInside(dGeomID g, const dReal* points, int stride, int count, unsigned char* inside) {
  return otg::guarded([&] {
    otg::Placed placed;
    otg::Points from{};
    if (const int status = otg::place(g, placed)) return status;
    if (const int status = otg::checkPoints(points, stride, count, inside, from)) return status;
    std::atomic<int> found{0};
    if (placed.mesh == nullptr || otg::surfaceKind(placed.mesh->mesh()) == otg::SurfaceKind::kShell) {
      std::fill_n(inside, count, static_cast<unsigned char>(0));
      return 0;
    }
    otg::askPoints(placed, from, count, false,
                   [&](std::size_t begin, std::size_t end, const otg::PointAnswer* answers) {
                     int some = 0;
                     for (std::size_t i = begin; i < end; ++i) {
                       inside[i] = answers[i - begin].inside ? 1 : 0;
                       some += inside[i];
                     }
                     found += some;
                   });
    return found.load();
  });
}

int dGpuTriMeshGetDistance(dGeomID o1, dGeomID o2, dReal limit, dGpuTriMeshDistance* out) {
  const dGpuTriMeshPair pair{o1, o2};
  return dGpuTriMeshGetDistances(&pair, 1, limit, out);
}

int dGpuTriMeshGetDistances(const dGpuTriMeshPair* pairs, int count, dReal limit, dGpuTriMeshDistance* out) {
  return otg::guarded([&] {
    if (const int status = otg::checkPairs(pairs, count, out)) return status;
    if (!(limit >= 0)) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    if (count < 2 || !otg::dispatcher().hasDevices()) {
      return otg::forPairs(count, otg::kPairsAtOnce,
                           [&](std::size_t i) { return otg::distanceOf(pairs[i].o1, pairs[i].o2, limit, out[i]); });
    }
    const otg::PlacedPairs placed(pairs, count, true);
    if (placed.status() < 0) return placed.status();
    std::vector<otg::MeshDistance> found(static_cast<std::size_t>(count));
    otg::dispatcher().askDistances(placed.jobs(), static_cast<double>(limit), found);
    otg::forParts(count, otg::kPlacedAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        otg::writeDistance(otg::opencl::queryOf(placed.jobs()[i].pair), placed.frame(i), found[i], out[i]);
      }
      return static_cast<int>(dGPUTRIMESH_OK);
    });
    return static_cast<int>(dGPUTRIMESH_OK);
  });
}

int dGpuTriMeshOverlap(dGeomID o1, dGeomID o2) {
  return otg::guarded([&] { return otg::overlapOf(o1, o2); });
}

int dGpuTriMeshOverlaps(const dGpuTriMeshPair* pairs, int count, unsigned char* out) {
  return otg::guarded([&] {
    if (const int status = otg::checkPairs(pairs, count, out)) return status;
    if (count == 1) {
      const int answer = otg::overlapOf(pairs->o1, pairs->o2);
      if (answer >= 0) *out = static_cast<unsigned char>(answer);
      return answer;
    }
    const otg::PlacedPairs placed(pairs, count, false);
    if (placed.status() < 0) return placed.status();
    otg::dispatcher().askOverlaps(placed.jobs(), {out, static_cast<std::size_t>(count)});
    return static_cast<int>(std::count(out, out + count, 1));
  });
}

int dGeomGpuTriMeshCastRays(dGeomID g, const dGpuTriMeshRay* rays, int count, int flags, dGpuTriMeshRayHit* hits) {
  return otg::guarded([&] {
    otg::Placed placed;
    if (const int status = otg::place(g, placed)) return status;
    constexpr int kKnown = dGPUTRIMESH_RAY_CULL_BACK | dGPUTRIMESH_RAY_ANY;
    if (count < 0 || (flags & ~kKnown) != 0 || (count > 0 && (rays == nullptr || hits == nullptr))) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    if (!otg::areAll(count, [&](std::size_t i) { return otg::isUsable(rays[i]); })) {
      return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    }
    if (placed.mesh == nullptr) {
      std::for_each_n(hits, count, otg::withoutHit);
      return 0;
    }
    return otg::castAll(placed, rays, count, flags, hits);
  });
}
