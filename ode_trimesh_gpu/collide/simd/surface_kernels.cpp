// SPDX-License-Identifier: BSD-3-Clause
#include "collide/simd/surface_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace otg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double lengthOf(const Vec3d& from, const Vec3d& to) {
  const Vec3d stretch = otgSub(to, from);
  return std::sqrt(otgDot(stretch, stretch));
}

/// Of what is missing: what rounds, and by how much ways in one direction differ that count as one.
Moved nearly(const Moved& moved) {
  return {moved.by, moved.missing * (1 + 1e-6) + 4e-6 * lengthOf({0, 0, 0}, moved.by)};
}

SimdLevel level() {
  static const SimdLevel best = bestSimdLevel();
  return best;
}

#ifdef OTG_HAVE_X86_KERNELS
#define OTG_CALL_SURFACE_KERNEL(level, kernel, args) \
  switch (level) {                                   \
    case SimdLevel::kAvx512:                         \
      simd_avx512::kernel(args);                     \
      break;                                         \
    case SimdLevel::kAvx2:                           \
      simd_avx2::kernel(args);                       \
      break;                                         \
    default:                                         \
      simd_baseline::kernel(args);                   \
      break;                                         \
  }
#else
#define OTG_CALL_SURFACE_KERNEL(level, kernel, args) \
  (void)level;                                       \
  simd_baseline::kernel(args);
#endif

}  // namespace

void exitThroughPlanes(SimdLevel level, PlaneExitArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, exitThroughPlanes, args)
}
void exitThroughRoundPlanes(SimdLevel level, PlaneExitArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, exitThroughRoundPlanes, args)
}
void findFacingPlane(SimdLevel level, FacingPlaneArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findFacingPlane, args)
}
void sumLocalAreas(SimdLevel level, LocalAreaArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, sumLocalAreas, args)
}
void findExtent(SimdLevel level, ExtentArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findExtent, args)
}

void findFarthestWay(SimdLevel level, FarthestWayArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findFarthestWay, args)
}

void findBoxRanges(SimdLevel level, BoxRangesArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findBoxRanges, args)
}

void findNearFaces(SimdLevel level, NearFacesArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findNearFaces, args)
}

void findNearestFace(SimdLevel level, NearFacesArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findNearestFace, args)
}

void findFacesOver(SimdLevel level, FacesOverArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findFacesOver, args)
}

void findSoonestFace(SimdLevel level, SoonestFaceArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findSoonestFace, args)
}

void findShortestWay(SimdLevel level, ShortestWayArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findShortestWay, args)
}

void findShortestWay(ShortestWayArgs& args) {
  findShortestWay(level(), args);
}

void findStretchesPassed(SimdLevel level, StretchesPassedArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findStretchesPassed, args)
}

void PlaneSet::clear() {
  blocks_.clear();
  count_ = 0;
}

void PlaneSet::add(const Vec3d& normal, double offset, const Vec3d& lo, const Vec3d& hi) {
  const std::size_t k = count_++ % kSurfaceLanes;
  if (k == 0) blocks_.push_back({});
  PlaneBlock& b = blocks_.back();
  b.normalX[k] = normal.x;
  b.normalY[k] = normal.y;
  b.normalZ[k] = normal.z;
  b.offset[k] = offset;
  b.loX[k] = lo.x;
  b.loY[k] = lo.y;
  b.loZ[k] = lo.z;
  b.hiX[k] = hi.x;
  b.hiY[k] = hi.y;
  b.hiZ[k] = hi.z;
}

double PlaneSet::Way::either() const {
  return std::isfinite(nearest) ? nearest : convex;
}

PlaneSet::Way PlaneSet::wayOut(const Vec3d& from, const Vec3d& direction, double slack) const {
  PlaneExitArgs args{blocks_.data(), blocks_.size(), from, direction, slack, 0, 0};
  exitThroughPlanes(level(), args);
  return {args.nearest, args.convex};
}

PlaneSet::Way PlaneSet::wayOutRound(const Vec3d& from, const Vec3d& direction, double slack) const {
  PlaneExitArgs args{blocks_.data(), blocks_.size(), from, direction, slack, 0, 0};
  exitThroughRoundPlanes(level(), args);
  return {args.nearest, args.convex};
}

std::uint32_t PlaneSet::facing(const Vec3d& from, const Vec3d& direction) const {
  FacingPlaneArgs args{blocks_.data(), blocks_.size(), from, direction, 0};
  findFacingPlane(level(), args);
  return args.plane;
}

void AreaSet::clear() {
  blocks_.clear();
  count_ = 0;
}

