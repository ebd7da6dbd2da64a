// SPDX-License-Identifier: BSD-3-Clause
// The way of convex pairs: against all separating axes, in both orders, and what becomes of its contacts.
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <set>

#include "base/vectors.h"
#include "collide/contact_id.h"
#include "collide/convex/box_axes.h"
#include "collide/convex/convex_pair_contacts.h"
#include "collide/convex/expanding_polytope.h"
#include "collide/convex/kept_axis.h"
#include "collide/convex/separating_axes.h"
#include "primitives/convex_hull.h"
#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/counted_memory.h"

using namespace otg;
using namespace otg::test;

namespace {

using Body = std::unique_ptr<const CollisionMesh>;

Body bodyOf(const scenes::MeshArrays& arrays) {
  Body body = std::make_unique<const CollisionMesh>(scenes::build(arrays), BuildStrategy::kSah);
  REQUIRE(body->convex() != nullptr);
  return body;
}

scenes::MeshArrays randomHull(std::mt19937& random, int points, const Vec3d& half) {
  std::normal_distribution<double> normal;
  std::vector<Vec3d> places;
  for (int i = 0; i < points; ++i) {
    const Vec3d d = unit(Vec3d{normal(random), normal(random), normal(random)});
    const auto rounded = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    places.push_back({rounded(d.x * half.x), rounded(d.y * half.y), rounded(d.z * half.z)});
  }
  scenes::MeshArrays mesh;
  std::map<std::uint32_t, std::uint32_t> number;
  for (const auto& triangle : convexHull(places)) {
    Triangle t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [at, isNew] = number.emplace(triangle[k], static_cast<std::uint32_t>(mesh.vertices.size()));
      const Vec3d& p = places[triangle[k]];
      if (isNew) {
        mesh.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
      }
      t.v[k] = at->second;
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

Transformd rotation(const Vec3d& axis, double angle, const Vec3d& t) {
  const double s = std::sin(angle / 2), w = std::cos(angle / 2), x = s * axis.x, y = s * axis.y, z = s * axis.z;
  return {
      {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
       2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
      t};
}

Transformd randomPose(std::mt19937& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-reach, reach), angle(0, 6.3);
  return rotation(unit(Vec3d{normal(random), normal(random), normal(random)}), angle(random),
                  {uniform(random), uniform(random), uniform(random)});
}

Transformd inverse(const Transformd& pose) {
  Transformd out{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) out.r[3 * i + j] = pose.r[3 * j + i];
  }
  out.t = otgScale(otgRotateBack(pose, pose.t), -1.0);
  return out;
}

std::vector<Vec3d> placed(const CollisionMesh& mesh, const Transformd& pose) {
  std::vector<Vec3d> places;
  for (const Vec3f& v : mesh.mesh().vertices()) places.push_back(otgTransform(pose, Vec3d{v.x, v.y, v.z}));
  return places;
}

/// How far `a` reaches over the beginning of `b` along a unit direction.
double overlapAlong(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b, const Vec3d& m) {
  double most = -1e300, least = 1e300;
  for (const Vec3d& p : a) most = std::max(most, otgDot(m, p));
  for (const Vec3d& p : b) least = std::min(least, otgDot(m, p));
  return most - least;
}

constexpr Transformd kSame{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

/// By the normal of every triangle and the product of any two edges: a way of its own to the least overlap.
double leastOverlap(const CollisionMesh& meshA, const CollisionMesh& meshB, const Transformd& pose) {
  const std::vector<Vec3d> a = placed(meshA, kSame), b = placed(meshB, pose);
  double least = 1e300;
  const auto tryAxis = [&](const Vec3d& m) {
    if (norm(m) > 0) least = std::min(least, overlapAlong(a, b, unit(m)));
  };
  const auto edgesOf = [](const CollisionMesh& mesh, const std::vector<Vec3d>& at) {
    std::vector<Vec3d> edges;
    for (const Topology::Edge& e : mesh.mesh().topology().edges) edges.push_back(at[e.b] - at[e.a]);
    return edges;
  };
  for (const auto& [mesh, at, sign] : {std::tuple{&meshA, &a, 1.0}, std::tuple{&meshB, &b, -1.0}}) {
    for (const Triangle& t : mesh->mesh().triangles()) {
      const Vec3d& p = (*at)[t.v[0]];
      tryAxis(otgCross((*at)[t.v[1]] - p, (*at)[t.v[2]] - p) * sign);
    }
  }
  for (const Vec3d& x : edgesOf(meshA, a)) {
    for (const Vec3d& y : edgesOf(meshB, b)) {
      const Vec3d m = otgCross(x, y);
      if (norm(m) < 1e-6 * norm(x) * norm(y)) continue;
      tryAxis(m);
      tryAxis(m * -1.0);
    }
  }
  return least;
}

Query queryOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = pose;
  query.options.contacts = ContactModel::kSolid;
  query.options.solid.convexPath = true;
  return query;
}

/// By each way to the least overlap that there is for a pair, deep or not.
std::vector<ConvexAxis> axesOf(const Query& query) {
  const ConvexPair pair(*query.a->convex(), *query.b->convex(), query.bInA);
  const double size = static_cast<double>(query.a->mesh().radius() + query.b->mesh().radius());
  const Vec3f &a = query.a->mesh().center(), &b = query.b->mesh().center();
  const Vec3d toB = otgTransform(query.bInA, Vec3d{b.x, b.y, b.z}) - Vec3d{a.x, a.y, a.z};
  std::vector<ConvexAxis> axes{leastByPolytope(pair, toB, size)};
  if (haveFewAxes(pair)) axes.push_back(leastByAxes(pair, size));
  if (pair.a().box() != nullptr && pair.b().box() != nullptr) axes.push_back(leastOfBoxes(pair, size));
  return axes;
}

/// What holds for the contacts of any pair.
void checkContacts(const Query& query, const std::vector<Contact>& contacts) {
  std::set<std::uint64_t> ids;
  REQUIRE(contacts.size() <= 8);
  for (const Contact& c : contacts) {
    CHECK(norm(c.normal) == Approx(1).epsilon(1e-12));
    CHECK(c.normal == contacts.front().normal);
    CHECK(c.depth >= 0);
    CHECK(c.depth <= contacts.front().depth);
    CHECK(c.triangleA < query.a->mesh().triangleCount());
    CHECK(c.triangleB < query.b->mesh().triangleCount());
    CHECK(ids.insert(contactId(c)).second);
  }
}

}  // namespace

TEST_CASE("Random convex pairs against all separating axes", "[convex]") {
  std::mt19937 random(11);
  std::vector<Body> bodies;
  for (int i = 0; i < 12; ++i) {
    bodies.push_back(bodyOf(randomHull(random, 5 + i, i % 3 ? Vec3d{1, 1, 1} : Vec3d{1, 0.5, 0.25})));
  }
  bodies.push_back(bodyOf(scenes::makeBox({1, 1, 1})));
  bodies.push_back(bodyOf(scenes::makeBox({2, 0.4, 0.8})));
  bodies.push_back(bodyOf(scenes::makeCylinder(0.6, 1, 6)));
  bodies.push_back(bodyOf(scenes::makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})));
  int touching = 0, deep = 0, missed = 0, underestimated = 0;
  double worst = 0;
  Workspace workspace, turned;
  for (int i = 0; i < 10000; ++i) {
    const CollisionMesh &a = *bodies[random() % bodies.size()], &b = *bodies[random() % bodies.size()];
    const Query query = queryOf(a, b, randomPose(random, i % 2 ? 0.4 : 0.9));
    const double truth = leastOverlap(a, b, query.bInA);
    if (std::fabs(truth) < 1e-9) continue;
    touching += truth > 0;
    for (const ConvexAxis& axis : axesOf(query)) {
      missed += (axis.of == ConvexAxis::Of::kNone) != (truth < 0);
      if (truth < 0) continue;
      underestimated += axis.overlap < truth * (1 - 1e-9);
      worst = std::max(worst, axis.overlap / truth - 1);
    }
    if (!collideConvexPair(query, workspace)) {
      ++deep;
      CHECK(truth > 0);
      continue;
    }
    missed += (truth > 0) != !workspace.reduced.empty();
    // The same in the other order, to rounding.
    if (!collideConvexPair(queryOf(b, a, inverse(query.bInA)), turned)) continue;
    CHECK(turned.reduced.empty() == workspace.reduced.empty());
    if (workspace.reduced.empty() || turned.reduced.empty()) continue;
    checkContacts(query, workspace.reduced);
    const double depth = workspace.reduced.front().depth;
    underestimated += depth < truth * (1 - 1e-9);
    worst = std::max(worst, depth / truth - 1);
    const double along = overlapAlong(placed(a, kSame), placed(b, query.bInA), workspace.reduced.front().normal * -1.0);
    CHECK(depth == Approx(along).epsilon(1e-9));
    CHECK(turned.reduced.front().depth == Approx(depth).epsilon(2.1e-3));
  }
  CHECK(touching > 3000);
  CHECK(touching < 9000);
  CHECK(touching - deep > 2000);
  CHECK(missed == 0);
  CHECK(underestimated == 0);
  CHECK(worst < 2.1e-3);
}

