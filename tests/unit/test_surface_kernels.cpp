// SPDX-License-Identifier: BSD-3-Clause
// The kernels over a region's surface against loops that say what they mean, and every instruction set bit for bit.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "base/vectors.h"
#include "collide/simd/surface_kernels.h"
#include "support/catch.h"

using namespace otg;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kInvalid = std::numeric_limits<std::uint32_t>::max();

std::vector<SimdLevel> levels() {
  std::vector<SimdLevel> out{SimdLevel::kBaseline};
  if (bestSimdLevel() >= SimdLevel::kAvx2) out.push_back(SimdLevel::kAvx2);
  if (bestSimdLevel() >= SimdLevel::kAvx512) out.push_back(SimdLevel::kAvx512);
  return out;
}

class Random {
 public:
  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  Vec3d inBox() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
  Vec3d direction() {
    for (;;) {
      const Vec3d d = inBox();
      const double l = norm(d);
      if (l > 0.1 && l < 1) return otgScale(d, 1 / l);
    }
  }

 private:
  std::mt19937 engine_{7};
};

template <class Block>
void fill(Block (&blocks)[3], Random& random) {
  std::vector<double> values(3 * sizeof(Block) / sizeof(double));
  for (double& x : values) x = random.between(-1, 1);
  std::memcpy(blocks, values.data(), sizeof blocks);
}

struct Part {
  Vec3d normal, lo, hi, vector;
  double offset, area;
};

std::vector<Part> parts(Random& random, int count) {
  std::vector<Part> out;
  for (int i = 0; i < count; ++i) {
    const Vec3d middle = random.inBox(), half{random.between(0, 0.4), random.between(0, 0.4), random.between(0, 0.4)};
    const Vec3d n = random.direction();
    out.push_back({n, otgSub(middle, half), otgAdd(middle, half), otgScale(random.direction(), random.between(0, 2)),
                   otgDot(n, middle), random.between(2, 3)});
  }
  return out;
}

double distance(const Vec3d& p, const Vec3d& lo, const Vec3d& hi) {
  return std::hypot(std::max({lo.x - p.x, 0.0, p.x - hi.x}), std::max({lo.y - p.y, 0.0, p.y - hi.y}),
                    std::max({lo.z - p.z, 0.0, p.z - hi.z}));
}

double chebyshev(const Vec3d& p, const Vec3d& lo, const Vec3d& hi) {
  return std::max({lo.x - p.x, p.x - hi.x, lo.y - p.y, p.y - hi.y, lo.z - p.z, p.z - hi.z, 0.0});
}

bool close(double a, double b) {
  return a == b || std::fabs(a - b) <= 1e-12 * (1 + std::fabs(b));
}

}  // namespace

TEST_CASE("ways out through planes") {
  Random random;
  int onPart = 0, onlyConvex = 0, none = 0;
  for (int round = 0; round < 400; ++round) {
    std::vector<Part> all = parts(random, round % 23);
    PlaneSet set;
    if (round % 2 == 0) {  // of equal ones the first faces
      const std::vector<Part> again = all;
      all.insert(all.end(), again.begin(), again.end());
    }
    for (const Part& p : all) set.add(p.normal, p.offset, p.lo, p.hi);
    const Vec3d from = random.inBox(), d = random.direction();
    const double slack = random.between(0, 0.1);
    double nearest = kInfinity, nearestRound = kInfinity, convex = kInfinity, leastSum = kInfinity;
    std::uint32_t facing = kInvalid;
    for (const Part& p : all) {
      const double cosine = otgDot(p.normal, d);
      if (cosine <= 0.05) continue;
      const double t = std::max(0.0, (p.offset - otgDot(p.normal, from)) / cosine);
      const Vec3d x = otgAdd(from, otgScale(d, t));
      convex = std::min(convex, t);
      const double sum = t + std::max({p.lo.x - from.x, 0.0, from.x - p.hi.x}) +
                         std::max({p.lo.y - from.y, 0.0, from.y - p.hi.y}) +
                         std::max({p.lo.z - from.z, 0.0, from.z - p.hi.z});
      if (sum < leastSum) facing = static_cast<std::uint32_t>(&p - all.data());
      leastSum = std::min(leastSum, sum);
      if (chebyshev(x, p.lo, p.hi) <= slack) nearest = std::min(nearest, t);
      if (distance(x, p.lo, p.hi) <= slack) nearestRound = std::min(nearestRound, t);
    }
    const PlaneSet::Way way = set.wayOut(from, d, slack), round2 = set.wayOutRound(from, d, slack);
    CHECK(close(way.nearest, nearest));
    CHECK(close(way.convex, convex));
    CHECK(close(round2.nearest, nearestRound));
    CHECK(close(round2.convex, convex));
    CHECK(set.facing(from, d) == facing);
    CHECK(way.either() == (std::isfinite(way.nearest) ? way.nearest : way.convex));
    ++(std::isfinite(nearest) ? onPart : std::isfinite(convex) ? onlyConvex : none);
  }
  CHECK(onPart > 20);
  CHECK(onlyConvex > 20);
  CHECK(none > 10);
}

