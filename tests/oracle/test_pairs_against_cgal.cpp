// SPDX-License-Identifier: BSD-3-Clause
// Sets of intersecting triangle pairs of generated meshes against CGAL's: not one pair more or less.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "oracle/pair_checks.h"
#include "scenes/generated_meshes.h"
#include "support/draw.h"

using namespace otg;
using namespace otg::scenes;
using namespace otg::test;

namespace {

constexpr double kPi = std::numbers::pi;

BothTrees trees(const MeshArrays& arrays) {
  return BothTrees(build(arrays));
}

/// A pose in which the two meshes' bounding spheres overlap.
Transformd overlappingPose(Draw& draw, const TriMesh& a, const TriMesh& b) {
  Transformd pose = makePose(draw.direction(), draw.uniform(-kPi, kPi), {0, 0, 0});
  const double reach = draw.uniform(0, 0.9) * (double{a.radius()} + b.radius());
  const Vec3d target = otgAdd(Vec3d{a.center().x, a.center().y, a.center().z}, otgScale(draw.direction(), reach));
  pose.t = otgSub(target, otgTransform(pose, Vec3d{b.center().x, b.center().y, b.center().z}));
  return pose;
}

MeshArrays scaledAndMoved(MeshArrays mesh, float scale, const Vec3f& move) {
  for (Vec3f& v : mesh.vertices) v = otgAdd(otgScale(v, scale), move);
  return mesh;
}

/// Triangles with small integer corners: shared points, overlapping edges and common planes in abundance.
MeshArrays latticeSoup(Draw& draw, std::uint32_t triangles, std::uint32_t size) {
  MeshArrays soup;
  for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
    soup.vertices.push_back({static_cast<float>(draw.below(size)), static_cast<float>(draw.below(size)),
                             static_cast<float>(draw.below(size))});
  }
  for (std::uint32_t i = 0; i < triangles; ++i) soup.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  return soup;
}

}  // namespace

TEST_CASE("random poses of generated meshes") {
  const std::vector<BothTrees> meshes = {
      trees(makeBox({1, 0.8, 0.6}, 3)),         trees(makeSphere(0.7, 3)),
      trees(makeTorus(0.8, 0.3, 32, 16)),       trees(makeLump(0.8, 3, 0.2, 4)),
      trees(makeGear(14, 0.7, 0.15, 0.3, 0.2)), trees(makeBowl(0.8, 0.1, 24, 8)),
      trees(makeCylinder(0.3, 1.6, 20, 4)),     trees(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}))};
  Draw draw(1);
  std::size_t pairs = 0, poses = 0;
  for (const BothTrees& a : meshes) {
    for (const BothTrees& b : meshes) {
      for (int round = 0; round < 12; ++round) {
        pairs += checkPose(a, b, overlappingPose(draw, a.mesh(), b.mesh()), draw.below(kVariants));
        ++poses;
      }
    }
  }
  CHECK(poses == 768);
  CHECK(pairs > 40000);
}

TEST_CASE("all traversals, descent rules, axes and build strategies at random poses") {
  const BothTrees torus = trees(makeTorus(0.8, 0.3, 40, 20)), lump = trees(makeLump(0.7, 3, 0.25, 9));
  const BothTrees bolt = trees(makeBolt(0.3, 0.1, 0.5, 24)), nut = trees(makeNut(0.3, 0.1, 0.2, 0.005, 24));
  Draw draw(2);
  std::size_t pairs = 0;
  for (int round = 0; round < 8; ++round) {
    pairs += checkPoseInAllVariants(torus, lump, overlappingPose(draw, torus.mesh(), lump.mesh()));
    pairs += checkPoseInAllVariants(bolt, nut, overlappingPose(draw, bolt.mesh(), nut.mesh()));
  }
  CHECK(pairs > 1000);
}

TEST_CASE("a mesh on itself") {
  const Transformd identity = makeMove({0, 0, 0});
  for (const MeshArrays& mesh :
       {makeBox({1, 1, 1}, 3), makeSphere(1, 2), makeTorus(1, 0.25, 16, 8), makeGear(9, 0.5, 0.1, 0.2, 0.1),
        makeBowl(1, 0.1, 12, 4), makeTetrahedron({0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1})}) {
    const BothTrees t = trees(mesh);
    const std::size_t pairs = checkPoseInAllVariants(t, t, identity);
    // Every triangle meets itself and the three across its edges.
    CHECK(pairs >= 4 * mesh.triangles.size());
    for (const double angle : {1e-16, 1e-9, 1e-7, 1e-5}) {
      checkPose(t, t, makePose({0.6, 0, 0.8}, angle, {0, 0, 0}), 0);
      checkPose(t, t, makeMove({angle, -angle, 0}), 0);
    }
  }
}

