// SPDX-License-Identifier: BSD-3-Clause
// Single queries of the contact model `solid` against formulas or the gradient of the overlap's volume. Poses are fixed
// random ones, with overlaps of 1 to 10 % of the bodies' size. `otg bench contacts` has the deep ones, too.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "collide/query.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "truth/contact_errors.h"
#include "truth/contact_families.h"

using namespace otg;

namespace {

/// What the model promises for a kind of bodies. Normals: every contact's (smooth bodies, which have one direction
/// only) or the median (where edges hang over, contacts beside them lean; boxes that touch with edges lean as a whole).
struct Promise {
  const char* family;
  double largestNormal, medianNormal;  ///< degrees
  double depth, medianDepth;           ///< error of the deepest contact, as a part of the size
  double force;                        ///< of all contacts together: degrees from the direction by formula
};

// How far surfaces lie from their facets' planes: a sphere of 5,120 triangles 0.0012 radii, a torus of 96 x 48 segments
// 0.0021 minor radii, a cylinder of 64 sides 0.0012 radii.
constexpr Promise kPromises[] = {
    {"spheres", 1, 0.2, 0.0024, 0.0012, 0.5},
    // Where both surfaces turn the same way the outermost of its contacts face as the surfaces do there.
    {"ball_torus", 8, 0.5, 0.0060, 0.0012, 1},
    {"tori_stacked", 1, 0.2, 0.0042, 0.0012, 0.5},
    {"cylinders_parallel", 1, 0.5, 0.0024, 0.0012, 0.5},
    {"boxes_aligned", 0.5, 0.1, 0.001, 0.0001, 0.1},
    {"boxes_face_turned", 0.5, 0.1, 0.001, 0.0001, 0.1},
    {"boxes_turned", 5, 0.01, 0.001, 0.0001, 5},
    {"cylinders_stacked", 5, 1, 0.001, 0.0001, 4},
    {"cylinder_on_box", 5, 1, 0.001, 0.0001, 1.02},
    {"ball_box", 7, 1, 0.01, 0.001, 3},
    {"ball_cylinder", 7, 2, 0.01, 0.001, 4},
    {"cylinders_crossed", 8, 3, 0.01, 0.001, 2},
};

std::vector<truth::PlainContact> contactsOf(const truth::ContactFamily& family, const Transformd& pose, int places) {
  Query query;
  query.a = family.a.get();
  query.b = family.b.get();
  query.bInA = pose;
  query.options.contacts = ContactModel::kSolid;
  query.options.maxContacts = places;
  Workspace workspace;
  collide(query, workspace);
  return truth::plain(workspace.reduced);
}

}  // namespace

TEST_CASE("shallow contacts point the right way and are as deep as the overlap") {
  const std::vector<truth::ContactFamily> families = truth::contactFamilies();
  for (const Promise& promise : kPromises) {
    const auto family = std::find_if(families.begin(), families.end(),
                                     [&](const truth::ContactFamily& f) { return f.name == promise.family; });
    REQUIRE(family != families.end());
    truth::Errors normal[2], depth[2], force[2];
    truth::Random random(11);
    for (int i = 0; i < 10; ++i) {
      const double overlap = 0.01 * std::pow(10, random.uniform(0, 1));
      const truth::Placement placement = family->place(random, overlap);
      const auto gradient = truth::volumeGradient(family->a->mesh(), family->b->mesh(), placement.bInA);
      for (const int k : {0, 1}) {
        const auto contacts = contactsOf(*family, placement.bInA, k == 0 ? 64 : 8);
        REQUIRE_FALSE(contacts.empty());
        double deepest = 0;
        for (const truth::PlainContact& c : contacts) {
          normal[k].add(truth::angleBetween(c.normal, placement.truth->direction));
          deepest = std::max(deepest, c.depth);
        }
        depth[k].add(std::fabs(deepest - placement.truth->depth) / family->size);
        // Not the gradient of the volume: where edges hang over that leans by up to 6 degrees, which the model does
        // not.
        const truth::Wrench wrench = truth::wrenchOf(contacts, gradient.overlap.centroid);
        force[k].add(truth::angleBetween(wrench.force, placement.truth->direction));
      }
    }
    for (const int k : {0, 1}) {
      INFO(promise.family << " with " << (k == 0 ? 64 : 8) << " places");
      CHECK(normal[k].largest() <= promise.largestNormal);
      CHECK(normal[k].quantile(0.5) <= promise.medianNormal);
      CHECK(depth[k].largest() <= promise.depth);
      CHECK(depth[k].quantile(0.5) <= promise.medianDepth);
      CHECK(force[k].largest() <= promise.force);
    }
  }
}