TEST_CASE("areas about a point, extents of points, ranges of boxes") {
  Random random;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Part> all = parts(random, round % 19);
    AreaSet areas;
    PointSet points;
    BoxSet boxes;
    for (const Part& p : all) {
      areas.add(p.lo, p.hi, p.vector, p.area);
      points.add(p.lo);
      boxes.add(p.lo, p.hi);
    }
    const Vec3d at = random.inBox(), d = random.direction();
    const double radius = random.between(0.1, 1);
    Vec3d vector{0, 0, 0};
    double area = 0, lo = kInfinity, hi = -kInfinity;
    std::vector<double> boxLo, boxHi;
    for (const Part& p : all) {
      const double x = std::max(0.0, 1 - std::pow(distance(at, p.lo, p.hi) / radius, 2)), weight = x * x;
      vector = otgAdd(vector, otgScale(p.vector, weight));
      area += weight * p.area;
      lo = std::min(lo, otgDot(p.lo, d));
      hi = std::max(hi, otgDot(p.lo, d));
      double least = kInfinity, most = -kInfinity;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3d c{corner & 1 ? p.hi.x : p.lo.x, corner & 2 ? p.hi.y : p.lo.y, corner & 4 ? p.hi.z : p.lo.z};
        least = std::min(least, otgDot(c, d));
        most = std::max(most, otgDot(c, d));
      }
      boxLo.push_back(least);
      boxHi.push_back(most);
    }
    const AreaSet::Sum sum = areas.about(at, radius);
    CHECK(close(sum.vector.x, vector.x));
    CHECK(close(sum.vector.y, vector.y));
    CHECK(close(sum.vector.z, vector.z));
    CHECK(close(sum.area, area));
    CHECK(close(points.extent(d), all.empty() ? 0 : hi - lo));
    std::pmr::vector<double> foundLo, foundHi;
    boxes.ranges(d, foundLo, foundHi);
    REQUIRE(foundLo.size() == all.size());
    REQUIRE(foundHi.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      CHECK(close(foundLo[i], boxLo[i]));
      CHECK(close(foundHi[i], boxHi[i]));
    }
  }
}

TEST_CASE("the farthest way of points to barriers") {
  Random random;
  int stopped = 0;
  for (int round = 0; round < 300; ++round) {
    PointSet set;
    std::vector<Vec3d> points;
    for (int i = 0; i < round % 19; ++i) {
      points.push_back(random.inBox());
      set.add(points.back());
    }
    std::vector<Barrier> barriers[2];
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < round % (5 + side); ++i) {
        barriers[side].push_back({otgScale(random.direction(), 2.0), random.between(-0.5, 2)});
      }
    }
    const double far = random.between(1, 3), enough = round % 2 == 0 ? kInfinity : random.between(0, 4);
    double most = 0;
    for (const Vec3d& p : points) {
      double way[2] = {far, far};
      for (int side = 0; side < 2; ++side) {
        for (const Barrier& b : barriers[side]) way[side] = std::min(way[side], b.offset - otgDot(b.normal, p));
      }
      most = std::max(most, std::max(0.0, way[0]) + std::max(0.0, way[1]));
      if (most >= enough) break;
    }
    CHECK(close(set.farthestWay(barriers[0], barriers[1], far, enough), most));
    stopped += most >= enough;
  }
  CHECK(stopped > 50);
}