TEST_CASE("boxes stacked, side by side, edge on edge and corner on corner, at every quarter turn") {
  const BothTrees coarse = trees(makeBox({1, 1, 1}, 1)), fine = trees(makeBox({1, 1, 1}, 4));
  const BothTrees flat = trees(makeBox({2, 2, 0.25}, 4));
  std::size_t pairs = 0;
  for (const Vec3d move :
       {Vec3d{0, 0, 1}, Vec3d{0, 1, 1}, Vec3d{1, 1, 1}, Vec3d{0.5, 0.25, 1}, Vec3d{0.125, 0, 1}, Vec3d{0, 0, 0.5},
        Vec3d{0, 0, 1 + 0x1p-30}, Vec3d{0, 0, 1 - 0x1p-30}, Vec3d{0, 0, 1 - 0x1p-52}}) {
    for (unsigned turn = 0; turn < 24; turn += 5) {
      pairs += checkPose(coarse, fine, makeQuarterTurn(turn, move), turn);
      pairs += checkPose(fine, fine, makeQuarterTurn(turn, move), turn + 20);
    }
    pairs += checkPoseInAllVariants(coarse, coarse, makeMove(move));
  }
  for (unsigned turn = 0; turn < 24; ++turn)
    pairs += checkPose(flat, coarse, makeQuarterTurn(turn, {0, 0, 0.625}), turn);
  // Turns about z by angles that are not exact leave heights exact: coplanar faces with crossing edges.
  for (const double angle : {0.1, kPi / 6, kPi / 4, kPi / 2, 1.0}) {
    pairs += checkPoseInAllVariants(flat, fine, makePose({0, 0, 1}, angle, {0, 0, 0.625}));
    checkPose(flat, fine, makePose({0, 0, 1}, angle, {0, 0, 0.625 + 1e-15}), 0);
  }
  CHECK(pairs > 10000);
}

TEST_CASE("meshes aligned on one grid") {
  const BothTrees ground = trees(makeGround(8, 0.5, 16)), box = trees(makeBox({1, 1, 1}, 2));
  const BothTrees hilly = trees(makeGround(8, 0.5, 16, [](double x, double y) { return 0.25 * std::floor(x + y); }));
  const BothTrees peg = trees(makeBox({0.5, 0.5, 2}, 2)), block = trees(makeBlockWithHole({2, 2, 1}, 0.5));
  std::size_t pairs = 0;
  for (const double x : {0.0, 0.25, 0.5, 1.0, 3.5}) {
    for (const double z : {0.5, 0.25, 0.0}) {
      pairs += checkPose(ground, box, makeMove({x, 0.5 * x, z}), 3);
      pairs += checkPose(hilly, box, makeMove({x, -x, z}), 17);
      pairs += checkPose(box, hilly, makeQuarterTurn(7, {x, -x, z}), 34);
    }
  }
  pairs += checkPoseInAllVariants(block, peg, makeMove({0, 0, 0}));  // every side of the peg on a side of the hole
  pairs += checkPoseInAllVariants(block, peg, makeQuarterTurn(5, {0, 0, 0.25}));
  CHECK(pairs > 3000);
}

