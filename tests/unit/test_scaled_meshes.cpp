// SPDX-License-Identifier: BSD-3-Clause
// Scaled images of a mesh with the mesh's trees: boxes that hold what they should, in exact arithmetic, and queries
// that find what they find in a mesh built from the scaled vertices.
#include <algorithm>
#include <cmath>
#include <memory_resource>

#include "base/vectors.h"
#include "bvh/collision_mesh.h"
#include "bvh/image_boxes.h"
#include "collide/mesh_ray.h"
#include "collide/simd/wide_kernels.h"
#include "queries/closest_point.h"
#include "queries/mesh_distance.h"
#include "queries/mesh_overlap.h"
#include "support/catch.h"
#include "support/mesh_samples.h"

using namespace otg;
using namespace otg::samples;

namespace {

/// With a tree of its own, and the same numbers of triangles.
std::unique_ptr<CollisionMesh> builtFrom(const TriMesh& mesh) {
  MeshInput input;
  input.vertices = mesh.vertices().data();
  input.vertexCount = mesh.vertices().size();
  input.indices = mesh.triangles().data();
  input.triangleCount = mesh.triangleCount();
  return std::make_unique<CollisionMesh>(buildTriMesh(input).mesh, BuildStrategy::kMeanSplit);
}

void take(const BoxScale<float>& scale, Vec3f& center, Vec3f& extent) {
  const BoxOf box = scaledBox(scale, center, extent);
  center = box.center;
  extent = box.extent;
}

BinaryTree taken(BinaryTree tree, const BoxScale<float>& scale) {
  for (BvhNode& node : tree.nodes) take(scale, node.center, node.extent);
  return tree;
}
NoLeafTree taken(NoLeafTree tree, const BoxScale<float>& scale) {
  for (NoLeafNode& node : tree.nodes) take(scale, node.center, node.extent);
  return tree;
}
WideTree taken(WideTree tree, const BoxScale<float>& scale) {
  for (WideNode& node : tree.nodes) {
    for (std::uint32_t k = 0; k < kWideArity; ++k) {
      Vec3f center{node.centerX[k], node.centerY[k], node.centerZ[k]};
      Vec3f extent{node.extentX[k], node.extentY[k], node.extentZ[k]};
      take(scale, center, extent);
      setBox(node, k, center, extent);
    }
  }
  return tree;
}
/// As a binary tree, which has the same numbers of nodes.
BinaryTree taken(const QuantizedTree& tree, BinaryTree binary, const BoxScale<float>& scale) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const QuantizedNode& q = tree.nodes[i];
    BvhNode& node = binary.nodes[i];
    node.center = {q.center[0] * tree.centerStep.x, q.center[1] * tree.centerStep.y, q.center[2] * tree.centerStep.z};
    node.extent = {q.extent[0] * tree.extentStep.x, q.extent[1] * tree.extentStep.y, q.extent[2] * tree.extentStep.z};
    take(scale, node.center, node.extent);
  }
  return binary;
}

/// The first box of any layout that does not hold its triangles; "" where all do.
std::string badBox(const CollisionMesh& mesh, const TriMesh& image, const BoxScale<float>& scale) {
  for (const std::string& error :
       {validateTree(taken(mesh.tree(), scale), image),
        validateTree(taken(mesh.quantized(), mesh.tree(), scale), image),
        validateLayout(taken(mesh.noLeaf(), scale), image), validateLayout(taken(mesh.wide(), scale), image)}) {
    if (!error.empty()) return error;
  }
  return {};
}

std::vector<NamedMesh> sampleMeshes() {
  std::vector<NamedMesh> meshes = ordinaryMeshes();
  for (NamedMesh& mesh : pathologicalMeshes()) {
    if (mesh.mesh->triangleCount() <= 20000) meshes.push_back(std::move(mesh));
  }
  // Points and flat triangles, whose boxes have nothing to spare, about an origin that is far away along one axis.
  Soup flat;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 3000; ++i) {
    const Vec3f p{300 + unit(random), unit(random), 1e-3f * unit(random)};
    flat.add(p, i % 2 == 0 ? p : Vec3f{p.x, p.y + unit(random), p.z}, {p.x, p.y, p.z});
  }
  meshes.push_back({"points and needles", flat.build()});
  return meshes;
}

