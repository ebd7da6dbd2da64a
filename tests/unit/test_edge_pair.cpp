// SPDX-License-Identifier: BSD-3-Clause
// Which way is out where an edge lies across an edge: two wedges that cross at the origin, and what they have inside
// each other moved along the edges.
#include "collide/solid/edge_pair.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/vectors.h"
#include "bvh/collision_mesh.h"
#include "collide/solid/contour.h"
#include "collide/solid/inside.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

using namespace otg;
using otg::test::makePose;

namespace {

constexpr double kQuarter = std::numbers::pi / 4, kDepth = 0.05, kTurn = 0.9;

/// A's edge lies along x at height 0, the body below it. `end` is where it ends.
scenes::MeshArrays below(double end) {
  return scenes::transformed(scenes::makeBox({4, 1, 1}), makePose({1, 0, 0}, kQuarter, {end - 2, 0, -std::sqrt(0.5)}));
}

/// B's edge lies across it, deeper by kDepth, the body above it, made narrow and leaning by `lean`.
scenes::MeshArrays above(double lean, double narrow = 1) {
  const scenes::MeshArrays atEdge =
      scenes::transformed(scenes::makeBox({1, 4, 1}), makePose({0, 0, 1}, 0, {0.5, 0, 0.5}));
  const scenes::MeshArrays wedge = scenes::transformed(atEdge, makePose({0, 1, 0}, -kQuarter, {0, 0, 0}));
  const scenes::MeshArrays sharp = scenes::transformed(wedge, {{narrow, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}});
  const scenes::MeshArrays upright = scenes::transformed(sharp, makePose({0, 1, 0}, lean, {0, 0, 0}));
  return scenes::transformed(upright, makePose({0, 0, 1}, kTurn, {0, 0, -kDepth}));
}

class Wedges {
 public:
  Wedges(const scenes::MeshArrays& a, const scenes::MeshArrays& b)
      : a_(std::make_shared<CollisionMesh>(scenes::build(a), BuildStrategy::kSah)),
        b_(std::make_shared<CollisionMesh>(scenes::build(b), BuildStrategy::kSah)) {
    query_.a = a_.get();
    query_.b = b_.get();
    query_.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    Workspace workspace;
    findIntersectingPairs(query_, workspace);
    const PlacedMeshes meshes(query_);
    Contour contour;
    InsideFlags inside;
    traceContour(meshes, workspace.intersecting, contour);
    floodInside(meshes, contour, inside);
    RegionBuilder().build(meshes, contour, inside, regions_);
    REQUIRE(regions_.regions.size() == 1);
  }

  std::vector<EdgePair> pairs() const { return pairs(regions_); }
  std::vector<EdgePair> pairs(const OverlapRegions& regions) const {
    const auto found = edgePairsOf(PlacedMeshes(query_), regions, regions.regions[0]);
    return {found.begin(), found.end()};
  }
  std::vector<Contact> contacts() const {
    Query query = query_;
    query.options.contacts = ContactModel::kSolid;
    Workspace workspace;
    collide(query, workspace);
    return workspace.reduced;
  }
  const OverlapRegions& regions() const { return regions_; }

 private:
  std::shared_ptr<const CollisionMesh> a_, b_;
  Query query_;
  OverlapRegions regions_;
};

/// The stretch of the mesh's edge that is inside the other one.
SupportPoint& stretchOf(int mesh, OverlapRegions& regions) {
  SupportPoint* found = nullptr;
  for (SupportPoint& p : regions.points) {
    if (p.mesh != mesh || p.kind < PointKind::kMiddle) continue;
    REQUIRE(found == nullptr);
    found = &p;
  }
  REQUIRE(found != nullptr);
  return *found;
}

}  // namespace