TEST_CASE("a corner on a face, on an edge, on a corner, and shared edges and faces") {
  const BothTrees box = trees(makeBox({1, 1, 1}, 2));
  const auto tetrahedron = [](const Vec3d& tip) {
    const Vec3d up[3] = {{1, 0.25, 1}, {-0.5, 1, 1}, {-0.5, -1, 1}};
    return trees(makeTetrahedron(tip, otgAdd(tip, up[0]), otgAdd(tip, up[1]), otgAdd(tip, up[2])));
  };
  CHECK(checkPoseInAllVariants(box, tetrahedron({0.125, 0.25, 0.5}), makeMove({0, 0, 0})) == 3);  // inside a triangle
  CHECK(checkPoseInAllVariants(box, tetrahedron({0.125, 0, 0.5}), makeMove({0, 0, 0})) == 6);     // on an inner edge
  CHECK(checkPoseInAllVariants(box, tetrahedron({0.125, 0.5, 0.5}), makeMove({0, 0, 0})) >= 6);   // on the rim
  CHECK(checkPoseInAllVariants(box, tetrahedron({0.5, 0.5, 0.5}), makeMove({0, 0, 0})) >= 9);     // on a corner
  CHECK(checkPoseInAllVariants(box, tetrahedron({0.125, 0.25, 0.5}), makeMove({0, 0, 0x1p-50})) == 0);
  CHECK(checkPoseInAllVariants(box, tetrahedron({0.125, 0.25, 0.5}), makeMove({0, 0, -0x1p-50})) == 3);

  const BothTrees one = trees(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  for (const BothTrees& other :
       {trees(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1})),         // a face
        trees(makeTetrahedron({0, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1})),        // an edge
        trees(makeTetrahedron({0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1})),       // a corner
        trees(makeTetrahedron({0.25, 0, 0}, {0.75, 0, 0}, {0, -1, 0}, {0, 0, -1})),  // part of an edge
        trees(makeTetrahedron({0.5, 0.5, 0}, {2, 2, 0}, {2, 1, 1}, {1, 2, 1}))}) {
    CHECK(checkPoseInAllVariants(one, other, makeMove({0, 0, 0})) > 0);
  }
}

TEST_CASE("soups of triangles on a small lattice") {
  Draw draw(3);
  std::size_t pairs = 0;
  for (unsigned round = 0; round < 24; ++round) {
    const BothTrees a = trees(latticeSoup(draw, 50, 3 + round % 3)), b = trees(latticeSoup(draw, 50, 3 + round % 3));
    const Vec3d move = {0.5 * draw.below(3), static_cast<double>(draw.below(2)), 0.25 * draw.below(5)};
    const Transformd pose = makeQuarterTurn(round, move);
    const std::vector<TrianglePair> expected = cgalPairs(a.mesh(), b.mesh(), pose);
    CHECK((pairsWithoutTrees(a, b, pose) == expected));
    for (unsigned variant = 0; variant < kVariants; ++variant) CHECK((pairsOf(a, b, pose, variant) == expected));
    pairs += expected.size();
  }
  CHECK(pairs > 2000);
}

TEST_CASE("small, large and far away") {
  Draw draw(4);
  const MeshArrays torus = makeTorus(0.8, 0.3, 24, 12), lump = makeLump(0.7, 2, 0.25, 5);
  std::size_t pairs = 0;
  for (const float scale : {1e-3f, 1.0f, 1e3f}) {
    for (const float far : {0.0f, 10.0f, 1e5f}) {
      const Vec3f move = {far * scale, -0.5f * far * scale, 0.25f * far * scale};
      const BothTrees a = trees(scaledAndMoved(torus, scale, move)), b = trees(scaledAndMoved(lump, scale, move));
      const BothTrees c = trees(scaledAndMoved(lump, 0.01f * scale, {0, 0, 0}));
      for (unsigned round = 0; round < 4; ++round) {
        pairs += checkPose(a, b, overlappingPose(draw, a.mesh(), b.mesh()), 16 * round + round);
        pairs += checkPose(a, c, overlappingPose(draw, a.mesh(), c.mesh()), 21 * round);
      }
      pairs += checkPose(a, a, makeMove({0, 0, 0}), 5);
    }
  }
  CHECK(pairs > 5000);
}

TEST_CASE("meshes that do not meet, and a mesh wholly inside another") {
  const BothTrees big = trees(makeSphere(1, 3)), small = trees(makeSphere(0.5, 2));
  CHECK(checkPoseInAllVariants(big, small, makeMove({0, 0, 0})) == 0);
  CHECK(checkPoseInAllVariants(big, small, makeMove({3, 0, 0})) == 0);
  CHECK(checkPoseInAllVariants(big, small, makeMove({0, 0, 0.75})) > 0);
}