namespace {

struct TestFace {
  FaceSet::Face face;
  Vec3d corner[3];
};

TestFace faceOf(Random& random) {
  TestFace out;
  const Vec3d at = random.inBox();
  for (Vec3d& c : out.corner) c = otgAdd(at, otgScale(random.inBox(), 0.3));
  const Vec3d* c = out.corner;
  FaceSet::Face& f = out.face;
  f.normal = unit(otgCross(otgSub(c[1], c[0]), otgSub(c[2], c[0])));
  f.offset = otgDot(f.normal, c[0]);
  for (int k = 0; k < 3; ++k) {
    f.inward[k] = unit(otgCross(f.normal, otgSub(c[(k + 1) % 3], c[k])));
    f.edge[k] = otgDot(f.inward[k], c[k]);
  }
  f.lo = minimum(c[0], minimum(c[1], c[2]));
  f.hi = maximum(c[0], maximum(c[1], c[2]));
  double least = kInfinity;
  for (int k = 0; k < 3; ++k) least = std::min(least, norm(otgAdd(f.inward[k], f.inward[(k + 1) % 3])));
  f.reach = 1 + 2 / least;
  return out;
}

/// Whether a point that lies `way` below the plane of a face lies over it, with as much beside it.
bool isOver(const FaceSet::Face& f, const Vec3d& p, double way, double slack) {
  const Vec3d x = otgAdd(p, otgScale(f.normal, way));
  double beside = -kInfinity;
  for (int k = 0; k < 3; ++k) beside = std::max(beside, f.edge[k] - otgDot(f.inward[k], x));
  return beside <= std::max(way, slack);
}

double deeperEnd(const FaceSet::Face& f, const Vec3d& from, const Vec3d& to) {
  return std::max(0.0, f.offset - std::min(otgDot(f.normal, from), otgDot(f.normal, to)));
}

using Numbers = std::vector<std::uint32_t>;
Numbers numbers(std::span<const std::uint32_t> found) {
  return {found.begin(), found.end()};
}

}  // namespace

TEST_CASE("faces near a point, and over a stretch") {
  Random random;
  std::size_t near = 0, over = 0, nearlyOut = 0, atBothEnds = 0, stretches = 0;
  for (int round = 0; round < 400; ++round) {
    FaceSet set;
    std::vector<TestFace> all;
    for (int i = 0; i < round % 90 + 1; ++i) {
      all.push_back(faceOf(random));
      set.add(all.back().face);
    }
    const Vec3d from = random.inBox(), to = round % 3 == 0 ? from : random.inBox();
    const double radius = round % 50 == 0 ? kInfinity : random.between(0, 0.8), slack = random.between(0, 0.1);
    Numbers expectedNear, expectedOver;
    double least = kInfinity;
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      const FaceSet::Face& f = all[i].face;
      const double d = distance(from, f.lo, f.hi);
      least = std::min(least, d);
      if (d <= radius) expectedNear.push_back(i);
      const double first = f.offset - otgDot(f.normal, from), last = f.offset - otgDot(f.normal, to);
      if (std::max(first, last) < -slack) continue;
      const bool a = isOver(f, from, first, slack), b = isOver(f, to, last, slack);
      if (a || b) expectedOver.push_back(i);
      atBothEnds += a && b;
    }
    CHECK(numbers(set.near(from, radius)) == expectedNear);
    CHECK(numbers(set.over(from, to, slack)) == expectedOver);
    const Moved moved{otgScale(random.inBox(), round % 4 * 0.1), random.between(0, 0.6)};
    Numbers expectedNearlyOut;
    for (const std::uint32_t i : expectedOver) {
      const FaceSet::Face& f = all[i].face;
      const double deeper = f.offset - std::min(otgDot(f.normal, from), otgDot(f.normal, to));
      if (deeper - otgDot(f.normal, moved.by) <= moved.missing) expectedNearlyOut.push_back(i);
    }
    CHECK(numbers(set.over(from, to, slack, moved)) == expectedNearlyOut);
    nearlyOut += expectedNearlyOut.size();
    double soonest = kInfinity;
    for (const std::uint32_t i : expectedOver) soonest = std::min(soonest, deeperEnd(all[i].face, from, to));
    const FaceSet::Soonest found = set.soonest(from, to, slack);
    CHECK(close(found.depth, soonest));
    if (!expectedOver.empty()) {
      CHECK(std::binary_search(expectedOver.begin(), expectedOver.end(), found.face));
      CHECK(close(deeperEnd(all[found.face].face, from, to), soonest));
      ++stretches;
    }
    REQUIRE(set.nearest(from) < all.size());
    const FaceSet::Face& nearest = all[set.nearest(from)].face;
    CHECK(distance(from, nearest.lo, nearest.hi) >= least);
    near += expectedNear.size();
    over += expectedOver.size();
    set.clear();
    CHECK(set.size() == 0);
    CHECK(set.near(from, kInfinity).empty());
    CHECK(set.over(from, to, slack).empty());
    CHECK(set.soonest(from, to, slack).depth == kInfinity);
  }
  CHECK(near > 1000);
  CHECK(over > 1000);
  CHECK(nearlyOut > 300);
  CHECK(nearlyOut < over / 2);
  CHECK(atBothEnds > 100);
  CHECK(stretches > 200);
}