std::vector<Vec3f> sampleScales(std::mt19937& random) {
  std::vector<Vec3f> scales = {{1, 1, 1},     {2, 0.5f, 1},           {-1, 1, 1},     {1, 1, 10},
                               {10, 1, 0.1f}, {-3, -3, -3},           {1e-20f, 1, 1}, {1e-30f, 1e-30f, 2e-30f},
                               {1e20f, 1, 1}, {1e30f, 1e30f, -1e30f}, {1e-44f, 1, 1}, {0.1f, 0.3f, 0.7f}};
  std::uniform_real_distribution<float> mantissa(1, 2);
  std::uniform_int_distribution<int> near(-2, 2), far(-60, 60), sign(0, 1);
  const auto draw = [&](auto& exponent) {
    return (sign(random) ? -1.0f : 1.0f) * std::ldexp(mantissa(random), exponent(random));
  };
  for (int i = 0; i < 12; ++i) scales.push_back({draw(near), draw(near), draw(near)});
  for (int i = 0; i < 6; ++i) scales.push_back({draw(far), draw(far), draw(far)});
  return scales;
}

bool isModerate(const Vec3f& s) {
  return std::max({std::abs(s.x), std::abs(s.y), std::abs(s.z)}) <= 16 &&
         std::min({std::abs(s.x), std::abs(s.y), std::abs(s.z)}) >= 1.0f / 16;
}

std::vector<TrianglePair> pairsOf(const CollisionMesh& a, const CollisionMesh& b, const Transformd& pose,
                                  Traversal traversal, DescentRule descent, int axes) {
  Query query;
  query.a = &a;
  query.b = &b;
  query.bInA = pose;
  query.options.middle = {traversal, descent, axes};
  Workspace workspace;
  findIntersectingPairs(query, workspace);
  std::vector<TrianglePair> pairs = workspace.intersecting;
  std::sort(pairs.begin(), pairs.end(),
            [](const TrianglePair& x, const TrianglePair& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
  return pairs;
}

bool samePairs(const std::vector<TrianglePair>& x, const std::vector<TrianglePair>& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [](const TrianglePair& p, const TrianglePair& q) { return p.a == q.a && p.b == q.b; });
}

Vec3d middleOf(const TriMesh& mesh) {
  return {mesh.center().x, mesh.center().y, mesh.center().z};
}

}  // namespace

TEST_CASE("boxes of a mesh become boxes that hold its scaled image, in every layout") {
  std::mt19937 random(3);
  int shared = 0, refused = 0;
  for (const NamedMesh& sample : sampleMeshes()) {
    const CollisionMesh mesh(sample.mesh, BuildStrategy::kSah);
    // A thousand steps of float across, at least.
    const double farthest = std::max({std::abs(sample.mesh->boundsMin().x), std::abs(sample.mesh->boundsMax().x),
                                      std::abs(sample.mesh->boundsMin().y), std::abs(sample.mesh->boundsMax().y)});
    const bool ordinary =
        sample.mesh->radius() > 1e-3f && sample.mesh->radius() < 1e6f && sample.mesh->radius() > 1e-4 * farthest;
    for (const Vec3f& by : sampleScales(random)) {
      INFO(sample.name << " times " << by.x << " " << by.y << " " << by.z);
      const MeshPtr image = scaledMesh(*sample.mesh, by);
      if (image == nullptr) continue;
      const std::optional<BoxScale<float>> scale = makeBoxScale(*sample.mesh, *image, by);
      if (!scale) {
        CHECK_FALSE((ordinary && isModerate(by)));
        ++refused;
        continue;
      }
      ++shared;
      REQUIRE(badBox(mesh, *image, *scale) == "");
      // And not much more: the boxes cost what the image's own ones do.
      if (!ordinary || !isModerate(by) || sample.mesh->triangleCount() < 2) continue;
      BinaryTree own = mesh.tree();
      refitTree(own, *image);
      CHECK(sahCost(mesh.tree(), *scale) <= (sample.name == "points and needles" ? 1.1 : 1.0001) * sahCost(own));
    }
  }
  INFO(shared << " shared, " << refused << " refused");
  CHECK(shared > 350);
  CHECK(refused > 50);
}

