// SPDX-License-Identifier: BSD-3-Clause
// The float box test never rejects boxes that truly overlap: boxes brought to the brink of touching, judged in rational
// arithmetic.
#include <algorithm>
#include <cmath>

#include "collide/pair_frame.h"
#include "collide/rotation_tolerance.h"
#include "oracle/cgal_oracle.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

enum class Shape { kPlain, kFlat, kNeedle, kPoint };

/// A box inside the cube of half-size `half`, in float.
void drawBox(Draw& draw, Shape shape, double half, Vec3f* center, Vec3f* extent) {
  double e[3], c[3];
  for (int k = 0; k < 3; ++k) e[k] = half * draw.uniform(0.01, 0.4);
  const std::uint32_t axis = draw.below(3);
  if (shape == Shape::kFlat) e[axis] = 0;
  if (shape == Shape::kNeedle) e[(axis + 1) % 3] = e[(axis + 2) % 3] = 1e-4 * e[axis];
  if (shape == Shape::kPoint) e[0] = e[1] = e[2] = 0;
  for (int k = 0; k < 3; ++k) c[k] = draw.uniform(-1, 1) * (half - e[k]);
  *center = {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
  *extent = {static_cast<float>(e[0]), static_cast<float>(e[1]), static_cast<float>(e[2])};
}

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// Largest gap in double, from the shared formulas: only used to find poses, never to judge.
double gapInDouble(const PlacedBoxes& p) {
  BoxFrame<double> f{};
  for (int k = 0; k < 9; ++k) {
    f.r[k] = p.bInA.r[k];
    f.absR[k] = std::fabs(f.r[k]);
  }
  f.t = p.bInA.t;
  const Vec3d d = otgSub(otgBoxCenterInA(f, p.centerB), p.centerA);
  return std::max({otgBoxGapA(d, p.extentA, otgBoxExtentInA(f, p.extentB)), otgBoxGapB(f, d, p.extentA, p.extentB),
                   otgBoxGapEdges(f, d, p.extentA, p.extentB)});
}

struct Gaps {
  float face, edge;
};

Gaps gapsInFloat(const BoxFrame<float>& f, const Vec3f& ca, const Vec3f& ea, const Vec3f& cb, const Vec3f& eb) {
  const Vec3f d = otgSub(otgBoxCenterInA(f, cb), ca);
  return {std::max(otgBoxGapA(d, ea, otgBoxExtentInA(f, eb)), otgBoxGapB(f, d, ea, eb)), otgBoxGapEdges(f, d, ea, eb)};
}

struct Tally {
  int overlapping = 0, apart = 0, rejected = 0, rejectedWithoutEps = 0;
};

/// Boxes within two meshes of the given half-sizes, moved along a random direction until they are just about to part.
/// The meshes are cubes; their centred frames and radii make the query's error bound.
void sweep(std::uint32_t seed, double halfA, double halfB, double angle, double extraDistance, int rounds,
           Tally& tally) {
  Draw draw(seed);
  const auto cube = [](double half) {
    return CollisionMesh(scenes::build(scenes::makeBox({2 * half, 2 * half, 2 * half}, 1)), BuildStrategy::kSah);
  };
  const CollisionMesh meshA = cube(halfA), meshB = cube(halfB);
  for (int round = 0; round < rounds; ++round) {
    PlacedBoxes p{};
    Vec3f ca, ea, cb, eb;
    drawBox(draw, static_cast<Shape>(draw.below(4)), halfA, &ca, &ea);
    drawBox(draw, static_cast<Shape>(draw.below(4)), halfB, &cb, &eb);
    p.centerA = toDouble(ca);
    p.extentA = toDouble(ea);
    p.centerB = toDouble(cb);
    p.extentB = toDouble(eb);
    p.bInA = makePose(draw.direction(), angle < 0 ? draw.uniform(-3, 3) : angle, {0, 0, 0});
    // From concentric (surely overlapping) outward.
    const Vec3d concentric = otgSub(p.centerA, otgTransform(p.bInA, p.centerB));
    const Vec3d way = otgScale(draw.direction(), 4 * (halfA + halfB) + extraDistance);
    double in = 0, out = 1;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (in + out);
      p.bInA.t = otgAdd(concentric, otgScale(way, middle));
      (gapInDouble(p) > 0 ? out : in) = middle;
    }
    for (const double back : {0.0, 1e-16, 1e-14, 1e-9, 1e-8, 1e-7}) {
      p.bInA.t = otgAdd(concentric, otgScale(way, in * (1 - back)));
      if (!exactBoxesMeet(p)) {
        ++tally.apart;
        continue;
      }
      ++tally.overlapping;
      Query query;
      query.a = &meshA;
      query.b = &meshB;
      query.bInA = p.bInA;
      const PairFrame frame = makePairFrame(query);
      const Gaps gaps = gapsInFloat(frame.boxes, ca, ea, cb, eb);
      if (gaps.face > frame.boxes.eps || gaps.edge > frame.boxes.eps) ++tally.rejected;
      if (gaps.face > 0 || gaps.edge > 0) ++tally.rejectedWithoutEps;
    }
  }
}

}  // namespace