TEST_CASE("Boxes whose edges cross deep have contacts at their corners, too", "[convex]") {
  std::mt19937 random(13);
  const Body boxes[] = {bodyOf(scenes::makeBox({1, 1, 1})), bodyOf(scenes::makeBox({2, 0.4, 0.8}))};
  Workspace workspace;
  int edges = 0, deep = 0, several = 0;
  for (int i = 0; i < 4000; ++i) {
    const CollisionMesh &a = *boxes[random() % 2], &b = *boxes[random() % 2];
    const Query query = queryOf(a, b, randomPose(random, i % 2 ? 0.5 : 0.8));
    const ConvexPair pair(*a.convex(), *b.convex(), query.bInA);
    const ConvexAxis axis = leastOfBoxes(pair, static_cast<double>(a.mesh().radius() + b.mesh().radius()));
    if (axis.of != ConvexAxis::Of::kEdges || !collideConvexPair(query, workspace)) continue;
    // Not those that touch all but as faces.
    const auto facing = [&](int body, double sign) {
      double most = -1;
      for (std::uint32_t f = 0; f < 6; ++f) most = std::max(most, sign * otgDot(pair.normal(body, f), axis.m));
      return most;
    };
    if (std::min(facing(0, 1), facing(1, -1)) > 0.997) continue;
    ++edges;
    const auto depthIn = [&](int body, const Vec3d& p) {
      double least = 1e9;
      for (std::uint32_t f = 0; f < pair.body(body).faceCount(); ++f) {
        const std::uint32_t on = pair.body(body).corner(pair.body(body).face(f).corner).vertex;
        least = std::min(least, otgDot(unit(pair.normal(body, f)), pair.place(body, on) - p));
      }
      return least;
    };
    CHECK(workspace.reduced.front().depth == Approx(axis.overlap).epsilon(1e-9));
    checkContacts(query, workspace.reduced);
    int inside = 0;
    for (const int body : {0, 1}) {
      for (std::uint32_t v = 0; v < 8; ++v) inside += depthIn(1 - body, pair.place(body, v)) > 0.25 * axis.overlap;
    }
    if (inside == 0) continue;
    ++deep;
    several += workspace.reduced.size() > 1;
  }
  CHECK(edges > 500);
  CHECK(deep > 200);
  CHECK(several > 0.95 * deep);  // of the others the corners belong to other faces
}

