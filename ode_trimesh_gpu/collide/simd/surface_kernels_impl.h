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
/// Of each its four lanes' sum, in the order (0 + 1) + (2 + 3).
__attribute__((always_inline)) inline Doubles sumsOf(Doubles a, Doubles b, Doubles c, Doubles d) {
  const Doubles ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Doubles cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}
__attribute__((always_inline)) inline double least(Doubles a) {
  double x = a[0];
  for (int k = 1; k < 4; ++k) x = a[k] < x ? a[k] : x;
  return x;
}

/// Bit k set where lane k is true.
__attribute__((always_inline)) inline unsigned bitsOfLanes(DoubleMask m) {
#if defined(__AVX__)
  Doubles signs;
  std::memcpy(&signs, &m, sizeof signs);
  return static_cast<unsigned>(__builtin_ia32_movmskpd256(signs));
#else
  unsigned bits = 0;
  for (int k = 0; k < 4; ++k) bits |= static_cast<unsigned>(m[k] != 0) << k;
  return bits;
#endif
}
/// Numbers of the lanes of block i whose bits are set, appended.
__attribute__((always_inline)) inline std::size_t appendLanes(unsigned bits, std::size_t i, std::uint32_t* found,
                                                              std::size_t count) {
  for (; bits; bits &= bits - 1) {
    found[count++] = static_cast<std::uint32_t>(kSurfaceLanes * i) + static_cast<unsigned>(__builtin_ctz(bits));
  }
  return count;
}

/// Distances of points from boxes along the axes.
struct Apart {
  Doubles x, y, z;
};
__attribute__((always_inline)) inline Apart apart(Doubles x, Doubles y, Doubles z, const double* loX, const double* loY,
                                                  const double* loZ, const double* hiX, const double* hiY,
                                                  const double* hiZ) {
  const Doubles zero{};
  return {larger(larger(load4(loX) - x, x - load4(hiX)), zero), larger(larger(load4(loY) - y, y - load4(hiY)), zero),
          larger(larger(load4(loZ) - z, z - load4(hiZ)), zero)};
}

struct Square {
  Doubles value;
};