TEST_CASE("an image has the trees of its mesh, but where these would not do") {
  const CollisionMesh mesh(scenes::build(scenes::makeLump(1, 3, 0.3, 2)), BuildStrategy::kSah);
  const auto hasOwn = [&](const Vec3f& by) {
    const CollisionMesh image(scaledMesh(mesh.mesh(), by), mesh, by);
    CHECK((image.boxScale() == nullptr) == (&image.wide() != &mesh.wide()));
    CHECK((image.boxScale() == nullptr) == (&image.tree() != &mesh.tree()));
    CHECK(validateTree(image.ownBoxes(), image.mesh()) == "");
    return image.boxScale() == nullptr;
  };
  CHECK_FALSE(hasOwn({2, 1, 0.5f}));
  CHECK_FALSE(hasOwn({-1, 1, 1}));
  CHECK_FALSE(hasOwn({1, 16, 16}));
  CHECK_FALSE(hasOwn({1e20f, -1e20f, 2e20f}));
  CHECK(hasOwn({1, 1, 17}));
  CHECK(hasOwn({-0.1f, 2, 1}));
  CHECK(hasOwn({1.5e38f, 1.5e38f, 1.5e38f}));
  CHECK(hasOwn({1e-40f, 1e-40f, 1e-40f}));
  // Few steps of float across: most of a box would be rounding.
  const CollisionMesh far(randomSoup(2, 300, 1.0f, 0.5f, {1e7f, 0, 0}), BuildStrategy::kSah);
  const Vec3f by{1.1f, 1, 1};
  CHECK(CollisionMesh(scaledMesh(far.mesh(), by), far, by).boxScale() == nullptr);
}

TEST_CASE("scaled images meet the triangles that meshes of scaled vertices meet, by every traversal") {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  const CollisionMesh lump(scenes::build(scenes::makeLump(1, 2, 0.3, 2)), BuildStrategy::kSah);
  const CollisionMesh torus(scenes::build(scenes::makeTorus(1, 0.4, 20, 12)), BuildStrategy::kSah);
  const CollisionMesh away(randomSoup(5, 300, 1.0f, 0.3f, {40, -7, 3}), BuildStrategy::kSah);
  std::size_t met = 0, points = 0, overlaps = 0;
  int images = 0;
  for (const CollisionMesh* mesh : {&lump, &torus, &away}) {
    for (const Vec3f& by : sampleScales(random)) {
      INFO("times " << by.x << " " << by.y << " " << by.z);
      const MeshPtr moved = scaledMesh(mesh->mesh(), by);
      if (moved == nullptr) continue;
      const CollisionMesh image(moved, *mesh, by);
      const std::unique_ptr<CollisionMesh> built = builtFrom(*moved);
      images += image.boxScale() != nullptr;
      const Vec3d middle = middleOf(*moved);
      const double reach = moved->radius();
      const int poses = isModerate(by) ? 8 : 2;  // what is pressed flat takes long: all of it lies in one plane
      for (int i = 0; i < poses; ++i) {
        // With a copy of itself, with the mesh as it is in the image's size, and as the second of a pair.
        Transformd pose{{1, 0, 0, 0, 0.6, -0.8, 0, 0.8, 0.6}, {}};
        pose.t = otgSub(middle, otgRotate(pose, middle));
        pose.t = otgAdd(pose.t, otgScale(Vec3d{unit(random), unit(random), unit(random)}, 0.6 * reach));
        const auto traversal = static_cast<Traversal>((poses == 8 ? i : images + i) % 4);
        const auto descent = static_cast<DescentRule>(i / 2);
        const int axes = i % 3 == 0 ? 15 : 6;
        const auto wanted = pairsOf(*built, *built, pose, Traversal::kStandard, DescentRule::kLargerFirst, 6);
        REQUIRE(samePairs(pairsOf(image, image, pose, traversal, descent, axes), wanted));
        REQUIRE(samePairs(pairsOf(image, *built, pose, traversal, descent, axes), wanted));
        REQUIRE(samePairs(pairsOf(*built, image, pose, traversal, descent, axes), wanted));
        met += wanted.size();

        Query query, other;
        query.a = query.b = &image;
        other.a = other.b = built.get();
        query.bInA = other.bInA = pose;
        overlaps += overlap(query);
        REQUIRE(overlap(query) == overlap(other));
        const double infinity = std::numeric_limits<double>::infinity();
        const MeshDistance apart = meshDistance(query, infinity), apartToo = meshDistance(other, infinity);
        REQUIRE(apart.distance == apartToo.distance);

        const Vec3d point = otgAdd(middle, otgScale(Vec3d{unit(random), unit(random), unit(random)}, 1.3 * reach));
        const SurfacePoint near = closestPoint(image, point), nearToo = closestPoint(*built, point);
        REQUIRE(near.triangle == nearToo.triangle);
        REQUIRE(near.distance == nearToo.distance);
        std::pmr::vector<SurfacePoint> within, withinToo;
        trianglesWithin(image, point, 1.2 * near.distance, within);
        trianglesWithin(*built, point, 1.2 * near.distance, withinToo);
        const auto numbers = [](const std::pmr::vector<SurfacePoint>& found) {
          std::vector<std::uint32_t> triangles;
          for (const SurfacePoint& p : found) triangles.push_back(p.triangle);
          std::sort(triangles.begin(), triangles.end());
          return triangles;
        };
        REQUIRE(numbers(within) == numbers(withinToo));
        points += within.size();
        if (reach > 1e29) continue;  // rays are not for meshes of that size
        const Vec3d to = otgAdd(middle, otgScale(Vec3d{unit(random), unit(random), unit(random)}, 0.3 * reach));
        const Vec3d toward = otgSub(to, point);
        const auto hits = [&](const CollisionMesh& tree) {
          std::vector<std::pair<std::uint32_t, double>> all;
          double limit = infinity;
          forEachRayHit(tree, {point, otgScale(toward, 1 / norm(toward))}, limit,
                        [&](std::uint32_t t, double distance, bool) { all.emplace_back(t, distance); });
          std::sort(all.begin(), all.end());
          return all;
        };
        const auto found = hits(image);
        REQUIRE(found == hits(*built));
        points += found.size();
      }
    }
  }
  CHECK(images > 40);
  CHECK(met > 10000);
  CHECK(overlaps > 100);
  CHECK(points > 1000);
}