TEST_CASE("Two boxes have the direction of all separating axes", "[convex]") {
  std::mt19937 random(12);
  scenes::MeshArrays away = scenes::makeBox({0.5, 3, 1}, 2);
  for (Vec3f& v : away.vertices) v = {v.x + 16, v.y - 8, v.z + 4};
  const std::vector<Body> boxes = [&] {
    std::vector<Body> all;
    all.push_back(bodyOf(scenes::makeBox({1, 1, 1})));
    all.push_back(bodyOf(scenes::makeBox({2, 0.4, 0.8})));
    all.push_back(bodyOf(away));
    return all;
  }();
  CHECK(bodyOf(scenes::makeCylinder(0.6, 1, 4))->convex()->box() == nullptr);  // a box that stands on an edge
  std::uniform_real_distribution<double> uniform(-1, 1);
  int touching = 0, edges = 0, faces[2] = {0, 0}, others = 0;
  for (int i = 0; i < 6000; ++i) {
    const CollisionMesh &a = *boxes[random() % 3], &b = *boxes[random() % 3];
    Transformd pose = i % 3 == 0 ? rotation({0, 0, 1}, 0.01 * uniform(random), {0, 0, 0}) : randomPose(random, 0);
    if (i % 4 == 0) pose.r[4] *= 1 + 5e-4 * uniform(random);  // no exact rotation
    const Vec3f &middleA = a.mesh().center(), &middleB = b.mesh().center();
    const Vec3d way{1.2 * uniform(random), 1.2 * uniform(random), 1.2 * uniform(random)};
    pose.t = Vec3d{middleA.x, middleA.y, middleA.z} + way -
             otgTransform(
                 {{pose.r[0], pose.r[1], pose.r[2], pose.r[3], pose.r[4], pose.r[5], pose.r[6], pose.r[7], pose.r[8]},
                  {0, 0, 0}},
                 Vec3d{middleB.x, middleB.y, middleB.z});
    const ConvexPair pair(*a.convex(), *b.convex(), pose);
    REQUIRE((pair.a().box() != nullptr && pair.b().box() != nullptr));
    const double size = static_cast<double>(a.mesh().radius() + b.mesh().radius());
    const ConvexAxis of = leastOfBoxes(pair, size), all = leastByAxes(pair, size);
    REQUIRE((of.of == ConvexAxis::Of::kNone) == (all.of == ConvexAxis::Of::kNone));
    if (of.of == ConvexAxis::Of::kNone) continue;
    ++touching;
    CHECK(of.overlap == Approx(all.overlap).epsilon(1.01e-3));  // of two edges as good the first one stays
    CHECK(pair.overlapAlong(of.m) == Approx(of.overlap).epsilon(1e-9));
    others += norm(of.m - all.m) > 1e-9;  // as good in two directions
    edges += of.of == ConvexAxis::Of::kEdges;
    if (of.of == ConvexAxis::Of::kEdges) continue;
    const int body = of.of == ConvexAxis::Of::kFaceA ? 0 : 1;
    ++faces[body];
    CHECK(otgDot(unit(pair.normal(body, of.face)), of.m) == Approx(body == 0 ? 1 : -1).epsilon(1e-12));
  }
  CHECK(touching > 2000);
  CHECK(edges > 100);
  CHECK((faces[0] > 300 && faces[1] > 300));
  CHECK(others < 10);
}

