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

/// A grid of so many places along each side, about half of which are cubes.
scenes::MeshArrays someCubes(int size, std::mt19937& random) {
  std::bernoulli_distribution half(0.5);
  std::vector<bool> full;
  for (int i = 0; i < size * size * size; ++i) full.push_back(half(random));
  return scenes::makeCubes(
      size, [&](int x, int y, int z) { return full[static_cast<std::size_t>(x + size * (y + size * z))]; });
}

/// Places, normals and depths, in their order.
std::vector<double> numbersOf(const std::vector<dContactGeom>& contacts) {
  std::vector<double> numbers;
  for (const dContactGeom& c : contacts) {
    numbers.insert(numbers.end(), c.pos, c.pos + 3);
    numbers.insert(numbers.end(), c.normal, c.normal + 3);
    numbers.push_back(c.depth);
  }
  return numbers;
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

TEST_CASE("cubes that touch along edges after an update, or scaled, have the contacts of a new mesh") {
  // Over a thousand triangles are sorted by their neighbours, and at such edges these depend on where vertices are.
  const OdeSession session;
  std::mt19937 random(42);
  std::uniform_real_distribution<double> place(0, 8);
  std::uniform_real_distribution<float> shift(-0.2F, 0.2F);
  const Data probe(someCubes(3, random));
  const Geom body(probe);
  std::size_t contacts = 0;
  for (int i = 0; i < 24; ++i) {
    INFO("grid " << i);
    const scenes::MeshArrays cubes = someCubes(8, random);
    REQUIRE(cubes.triangles.size() > kMostUnsorted);
    scenes::MeshArrays before = cubes, wide = cubes;
    for (Vec3f& v : before.vertices) {
      if (i % 3 == 0) v = {v.x + shift(random), v.y + shift(random), v.z + shift(random)};
      if (i % 3 == 1) v.z = 0;
      if (i % 3 == 2) v.z = -v.z;
    }
    for (Vec3f& v : wide.vertices) v = {2 * v.x, -v.y, 0.5F * v.z};
    for (Triangle& t : wide.triangles) std::swap(t.v[1], t.v[2]);
    const Data moved(before), built(cubes), builtWide(wide);
    update(moved, cubes);
    const Geom of[4] = {Geom(moved), Geom(built), Geom(moved), Geom(builtWide)};
    REQUIRE(dGeomGpuTriMeshSetScale(of[2].id, 2, -1, 0.5) == dGPUTRIMESH_OK);
    for (int k = 0; k < 10; ++k) {
      INFO("pose " << k);
      for (const int pair : {0, 2}) {
        setRandomPose(body.id, random, 0.01);
        const dQuaternion upright = {1, 0, 0, 0};
        if (k == 0) dGeomSetQuaternion(body.id, upright);
        const double x = place(random), y = place(random), z = place(random);
        if (pair == 0) dGeomSetPosition(body.id, x, y, z);
        if (pair == 2) dGeomSetPosition(body.id, 2 * x, -y, 0.5 * z);
        const std::vector<dContactGeom> wanted = collide(of[pair + 1].id, body.id);
        CHECK(numbersOf(collide(of[pair].id, body.id)) == numbersOf(wanted));
        contacts += wanted.size();
      }
    }
  }
  CHECK(contacts > 3000);
}

TEST_CASE("a scaled mesh whose vertices meet by rounding has the contacts of a new mesh") {
  // Triangles have vertices of their own. Some boxes are as thick as a rounding, and flat at a third of their size.
  const OdeSession session;
  std::mt19937 random(43);
  std::uniform_real_distribution<double> place(4, 8);
  std::vector<scenes::MeshArrays> boxes;
  for (int i = 0; i < 125; ++i) {
    scenes::MeshArrays box = scenes::makeBox({1, 1, 1});
    const float at[3] = {static_cast<float>(i % 5), static_cast<float>(i / 5 % 5), static_cast<float>(i / 25)};
    for (Vec3f& v : box.vertices) {
      v = {v.x + at[0] + 4.5F, v.y + at[1] + 4.5F, v.z + at[2] + 4.5F};
      if (i % 3 == 0 && v.z > at[2] + 4.5F) v.z = at[2] + 4 + 0x1p-21F;
    }
    boxes.push_back(box);
  }
  const scenes::MeshArrays whole = scenes::merge(boxes);
  scenes::MeshArrays soup, small;
  for (const Triangle& t : whole.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t.v) soup.vertices.push_back(whole.vertices[v]);
    soup.triangles.push_back({{first, first + 1, first + 2}});
  }
  REQUIRE(soup.triangles.size() > kMostUnsorted);
  constexpr float kThird = 1.0F / 3;
  small = soup;
  for (Vec3f& v : small.vertices) v = {kThird * v.x, kThird * v.y, kThird * v.z};
  const Data data(soup), built(small), probe(someCubes(2, random));
  const Geom image(data), wanted(built), body(probe);
  REQUIRE(dGeomGpuTriMeshSetScale(image.id, kThird, kThird, kThird) == dGPUTRIMESH_OK);
  REQUIRE(dGeomGpuTriMeshSetScale(body.id, 0.25, 0.25, 0.25) == dGPUTRIMESH_OK);
  std::size_t contacts = 0;
  for (int i = 0; i < 300; ++i) {
    INFO("pose " << i);
    setRandomPose(body.id, random, 0.01);
    const Vec3d at{kThird * place(random), kThird * place(random), kThird * place(random)};
    dGeomSetPosition(body.id, at.x, at.y, at.z);
    const std::vector<dContactGeom> of = collide(wanted.id, body.id);
    CHECK(numbersOf(collide(image.id, body.id)) == numbersOf(of));
    contacts += of.size();
  }
  CHECK(contacts > 1500);
}
