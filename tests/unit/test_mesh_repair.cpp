// SPDX-License-Identifier: BSD-3-Clause
// Repairs: each alone, all together, and what they say they did.
#include <algorithm>
#include <cmath>
#include <random>

#include "scenes/generated_meshes.h"
#include "support/catch.h"

using namespace otg;
using namespace otg::scenes;

namespace {

MeshArrays soupOf(const MeshArrays& mesh) {
  MeshArrays soup;
  for (const Triangle& t : mesh.triangles) {
    const std::uint32_t n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t.v) soup.vertices.push_back(mesh.vertices[v]);
    soup.triangles.push_back({{n, n + 1, n + 2}});
  }
  return soup;
}

void flip(Triangle& t) {
  std::swap(t.v[0], t.v[2]);
}

MeshArrays shuffledWinding(MeshArrays mesh, std::uint32_t seed, double share = 0.5) {
  std::mt19937 random(seed);
  for (Triangle& t : mesh.triangles)
    if (random() < share * 4294967296.0) flip(t);
  return mesh;
}

RepairOptions only(bool RepairOptions::*option) {
  RepairOptions options;
  options.*option = true;
  return options;
}

}  // namespace

TEST_CASE("a sound mesh is left alone by all repairs") {
  const MeshArrays gear = makeGear(12, 1, 0.2, 0.3, 0.2);
  const MeshResult result = buildTriMesh(gear.input(), RepairOptions::all());
  REQUIRE(result.mesh);
  CHECK(std::equal(gear.triangles.begin(), gear.triangles.end(), result.mesh->triangles().begin()));
  CHECK(result.report.repair.messages.empty());
  CHECK(result.report.repair.flippedTriangles == 0);
}

TEST_CASE("nothing is repaired unless asked for") {
  MeshArrays bad = shuffledWinding(makeSphere(1, 2), 1);
  bad.triangles.push_back(bad.triangles[0]);
  bad.triangles.push_back({{0, 0, 0}});
  const auto mesh = build(bad);
  CHECK(std::equal(bad.triangles.begin(), bad.triangles.end(), mesh->triangles().begin()));
  CHECK(mesh->triangleCount() == bad.triangles.size());
}

TEST_CASE("welding merges equal positions and keeps the triangles") {
  const MeshArrays sphere = makeSphere(1, 2);
  const MeshArrays soup = soupOf(sphere);
  const MeshResult result = buildTriMesh(soup.input(), only(&RepairOptions::weldVertices));
  REQUIRE(result.mesh);
  CHECK(result.mesh->vertices().size() == sphere.vertices.size());
  CHECK(result.report.vertices == sphere.vertices.size());
  CHECK(result.report.repair.weldedVertices == soup.vertices.size() - sphere.vertices.size());
  CHECK(result.report.repair.messages.size() == 1);
  bool same = true;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      same &= result.mesh->vertices()[result.mesh->triangles()[t].v[k]] == soup.vertices[soup.triangles[t].v[k]];
  CHECK(same);
}

TEST_CASE("degenerate and duplicate triangles are dropped, in this order") {
  MeshArrays bad = makeBox({1, 1, 1});
  bad.triangles.insert(bad.triangles.begin() + 3, Triangle{{1, 1, 2}});
  const Triangle t = bad.triangles[7];
  bad.triangles.push_back({{t.v[2], t.v[1], t.v[0]}});
  bad.vertices.push_back({0, 0, 0});
  bad.vertices.push_back({0.25f, 0, 0});
  bad.vertices.push_back({-0.25f, 0, 0});
  bad.triangles.push_back({{8, 9, 10}});
  bad.triangles.push_back({{8, 9, 10}});
  RepairOptions options;
  options.dropDegenerate = options.dropDuplicates = true;
  const MeshResult result = buildTriMesh(bad.input(), options);
  REQUIRE(result.mesh);
  CHECK(result.report.solid);
  CHECK(result.report.valid());
  CHECK(result.report.repair.droppedDegenerate == 3);
  CHECK(result.report.repair.droppedDuplicates == 1);
  CHECK(result.report.repair.messages.size() == 2);
  const MeshArrays box = makeBox({1, 1, 1});
  CHECK(std::equal(box.triangles.begin(), box.triangles.end(), result.mesh->triangles().begin(),
                   result.mesh->triangles().end()));
}