TEST_CASE("What a convex pair keeps changes no byte of its contacts", "[convex]") {
  std::vector<Body> bodies;
  bodies.push_back(bodyOf(scenes::makeCylinder(0.5, 1, 48)));
  bodies.push_back(bodyOf(scenes::makeSphere(0.5, 2)));
  bodies.push_back(bodyOf(scenes::makeCapsule(0.25, 0.5, 24, 8)));
  bodies.push_back(bodyOf(scenes::makeBox({4, 4, 1}, 3)));
  bodies.push_back(bodyOf(scenes::makeBox({1, 1, 1})));
  std::mt19937 random(13);
  bodies.push_back(bodyOf(randomHull(random, 40, {0.6, 0.5, 0.4})));
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto bytesOf = [](const std::vector<Contact>& contacts) {
    std::string bytes;
    const auto add = [&](const auto& x) { bytes.append(reinterpret_cast<const char*>(&x), sizeof x); };
    for (const Contact& c : contacts) {
      add(c.position);
      add(c.normal);
      add(c.depth);
      add(c.triangleA);
      add(c.triangleB);
      add(c.feature);
      add(c.flags);
      add(c.element);
      add(c.ordinal);
    }
    return bytes;
  };
  int touching = 0, kept = 0, same = 0;
  Workspace warm, cold;
  for (int walk = 0; walk < 600; ++walk) {
    const CollisionMesh &a = *bodies[random() % bodies.size()], &b = *bodies[random() % bodies.size()];
    SolidHistory history;
    // Set against each other somewhere, then shaken: by much, by little, and not at all.
    Transformd pose = walk % 2 ? randomPose(random, 1) : rotation({0, 0, 1}, uniform(random), {0, 0, 0});
    pose.t = unit(walk % 2 ? Vec3d{uniform(random), uniform(random), uniform(random)} : Vec3d{0, 0, 1}) * 3.0;
    const auto apart = [&](double by) {
      const Query query =
          queryOf(a, b,
                  {{pose.r[0], pose.r[1], pose.r[2], pose.r[3], pose.r[4], pose.r[5], pose.r[6], pose.r[7], pose.r[8]},
                   pose.t * by});
      const ConvexPair pair(*a.convex(), *b.convex(), query.bInA);
      return leastByPolytope(pair, query.bInA.t, 2).of == ConvexAxis::Of::kNone;
    };
    double in = 0, out = 1;
    for (int i = 0; i < 30; ++i) (apart(0.5 * (in + out)) ? out : in) = 0.5 * (in + out);
    pose.t = pose.t * (in - 0.001);
    const double by = std::pow(10.0, -6 + walk % 4);
    for (int step = 0; step < 30; ++step) {
      if (step % 5 != 4) {
        const Vec3d axis{uniform(random), uniform(random), uniform(random)};
        const Transformd turn = rotation(unit(axis), by * uniform(random), {0, 0, 0});
        Transformd next = pose;
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            next.r[3 * i + j] =
                turn.r[3 * i] * pose.r[j] + turn.r[3 * i + 1] * pose.r[3 + j] + turn.r[3 * i + 2] * pose.r[6 + j];
          }
        }
        next.t = pose.t + Vec3d{uniform(random), uniform(random), uniform(random)} * by;
        pose = next;
      }
      Query query = queryOf(a, b, pose);
      SolidHistory without = history;
      without.kept = {};
      const ConvexPair pair(*a.convex(), *b.convex(), query.bInA);
      const double size = static_cast<double>(a.mesh().radius() + b.mesh().radius());
      ConvexAxis axis;
      same += isOfPose(pair, history.kept);
      kept += isOfPair(pair, history.kept) && isStillLeast(pair, history.kept, size, axis);
      query.history = &without;
      collide(query, cold);
      query.history = &history;
      collide(query, warm);
      REQUIRE(bytesOf(warm.reduced) == bytesOf(cold.reduced));
      touching += !warm.reduced.empty();
    }
  }
  CHECK(touching > 10000);
  CHECK(kept > 3000);
  CHECK(same > 2000);
}