TEST_CASE("the soonest of several faces that are as deep") {
  Random random;
  int asDeep = 0;
  for (int round = 0; round < 200; ++round) {
    const TestFace face = faceOf(random);
    TestFace mirrored = face;
    FaceSet::Face& m = mirrored.face;
    for (Vec3d* v : {&m.normal, &m.inward[0], &m.inward[1], &m.inward[2]}) v->x = -v->x;
    m.lo.x = -face.face.hi.x;
    m.hi.x = -face.face.lo.x;
    Vec3d from = otgSub(face.corner[0], otgScale(face.face.normal, random.between(0, 0.1)));
    from.x = 0;  // seen from there a face and its mirror image are the same
    FaceSet set;
    const auto first = static_cast<std::uint32_t>(round % 40);
    TestFace farOff = face;  // groups of faces that the point is not over, before and between the two
    farOff.face.lo = farOff.face.hi = {50, 50, 50};
    for (double& edge : farOff.face.edge) edge = 50;
    for (std::uint32_t i = 0; i < first; ++i) set.add(farOff.face);
    set.add(face.face);
    for (int i = 0; i < 20; ++i) set.add(farOff.face);
    set.add(mirrored.face);
    const double slack = 1;
    const Numbers over = numbers(set.over(from, from, slack));
    if (over.empty()) continue;
    REQUIRE(over == Numbers{first, first + 21});
    CHECK(set.soonest(from, from, slack).face == first);
    ++asDeep;
  }
  CHECK(asDeep > 50);
}

namespace {

RegionTriangle triangleOf(const TestFace& face) {
  RegionTriangle t{};
  t.normal = face.face.normal;
  t.offset = face.face.offset;
  for (int k = 0; k < 3; ++k) {
    t.corner[k] = face.corner[k];
    t.inward[k] = face.face.inward[k];
    t.edge[k] = face.face.edge[k];
  }
  return t;
}

/// Through the nearest triangle, one after the other.
double wayThrough(const std::vector<RegionTriangle>& triangles, const std::vector<TriangleAhead>& ahead, const Vec3d& p,
                  const Vec3d& d, double leastCosine, double slack) {
  double nearest = kInfinity;
  for (const TriangleAhead& a : ahead) {
    const RegionTriangle& t = triangles[a.triangle];
    const double cosine = otgDot(t.normal, d);
    if (cosine <= leastCosine) continue;
    const double way = std::max(0.0, a.depth / cosine);
    double beside = -kInfinity;
    for (int k = 0; k < 3; ++k) {
      beside = std::max(beside, t.edge[k] - otgDot(t.inward[k], otgAdd(p, otgScale(d, way))));
    }
    if (beside <= slack) nearest = std::min(nearest, way);
  }
  return nearest;
}

}  // namespace

