// SPDX-License-Identifier: BSD-3-Clause
// `otg bench build`: how long a mesh takes until it can collide.
#include <fmt/format.h>

#include "bvh/collision_mesh.h"
#include "cli/progress.h"
#include "cli/query_options.h"
#include "otg_bench/bench.h"
#include "otg_bench/moves.h"
#include "otg_bench/scales.h"
#include "scenes/generated_meshes.h"

namespace otg::cli {
namespace {

double validateMs(const TriMesh& mesh, int repeat) {
  MeshInput input;
  input.vertices = mesh.vertices().data();
  input.vertexCount = mesh.vertices().size();
  input.indices = mesh.triangles().data();
  input.triangleCount = mesh.triangleCount();
  return median(repeatTimes(repeat, [&] { return timeOnce([&] { buildTriMesh(input, {}, MeshOrder::kBySize); }); }));
}

std::string hashOfTree(const BinaryTree& tree) {
  Fnv1a hash;
  hash.add(tree.nodes.data(), tree.nodes.size() * sizeof(BvhNode));
  return hash.hex();
}

/// Some vertices moved back and forth by a ten-thousandth of the mesh's size.
std::vector<MovedVertex> shaken(const TriMesh& mesh, std::uint32_t first, std::uint32_t step, std::uint32_t count,
                                int round) {
  std::vector<MovedVertex> moved;
  const float by = (round % 2 == 0 ? 1e-4f : -1e-4f) * mesh.radius();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t v = first + i * step;
    moved.push_back({v, otgAdd(mesh.vertices()[v], Vec3f{by, 0, 0})});
  }
  return moved;
}

/// What a mesh costs whose vertices move, until it can collide again by the defaults (eight-wide tree, solids).
Json updateRow(const BenchMesh& entry, int repeat) {
  const auto input = [](const TriMesh& mesh, std::vector<Vec3f>& vertices) {
    vertices.resize(mesh.inputVertexCount());
    for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) vertices[mesh.callerVertex(v)] = mesh.vertices()[v];
    MeshInput in;
    in.vertices = vertices.data();
    in.vertexCount = vertices.size();
    return in;
  };
  const auto ready = [](const CollisionMesh& mesh) {
    mesh.wide();
    mesh.adjacency();
  };
  MeshInput own;
  own.vertices = entry.mesh->vertices().data();
  own.vertexCount = entry.mesh->vertices().size();
  own.indices = entry.mesh->triangles().data();
  own.triangleCount = entry.mesh->triangleCount();
  MeshResult built = buildTriMesh(own, {}, MeshOrder::kBySize);
  CollisionMesh mesh(std::move(built.mesh), BuildStrategy::kSah);
  built = {};
  ready(mesh);
  const auto vertices = static_cast<std::uint32_t>(mesh.mesh().vertices().size());
  const std::uint32_t some = std::max(1u, vertices / 100);
  std::vector<Vec3f> arrays;
  Json row;
  row["mesh"] = entry.name;
  row["triangles"] = mesh.mesh().triangleCount();
  row["vertices"] = vertices;
  row["moved"] = some;
  row["whole_ms"] = median(repeatTimes(repeat, [&] {
    const MeshInput all = input(mesh.mesh(), arrays);
    return timeOnce([&] {
      const MeshResult moved = moveVertices(mesh.mesh(), all);
      const CollisionMesh after(moved.mesh, mesh);
      ready(after);
    });
  }));
  int round = 0;
  const auto partial = [&](std::uint32_t first, std::uint32_t step, std::uint32_t count) {
    return timeOnce([&] {
      const auto moved = shaken(mesh.mesh(), first, step, count, round++);
      if (!mesh.moveSome(moved)) throw InputError(entry.name + ": its vertices cannot be moved in place");
    });
  };
  row["first_ms"] = partial(0, 1, 1);
  row["patch_ms"] = median(repeatTimes(2 * repeat, [&] { return partial(vertices / 3, 1, some); }));
  row["scattered_ms"] = median(repeatTimes(2 * repeat, [&] { return partial(0, vertices / some, some); }));
  row["one_ms"] = median(repeatTimes(2 * repeat, [&] { return partial(vertices / 2, 1, 1); }));
  Fnv1a hash;
  const std::vector<Vec3f> places(mesh.mesh().vertices().begin(), mesh.mesh().vertices().end());
  hash.add(places.data(), places.size() * sizeof(Vec3f));
  hash.add(mesh.tree().nodes.data(), mesh.tree().nodes.size() * sizeof(BvhNode));
  row["hash"] = hash.hex();
  return row;
}

/// Many closed parts, none of which may come to lie in another one.
BenchMesh spheresInARow() {
  constexpr std::uint32_t kSpheres = 20;
  const scenes::MeshArrays sphere = scenes::makeSphere(1, 4);
  scenes::MeshArrays row;
  for (std::uint32_t i = 0; i < kSpheres; ++i) {
    const auto first = static_cast<std::uint32_t>(row.vertices.size());
    for (const Vec3f& v : sphere.vertices) row.vertices.push_back({v.x + 3 * static_cast<float>(i), v.y, v.z});
    for (const Triangle& t : sphere.triangles) {
      row.triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
    }
  }
  return {"20 spheres in a row", scenes::build(row)};
}

}  // namespace

int benchBuild(const BenchOptions& options) {
  Json rows = Json::array(), updates = Json::array();
  const std::vector<BenchMesh> meshes = benchMeshes(options);
  Progress all(meshes.size() + 3);
  for (const BenchMesh& entry : meshes) {
    progress(fmt::format("{}: {} triangles", entry.name, entry.mesh->triangleCount()));
    const double validate = validateMs(*entry.mesh, options.repeat);
    for (const BuildStrategy strategy : {BuildStrategy::kMeanSplit, BuildStrategy::kSah}) {
      BinaryTree tree;
      const auto times = [&](const std::function<void()>& body) {
        return median(repeatTimes(options.repeat, [&] { return timeOnce(body); }));
      };
      Json row;
      row["mesh"] = entry.name;
      row["triangles"] = entry.mesh->triangleCount();
      row["build"] = nameOf(strategy);
      row["validate_ms"] = validate;
      row["tree_ms"] = times([&] { tree = buildTree(*entry.mesh, strategy); });
      row["quantize_ms"] = times([&] { quantizeTree(tree); });
      row["noleaf_ms"] = times([&] { makeNoLeafTree(tree); });
      row["refit_ms"] = times([&] { refitTree(tree, *entry.mesh); });
      row["nodes"] = tree.nodes.size();
      row["depth"] = tree.depth;
      row["sah_cost"] = sahCost(tree);
      row["hash"] = hashOfTree(tree);
      rows.push_back(row);
    }
    updates.push_back(updateRow(entry, options.repeat));
    all.step();
  }
  updates.push_back(updateRow(spheresInARow(), options.repeat));
  all.step();
  const Json scales = scaleRows(options);
  all.step();
  printBench({{"bench", "build"},
              {"tables", {{"build", rows}, {"update", updates}, {"scale", scales}, {"sent", sentRows(options)}}}},
             options.json);
  return kOk;
}

}  // namespace otg::cli