TEST_CASE("Spheres of many triangles overlap by what their radii say", "[convex]") {
  std::mt19937 random(5);
  Workspace workspace;
  for (const int level : {1, 2, 3, 4, 5}) {
    const Body a = bodyOf(scenes::makeSphere(1, level)), b = bodyOf(scenes::makeSphere(0.5, level));
    const double sagitta = 0.25 * std::pow(0.25, level);
    for (int i = 0; i < 100; ++i) {
      Transformd pose = randomPose(random, 1);
      const double depth = i % 2 ? 0.02 : 0.3;
      pose.t = unit(pose.t) * (1.5 - depth);
      collide(queryOf(*a, *b, pose), workspace);
      if (depth < 2 * sagitta) continue;
      REQUIRE(!workspace.reduced.empty());
      const Contact& deepest = workspace.reduced.front();
      CHECK(std::fabs(deepest.depth - depth) < 2 * sagitta);
      CHECK(otgDot(deepest.normal, unit(pose.t)) < -1 + 2 * sagitta);
    }
    for (int i = 0; i < 100; ++i) {
      Transformd pose = randomPose(random, 1);
      pose.t = unit(pose.t) * 1.5000001;
      collide(queryOf(*a, *b, pose), workspace);
      CHECK(workspace.reduced.empty());
    }
  }
}

TEST_CASE("Faces that face each other touch at the corners of their overlap", "[convex]") {
  // A box on a larger one, whose faces are divided: four contacts at its own corners.
  const Body small = bodyOf(scenes::makeBox({1, 1, 1})), large = bodyOf(scenes::makeBox({4, 4, 1}, 8));
  Workspace workspace;
  collide(queryOf(*small, *large, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1, 0.2, -0.999}}), workspace);
  REQUIRE(workspace.reduced.size() == 4);
  for (const Contact& c : workspace.reduced) {
    CHECK(c.feature == ContactFeature::kVertexA);
    CHECK(c.depth == Approx(1e-3).epsilon(1e-6));
    CHECK(c.normal.z == Approx(1));
    CHECK(c.position.z == Approx(-0.4995));
    CHECK(std::fabs(c.position.x) == Approx(0.5));
    CHECK(std::fabs(c.position.y) == Approx(0.5));
    // The triangle of B below the contact.
    const Triangle& t = large->mesh().triangles()[c.triangleB];
    Vec3d corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& v = large->mesh().vertices()[t.v[k]];
      corner[k] = Vec3d{v.x, v.y, v.z} + Vec3d{0.1, 0.2, -0.999};
      CHECK(corner[k].z == Approx(-0.499));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(otgCross(corner[(k + 1) % 3] - corner[k], c.position - corner[k]).z >= -1e-9);
    }
  }
  // Crossed by 45 degrees, the overlap has eight corners.
  const Body other = bodyOf(scenes::makeBox({1, 1, 1}));
  collide(queryOf(*small, *other, rotation({0, 0, 1}, std::acos(-1.0) / 4, {0, 0, -0.99})), workspace);
  CHECK(workspace.reduced.size() == 8);
  for (const Contact& c : workspace.reduced) CHECK(c.feature == ContactFeature::kCrossingA);
  // Edge across edge: one contact between the two.
  const Transformd up = rotation({1, 0, 0}, std::acos(-1.0) / 4, {0, 0, 0});
  Transformd crossed = rotation({0, 1, 0}, std::acos(-1.0) / 4, {0, 0, 0});
  Transformd pose{};
  const Transformd back = inverse(up);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) pose.r[3 * i + j] += back.r[3 * i + k] * crossed.r[3 * k + j];
    }
  }
  pose.t = otgRotate(back, Vec3d{0, 0, -std::sqrt(2.0) + 0.01});
  collide(queryOf(*small, *other, pose), workspace);
  REQUIRE(workspace.reduced.size() == 1);
  CHECK(workspace.reduced.front().feature == ContactFeature::kMiddleA);
  CHECK(workspace.reduced.front().depth == Approx(0.01).epsilon(1e-6));
  // A box that lies on one edge: two contacts.
  pose = inverse(rotation({1, 0, 0}, std::acos(-1.0) / 4, {0, 0, 0}));
  pose.t = otgRotate(pose, Vec3d{0, 0, -std::sqrt(0.5) - 0.49});
  collide(queryOf(*small, *large, pose), workspace);
  CHECK(workspace.reduced.size() == 2);
}

