// SPDX-License-Identifier: BSD-3-Clause
// Poses that are not rigid: how the defect of a rotation is measured, what a query refuses, what it bounds.
#include "collide/rotation_tolerance.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "collide/boxes_apart.h"
#include "collide/query.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::test;

namespace {

Transformd turn(Draw& draw) {
  return makePose(draw.direction(), draw.uniform(-3, 3), {0, 0, 0});
}

template <class Change>
Transformd changed(Transformd m, const Change& change) {
  for (double& r : m.r) r = change(r);
  return m;
}

Transformd product(const Transformd& m, const Transformd& n) {
  Transformd p{{}, {0, 0, 0}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) p.r[3 * i + j] += m.r[3 * i + k] * n.r[3 * k + j];
    }
  }
  return p;
}

/// R (1 + k E_xy): B's y axis leans towards its x axis.
Transformd sheared(Transformd m, double k) {
  for (int row = 0; row < 3; ++row) m.r[3 * row + 1] += k * m.r[3 * row];
  return m;
}

Transformd mirrored(Transformd m) {
  for (int row = 0; row < 3; ++row) m.r[3 * row] = -m.r[3 * row];
  return m;
}

std::vector<TrianglePair> everyPair(const CollisionMesh& a, const CollisionMesh& b) {
  std::vector<TrianglePair> pairs;
  for (std::uint32_t i = 0; i < a.mesh().triangleCount(); ++i) {
    for (std::uint32_t j = 0; j < b.mesh().triangleCount(); ++j) pairs.push_back({i, j});
  }
  return pairs;
}

}  // namespace

TEST_CASE("the defect of a rotation is the Frobenius norm of what its columns' products lack") {
  // Closed forms: (s^2 - 1) sqrt(3) for a scale, sqrt(2 k^2 + k^4) for a shear; no turn before changes them.
  Draw draw(3);
  for (int i = 0; i < 100; ++i) {
    const Transformd r = turn(draw);
    CHECK(rotationDefect(r) < 4e-15);  // rounding of nine products of numbers near 1
    for (const double k : {1e-6, 1e-3, 0.1, 2.0}) {
      const double scale = rotationDefect(changed(r, [&](double x) { return (1 + k) * x; }));
      CHECK(std::abs(scale - (2 * k + k * k) * std::sqrt(3)) < 1e-13);
      CHECK(std::abs(rotationDefect(sheared(r, k)) - k * std::sqrt(2 + k * k)) < 1e-13);
    }
    CHECK(rotationDefect(mirrored(r)) == std::numeric_limits<double>::infinity());
  }
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, inf, -inf, 1e200}) {
    for (int i = 0; i < 9; ++i) {
      Transformd m = makeMove({0, 0, 0});
      m.r[i] = bad;
      CHECK(rotationDefect(m) == inf);
    }
  }
  CHECK(rotationDefect({{}, {0, 0, 0}}) == inf);
}

TEST_CASE("rotations kept in single precision, and long products of them, are within the tolerance") {
  Draw draw(4);
  double worstRounded = 0, worstProduct = 0;
  for (int i = 0; i < 200; ++i) {
    Transformd p = turn(draw);
    for (int k = 0; k < 500; ++k) {
      const auto rounded = [](double x) { return static_cast<double>(static_cast<float>(x)); };
      const Transformd r = changed(turn(draw), rounded);
      worstRounded = std::max(worstRounded, rotationDefect(r));
      p = changed(product(p, r), rounded);
    }
    worstProduct = std::max(worstProduct, rotationDefect(p));
  }
  CHECK(worstRounded > 0);
  CHECK(worstRounded < 1e-3 * kRotationTolerance);
  CHECK(worstProduct < 0.1 * kRotationTolerance);
}

TEST_CASE("the pose of one mesh in the other's frame may have the defects of both") {
  Draw draw(5);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    // sqrt(1 + t / sqrt(3)) scales by the whole tolerance; so does a shear of about t / sqrt(2), one way and the other.
    const double scale = std::sqrt(1 + 0.999999 * kRotationTolerance / std::sqrt(3));
    const double shear = 0.999 * kRotationTolerance / std::sqrt(2);
    const auto spoilt = [&](Transformd m, int how) {
      if (how == 0) return changed(m, [&](double x) { return x * scale; });
      return sheared(m, how == 1 ? shear : -shear);
    };
    const Transformd a = spoilt(turn(draw), i % 3), b = spoilt(turn(draw), i / 3 % 3);
    REQUIRE(rotationDefect(a) <= kRotationTolerance);
    REQUIRE(rotationDefect(b) <= kRotationTolerance);
    Transformd transposed = a;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) transposed.r[3 * row + column] = a.r[3 * column + row];
    }
    worst = std::max(worst, rotationDefect(product(transposed, b)));
  }
  CHECK(worst <= kRelativeRotationTolerance);
  CHECK(worst > 0.95 * kRelativeRotationTolerance);
}