/// Squared distance of points from boxes.
__attribute__((always_inline)) inline Square squaredDistance(Doubles x, Doubles y, Doubles z, const double* loX,
                                                             const double* loY, const double* loZ, const double* hiX,
                                                             const double* hiY, const double* hiZ) {
  const Apart d = apart(x, y, z, loX, loY, loZ, hiX, hiY, hiZ);
  return {d.x * d.x + d.y * d.y + d.z * d.z};
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

/// Among planes equally far the one whose part is nearest to the point.
void findFacingPlane(FacingPlaneArgs& args) {
  const Doubles px = spread4(args.from.x), py = spread4(args.from.y), pz = spread4(args.from.z);
  const Doubles dx = spread4(args.direction.x), dy = spread4(args.direction.y), dz = spread4(args.direction.z);
  const Doubles far = spread4(kFarAway);
  Doubles nearest = far;
  DoubleMask at{}, block{};
  for (std::size_t i = 0; i < args.count; ++i, block += 1) {
    const PlaneBlock& b = args.blocks[i];
    const Doubles nx = load4(b.normalX), ny = load4(b.normalY), nz = load4(b.normalZ);
    const Doubles cosine = nx * dx + ny * dy + nz * dz;
    const Doubles way = larger((load4(b.offset) - (nx * px + ny * py + nz * pz)) / cosine, Doubles{});
    const Apart d = apart(px, py, pz, b.loX, b.loY, b.loZ, b.hiX, b.hiY, b.hiZ);
    const Doubles t = cosine > 0.05 ? way + d.x + d.y + d.z : far;
    at = t < nearest ? block : at;
    nearest = smaller(t, nearest);
  }
  double best = kFarAway;
  args.plane = ~std::uint32_t{0};
  for (int k = 0; k < 4; ++k) {
    const auto plane =
        static_cast<std::uint32_t>(at[k]) * static_cast<std::uint32_t>(kSurfaceLanes) + static_cast<std::uint32_t>(k);
    if (!(nearest[k] < kFarAway) || nearest[k] > best || (nearest[k] == best && plane > args.plane)) continue;
    best = nearest[k];
    args.plane = plane;
  }
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
  const Doubles sums = sumsOf(x, y, z, area);
  args.vector = {sums[0], sums[1], sums[2]};
  args.area = sums[3];
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

void findFarthestWay(FarthestWayArgs& args) {
  args.way = 0;
  for (std::size_t i = 0; i < args.count; ++i) {
    const PointBlock& b = args.blocks[i];
    const Doubles px = load4(b.x), py = load4(b.y), pz = load4(b.z);
    Doubles way{};
    for (int side = 0; side < 2; ++side) {
      Doubles exit = spread4(args.far);
      for (std::size_t k = 0; k < args.barrierCount[side]; ++k) {
        const Barrier& barrier = args.barriers[side][k];
        exit = smaller(barrier.offset - (barrier.normal.x * px + barrier.normal.y * py + barrier.normal.z * pz), exit);
      }
      way += larger(exit, Doubles{});
    }
    for (int lane = 0; lane < 4; ++lane) {
      args.way = args.way < way[lane] ? way[lane] : args.way;
      if (args.way >= args.enough) return;
    }
  }
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

namespace {

template <class Boxes>
__attribute__((always_inline)) inline Doubles squaredDistanceFrom(const Boxes& b, const Vec3d& p) {
  return squaredDistance(spread4(p.x), spread4(p.y), spread4(p.z), b.loX, b.loY, b.loZ, b.hiX, b.hiY, b.hiZ).value;
}

/// Where a number is the least of `count` boxes' distances.
template <class Boxes>
__attribute__((always_inline)) inline std::size_t nearestOf(const Boxes* boxes, std::size_t count, const Vec3d& p) {
  Doubles least = spread4(kFarAway);
  DoubleMask at{}, block{};
  for (std::size_t i = 0; i < count; ++i, block += 1) {
    const Doubles d = squaredDistanceFrom(boxes[i], p);
    at = d < least ? block : at;
    least = smaller(d, least);
  }
  int lane = 0;
  for (int k = 1; k < 4; ++k) lane = least[k] < least[lane] ? k : lane;
  return static_cast<std::size_t>(at[lane]) * kSurfaceLanes + static_cast<std::size_t>(lane);
}

__attribute__((always_inline)) inline std::size_t endOfGroup(std::size_t first, std::size_t count) {
  return first + kFaceGroup < count ? first + kFaceGroup : count;
}

/// Whether a stretch may lie over a face of a group, `depth` below its plane at most: an end over a face is below its
/// plane by the depth at most, or in front of it by the length at most.
template <class Args>
__attribute__((always_inline)) inline unsigned mayBeOver(const Args& args, std::size_t group, double depth) {
  const FaceGroups& g = args.groups[group];
  const Doubles reach = load4(g.reach);
  const Doubles below = reach * (depth > args.slack ? depth : args.slack);
  const Doubles far = larger(below, reach * args.slack + args.length) * (1 + 1e-6);
  const Doubles nearer = smaller(squaredDistanceFrom(g, args.from), squaredDistanceFrom(g, args.to));
  return bitsOfLanes(~(nearer > far * far));
}

}  // namespace

void findNearFaces(NearFacesArgs& args) {
  const Doubles radius2 = spread4(args.radius2);
  args.foundCount = 0;
  for (std::size_t g = 0; g < args.groupCount; ++g) {
    for (unsigned bits = bitsOfLanes(squaredDistanceFrom(args.groups[g], args.point) <= radius2); bits;
         bits &= bits - 1) {
      const std::size_t first = (kSurfaceLanes * g + static_cast<unsigned>(__builtin_ctz(bits))) * kFaceGroup;
      const std::size_t end = endOfGroup(first, args.count);
      for (std::size_t i = first; i < end; ++i) {
        const DoubleMask near = squaredDistanceFrom(args.blocks[i], args.point) <= radius2;
        args.foundCount = appendLanes(bitsOfLanes(near), i, args.found, args.foundCount);
      }
    }
  }
}

void findNearestFace(NearFacesArgs& args) {
  const std::size_t first = nearestOf(args.groups, args.groupCount, args.point) * kFaceGroup;
  const std::size_t count = endOfGroup(first, args.count) - first;
  args.nearest = static_cast<std::uint32_t>(first * kSurfaceLanes + nearestOf(args.blocks + first, count, args.point));
}

namespace {

__attribute__((always_inline)) inline Doubles dot4(const double* x, const double* y, const double* z, Doubles px,
                                                   Doubles py, Doubles pz) {
  return load4(x) * px + load4(y) * py + load4(z) * pz;
}

/// Whether a point that lies `way` below the planes lies over the faces: RegionTriangle::beside(), lane by lane.
__attribute__((always_inline)) inline DoubleMask isOver(const FaceBlock& b, Doubles px, Doubles py, Doubles pz,
                                                        Doubles way, Doubles slack) {
  const Doubles x = px + load4(b.normalX) * way, y = py + load4(b.normalY) * way, z = pz + load4(b.normalZ) * way;
  Doubles most = load4(b.edge[0]) - dot4(b.inwardX[0], b.inwardY[0], b.inwardZ[0], x, y, z);
  for (int k = 1; k < 3; ++k) {
    most = larger(load4(b.edge[k]) - dot4(b.inwardX[k], b.inwardY[k], b.inwardZ[k], x, y, z), most);
  }
  return most <= larger(way, slack);
}

}  // namespace

void findFacesOver(FacesOverArgs& args) {
  const Doubles px = spread4(args.from.x), py = spread4(args.from.y), pz = spread4(args.from.z);
  const Vec3d& moved = args.moved.by;
  const Doubles bx = spread4(moved.x), by = spread4(moved.y), bz = spread4(moved.z);
  const bool isPoint = args.from.x == args.to.x && args.from.y == args.to.y && args.from.z == args.to.z;
  const Doubles qx = spread4(args.to.x), qy = spread4(args.to.y), qz = spread4(args.to.z);
  const Doubles slack = spread4(args.slack);
  args.foundCount = 0;
  for (std::size_t g = 0; g < args.groupCount; ++g) {
    for (unsigned bits = mayBeOver(args, g, args.limit); bits; bits &= bits - 1) {
      const std::size_t begin = (kSurfaceLanes * g + static_cast<unsigned>(__builtin_ctz(bits))) * kFaceGroup;
      const std::size_t end = endOfGroup(begin, args.count);
      for (std::size_t i = begin; i < end; ++i) {
        const FaceBlock& b = args.blocks[i];
        const Doubles first = load4(b.offset) - dot4(b.normalX, b.normalY, b.normalZ, px, py, pz);
        const Doubles last = load4(b.offset) - dot4(b.normalX, b.normalY, b.normalZ, qx, qy, qz);
        const Doubles deeper = larger(first, last);
        const Doubles gone = dot4(b.normalX, b.normalY, b.normalZ, bx, by, bz);
        const DoubleMask below = (deeper >= -slack) & (deeper - gone <= args.moved.missing);
        if (bitsOfLanes(below) == 0) continue;
        DoubleMask over = isOver(b, px, py, pz, first, slack);
        if (!isPoint) over |= isOver(b, qx, qy, qz, last, slack);
        args.foundCount = appendLanes(bitsOfLanes(below & over), i, args.found, args.foundCount);
      }
    }
  }
}

namespace {

/// Among the blocks of one group: what findFacesOver() finds, but only as far as it is no deeper than the best so far.
__attribute__((always_inline)) inline void soonestOfGroup(SoonestFaceArgs& args, std::size_t group) {
  const Doubles px = spread4(args.from.x), py = spread4(args.from.y), pz = spread4(args.from.z);
  const Doubles qx = spread4(args.to.x), qy = spread4(args.to.y), qz = spread4(args.to.z);
  const Doubles slack = spread4(args.slack);
  const std::size_t first = group * kFaceGroup, end = endOfGroup(first, args.count);
  for (std::size_t i = first; i < end; ++i) {
    const FaceBlock& b = args.blocks[i];
    const Doubles from = load4(b.offset) - dot4(b.normalX, b.normalY, b.normalZ, px, py, pz);
    const Doubles to = load4(b.offset) - dot4(b.normalX, b.normalY, b.normalZ, qx, qy, qz);
    const Doubles deeper = larger(from, to);
    const DoubleMask below = (deeper >= -slack) & (deeper <= args.depth);
    if (bitsOfLanes(below) == 0) continue;
    const DoubleMask over = isOver(b, px, py, pz, from, slack) | isOver(b, qx, qy, qz, to, slack);
    for (unsigned bits = bitsOfLanes(below & over); bits; bits &= bits - 1) {
      const auto lane = static_cast<unsigned>(__builtin_ctz(bits));
      const double depth = deeper[lane] > 0 ? deeper[lane] : 0;
      const auto face = static_cast<std::uint32_t>(kSurfaceLanes * i + lane);
      if (depth > args.depth || (depth == args.depth && face >= args.face)) continue;
      args.depth = depth;
      args.face = face;
    }
  }
}

}  // namespace

void findSoonestFace(SoonestFaceArgs& args) {
  args.depth = kFarAway;
  args.face = 0;
  // The nearest group first: what it has spares most of the others.
  const std::size_t nearest = nearestOf(args.groups, args.groupCount, args.from);
  soonestOfGroup(args, nearest);
  for (std::size_t g = 0; g < args.groupCount; ++g) {
    for (unsigned bits = mayBeOver(args, g, args.depth); bits; bits &= bits - 1) {
      const std::size_t group = kSurfaceLanes * g + static_cast<unsigned>(__builtin_ctz(bits));
      if (group != nearest) soonestOfGroup(args, group);
    }
  }
}

namespace {

constexpr double kSurely = 1 + 1e-8;  ///< for lengths that round
constexpr double kWithin = 1 + 1e-6;  ///< for limits of lengths

struct Directions {
  Doubles x, y, z;
};

__attribute__((always_inline)) inline double largest(Doubles a) {
  return -least(-a);
}

/// The ways along four directions through the nearest triangle of mesh m that faces along and is met sooner than
/// `limit`, or infinity.
__attribute__((always_inline)) inline Doubles waysThrough(const ShortestWayArgs& args, int m, const Directions& d,
                                                          Doubles limit) {
  Doubles nearest = limit;
  double most = largest(nearest) * kSurely;
  for (std::size_t k = 0; k < args.aheadCount[m]; ++k) {
    const TriangleAhead& ahead = args.ahead[m][k];
    if (!(ahead.depth < most)) break;  // no way is shorter than the distance from the plane
    const RegionTriangle& t = args.triangles[ahead.triangle];
    const Doubles cosine = t.normal.x * d.x + t.normal.y * d.y + t.normal.z * d.z;
    DoubleMask met = (cosine > args.leastCosine) & (ahead.depth < kSurely * nearest * cosine);
    if (bitsOfLanes(met) == 0) continue;
    const Doubles way = larger(ahead.depth / cosine, Doubles{});
    const Doubles x = args.from.x + d.x * way, y = args.from.y + d.y * way, z = args.from.z + d.z * way;
    Doubles beside = t.edge[0] - (t.inward[0].x * x + t.inward[0].y * y + t.inward[0].z * z);
    for (int e = 1; e < 3; ++e) {
      beside = larger(t.edge[e] - (t.inward[e].x * x + t.inward[e].y * y + t.inward[e].z * z), beside);
    }
    met &= (way < nearest) & (beside <= args.slack);
    if (bitsOfLanes(met) == 0) continue;
    nearest = met ? way : nearest;
    most = largest(nearest) * kSurely;
  }
  return nearest < limit ? nearest : spread4(kFarAway);
}

}  // namespace

void findShortestWay(ShortestWayArgs& args) {
  args.length = kFarAway;
  double most = args.most;
  for (std::size_t i = 0; i < args.count; ++i) {
    const WayBlock& b = args.ways[i];
    const Directions d{load4(b.x), load4(b.y), load4(b.z)};
    const Doubles cosine = args.ending.x * d.x + args.ending.y * d.y + args.ending.z * d.z;
    const Doubles none = spread4(-1), longest = load4(b.length);
    const Doubles limit = cosine > args.mostEnding ? none : smaller(longest, spread4(most)) * kWithin;
    if (bitsOfLanes(limit > 0) == 0) continue;
    const Doubles out = waysThrough(args, 1, d, limit);
    if (bitsOfLanes(out < kFarAway) == 0) continue;
    const Doubles back = waysThrough(args, 0, {-d.x, -d.y, -d.z}, out < kFarAway ? limit - out : none);
    const Doubles length = out + back;
    for (unsigned bits = bitsOfLanes(length <= longest); bits; bits &= bits - 1) {
      const int lane = __builtin_ctz(bits);
      if (!(length[lane] < most)) continue;
      args.length = most = length[lane];
      args.out = out[lane];
      args.back = back[lane];
      args.way = static_cast<std::uint32_t>(kSurfaceLanes * i) + static_cast<std::uint32_t>(lane);
    }
  }
}

/// Those that otgPassOfStretches() may find, and few more: along the common perpendicular.
void findStretchesPassed(StretchesPassedArgs& args) {
  const Doubles px = spread4(args.middle.x), py = spread4(args.middle.y), pz = spread4(args.middle.z);
  const Doubles ax = spread4(args.along.x), ay = spread4(args.along.y), az = spread4(args.along.z);
  // What rounds: products of numbers of about the distance between the middles, and relative errors.
  const Doubles within = spread4(1 + 1e-6), grain = spread4(1e-12);
  const Doubles reach = spread4(args.reach) * within, least = spread4(args.leastSine * args.leastSine) * (2.0 - within);
  const Vec3d& moved = args.moved.by;
  args.foundCount = 0;
  for (std::size_t i = 0; i < args.count; ++i) {
    const StretchBlock& b = args.blocks[i];
    const Doubles bx = load4(b.alongX), by = load4(b.alongY), bz = load4(b.alongZ);
    const Doubles dx = load4(b.x) - px, dy = load4(b.y) - py, dz = load4(b.z) - pz;
    const Doubles cx = ay * bz - az * by, cy = az * bx - ax * bz, cz = ax * by - ay * bx;
    const Doubles square = cx * cx + cy * cy + cz * cz;
    const Doubles at = (dy * bz - dz * by) * cx + (dz * bx - dx * bz) * cy + (dx * by - dy * bx) * cz;
    const Doubles other = (dy * az - dz * ay) * cx + (dz * ax - dx * az) * cy + (dx * ay - dy * ax) * cz;
    const Doubles rounding = grain * (larger(dx, -dx) + larger(dy, -dy) + larger(dz, -dz));
    // Along `c`, which is no longer than 1: the way, and how far it has been gone.
    const Doubles way = dx * cx + dy * cy + dz * cz, gone = moved.x * cx + moved.y * cy + moved.z * cz;
    const Doubles left = larger(way, -way) - (way < 0 ? -gone : gone);
    const DoubleMask missing = (left <= args.moved.missing + rounding) | (larger(way, -way) <= rounding);
    const DoubleMask passed = (larger(at, -at) <= reach * square + rounding) & missing &
                              (larger(other, -other) <= load4(b.reach) * within * square + rounding) &
                              (square >= least);
    if (const unsigned bits = bitsOfLanes(passed)) {
      args.foundCount = appendLanes(bits, i, args.found, args.foundCount);
    }
  }
}

}  // namespace otg::OTG_SIMD_NAMESPACE