TEST_CASE("Contacts of a face of many corners lie far from each other", "[convex]") {
  // Of the 24 corners of a round face those that are kept are a quarter of the circle apart, to one corner.
  const Body disc = bodyOf(scenes::makeCylinder(1, 0.2, 24)), table = bodyOf(scenes::makeBox({4, 4, 1}));
  for (const double turned : {0.0, 0.1, 0.7}) {
    Workspace workspace;
    Query query = queryOf(*disc, *table, rotation({0, 0, 1}, turned, {0, 0, -0.599}));
    query.options.solid.contactsPerRegion = 4;
    collide(query, workspace);
    REQUIRE(workspace.reduced.size() == 4);
    const auto& found = workspace.reduced;
    for (std::size_t i = 0; i < 4; ++i) CHECK(norm(found[i].position - found[(i + 1) % 4].position) > 1.2);
  }
}

TEST_CASE("Contacts keep their ids while a convex body slides and trembles", "[convex]") {
  const Body small = bodyOf(scenes::makeBox({1, 1, 1}, 3)), large = bodyOf(scenes::makeBox({8, 8, 1}, 16));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> tremble(-1e-5, 1e-5);
  Workspace workspace;
  std::set<std::uint64_t> first;
  for (int i = 0; i < 200; ++i) {
    const Transformd pose = rotation(unit(Vec3d{tremble(random), tremble(random), 1e-5}), 1e-5,
                                     {0.01 * i - 1 + tremble(random), tremble(random), -0.9995 + tremble(random)});
    collide(queryOf(*small, *large, pose), workspace);
    std::set<std::uint64_t> ids;
    for (const Contact& c : workspace.reduced) ids.insert(contactId(c));
    REQUIRE(ids.size() == 4);
    if (i == 0) first = ids;
    CHECK(ids == first);
  }
}

TEST_CASE("Deep, entangled and barely touching pairs are left to the stages for any solids", "[convex]") {
  const Body box = bodyOf(scenes::makeBox({1, 1, 1})), ball = bodyOf(scenes::makeSphere(0.2, 3)),
             large = bodyOf(scenes::makeSphere(1, 3));
  const auto at = [](double x, double y, double z) { return Transformd{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, y, z}}; };
  struct Sample {
    const CollisionMesh *a, *b;
    Transformd pose;
    bool isOwn;  ///< of the way of convex pairs
  };
  const std::vector<Sample> samples = {{box.get(), box.get(), kSame, false},
                                       {ball.get(), box.get(), at(0.1, 0, 0), false},
                                       {large.get(), large.get(), kSame, false},
                                       {box.get(), box.get(), at(0.45, 0, 0), false},
                                       {box.get(), box.get(), at(0.55, 0, 0), true},
                                       {box.get(), box.get(), at(0.25, 0.125, 1), false},
                                       {box.get(), box.get(), at(0.25, 0.125, 1 - 1e-9), true},
                                       {box.get(), box.get(), at(0.25, 0.125, 1 + 1e-9), true}};
  Workspace workspace, other;
  for (const Sample& sample : samples) {
    Query query = queryOf(*sample.a, *sample.b, sample.pose);
    INFO(sample.pose.t.x << " " << sample.pose.t.z);
    CHECK(collideConvexPair(query, workspace) == sample.isOwn);
    collide(query, workspace);
    query.options.solid.convexPath = false;
    collide(query, other);
    CHECK(workspace.reduced.empty() == other.reduced.empty());
    if (!sample.isOwn) CHECK(workspace.reduced.size() == other.reduced.size());
  }
  // A pair that remembers being entangled keeps its way until that is over.
  SolidHistory history;
  Query query = queryOf(*ball, *box, at(0.6, 0, 0));
  CHECK(collideConvexPair(query, workspace));
  query.history = &history;
  history.current.clampLeft = SolidHistory::kClampQueries;
  history.current.pose = query.bInA;
  history.current.hasPose = history.used = true;
  query.bInA.t.x = 0.601;
  CHECK_FALSE(collideConvexPair(query, workspace));
}