TEST_CASE("a triangle far away leaves a small cube its pairs") {
  MeshArrays cube = makeBox({0.01, 0.01, 0.01}), pair = cube;
  for (MeshArrays* mesh : {&cube, &pair}) {
    const auto first = static_cast<std::uint32_t>(mesh->vertices.size());
    const float away = mesh == &cube ? 1e5f : -3e7f;
    for (const Vec3f& v : {Vec3f{away, 0, 0}, Vec3f{away, 1, 0}, Vec3f{away, 0, 1}}) mesh->vertices.push_back(v);
    mesh->triangles.push_back({{first, first + 1, first + 2}});
  }
  const BothTrees a = trees(cube), b = trees(pair), c = trees(makeBox({0.01, 0.01, 0.01}));
  CHECK(checkPoseInAllVariants(a, c, makeMove({0.005, 0.005, 0.005})) >= 18);
  CHECK(checkPoseInAllVariants(c, a, makePose({0, 1, 0}, 0.3, {0.005, 0.005, 0.005})) > 10);
  CHECK(checkPoseInAllVariants(a, b, makePose({0.6, 0.8, 0}, 0.7, {0.003, 0.001, 0.005})) > 10);
}

TEST_CASE("soups of needles") {
  Draw draw(5);
  std::size_t pairs = 0, poses = 0;
  const auto needles = [&](double thin) {
    MeshArrays soup;
    for (std::uint32_t i = 0; i < 24; ++i) {
      const Vec3d from = draw.inBox(1), along = draw.inBox(1), side = otgScale(draw.inBox(1), thin);
      const Vec3d to = otgAdd(from, along);
      const Vec3d tip = otgAdd(otgAdd(from, otgScale(along, draw.uniform(0, 1))), side);
      for (const Vec3d& p : {from, to, tip}) {
        soup.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
      }
      soup.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
    }
    return soup;
  };
  // In a plane every needle meets others; with a z of least bits they are nearly in one.
  const auto flattened = [&](MeshArrays soup, float z) {
    for (Vec3f& v : soup.vertices) v.z = z * static_cast<float>(draw.below(3));
    return soup;
  };
  for (const double thin : {1e-3, 1e-6, 1e-7, 3e-8, 0.0}) {
    for (int round = 0; round < 40; ++round) {
      const MeshArrays first = needles(thin), second = needles(thin);
      const float z = round % 4 == 0 ? 0 : round % 4 == 1 ? 1e-9f : 1e-45f;
      const BothTrees a = trees(round % 2 == 0 ? flattened(first, z) : first);
      const BothTrees b = trees(round % 2 == 0 ? flattened(second, z) : second);
      const Transformd pose = round % 3 == 0   ? makeMove({0, 0, 0})
                              : round % 3 == 1 ? makePose({0, 0, 1}, draw.uniform(-3, 3), {0.01, 0, 0})
                                               : makePose(draw.direction(), draw.uniform(-3, 3), draw.inBox(0.1));
      pairs += checkPose(a, b, pose, draw.below(kVariants));
      ++poses;
    }
  }
  CHECK(poses == 200);
  CHECK(pairs > 1000);
}

TEST_CASE("meshes from 1e-15 to 1e15 metres in all variants") {
  const MeshArrays sphere = makeSphere(1, 1), box = makeBox({1, 1.2, 0.8}, 2);
  std::size_t least = 1000;
  for (const float scale : {1e-15f, 1e-10f, 1e-5f, 1e5f, 1e12f, 4e12f, 1e13f, 1e15f}) {
    const BothTrees a = trees(scaledAndMoved(sphere, scale, {0, 0, 0}));
    const BothTrees b = trees(scaledAndMoved(box, scale, {0, 0, 0}));
    Transformd pose = makePose({0.6, 0, 0.8}, 0.5, otgScale(Vec3d{0.7, 0.4, 0.2}, double{scale}));
    least = std::min(least, checkPoseInAllVariants(a, b, pose));
  }
  CHECK(least > 20);
}

TEST_CASE("rotations with entries down to 1e-300") {
  Draw draw(6);
  std::size_t pairs = 0;
  for (int round = 0; round < 120; ++round) {
    // Faces of one plane but for parts of the matrix that no sum of single products sees.
    const BothTrees a = trees(latticeSoup(draw, 30, 4)), b = trees(latticeSoup(draw, 30, 4));
    Transformd pose = makeQuarterTurn(static_cast<unsigned>(round), {0, 0, static_cast<double>(draw.below(2))});
    for (double& r : pose.r) {
      if (r == 0 && draw.below(3) != 0)
        r = std::ldexp(draw.below(2) != 0 ? 1.25 : -1, -static_cast<int>(draw.below(470)) - 530);
    }
    if (draw.below(2) != 0) pose.t.x = std::ldexp(1.0, -1000);
    pairs += checkPose(a, b, pose, draw.below(kVariants));
  }
  CHECK(pairs > 1000);
}