TEST_CASE("the shortest of many ways") {
  constexpr double kLeastCosine = 0.05, kMostEnding = 0.9;
  Random random;
  int found = 0, later = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<RegionTriangle> triangles;
    std::vector<TriangleAhead> ahead[2];
    const Vec3d from = otgScale(random.inBox(), 0.3), ending = random.direction();
    for (std::uint32_t i = 0; i < 200; ++i) {
      triangles.push_back(triangleOf(faceOf(random)));
      const double depth = triangles[i].offset - otgDot(triangles[i].normal, from);
      if (depth > -0.01) ahead[i % 2].push_back({depth, i});
    }
    for (auto& a : ahead) {
      std::sort(a.begin(), a.end(), [](const auto& x, const auto& y) { return x.depth < y.depth; });
    }
    const double slack = random.between(0, 0.1);
    WaySet set;
    double least = kInfinity;
    std::uint32_t best = 0;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(round % 30); ++i) {
      const Vec3d d = random.direction();
      const double longest = random.between(0, 2);
      set.add(d, longest);
      if (otgDot(ending, d) > kMostEnding) continue;
      const double length = wayThrough(triangles, ahead[1], from, d, kLeastCosine, slack) +
                            wayThrough(triangles, ahead[0], from, otgScale(d, -1.0), kLeastCosine, slack);
      if (length > longest || !(length < least)) continue;
      least = length;
      best = i;
    }
    ShortestWayArgs args{set.blocks().data(),
                         set.blocks().size(),
                         triangles.data(),
                         {ahead[0].data(), ahead[1].data()},
                         {ahead[0].size(), ahead[1].size()},
                         from,
                         ending,
                         kMostEnding,
                         kLeastCosine,
                         slack,
                         kInfinity,
                         0,
                         0,
                         0,
                         0};
    for (const SimdLevel level : levels()) {
      args.most = kInfinity;
      findShortestWay(level, args);
      CHECK(args.length == least);
      if (!(least < kInfinity)) continue;
      CHECK(args.way == best);
      CHECK(args.out + args.back == least);
      ++found;
      later += best > 3;
      args.most = 1.5 * least;
      findShortestWay(level, args);
      CHECK(args.length == least);
      CHECK(args.way == best);
      args.most = least;
      findShortestWay(level, args);
      CHECK(args.length == kInfinity);
    }
  }
  CHECK(found > 100);
  CHECK(later > 50);
}

TEST_CASE("stretches that pass each other along their common perpendicular") {
  Random random;
  constexpr double kLeastSine = 0.05;
  std::size_t passed[2] = {0, 0}, found[2] = {0, 0}, all = 0;
  for (int round = 0; round < 800; ++round) {
    const int isMoved = round % 2;
    StretchSet set;
    struct Stretch {
      Vec3d middle, along;
      double reach;
    };
    std::vector<Stretch> stretches;
    for (int i = 0; i < round % 31; ++i) {
      stretches.push_back({random.inBox(), random.direction(), random.between(0, 1)});
      set.add(stretches.back().middle, stretches.back().along, stretches.back().reach);
    }
    const Stretch p{random.inBox(), random.direction(), random.between(0, 1)};
    Moved moved;
    if (isMoved == 1) moved = {otgScale(random.inBox(), round % 3 * 0.2), random.between(0, 0.8)};
    const Numbers answer = numbers(set.passed(p.middle, p.along, p.reach, kLeastSine, moved));
    CHECK(std::is_sorted(answer.begin(), answer.end()));
    for (std::uint32_t i = 0; i < stretches.size(); ++i) {
      const Stretch& q = stretches[i];
      const Vec3d across = otgCross(p.along, q.along), apart = otgSub(q.middle, p.middle);
      const double square = otgDot(across, across);
      const double at = otgDot(otgCross(apart, q.along), across) / square;
      const double atOther = otgDot(otgCross(apart, p.along), across) / square;
      const double way = otgDot(apart, across) / std::sqrt(square), gone = otgDot(moved.by, across) / std::sqrt(square);
      const bool passes = square >= kLeastSine * kLeastSine && std::fabs(at) <= p.reach &&
                          std::fabs(atOther) <= q.reach && std::fabs(way) - (way < 0 ? -gone : gone) <= moved.missing;
      if (passes) CHECK(std::binary_search(answer.begin(), answer.end(), i));
      passed[isMoved] += passes;
    }
    found[isMoved] += answer.size();
    if (isMoved == 0) all += stretches.size();
  }
  CHECK(passed[0] > 500);
  CHECK(found[0] <= passed[0] + 1);
  CHECK(2 * found[0] < all);
  CHECK(passed[1] > 250);
  CHECK(found[1] < 1.5 * static_cast<double>(passed[1]));
}