TEST_CASE("Convex bodies of all sizes, far from their origins, and slender ones", "[convex]") {
  std::mt19937 random(23);
  Workspace workspace;
  const auto check = [&](const scenes::MeshArrays& x, const scenes::MeshArrays& y, const Vec3d& middle, double size) {
    const Body a = bodyOf(x), b = bodyOf(y);
    int touching = 0;
    for (int i = 0; i < 300; ++i) {
      Transformd pose = randomPose(random, 0.5 * size);
      pose.t = pose.t + middle - otgRotate(pose, middle);
      const double truth = leastOverlap(*a, *b, pose), rounding = 1e-9 * (size + norm(middle));
      if (std::fabs(truth) < rounding) continue;
      touching += truth > 0;
      for (const ConvexAxis& axis : axesOf(queryOf(*a, *b, pose))) {
        REQUIRE((truth > 0) == (axis.of != ConvexAxis::Of::kNone));
        if (truth < 0) continue;
        CHECK(axis.overlap > truth * (1 - 1e-9) - rounding);
        CHECK(axis.overlap < truth * (1 + 2.1e-3) + 1e-8 * size + rounding);
      }
    }
    CHECK(touching > 20);
  };
  for (const double size : {1e-3, 1.0, 1e3}) {
    check(randomHull(random, 14, {size, size, size}), randomHull(random, 12, {size, size, size}), {0, 0, 0}, size);
    check(scenes::makeBox({size, size, 0.01 * size}), scenes::makeBox({size, 0.02 * size, 0.02 * size}), {0, 0, 0},
          size);
  }
  scenes::MeshArrays away = randomHull(random, 14, {1, 1, 1});
  for (Vec3f& v : away.vertices) v = {v.x + 64, v.y - 32, v.z + 16};
  check(away, away, {64, -32, 16}, 1);
}

TEST_CASE("A warm query of a convex pair takes no memory", "[convex]") {
  const Body box = bodyOf(scenes::makeBox({1, 1, 1})), ball = bodyOf(scenes::makeSphere(0.5, 4));
  const Body cylinder = bodyOf(scenes::makeCylinder(0.5, 1, 48));
  Workspace workspace;
  std::mt19937 random(9);
  SolidHistory history;
  const auto run = [&] {
    for (const auto& [a, b] : {std::pair{&box, &box}, {&box, &ball}, {&ball, &ball}, {&cylinder, &cylinder}}) {
      Query query = queryOf(**a, **b, randomPose(random, 1));
      query.bInA.t = unit(query.bInA.t);
      query.history = &history;
      collide(query, workspace);
      query.bInA = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.1, 0.1, 0.99}};
      collide(query, workspace);
    }
  };
  for (int i = 0; i < 200; ++i) run();
  const std::size_t before = allocations;
  for (int i = 0; i < 200; ++i) run();
  CHECK(allocations == before);
}

TEST_CASE("A pose that is refused is refused for convex pairs", "[convex]") {
  const Body box = bodyOf(scenes::makeBox({1, 1, 1}));
  Workspace workspace;
  collide(queryOf(*box, *box, kSame), workspace);
  REQUIRE(!workspace.reduced.empty());
  CHECK_THROWS_AS(collide(queryOf(*box, *box, {{2, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}), workspace),
                  std::invalid_argument);
  CHECK(workspace.reduced.empty());
}