TEST_CASE("boxes on the brink of touching are never rejected") {
  Tally tally;
  std::uint32_t seed = 0;
  for (const double angle : {-1.0, 0.0, 1e-7, 1e-4, 1.5707963267948966}) {
    for (const auto& [halfA, halfB] :
         {std::pair{1.0, 1.0}, std::pair{1.0, 1e-3}, std::pair{1e-2, 10.0}, std::pair{1e3, 700.0}}) {
      sweep(++seed, halfA, halfB, angle, 0, 150, tally);
    }
  }
  CHECK(tally.rejected == 0);
  // What shows that the cases are hard enough: without the error term many would be lost.
  CHECK(tally.overlapping > 10000);
  CHECK(tally.rejectedWithoutEps > tally.overlapping / 50);
}

TEST_CASE("boxes placed by the worst matrix that a query takes are never rejected") {
  // The brink is found in rational arithmetic: with a defect the shared formulas are off by more than rounding. Boxes
  // that fill their meshes have the largest extents that the bound allows for.
  Draw draw(31);
  int overlapping = 0, rejected = 0, rejectedWithoutDefect = 0;
  double worst = 0;
  for (int round = 0; round < 900; ++round) {
    const double halfA = draw.below(2) != 0 ? 1 : 20, halfB = 1;
    const auto cube = [](double half) {
      return CollisionMesh(scenes::build(scenes::makeBox({2 * half, 2 * half, 2 * half}, 1)), BuildStrategy::kSah);
    };
    const CollisionMesh meshA = cube(halfA), meshB = cube(halfB);
    PlacedBoxes p{{0, 0, 0}, {halfA, halfA, halfA}, {0, 0, 0}, {halfB, halfB, halfB}, {}};
    p.bInA = makePose(draw.direction(), draw.uniform(-3, 3), {0, 0, 0});
    // R (1 + k S) for a symmetric S: a scale, a stretch, a shear or any mixture, at the largest defect.
    double s[9];
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) s[3 * i + j] = s[3 * j + i] = draw.uniform(-1, 1);
    }
    if (round % 4 == 0) std::copy_n(makeMove({}).r, 9, s);
    if (round % 4 == 1) std::fill_n(s, 9, round % 8 == 1 ? 1.0 : -1.0);  // rank one: all of it along one diagonal
    const Transformd rigid = p.bInA;
    double low = 0, high = 1e-2;
    for (int k = 0; k < 50; ++k) {
      const double size = 0.5 * (low + high);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          p.bInA.r[3 * i + j] = rigid.r[3 * i + j];
          for (int m = 0; m < 3; ++m) p.bInA.r[3 * i + j] += size * rigid.r[3 * i + m] * s[3 * m + j];
        }
      }
      (rotationDefect(p.bInA) > kRelativeRotationTolerance ? high : low) = size;
    }
    // Towards a face, an edge or a corner of B, or anywhere.
    const int corner[3] = {static_cast<int>(draw.below(3)) - 1, static_cast<int>(draw.below(3)) - 1,
                           static_cast<int>(draw.below(3)) - 1};
    Vec3d way = otgRotate(rigid, Vec3d{double(corner[0]), double(corner[1]), double(corner[2])});
    if (otgDot(way, way) == 0) way = draw.direction();
    way = otgScale(way, 2 * (halfA + halfB));
    double in = 0, out = 1;
    for (int k = 0; k < 40; ++k) {
      p.bInA.t = otgScale(way, 0.5 * (in + out));
      (exactBoxesMeet(p) ? in : out) = 0.5 * (in + out);
    }
    p.bInA.t = otgScale(way, in);
    REQUIRE(exactBoxesMeet(p));
    ++overlapping;
    Query query;
    query.a = &meshA;
    query.b = &meshB;
    query.bInA = p.bInA;
    const PairFrame frame = makePairFrame(query);
    const auto toFloat = [](const Vec3d& v) {
      return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    };
    const Gaps gaps =
        gapsInFloat(frame.boxes, toFloat(p.centerA), toFloat(p.extentA), toFloat(p.centerB), toFloat(p.extentB));
    const double gap = std::max(gaps.face, gaps.edge);
    // What the bound has for the defect: of a radius about an origin that may be a quarter of it from the middle.
    const double rounding = frame.boxes.eps - 2 * rotationDefect(p.bInA) * 1.25 * meshB.mesh().radius();
    rejected += gap > frame.boxes.eps;
    rejectedWithoutDefect += gap > rounding;
    worst = std::max(worst, gap / frame.boxes.eps);
  }
  CHECK(overlapping == 900);
  CHECK(rejected == 0);
  CHECK(rejectedWithoutDefect > 50);
  INFO(worst);
  CHECK(worst > 0.2);  // the bound is of use: some boxes need a good part of it
}