TEST_CASE("randomly wound solids become outward solids again") {
  const MeshArrays solids[] = {makeBox({1, 2, 3}, 3), makeSphere(1, 3), makeTorus(2, 0.5, 20, 12),
                               makeNut(8, 2, 6, 0.1, 24)};
  for (const MeshArrays& solid : solids) {
    const auto good = build(solid);
    for (std::uint32_t seed = 0; seed < 3; ++seed) {
      const MeshArrays shuffled = shuffledWinding(solid, seed);
      std::size_t wrong = 0;
      for (std::size_t t = 0; t < solid.triangles.size(); ++t) wrong += solid.triangles[t] != shuffled.triangles[t];
      const MeshResult result = buildTriMesh(shuffled.input(), only(&RepairOptions::orientConsistently));
      REQUIRE(result.mesh);
      CHECK(result.report.solid);
      CHECK(result.report.repair.flippedTriangles == wrong);
      CHECK(result.mesh->massProperties().volume == Approx(good->massProperties().volume));
    }
  }
}

TEST_CASE("cavities and islands are oriented by their depth") {
  const MeshArrays nested = merge({makeSphere(1, 2), makeSphere(3, 2), makeSphere(2, 2)});
  const MeshResult result = buildTriMesh(shuffledWinding(nested, 5).input(), RepairOptions::all());
  REQUIRE(result.mesh);
  CHECK(result.report.solid);
  const double unit = build(makeSphere(1, 2))->massProperties().volume;
  CHECK(result.mesh->massProperties().volume == Approx((27 - 8 + 1) * unit));
  CHECK(result.mesh->topology().componentVolume[2] == Approx(-8 * unit));
}

TEST_CASE("open patches take the winding of their majority") {
  MeshArrays open = makeSphere(1, 3);
  open.triangles.resize(open.triangles.size() / 2);
  MeshArrays few = open;
  for (std::size_t t = 0; t < few.triangles.size(); t += 7) flip(few.triangles[t]);
  const MeshResult result = buildTriMesh(few.input(), only(&RepairOptions::orientConsistently));
  REQUIRE(result.mesh);
  CHECK(result.report.oriented);
  CHECK(std::equal(open.vertices.begin(), open.vertices.end(), result.mesh->vertices().begin()));
  double agreement = 0;  // all normals of a part of a sphere about the origin still point away from it
  for (const Triangle& t : result.mesh->triangles()) {
    const Vec3f &a = open.vertices[t.v[0]], &b = open.vertices[t.v[1]], &c = open.vertices[t.v[2]];
    agreement += otgDot(a, otgCross(otgSub(b, a), otgSub(c, a))) > 0 ? 1 : 0;
  }
  CHECK(agreement == static_cast<double>(open.triangles.size()));
}

TEST_CASE("a Moebius strip cannot be oriented, and the report still says so") {
  MeshArrays strip;
  const int n = 12;
  for (int i = 0; i < n; ++i) {
    const double u = 6.283185307179586 * i / n, half = u / 2;
    for (const double w : {-0.3, 0.3})
      strip.vertices.push_back({static_cast<float>((1 + w * std::cos(half)) * std::cos(u)),
                                static_cast<float>((1 + w * std::cos(half)) * std::sin(u)),
                                static_cast<float>(w * std::sin(half))});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool seam = i + 1 == n;
    const std::uint32_t a = 2 * i, b = a + 1, c = seam ? 1 : a + 2, d = seam ? 0 : a + 3;
    strip.triangles.push_back({{a, c, d}});
    strip.triangles.push_back({{a, d, b}});
  }
  const MeshResult result = buildTriMesh(strip.input(), RepairOptions::all());
  REQUIRE(result.mesh);
  CHECK_FALSE(result.report.oriented);
  CHECK(result.report.inconsistentEdges == 1);
  CHECK(result.report.manifold);
  CHECK(result.report.boundaryEdges == 2 * n);
}