TEST_CASE("instruction sets agree bit for bit over surfaces") {
  Random random;
  for (int round = 0; round < 200; ++round) {
    PlaneBlock planes[3];
    AreaBlock areas[3];
    PointBlock points[3];
    BoxBlock boxes[3];
    FaceBlock faces[3];
    FaceGroups groups;
    std::fill_n(groups.loX, sizeof groups / sizeof(double), kInfinity);
    groups.loX[0] = groups.loY[0] = groups.loZ[0] = -1;
    groups.hiX[0] = groups.hiY[0] = groups.hiZ[0] = 1;
    StretchBlock stretches[3];
    fill(faces, random);
    fill(stretches, random);
    fill(planes, random);
    fill(areas, random);
    fill(points, random);
    fill(boxes, random);
    const Vec3d p = random.inBox(), d = random.direction();
    std::vector<double> expected;
    for (const SimdLevel level : levels()) {
      std::vector<double> found;
      PlaneExitArgs exit{planes, 3, p, d, 0.5, 0, 0};
      exitThroughPlanes(level, exit);
      found.insert(found.end(), {exit.nearest, exit.convex});
      exitThroughRoundPlanes(level, exit);
      found.insert(found.end(), {exit.nearest, exit.convex});
      LocalAreaArgs local{areas, 3, p, 1.5, {0, 0, 0}, 0};
      sumLocalAreas(level, local);
      found.insert(found.end(), {local.vector.x, local.vector.y, local.vector.z, local.area});
      FacingPlaneArgs facing{planes, 3, p, d, 0};
      findFacingPlane(level, facing);
      found.push_back(facing.plane);
      ExtentArgs extent{points, 3, d, 0, 0};
      findExtent(level, extent);
      found.insert(found.end(), {extent.lo, extent.hi});
      const Barrier barriers[3] = {{p, 0.5}, {d, 0.7}, {{1, 0, 0}, 0.9}};
      FarthestWayArgs farthest{points, 3, {barriers, barriers + 1}, {2, 2}, 3, 1.5, 0};
      findFarthestWay(level, farthest);
      found.push_back(farthest.way);
      double lo[12], hi[12];
      BoxRangesArgs ranges{boxes, 3, d, lo, hi};
      findBoxRanges(level, ranges);
      found.insert(found.end(), lo, lo + 12);
      found.insert(found.end(), hi, hi + 12);
      std::uint32_t places[12];
      const auto addFound = [&](std::size_t count) { found.insert(found.end(), places, places + count); };
      NearFacesArgs near{faces, 3, &groups, 1, p, 1.5, places, 0, 0};
      findNearFaces(level, near);
      addFound(near.foundCount);
      findNearestFace(level, near);
      found.push_back(near.nearest);
      FacesOverArgs over{faces, 3, &groups, 1, p, d, 0.5, 2, 1.5, {d, 0.5}, places, 0};
      findFacesOver(level, over);
      addFound(over.foundCount);
      SoonestFaceArgs soonest{faces, 3, &groups, 1, p, d, 0.5, 2, 0, 0};
      findSoonestFace(level, soonest);
      found.insert(found.end(), {soonest.depth, static_cast<double>(soonest.face)});
      StretchesPassedArgs passed{stretches, 3, p, d, 0.5, 0.05, {p, 0.7}, places, 0};
      findStretchesPassed(level, passed);
      addFound(passed.foundCount);
      if (level == SimdLevel::kBaseline) expected = found;
      REQUIRE(found == expected);
    }
    CHECK(expected[7] != 0);
  }
}