TEST_CASE("boxes of trees are never rejected when they overlap") {
  const auto mesh = [](const scenes::MeshArrays& arrays) {
    return CollisionMesh(scenes::build(arrays), BuildStrategy::kSah);
  };
  const CollisionMesh a = mesh(scenes::makeLump(1, 3, 0.2, 1)), b = mesh(scenes::makeTorus(0.6, 0.2, 24, 12));
  Draw draw(77);
  int overlapping = 0, rejected = 0, apart = 0;
  for (int round = 0; round < 4000; ++round) {
    Query query;
    query.a = &a;
    query.b = &b;
    query.bInA = makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(1));
    const BvhNode& na = a.tree().nodes[draw.below(static_cast<std::uint32_t>(a.tree().nodes.size()))];
    const BvhNode& nb = b.tree().nodes[draw.below(static_cast<std::uint32_t>(b.tree().nodes.size()))];
    PlacedBoxes p{toDouble(na.center), toDouble(na.extent), toDouble(nb.center), toDouble(nb.extent), query.bInA};
    // The centred frames, exactly: both meshes' centres are added to their boxes in double, which floats of like size
    // allow.
    p.centerA = otgAdd(p.centerA, toDouble(a.mesh().center()));
    p.centerB = otgAdd(p.centerB, toDouble(b.mesh().center()));
    // Bring B's box close to A's.
    query.bInA.t = otgAdd(
        otgSub(p.centerA, otgSub(otgTransform(p.bInA, p.centerB), p.bInA.t)),
        otgScale(draw.direction(), draw.uniform(0, 2) * std::max({p.extentA.x, p.extentA.y, p.extentB.x, 1e-3})));
    p.bInA = query.bInA;
    const PairFrame frame = makePairFrame(query);
    const Gaps gaps = gapsInFloat(frame.boxes, na.center, na.extent, nb.center, nb.extent);
    const bool rejects = gaps.face > frame.boxes.eps || gaps.edge > frame.boxes.eps;
    if (exactBoxesMeet(p)) {
      ++overlapping;
      rejected += rejects;
    } else {
      ++apart;
    }
  }
  CHECK(rejected == 0);
  CHECK(overlapping > 500);
  CHECK(apart > 500);
}