TEST_CASE("all repairs together make a solid of a bad soup") {
  MeshArrays soup = soupOf(shuffledWinding(makeTorus(2, 0.5, 24, 12), 9));
  for (int i = 0; i < 10; ++i) soup.triangles.push_back(soup.triangles[static_cast<std::size_t>(31 * i)]);
  soup.triangles.push_back({{5, 5, 9}});
  const MeshResult result = buildTriMesh(soup.input(), RepairOptions::all());
  REQUIRE(result.mesh);
  CHECK(result.report.valid());
  CHECK(result.report.solid);
  CHECK(result.report.repair.droppedDuplicates == 10);
  CHECK(result.report.repair.droppedDegenerate == 1);
  CHECK(result.report.repair.messages.size() == 4);
}

TEST_CASE("zero-area triangles that close a surface are removed without tearing it") {
  // A vertex in the middle of a box's edge that only one of the two faces knows: a T-junction, closed by a sliver.
  for (const bool shuffle : {false, true}) {
    MeshArrays box = makeBox({1, 1, 1});
    std::size_t t = 0;
    while (!(box.triangles[t].v[0] == 0 || box.triangles[t].v[1] == 0)) ++t;
    const Triangle old = box.triangles[t];
    const Vec3f &a = box.vertices[old.v[0]], &b = box.vertices[old.v[1]];
    box.vertices.push_back(otgScale(otgAdd(a, b), 0.5f));
    box.triangles[t] = {{old.v[0], 8, old.v[2]}};
    box.triangles.push_back({{8, old.v[1], old.v[2]}});
    box.triangles.push_back({{old.v[0], old.v[1], 8}});
    REQUIRE(build(box)->report().solid);
    REQUIRE(build(box)->report().degenerateTriangles == 1);
    const MeshArrays input = shuffle ? shuffledWinding(box, 4) : box;
    const MeshResult result = buildTriMesh(input.input(), RepairOptions::all());
    CHECK(result.report.valid());
    CHECK(result.report.triangles == 14);
    CHECK(result.report.repair.splitDegenerate == 1);
    CHECK(result.report.repair.droppedDegenerate == 0);
    CHECK(result.mesh->massProperties().volume == Approx(1));
    CHECK(result.mesh->massProperties().area == Approx(6));
  }
}

TEST_CASE("stacks of zero-area triangles are taken apart layer by layer") {
  // The edge a-b of a tetrahedron, divided by seven points on one side and by nested slivers filled up on the other.
  MeshArrays mesh = makeTetrahedron({0, 0, 0}, {8, 0, 0}, {0, 4, 0}, {0, 0, 4});
  const auto index = [&](Vec3f p) {
    return static_cast<std::uint32_t>(std::find(mesh.vertices.begin(), mesh.vertices.end(), p) - mesh.vertices.begin());
  };
  const std::uint32_t a = index({0, 0, 0}), b = index({8, 0, 0});
  const auto side = std::find_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
    return std::count(t.v, t.v + 3, a) == 1 && std::count(t.v, t.v + 3, b) == 1;
  });
  REQUIRE(side != mesh.triangles.end());
  while (side->v[2] == a || side->v[2] == b) std::rotate(side->v, side->v + 1, side->v + 3);
  const Triangle face = *side;
  std::vector<std::uint32_t> on = {face.v[0]};
  for (int i = 1; i < 8; ++i) {
    on.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back({static_cast<float>(face.v[0] == a ? i : 8 - i), 0, 0});
  }
  on.push_back(face.v[1]);
  mesh.triangles.erase(side);
  for (int i = 0; i < 8; ++i) mesh.triangles.push_back({{on[i], on[i + 1], face.v[2]}});
  for (int step = 8; step > 1; step /= 2)
    for (int i = 0; i < 8; i += step) mesh.triangles.push_back({{on[i], on[i + step], on[i + step / 2]}});
  REQUIRE(build(mesh)->report().solid);
  REQUIRE(build(mesh)->report().degenerateTriangles == 7);
  const MeshResult result = buildTriMesh(mesh.input(), only(&RepairOptions::dropDegenerate));
  CHECK(result.report.valid());
  CHECK(result.report.repair.splitDegenerate == 7);
  CHECK(result.mesh->massProperties().volume == Approx(8.0 * 4 * 4 / 6));
}