TEST_CASE("an edge in a face is pushed along the face's normal, whatever the angle and the width") {
  // A's upper edge at x = 1 in the lower face of B, which rises towards -x by a few degrees: a thin wedge of overlap.
  const auto block = std::make_shared<CollisionMesh>(scenes::build(scenes::makeBox({2, 2, 2}, 1)), BuildStrategy::kSah);
  const double width = GENERATE(0.1, 0.5, 1.5);
  const auto plank =
      std::make_shared<CollisionMesh>(scenes::build(scenes::makeBox({1, width, 1}, 1)), BuildStrategy::kSah);
  const double degrees = GENERATE(0.5, 1.0, 4.0, 12.0);
  const bool swapped = GENERATE(false, true);
  CAPTURE(width, degrees, swapped);
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  // The plank turned about y, its lower face 0.002 below A's edge, its middle over the edge.
  const Vec3d out{s, 0, c};
  Transformd pose{{c, 0, s, 0, 1, 0, -s, 0, c}, otgAdd({1, 0, 1}, otgScale(out, 0.5 - 0.002))};
  Vec3d expected = otgScale(out, -1.0);
  Query query;
  query.a = block.get();
  query.b = plank.get();
  if (swapped) {
    std::swap(query.a, query.b);
    const Vec3d back = otgScale(otgRotateBack(pose, pose.t), -1.0);
    expected = otgRotateBack(pose, out);
    std::swap(pose.r[1], pose.r[3]);
    std::swap(pose.r[2], pose.r[6]);
    std::swap(pose.r[5], pose.r[7]);
    pose.t = back;
  }
  query.bInA = pose;
  query.options.contacts = ContactModel::kSolid;
  query.options.maxContacts = 64;
  Workspace workspace;
  collide(query, workspace);
  REQUIRE(workspace.reduced.size() >= 2);
  for (const Contact& contact : workspace.reduced) CHECK(truth::angleBetween(contact.normal, expected) < 0.1);
  // Ends of the edge inside B are measured a thousandth of the diagonal further in.
  CHECK(workspace.reduced[0].depth == Approx(0.002).epsilon(0.02));
}

TEST_CASE("a facetted ball stands on the vertices that are in the ground and on nothing else") {
  // The surfaces also cross around each vertex. There is no depth there, and what says so brakes the ball when it
  // rolls.
  const scenes::MeshArrays arrays = scenes::makeSphere(0.5, 4);
  const auto ball = std::make_shared<CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
  const auto ground =
      std::make_shared<CollisionMesh>(scenes::build(scenes::makeBox({4, 4, 1}, 1)), BuildStrategy::kSah);
  truth::Random random(14);
  std::array<int, 4> seen{};
  for (int i = 0; i < 60; ++i) {
    Transformd pose = random.rotation();
    const double sink = random.uniform(2e-5, 4e-4);
    double lowest = 0;
    for (const Vec3f& v : arrays.vertices) lowest = std::min(lowest, otgTransform(pose, Vec3d{v.x, v.y, v.z}).z);
    pose.t = {0.013, -0.021, 0.5 - sink - lowest};
    std::vector<Vec3d> below;
    for (const Vec3f& v : arrays.vertices) {
      const Vec3d p = otgTransform(pose, Vec3d{v.x, v.y, v.z});
      // Much shallower ones may be left out.
      if (p.z < 0.5 - 0.05 * sink) below.push_back(p);
    }
    Query query;
    query.a = ground.get();
    query.b = ball.get();
    query.bInA = pose;
    query.options.contacts = ContactModel::kSolid;
    query.options.maxContacts = 64;
    Workspace workspace;
    collide(query, workspace);
    std::size_t firm = 0;
    for (const Contact& c : workspace.reduced) {
      CAPTURE(i, sink, c.depth, c.feature);
      CHECK(c.feature == ContactFeature::kVertexB);
      firm += c.depth > 0.05 * sink;
    }
    CHECK(firm == below.size());
    for (const Vec3d& p : below) {
      CHECK(std::any_of(workspace.reduced.begin(), workspace.reduced.end(), [&](const Contact& c) {
        return std::hypot(c.position.x - p.x, c.position.y - p.y) < 1e-6 && std::fabs(c.depth - (0.5 - p.z)) < 1e-6;
      }));
    }
    ++seen[std::min(below.size(), seen.size() - 1)];
  }
  for (const int vertices : {1, 2, 3}) CHECK(seen[static_cast<std::size_t>(vertices)] > 0);
}