TEST_CASE("instruction sets agree bit for bit on scaled boxes") {
  const CollisionMesh torus(scenes::build(scenes::makeTorus(1.0, 0.4, 61, 29)), BuildStrategy::kSah);
  const CollisionMesh lump(scenes::build(scenes::makeLump(0.9, 4, 0.2, 7)), BuildStrategy::kSah);
  const Vec3f by{-1.3f, 0.7f, 2.1f};
  const CollisionMesh image(scaledMesh(lump.mesh(), by), lump, by);
  REQUIRE(image.boxScale() != nullptr);
  std::size_t candidates = 0;
  for (const auto& [a, b] : {std::pair{&image, &torus}, {&torus, &image}, {&image, &image}}) {
    for (const int axes : {6, 15}) {
      Query query;
      query.a = a;
      query.b = b;
      query.bInA = {{0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}, {0.4, 0.2, 0.1}};
      query.options.middle.axes = axes;
      const PairFrame frame = makePairFrame(query);
      std::vector<TrianglePair> expected;
      CollideStats stats;
      traverseWide(SimdLevel::kBaseline, query, frame, expected, stats);
      candidates += expected.size();
      for (const SimdLevel level : {SimdLevel::kAvx2, SimdLevel::kAvx512}) {
        if (bestSimdLevel() < level) continue;
        std::vector<TrianglePair> found;
        CollideStats other;
        traverseWide(level, query, frame, found, other);
        REQUIRE(found == expected);
        REQUIRE(other.boxTests == stats.boxTests);
      }
    }
  }
  CHECK(candidates > 10000);
}

