// SPDX-License-Identifier: BSD-3-Clause
// Bodies of the kernels over a region's surface, for the instruction set that OTG_SIMD_NAMESPACE names: see
// collide/simd/wide_kernels.h. Four lanes everywhere, so that sums come out the same for every instruction set.
#pragma once

#include <cstdint>
#include <cstring>

#include "collide/simd/surface_kernels_args.h"

namespace otg::OTG_SIMD_NAMESPACE {
namespace {

typedef double Doubles __attribute__((vector_size(32)));
typedef std::int64_t DoubleMask __attribute__((vector_size(32)));
constexpr double kFarAway = __builtin_huge_val();

__attribute__((always_inline)) inline Doubles load4(const double* p) {
  Doubles x;
  std::memcpy(&x, p, sizeof x);
  return x;
}
__attribute__((always_inline)) inline Doubles spread4(double x) {
  return x - Doubles{};
}
__attribute__((always_inline)) inline void store4(double* p, Doubles x) {
  std::memcpy(p, &x, sizeof x);
}
__attribute__((always_inline)) inline Doubles larger(Doubles a, Doubles b) {
  return a > b ? a : b;
}
__attribute__((always_inline)) inline Doubles smaller(Doubles a, Doubles b) {
  return a < b ? a : b;
}
/// In the order (0 + 1) + (2 + 3).
__attribute__((always_inline)) inline double sumOf(Doubles a) {
  return (a[0] + a[1]) + (a[2] + a[3]);
}
__attribute__((always_inline)) inline double least(Doubles a) {
  double x = a[0];
  for (int k = 1; k < 4; ++k) x = a[k] < x ? a[k] : x;
  return x;
}

struct Square {
  Doubles value;
};

/// Squared distance of points from boxes.
__attribute__((always_inline)) inline Square squaredDistance(Doubles x, Doubles y, Doubles z, const double* loX,
                                                             const double* loY, const double* loZ, const double* hiX,
                                                             const double* hiY, const double* hiZ) {
  const Doubles zero{};
  const Doubles dx = larger(larger(load4(loX) - x, x - load4(hiX)), zero);
  const Doubles dy = larger(larger(load4(loY) - y, y - load4(hiY)), zero);
  const Doubles dz = larger(larger(load4(loZ) - z, z - load4(hiZ)), zero);
  return {dx * dx + dy * dy + dz * dz};
}

template <bool kRound>
__attribute__((always_inline)) inline void exitThrough(PlaneExitArgs& args) {
  const Doubles px = spread4(args.from.x), py = spread4(args.from.y), pz = spread4(args.from.z);
  const Doubles dx = spread4(args.direction.x), dy = spread4(args.direction.y), dz = spread4(args.direction.z);
  const Doubles zero{}, far = spread4(kFarAway), slack = spread4(args.slack);
  Doubles nearest = far, convex = far;
  for (std::size_t i = 0; i < args.count; ++i) {
    const PlaneBlock& b = args.blocks[i];
    const Doubles nx = load4(b.normalX), ny = load4(b.normalY), nz = load4(b.normalZ);
    const Doubles cosine = nx * dx + ny * dy + nz * dz;
    const DoubleMask ahead = cosine > 0.05;
    const Doubles way = larger((load4(b.offset) - (nx * px + ny * py + nz * pz)) / cosine, zero);
    const Doubles t = ahead ? way : far;
    convex = smaller(t, convex);
    const Doubles x = px + dx * way, y = py + dy * way, z = pz + dz * way;
    DoubleMask there;
    if constexpr (kRound) {
      there = squaredDistance(x, y, z, b.loX, b.loY, b.loZ, b.hiX, b.hiY, b.hiZ).value <= slack * slack;
    } else {
      there = (x >= load4(b.loX) - slack) & (x <= load4(b.hiX) + slack) & (y >= load4(b.loY) - slack) &
              (y <= load4(b.hiY) + slack) & (z >= load4(b.loZ) - slack) & (z <= load4(b.hiZ) + slack);
    }
    nearest = smaller(there ? t : far, nearest);
  }
  args.nearest = least(nearest);
  args.convex = least(convex);
}

}  // namespace

void exitThroughPlanes(PlaneExitArgs& args) {
  exitThrough<false>(args);
}

void exitThroughRoundPlanes(PlaneExitArgs& args) {
  exitThrough<true>(args);
}

void sumLocalAreas(LocalAreaArgs& args) {
  const Doubles px = spread4(args.point.x), py = spread4(args.point.y), pz = spread4(args.point.z);
  const Doubles zero{}, one = spread4(1), inverse = spread4(1 / (args.radius * args.radius));
  Doubles x{}, y{}, z{}, area{};
  for (std::size_t i = 0; i < args.count; ++i) {
    const AreaBlock& b = args.blocks[i];
    const Doubles d = squaredDistance(px, py, pz, b.loX, b.loY, b.loZ, b.hiX, b.hiY, b.hiZ).value;
    const Doubles near = larger(one - d * inverse, zero), weight = near * near;
    x += load4(b.x) * weight;
    y += load4(b.y) * weight;
    z += load4(b.z) * weight;
    area += load4(b.area) * weight;
  }
  args.vector = {sumOf(x), sumOf(y), sumOf(z)};
  args.area = sumOf(area);
}

void findExtent(ExtentArgs& args) {
  const Doubles dx = spread4(args.direction.x), dy = spread4(args.direction.y), dz = spread4(args.direction.z);
  Doubles lo = spread4(kFarAway), hi = spread4(-kFarAway);
  for (std::size_t i = 0; i < args.count; ++i) {
    const PointBlock& b = args.blocks[i];
    const Doubles at = load4(b.x) * dx + load4(b.y) * dy + load4(b.z) * dz;
    lo = smaller(at, lo);
    hi = larger(at, hi);
  }
  args.lo = least(lo);
  args.hi = -least(-hi);
}

void findBoxRanges(BoxRangesArgs& args) {
  const Doubles dx = spread4(args.direction.x), dy = spread4(args.direction.y), dz = spread4(args.direction.z);
  const Doubles ax = larger(dx, -dx), ay = larger(dy, -dy), az = larger(dz, -dz);
  for (std::size_t i = 0; i < args.count; ++i) {
    const BoxBlock& b = args.blocks[i];
    const Doubles middle = load4(b.x) * dx + load4(b.y) * dy + load4(b.z) * dz;
    const Doubles half = load4(b.halfX) * ax + load4(b.halfY) * ay + load4(b.halfZ) * az;
    store4(args.lo + kSurfaceLanes * i, middle - half);
    store4(args.hi + kSurfaceLanes * i, middle + half);
  }
}

}  // namespace otg::OTG_SIMD_NAMESPACE