TEST_CASE("contacts lie in the middle of the overlap") {
  // A box in the top of another: the contacts' places are between the two faces, to rounding and not to some skin.
  const auto box = std::make_shared<CollisionMesh>(scenes::build(scenes::makeBox({1, 1, 1}, 1)), BuildStrategy::kSah);
  Query query;
  query.a = query.b = box.get();
  query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 1 - 0.002}};
  query.options.contacts = ContactModel::kSolid;
  Workspace workspace;
  collide(query, workspace);
  REQUIRE(workspace.reduced.size() == 4);
  for (const Contact& contact : workspace.reduced) {
    CHECK(contact.position.z == Approx(0.5 - 0.001).epsilon(1e-12));
    CHECK(contact.depth == Approx(0.002).epsilon(1e-12));
  }
}

TEST_CASE("the contacts of stacked rings are spread around them and push along their axis") {
  const std::vector<truth::ContactFamily> families = truth::contactFamilies();
  const auto rings = std::find_if(families.begin(), families.end(),
                                  [](const truth::ContactFamily& f) { return f.name == "tori_stacked"; });
  REQUIRE(rings != families.end());
  truth::Random random(13);
  for (int i = 0; i < 10; ++i) {
    const truth::Placement placement = rings->place(random, random.uniform(0.01, 0.1));
    const auto contacts = contactsOf(*rings, placement.bInA, 64);
    double deepest = 0;
    for (const truth::PlainContact& c : contacts) deepest = std::max(deepest, c.depth);
    // Firm ones in every sector of 60 degrees: the rim of the overlap, which is shallow, does not crowd them out.
    std::array<int, 6> sectors{};
    for (const truth::PlainContact& c : contacts) {
      const double turn = std::atan2(c.position.y, c.position.x) / (2 * std::numbers::pi) + 0.5;
      if (c.depth >= 0.5 * deepest) ++sectors[std::min(static_cast<std::size_t>(6 * turn), std::size_t{5})];
    }
    CHECK(*std::min_element(sectors.begin(), sectors.end()) >= 1);
    const auto gradient = truth::volumeGradient(rings->a->mesh(), rings->b->mesh(), placement.bInA);
    const truth::Wrench wrench = truth::wrenchOf(contacts, gradient.overlap.centroid);
    CHECK(truth::armError(wrench, {gradient.push, gradient.moment}) <= rings->size);
  }
}

TEST_CASE("the contacts of tori at random push as their overlap does") {
  const std::vector<truth::ContactFamily> families = truth::contactFamilies();
  const truth::ContactFamily& tori = families.back();
  REQUIRE(tori.name == "tori");
  truth::Random random(12);
  for (int i = 0; i < 10; ++i) {
    const truth::Placement placement = tori.place(random, 0.1);
    const auto gradient = truth::volumeGradient(tori.a->mesh(), tori.b->mesh(), placement.bInA);
    for (const int places : {64, 8}) {
      const auto contacts = contactsOf(tori, placement.bInA, places);
      const truth::Wrench wrench = truth::wrenchOf(contacts, gradient.overlap.centroid);
      CHECK(truth::angleBetween(wrench.force, gradient.push) <= 1);
      CHECK(truth::armError(wrench, {gradient.push, gradient.moment}) <= 0.2 * tori.size);
    }
  }
}