void AreaSet::add(const Vec3d& lo, const Vec3d& hi, const Vec3d& vector, double area) {
  const std::size_t k = count_++ % kSurfaceLanes;
  if (k == 0) blocks_.push_back({});
  AreaBlock& b = blocks_.back();
  b.loX[k] = lo.x;
  b.loY[k] = lo.y;
  b.loZ[k] = lo.z;
  b.hiX[k] = hi.x;
  b.hiY[k] = hi.y;
  b.hiZ[k] = hi.z;
  b.x[k] = vector.x;
  b.y[k] = vector.y;
  b.z[k] = vector.z;
  b.area[k] = area;
}

AreaSet::Sum AreaSet::about(const Vec3d& point, double radius) const {
  LocalAreaArgs args{blocks_.data(), blocks_.size(), point, radius, {0, 0, 0}, 0};
  sumLocalAreas(level(), args);
  return {args.vector, args.area};
}

void PointSet::clear() {
  blocks_.clear();
  count_ = 0;
}

void PointSet::add(const Vec3d& p) {
  const std::size_t k = count_++ % kSurfaceLanes;
  if (k == 0) blocks_.push_back({});
  PointBlock& b = blocks_.back();
  for (std::size_t i = k; i < kSurfaceLanes; ++i) {
    b.x[i] = p.x;
    b.y[i] = p.y;
    b.z[i] = p.z;
  }
}

double PointSet::extent(const Vec3d& direction) const {
  if (blocks_.empty()) return 0;
  ExtentArgs args{blocks_.data(), blocks_.size(), direction, 0, 0};
  findExtent(level(), args);
  return args.hi - args.lo;
}

double PointSet::farthestWay(std::span<const Barrier> first, std::span<const Barrier> second, double far,
                             double enough) const {
  FarthestWayArgs args{
      blocks_.data(), blocks_.size(), {first.data(), second.data()}, {first.size(), second.size()}, far, enough, 0};
  findFarthestWay(level(), args);
  return args.way;
}

void BoxSet::clear() {
  blocks_.clear();
  count_ = 0;
}

void BoxSet::add(const Vec3d& lo, const Vec3d& hi) {
  const std::size_t k = count_++ % kSurfaceLanes;
  if (k == 0) blocks_.push_back({});
  BoxBlock& b = blocks_.back();
  for (std::size_t i = k; i < kSurfaceLanes; ++i) {
    b.x[i] = 0.5 * (lo.x + hi.x);
    b.y[i] = 0.5 * (lo.y + hi.y);
    b.z[i] = 0.5 * (lo.z + hi.z);
    b.halfX[i] = 0.5 * (hi.x - lo.x);
    b.halfY[i] = 0.5 * (hi.y - lo.y);
    b.halfZ[i] = 0.5 * (hi.z - lo.z);
  }
}

void BoxSet::ranges(const Vec3d& direction, std::pmr::vector<double>& lo, std::pmr::vector<double>& hi) const {
  lo.resize(kSurfaceLanes * blocks_.size());
  hi.resize(kSurfaceLanes * blocks_.size());
  BoxRangesArgs args{blocks_.data(), blocks_.size(), direction, lo.data(), hi.data()};
  findBoxRanges(level(), args);
  lo.resize(count_);
  hi.resize(count_);
}

void FaceSet::clear() {
  blocks_.clear();
  groups_.clear();
  count_ = 0;
}

void FaceSet::reserve(std::size_t count) {
  const std::size_t blocks = (count + kSurfaceLanes - 1) / kSurfaceLanes, ofGroups = kSurfaceLanes * kFaceGroup;
  blocks_.reserve(blocks);
  groups_.reserve((blocks + ofGroups - 1) / ofGroups);
}

void FaceSet::add(const Face& face) {
  addToGroup(face);
  const std::size_t k = count_++ % kSurfaceLanes;
  if (k == 0) {
    FaceBlock& empty = blocks_.emplace_back();
    std::fill_n(empty.offset, kSurfaceLanes, -kInfinity);
    std::fill_n(empty.loX, kSurfaceLanes, kInfinity);
    std::fill_n(empty.hiX, kSurfaceLanes, kInfinity);
  }
  FaceBlock& b = blocks_.back();
  b.normalX[k] = face.normal.x;
  b.normalY[k] = face.normal.y;
  b.normalZ[k] = face.normal.z;
  b.offset[k] = face.offset;
  for (std::size_t e = 0; e < 3; ++e) {
    b.inwardX[e][k] = face.inward[e].x;
    b.inwardY[e][k] = face.inward[e].y;
    b.inwardZ[e][k] = face.inward[e].z;
    b.edge[e][k] = face.edge[e];
  }
  b.loX[k] = face.lo.x;
  b.loY[k] = face.lo.y;
  b.loZ[k] = face.lo.z;
  b.hiX[k] = face.hi.x;
  b.hiY[k] = face.hi.y;
  b.hiZ[k] = face.hi.z;
}