TEST_CASE("queries refuse poses that are not rigid, and say why") {
  const CollisionMesh lump(scenes::build(scenes::makeLump(1, 2, 0.3, 3)), BuildStrategy::kSah);
  Query query;
  query.a = query.b = &lump;
  query.options.contacts = ContactModel::kSolid;
  Workspace workspace;
  Draw draw(6);
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const Transformd& pose, const std::string& word) {
    query.bInA = makeMove({1.2, 0, 0});
    collide(query, workspace);
    REQUIRE(!workspace.reduced.empty());  // an answer that must not stay
    query.bInA = pose;
    std::string said;
    try {
      collide(query, workspace);
    } catch (const std::invalid_argument& error) {
      said = error.what();
    }
    INFO(said);
    CHECK(said.find(word) != std::string::npos);
    CHECK(workspace.candidates.empty());
    CHECK(workspace.intersecting.empty());
    CHECK(workspace.contacts.empty());
    CHECK(workspace.reduced.empty());
    CHECK(workspace.stats.boxTests == 0);
    CHECK_THROWS_AS(findIntersectingPairs(query, workspace), std::invalid_argument);
  };
  for (int i = 0; i < 10; ++i) {
    const Transformd r = turn(draw);
    for (const double k : {-0.5, -0.01, 0.01, 1.0}) {
      refused(changed(r, [&](double x) { return (1 + k) * x; }), "rotation");
      refused(sheared(r, k), "rotation");
    }
    refused(mirrored(r), "rotation");
  }
  refused({{}, {0, 0, 0}}, "rotation");
  for (const double bad : {nan, inf, -inf}) {
    Transformd m = makeMove({0, 0, 0});
    m.r[4] = bad;
    refused(m, "rotation");
    refused(makeMove({0, bad, 0}), "finite");
  }
}

TEST_CASE("boxes that touch are not apart, though the middle of their bounds is a rounded one") {
  scenes::MeshArrays arrays = scenes::makeBox({1, 1, 1});
  const float low = 1 + 0x1p-23f, high = 2;
  for (Vec3f& v : arrays.vertices) v.x = v.x < 0 ? low : high;
  const CollisionMesh box(scenes::build(arrays), BuildStrategy::kSah);
  for (const double gap : {0.0, 1e-6}) {
    for (const double side : {1.0, -1.0}) {
      INFO(gap << ", " << side);
      const Transformd pose = makeMove({side * (double{high} - low + gap), 0, 0});
      CHECK(areBoxesApart(box.mesh(), box.mesh(), pose, 0) == (gap > 0));
      Query query;
      query.a = query.b = &box;
      query.bInA = pose;
      Workspace workspace;
      findIntersectingPairs(query, workspace);
      CHECK(workspace.intersecting.empty() == (gap > 0));
    }
  }
}

TEST_CASE("within the tolerance no intersecting pair is lost, by any traversal, and the query costs little more") {
  const CollisionMesh lump(scenes::build(scenes::makeLump(1, 3, 0.3, 3)), BuildStrategy::kSah);
  const CollisionMesh torus(scenes::build(scenes::makeTorus(0.8, 0.3, 32, 16)), BuildStrategy::kSah);
  const CollisionMesh slab(scenes::build(scenes::makeBox({400, 300, 1})), BuildStrategy::kSah);
  Draw draw(7);
  std::uint64_t intersecting = 0, testsOfRigid = 0, testsOfSpoilt = 0;
  for (int i = 0; i < 24; ++i) {
    Query query;
    // Bodies of a size, and a large one whose few triangles reach far beyond the other, either way round.
    query.a = i % 4 == 2 ? &slab : &lump;
    query.b = i % 4 == 3 ? &slab : &torus;
    const Transformd rigid = makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(0.8));
    const double k = 0.99 * kRelativeRotationTolerance;
    query.bInA = i % 3 == 0   ? changed(rigid, [&](double x) { return x * std::sqrt(1 + k / std::sqrt(3)); })
                 : i % 3 == 1 ? changed(rigid, [&](double x) { return x * std::sqrt(1 - k / std::sqrt(3)); })
                              : sheared(rigid, k / std::sqrt(2.001));
    Workspace brute;
    brute.candidates = everyPair(*query.a, *query.b);
    nearPhase(query, brute);
    intersecting += brute.intersecting.size();
    for (const Traversal traversal :
         {Traversal::kStandard, Traversal::kQuantized, Traversal::kNoLeaf, Traversal::kWide}) {
      for (const int axes : {6, 15}) {
        query.options.middle.traversal = traversal;
        query.options.middle.axes = axes;
        Workspace workspace;
        findIntersectingPairs(query, workspace);
        REQUIRE(workspace.intersecting == brute.intersecting);
        testsOfSpoilt += workspace.stats.boxTests + workspace.stats.triangleBoxTests;
        Query exact = query;
        exact.bInA = rigid;
        findIntersectingPairs(exact, workspace);
        testsOfRigid += workspace.stats.boxTests + workspace.stats.triangleBoxTests;
      }
    }
  }
  CHECK(intersecting > 1000);
  CHECK(testsOfSpoilt < 1.5 * static_cast<double>(testsOfRigid));
}
