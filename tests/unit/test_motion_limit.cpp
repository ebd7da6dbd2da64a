// SPDX-License-Identifier: BSD-3-Clause
// Contacts of open meshes are no deeper than what the pair remembers, and the motion since.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/vectors.h"
#include "collide/pair_history.h"
#include "support/catch.h"
#include "support/mesh_samples.h"
#include "support/shell_scenes.h"

using namespace otg;
using namespace otg::test;

namespace {

double deepestOf(const std::vector<Contact>& contacts) {
  double deepest = 0;
  for (const Contact& c : contacts) deepest = std::max(deepest, c.depth);
  return deepest;
}

Eigen::Isometry3d toEigen(const Transformd& t) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 9; ++i) out.linear()(i / 3, i % 3) = t.r[i];
  out.translation() = Eigen::Vector3d(t.t.x, t.t.y, t.t.z);
  return out;
}

/// How far the place of a contact on mesh B has moved into mesh A.
double motionInto(const Contact& c, const Transformd& from, const Transformd& to) {
  const Eigen::Vector3d place(c.position.x, c.position.y, c.position.z), normal(c.normal.x, c.normal.y, c.normal.z);
  const Eigen::Vector3d then = toEigen(from) * (toEigen(to).inverse() * place);
  return std::max(0.0, normal.dot(place - then));
}

struct Walk {
  MeshPtr a, b;
  Transformd pose;  ///< of B in A
};

/// Bodies at the faces and rims of open grounds, either of the two as mesh A.
std::vector<Walk> walks(std::uint32_t seed, int each) {
  Draw draw(seed);
  std::vector<MeshPtr> grounds, bodies;
  for (const auto& ground : {terrain(4, 8, 0.3), terrain(2, 1, 0), makeBody(ShellBody::kOpenBox, {3, 3, 1})}) {
    grounds.push_back(collisionMesh(ground));
  }
  for (const auto& body : {scenes::makeBox({1, 0.7, 0.4}), makeBody(ShellBody::kQuad, {1, 1, 0.5}),
                           makeBody(ShellBody::kOpenBox, {0.8, 0.6, 0.5})}) {
    bodies.push_back(collisionMesh(body));
  }
  std::vector<Walk> out;
  for (const MeshPtr& ground : grounds) {
    for (const MeshPtr& body : bodies) {
      for (int i = 0; i < each; ++i) {
        const double angle = draw.uniform(0, 6);
        Transformd pose = makePose(draw.direction(), angle, {0, 0, 0});
        pose.t = {draw.uniform(-1.7, 1.7), draw.uniform(-1.7, 1.7), draw.uniform(-0.4, 0.6)};
        const bool isSwapped = i % 2 == 1;
        out.push_back({isSwapped ? body : ground, isSwapped ? ground : body, isSwapped ? inverse(pose) : pose});
      }
    }
  }
  return out;
}

}  // namespace

TEST_CASE("a contact of an open mesh is no deeper than the last ones and what its place has moved since") {
  Draw draw(2);
  int known = 0, cut = 0;
  for (const Walk& walk : walks(1, 40)) {
    SolidHistory history;
    Query query = solidQuery(*walk.a, *walk.b, walk.pose);
    query.options.maxContacts = 1000;
    std::optional<double> before;
    for (int step = 0; step < 12; ++step) {
      const Transformd from = query.bInA;
      if (step > 0) {
        const Transformd turn = makePose(draw.direction(), draw.uniform(0, 0.02), {0, 0, 0});
        query.bInA = makePose(draw.direction(), 0, otgAdd(from.t, otgScale(draw.direction(), 0.01)));
        const Eigen::Matrix3d r = toEigen(turn).linear() * toEigen(from).linear();
        for (int i = 0; i < 9; ++i) query.bInA.r[i] = r(i / 3, i % 3);
      }
      query.history = nullptr;
      const double unlimited = deepestOf(contactsOf(query));
      query.history = &history;
      const std::vector<Contact> contacts = contactsOf(query);
      for (const Contact& c : contacts) {
        if (before) CHECK(c.depth <= *before + motionInto(c, from, query.bInA) + 1e-12);
      }
      known += before && !contacts.empty();
      CHECK(history.current.deepest >= deepestOf(contacts));
      cut += before && unlimited > deepestOf(contacts) + 1e-6;
      before = history.current.deepest;
    }
  }
  CHECK(known > 500);
  CHECK(cut > 50);
}

TEST_CASE("what moved without the pose, and what was put elsewhere, is not limited") {
  const MeshPtr sheet = collisionMesh(terrain(4, 1, 0)), box = collisionMesh(scenes::makeBox({1, 1, 1}));
  scenes::MeshArrays arrays = terrain(4, 1, 0);
  for (Vec3f& v : arrays.vertices) v.z += 0.1F;
  const MeshPtr raised = collisionMesh(arrays);
  SolidHistory history;
  const auto deepest = [&](const MeshPtr& ground, double height) {
    Query query = solidQuery(*ground, *box, makePose({0, 0, 1}, 0.3, {0.1, 0.2, height}));
    query.history = &history;
    return deepestOf(contactsOf(query));
  };
  CHECK(std::fabs(deepest(sheet, 0.4995) - 0.0005) < 1e-6);
  CHECK(history.current.deepest == deepest(sheet, 0.4995));
  history.current.deepest = 0;  // had they touched without depth
  CHECK(std::fabs(deepest(sheet, 0.499) - 0.0005) < 1e-6);
  CHECK(std::fabs(deepest(raised, 0.499) - 0.101) < 1e-6);
  CHECK(std::fabs(deepest(sheet, 0.499) - 0.0005) < 1e-6);
  history = {};
  CHECK(std::fabs(deepest(sheet, 0.499) - 0.001) < 1e-6);
  CHECK(std::fabs(deepest(sheet, 0.1) - 0.4) < 1e-6);  // 0.399 lower
}

TEST_CASE("contacts of two solids are not limited by what the pair remembers") {
  const MeshPtr ground = collisionMesh(scenes::makeBox({4, 4, 1})), box = collisionMesh(scenes::makeBox({1, 1, 1}, 3));
  SolidHistory history;
  Query query = solidQuery(*ground, *box, makePose({0, 0, 1}, 0.3, {0.1, 0.2, 0.99}));
  query.options.solid.convexPath = false;
  query.history = &history;
  CHECK(deepestOf(contactsOf(query)) > 0.009);
  CHECK(history.used);
  CHECK(history.current.deepest < 0);
}
