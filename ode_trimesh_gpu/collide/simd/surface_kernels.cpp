// SPDX-License-Identifier: BSD-3-Clause
#include "collide/simd/surface_kernels.h"

#include <cmath>

namespace otg {
namespace {

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
void sumLocalAreas(SimdLevel level, LocalAreaArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, sumLocalAreas, args)
}
void findExtent(SimdLevel level, ExtentArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findExtent, args)
}

void findBoxRanges(SimdLevel level, BoxRangesArgs& args) {
  OTG_CALL_SURFACE_KERNEL(level, findBoxRanges, args)
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

}  // namespace otg