TEST_CASE("images follow the moves of their mesh, also when its tree is built anew or somebody holds one of them") {
  const auto ofArrays = [](const scenes::MeshArrays& arrays) {
    MeshResult built = buildTriMesh(arrays.input(), {}, MeshOrder::kLocal);
    return std::make_unique<CollisionMesh>(std::move(built.mesh), BuildStrategy::kSah);
  };
  const auto mesh = ofArrays(scenes::makeSphere(1, 4));
  const std::vector<Vec3f> rest(mesh->mesh().vertices().begin(), mesh->mesh().vertices().end());
  const Vec3f factors[] = {{2, 1, 0.5f}, {-1, 1, 3}, {0.3f, -0.4f, 0.5f}};
  std::vector<std::unique_ptr<CollisionMesh>> images;
  for (const Vec3f& by : factors) {
    MeshPtr moved = scaledMesh(mesh->mesh(), by);
    images.push_back(std::make_unique<CollisionMesh>(std::move(moved), *mesh, by));
    REQUIRE(images.back()->boxScale() != nullptr);
  }
  int rebuilt = 0, own = 0, copied = 0;
  for (int step = 1; step <= 25; ++step) {
    INFO("step " << step);
    for (const CollisionMesh* m : {mesh.get(), images[0].get()}) {  // all layouts are there
      m->quantized();
      m->noLeaf();
      m->wide();
      m->adjacency();
    }
    // All vertices, so that the tree wears out, or a few.
    std::vector<MovedVertex> moved;
    for (std::uint32_t v = 0; v < rest.size(); v += step % 3 == 0 ? 100 : 1) {
      const float angle = 0.4f * static_cast<float>(step) * rest[v].z, c = std::cos(angle), s = std::sin(angle);
      moved.push_back({v, {rest[v].x * c - rest[v].y * s, rest[v].x * s + rest[v].y * c, rest[v].z}});
    }
    // Another image that does not move, and has to find the boxes as they were.
    std::unique_ptr<CollisionMesh> held;
    if (step % 4 == 0)
      held = std::make_unique<CollisionMesh>(scaledMesh(mesh->mesh(), {1, 2, 1}), *mesh, Vec3f{1, 2, 1});
    std::vector<std::weak_ptr<const void>> structures;
    for (const auto& image : images)
      structures.push_back(image->boxScale() == nullptr ? std::weak_ptr<const void>() : image->structure());
    const std::weak_ptr<const void> structure = mesh->structure();
    const BinaryTree* const before = &mesh->tree();
    long sharing = 0;
    for (const auto& image : images) sharing += image->boxScale() != nullptr;
    REQUIRE(mesh->beginMove(moved, sharing));
    std::vector<std::vector<MovedVertex>> scaled;
    for (std::size_t i = 0; i < images.size(); ++i) {
      std::vector<MovedVertex>& there = scaled.emplace_back(moved);
      for (MovedVertex& m : there) m.to = {m.to.x * factors[i].x, m.to.y * factors[i].y, m.to.z * factors[i].z};
      REQUIRE((images[i]->boxScale() == nullptr ? images[i]->beginMove(there) : images[i]->followMove(*mesh, there)));
    }
    if (step % 5 == 0) {  // and back again
      for (const auto& image : images) image->undoMove();
      mesh->undoMove();
      CHECK(&mesh->tree() == before);
    } else {
      mesh->finishMove();
      for (const auto& image : images) image->finishMove();
      copied += &mesh->tree() != before;
      CHECK((&mesh->tree() != before) == (held != nullptr && held->boxScale() != nullptr));
    }
    rebuilt += structure.expired();
    for (std::size_t i = 0; i < images.size(); ++i) {
      const CollisionMesh& image = *images[i];
      CHECK((image.boxScale() == nullptr) == (&image.tree() != &mesh->tree()));
      own += image.boxScale() == nullptr;
      if (structure.expired()) CHECK(structures[i].expired());
      REQUIRE(badBox(image, image.mesh(), image.anyBoxScale()) == "");
      const MeshPtr wanted = scaledMesh(mesh->mesh(), factors[i]);
      REQUIRE(std::ranges::equal(wanted->vertices(), image.mesh().vertices()));
    }
    REQUIRE(badBox(*mesh, mesh->mesh(), kSameBoxes) == "");
    if (held != nullptr) REQUIRE(badBox(*held, held->mesh(), held->anyBoxScale()) == "");
    // What devices hear of: all triangles whose boxes are others now.
    if (step % 5 != 0 && !structure.expired() && images[2]->boxScale() != nullptr && step % 3 == 0) {
      CHECK(images[2]->changedSince(images[2]->moves() - 1) == mesh->changedSince(mesh->moves() - 1));
    }
  }
  CHECK(rebuilt >= 1);
  CHECK(copied >= 4);
  INFO(own);
}

TEST_CASE("an image in which points have met by rounding knows so when one of them moves") {
  // Triangles with corners a step of float apart, where steps of the image are twice as long.
  Soup soup;
  for (int i = 0; i < 40; ++i) {
    const float x = 1.85f + 0.001f * static_cast<float>(i), y = 0.1f * static_cast<float>(i);
    const float next = std::nextafter(x, 2.0f);
    soup.add({x, y, 0}, {1, y, 0}, {1, y + 0.05f, 1});
    soup.add({next, y, 0}, {1, y + 0.05f, -1}, {1, y, -2});
  }
  const MeshPtr arrays = soup.build();
  const Vec3f by{1.1f, 1, 1};
  int met = 0;
  for (std::uint32_t v = 0; v < arrays->vertices().size(); v += 6) {
    auto mesh =
        std::make_unique<CollisionMesh>(scenes::build({{arrays->vertices().begin(), arrays->vertices().end()},
                                                       {arrays->triangles().begin(), arrays->triangles().end()}}),
                                        BuildStrategy::kSah);
    auto image = std::make_unique<CollisionMesh>(scaledMesh(mesh->mesh(), by), *mesh, by);
    REQUIRE(image->boxScale() != nullptr);
    const bool meet = image->mesh().vertices()[v] == image->mesh().vertices()[v + 3];
    met += meet;
    const Vec3f& at = mesh->mesh().vertices()[v];
    const Vec3f to{at.x, at.y + 0.01f, at.z};
    REQUIRE(mesh->beginMove(std::vector<MovedVertex>{{v, to}}, 1));
    CHECK(image->followMove(*mesh, std::vector<MovedVertex>{{v, {to.x * by.x, to.y, to.z}}}) == !meet);
    mesh->finishMove();
    if (!meet) image->finishMove();
  }
  CHECK(met > 5);
  CHECK(met < 35);
}