void FaceSet::addToGroup(const Face& face) {
  const std::size_t group = count_ / (kSurfaceLanes * kFaceGroup), k = group % kSurfaceLanes;
  if (count_ % (kSurfaceLanes * kFaceGroup) == 0) {
    if (k == 0) std::fill_n(groups_.emplace_back().loX, sizeof(FaceGroups) / sizeof(double), kInfinity);
    FaceGroups& g = groups_.back();
    g.hiX[k] = g.hiY[k] = g.hiZ[k] = -kInfinity;
    g.reach[k] = 0;
  }
  FaceGroups& g = groups_.back();
  g.loX[k] = std::min(g.loX[k], face.lo.x);
  g.loY[k] = std::min(g.loY[k], face.lo.y);
  g.loZ[k] = std::min(g.loZ[k], face.lo.z);
  g.hiX[k] = std::max(g.hiX[k], face.hi.x);
  g.hiY[k] = std::max(g.hiY[k], face.hi.y);
  g.hiZ[k] = std::max(g.hiZ[k], face.hi.z);
  g.reach[k] = std::max(g.reach[k], face.reach);
}

std::span<const std::uint32_t> FaceSet::near(const Vec3d& point, double radius) const {
  found_.resize(kSurfaceLanes * blocks_.size());
  // Lanes that are not used are infinitely far away.
  const double radius2 = std::min(radius * radius, std::numeric_limits<double>::max());
  NearFacesArgs args{
      blocks_.data(), blocks_.size(), groups_.data(), groups_.size(), point, radius2, found_.data(), 0, 0};
  findNearFaces(level(), args);
  return {found_.data(), args.foundCount};
}

std::uint32_t FaceSet::nearest(const Vec3d& point) const {
  NearFacesArgs args{blocks_.data(), blocks_.size(), groups_.data(), groups_.size(), point, 0, nullptr, 0, 0};
  findNearestFace(level(), args);
  return args.nearest;
}

std::span<const std::uint32_t> FaceSet::over(const Vec3d& from, const Vec3d& to, double slack,
                                             const Moved& moved) const {
  found_.resize(kSurfaceLanes * blocks_.size());
  const Moved almost = nearly(moved);
  const double limit = almost.missing + lengthOf({0, 0, 0}, moved.by);
  FacesOverArgs args{blocks_.data(), blocks_.size(),     groups_.data(), groups_.size(), from,          to,
                     slack,          lengthOf(from, to), limit,          almost,         found_.data(), 0};
  findFacesOver(level(), args);
  return {found_.data(), args.foundCount};
}

FaceSet::Soonest FaceSet::soonest(const Vec3d& from, const Vec3d& to, double slack) const {
  SoonestFaceArgs args{blocks_.data(), blocks_.size(),
                       groups_.data(), groups_.size(),
                       from,           to,
                       slack,          lengthOf(from, to),
                       kInfinity,      0};
  if (count_ > 0) findSoonestFace(level(), args);
  return {args.depth, args.face};
}

void WaySet::add(const Vec3d& direction, double length) {
  const std::size_t k = count_++ % kSurfaceLanes;
  if (k == 0) std::fill_n(blocks_.emplace_back().length, kSurfaceLanes, -1.0);
  WayBlock& b = blocks_.back();
  b.x[k] = direction.x;
  b.y[k] = direction.y;
  b.z[k] = direction.z;
  b.length[k] = length;
}

void StretchSet::clear() {
  blocks_.clear();
  count_ = 0;
}

void StretchSet::add(const Vec3d& middle, const Vec3d& along, double reach) {
  const std::size_t k = count_++ % kSurfaceLanes;
  if (k == 0) blocks_.push_back({});
  StretchBlock& b = blocks_.back();
  b.x[k] = middle.x;
  b.y[k] = middle.y;
  b.z[k] = middle.z;
  b.alongX[k] = along.x;
  b.alongY[k] = along.y;
  b.alongZ[k] = along.z;
  b.reach[k] = reach;
}

std::span<const std::uint32_t> StretchSet::passed(const Vec3d& middle, const Vec3d& along, double reach,
                                                  double leastSine, const Moved& moved) const {
  found_.resize(kSurfaceLanes * blocks_.size());
  StretchesPassedArgs args{blocks_.data(), blocks_.size(), middle,        along, reach,
                           leastSine,      nearly(moved),  found_.data(), 0};
  findStretchesPassed(level(), args);
  return {found_.data(), args.foundCount};
}

}  // namespace otg