TEST_CASE("the way out of an edge that lies across an edge is at right angles to both") {
  for (const double lean : {-0.3, 0.0, 0.2}) {
    const std::vector<EdgePair> found = Wedges(below(2), above(lean)).pairs();
    REQUIRE(found.size() == 1);
    CHECK(norm(found[0].direction - Vec3d{0, 0, -1}) < 1e-6);
    CHECK(found[0].depth == Approx(kDepth).epsilon(1e-6));
    CHECK(found[0].isAll);
    const std::vector<EdgePair> swapped = Wedges(above(lean), below(2)).pairs();
    REQUIRE(swapped.size() == 1);
    CHECK(norm(swapped[0].direction - Vec3d{0, 0, 1}) < 1e-6);
    CHECK(swapped[0].depth == Approx(kDepth).epsilon(1e-6));
  }
}

TEST_CASE("edges are across each other where both reach the place where their lines are nearest") {
  const Wedges wedges(below(2), above(0.2));
  OverlapRegions regions = wedges.regions();
  SupportPoint &a = stretchOf(0, regions), &b = stretchOf(1, regions);
  const Vec3d deeper{0, 0, -kDepth};
  const double cosine = otgDot(a.along, b.along), square = 1 - cosine * cosine;
  // Both edges are 4 long, with their middles above each other.
  for (const double u : {-2.02, -1.98, 0.0, 1.98, 2.02}) {
    for (const double v : {-2.02, -1.98, 0.0, 1.98, 2.02}) {
      const Vec3d place = a.along * ((u - cosine * v) / square) + b.along * ((v - cosine * u) / square);
      a.position = place - regions.origin;
      b.position = place + deeper - regions.origin;
      CAPTURE(u, v);
      CHECK(wedges.pairs(regions).size() == (std::fabs(u) < 2 && std::fabs(v) < 2 ? 1u : 0u));
    }
  }
}

TEST_CASE("contacts take edges past each other, even where these are nearest beside what is inside") {
  int beside = 0;
  for (const double lean : {-0.6, -0.3, 0.0, 0.4, 0.6}) {
    for (const double narrow : {1.0, 0.5, 0.3}) {
      const scenes::MeshArrays upper = above(lean, narrow);
      for (const Wedges& wedges : {Wedges(below(2), upper), Wedges(upper, below(2))}) {
        const std::vector<EdgePair> pairs = wedges.pairs();
        CAPTURE(lean, narrow);
        REQUIRE(pairs.size() == 1);
        OverlapRegions regions = wedges.regions();
        for (const int m : {0, 1}) {
          const SupportPoint& p = stretchOf(m, regions);
          if (std::fabs(otgDot(p.along, p.position + regions.origin)) > p.reach) ++beside;
        }
        double deepest = 0;
        for (const Contact& contact : wedges.contacts()) {
          CHECK(otgDot(contact.normal, pairs[0].direction) > 1 - 1e-9);
          deepest = std::max(deepest, contact.depth);
        }
        CHECK(deepest > kDepth * (1 - 1e-6));
        CHECK(deepest < kDepth * 1.02);
      }
    }
  }
  CHECK(beside >= 4);
}

TEST_CASE("a thin overlap has a way out across where each mesh has only the two faces of its edge inside") {
  const Transformd flat{{1, 0, 0, 0, 1, 0, 0, 0, 0.35}, {0, 0, 0}};
  for (const double end : {2.0, 0.02}) {  // the second: A's edge ends inside B
    const scenes::MeshArrays a = scenes::transformed(below(end), flat), b = scenes::transformed(above(0), flat);
    for (const Wedges& wedges : {Wedges(a, b), Wedges(b, a)}) {
      const Region& region = wedges.regions().regions[0];
      CHECK(region.thickness < OTG_SOLID_DEEP * region.diagonal);
      CHECK(wedges.pairs().size() == (end > 1 ? 1u : 0u));
    }
  }
}

TEST_CASE("an edge on a face and edges along each other have no way out across") {
  CHECK(
      Wedges(below(2), scenes::transformed(scenes::makeBox({1, 1, 1}), makePose({0, 0, 1}, 0.3, {0, 0, 0.5 - kDepth})))
          .pairs()
          .empty());
  CHECK(Wedges(below(2), scenes::transformed(above(0.1), makePose({0, 0, 1}, 2 * kQuarter - kTurn, {0, 0, 0})))
            .pairs()
            .empty());
}
