// SPDX-License-Identifier: BSD-3-Clause
// A mesh that is closed by its own indices is a solid, also where some of its vertices lie at the same place.
#include "support/self_touching.h"

#include "support/catch.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

dGpuTriMeshReport reportOf(dGpuTriMeshDataID data) {
  dGpuTriMeshReport report;
  dGpuTriMeshReportInit(&report);
  REQUIRE(dGpuTriMeshDataGetReport(data, &report) == dGPUTRIMESH_OK);
  return report;
}

void update(const Data& data, const scenes::MeshArrays& to) {
  REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(data.id, to.vertices.data(), sizeof(Vec3f),
                                              static_cast<int>(to.vertices.size())) == dGPUTRIMESH_OK);
}

/// A contact of `other` within 1e-4 of this one in place and depth, and that faces the same way.
bool hasOneLike(const dContactGeom& c, const std::vector<dContactGeom>& others) {
  return std::any_of(others.begin(), others.end(), [&](const dContactGeom& d) {
    double apart = std::fabs(c.depth - d.depth), cosine = 0;
    for (int k = 0; k < 3; ++k) {
      apart = std::max(apart, std::fabs(c.pos[k] - d.pos[k]));
      cosine += c.normal[k] * d.normal[k];
    }
    return apart < 1e-4 && cosine > 1 - 1e-4;
  });
}

void forgetHistory(dGeomID g) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  params.history = dGPUTRIMESH_HISTORY_OFF;
  REQUIRE(dGeomGpuTriMeshSetParams(g, &params) == dGPUTRIMESH_OK);
}

}  // namespace

TEST_CASE("bodies that touch themselves are solids, built, moved there and moved on") {
  const OdeSession session;
  for (const SelfTouching& body : selfTouching()) {
    INFO(body.what);
    const Data touching(body.touching), moving(body.apart);
    const dGpuTriMeshReport built = reportOf(touching.id);
    CHECK(built.solid == 1);
    CHECK(built.non_manifold_edges == 0);
    CHECK(built.edges == 3 * static_cast<int>(body.touching.triangles.size()) / 2);
    CHECK(reportOf(moving.id).solid == 1);
    update(moving, body.touching);
    CHECK(reportOf(moving.id).solid == 1);
    CHECK(reportOf(moving.id).edges == built.edges);
    update(touching, body.apart);
    CHECK(reportOf(touching.id).solid == 1);
  }
}

TEST_CASE("faces that lie on each other and face the same way still make a shell") {
  const OdeSession session;
  const scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
  CHECK(reportOf(Data(scenes::merge({box, box})).id).solid == 0);
}

TEST_CASE("contacts on a body that touches itself are those on the same body with a small gap") {
  const OdeSession session;
  std::mt19937 random(41);
  std::uniform_real_distribution<double> part(-1, 1);
  const Data probe(scenes::makeBox({0.5, 0.375, 0.25}));
  for (const SelfTouching& body : selfTouching()) {
    const Data touching(body.touching), apart(body.apart);
    const Geom one(touching), other(apart), box(probe);
    for (const dGeomID g : {one.id, other.id, box.id}) forgetHistory(g);
    int with = 0, contacts = 0, unlike = 0;
    for (int i = 0; i < 300; ++i) {
      setRandomPose(box.id, random, 0.01);
      // About the place where the body touches itself, and beside it.
      const double far = body.what == "a pinched torus" ? 0.3 : 0.9;
      const double middle = body.what == "a pinched torus" ? 0 : 0.5;
      dGeomSetPosition(box.id, middle + far * part(random), middle + far * part(random), middle + far * part(random));
      const auto x = collide(one.id, box.id, 64), y = collide(other.id, box.id, 64);
      CHECK(x.empty() == y.empty());
      with += !x.empty();
      contacts += static_cast<int>(x.size());
      for (const dContactGeom& c : x) unlike += !hasOneLike(c, y);
    }
    INFO(body.what << ": " << with << " poses, " << contacts << " contacts");
    CHECK(with > 100);
    CHECK(unlike <= contacts / 40);
  }
}
