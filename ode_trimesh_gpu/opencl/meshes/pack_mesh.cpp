// SPDX-License-Identifier: BSD-3-Clause
#include "opencl/meshes/pack_mesh.h"

#include <algorithm>
#include <bit>
#include <random>
#include <utility>

#include "bvh/packed_tree.h"
#include "opencl/meshes/packed_motion.h"
#include "opencl/meshes/packed_solid.h"

namespace otg::opencl {
namespace {

void addNode(PackedMesh& out, Vec3f center, std::uint32_t first, Vec3f extent, std::int32_t count) {
  out.units.push_back(nodeCenter(center, first));
  out.units.push_back(nodeExtent(extent, count));
}

void addTriangle(PackedMesh& out, const TriMesh& mesh, std::uint32_t triangle) {
  for (std::uint32_t k = 0; k < 3; ++k) out.units.push_back(triangleCorner(mesh, triangle, k));
}

/// Nodes, triangles and cut.
PackedTree addEightWide(PackedMesh& out, const CollisionMesh& mesh, std::uint32_t leafTriangles, std::uint32_t cutOrder,
                        std::vector<std::uint32_t>* binaryNodes) {
  PackedTree tree =
      mesh.withOwnBoxes([&](const BinaryTree& binary) { return makePackedTree(binary, leafTriangles, binaryNodes); });
  if (cutOrder != 0) std::shuffle(tree.cut.begin(), tree.cut.end(), std::mt19937(cutOrder));
  out.units.reserve(2 * tree.nodes.size() + 4 * tree.triangles.size() + 2 * tree.cut.size());
  for (const PackedNode& n : tree.nodes) {
    addNode(out, n.center, static_cast<std::uint32_t>(n.first), n.extent, n.count);
  }
  out.place.soup = static_cast<std::uint32_t>(out.units.size());
  for (const std::uint32_t triangle : tree.triangles) addTriangle(out, mesh.mesh(), triangle);
  out.place.cut = static_cast<std::uint32_t>(out.units.size());
  out.place.cutCount = static_cast<std::uint32_t>(tree.cut.size());
  for (const std::uint32_t node : tree.cut) {
    addNode(out, tree.nodes[node].center, node, tree.nodes[node].extent, tree.nodes[node].count);
  }
  out.place.depth = tree.depth;
  return tree;
}

/// Nodes and triangles. A leaf's first is its triangle, whose place in the soup is its number.
void addBinary(PackedMesh& out, const CollisionMesh& mesh, const BinaryTree& tree) {
  const auto triangles = static_cast<std::uint32_t>(mesh.mesh().triangleCount());
  out.units.reserve(2 * tree.nodes.size() + 4 * std::size_t{triangles});
  for (const BvhNode& n : tree.nodes) {
    addNode(out, n.center, n.isLeaf() ? n.triangle() : static_cast<std::uint32_t>(n.child), n.extent,
            n.isLeaf() ? -1 : 2);
  }
  out.place.soup = static_cast<std::uint32_t>(out.units.size());
  for (std::uint32_t triangle = 0; triangle < triangles; ++triangle) addTriangle(out, mesh.mesh(), triangle);
  out.place.depth = tree.depth;
}

/// See OTG_RING_TWIN.
void addRings(PackedMesh& out, const TriMesh& mesh) {
  const Topology& topology = mesh.topology();
  const std::size_t halfEdges = 3 * mesh.triangleCount();
  std::vector<std::uint32_t> next(halfEdges), last(topology.edgeCount(), kNone), count(topology.edgeCount(), 0);
  for (std::uint32_t h = 0; h < halfEdges; ++h) {
    next[h] = h;
    const std::uint32_t edge = topology.edgeOf[h];
    if (edge == kNone) continue;
    if (last[edge] != kNone) std::swap(next[h], next[last[edge]]);
    last[edge] = h;
    if (++count[edge] > OTG_MOST_ON_EDGE) out.place.flags |= OTG_MESH_TANGLED;
  }
  for (std::uint32_t h = 0; h < halfEdges; ++h) {
    if (topology.edgeOf[h] != kNone && count[topology.edgeOf[h]] == 2) next[h] |= OTG_RING_TWIN;
  }
  out.place.rings = static_cast<std::uint32_t>(out.units.size());
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    out.units.push_back({std::bit_cast<float>(next[3 * t]), std::bit_cast<float>(next[3 * t + 1]),
                         std::bit_cast<float>(next[3 * t + 2]), mesh.callerTriangle(t)});
  }
}

}  // namespace

PackedMesh packMesh(const CollisionMesh& mesh, MeshLayout layout, std::uint32_t leafTriangles, std::uint32_t cutOrder,
                    std::shared_ptr<const PackedPlaces>* places) {
  PackedMesh out;
  PackedTree tree;
  std::vector<std::uint32_t> binaryNodes;
  if (layout == MeshLayout::kBinary) {
    mesh.withOwnBoxes([&](const BinaryTree& binary) { addBinary(out, mesh, binary); });
  } else {
    tree = addEightWide(out, mesh, leafTriangles, cutOrder, places == nullptr ? nullptr : &binaryNodes);
  }
  addRings(out, mesh.mesh());
  out.place.center = mesh.mesh().origin();
  out.place.radius = mesh.mesh().radius();
  out.place.triangles = static_cast<std::uint32_t>(mesh.mesh().triangleCount());
  if (layout == MeshLayout::kEightWide) {
    addSolid(out, mesh);
    if (places != nullptr) *places = std::make_shared<PackedPlaces>(tree, binaryNodes, out);
  }
  return out;
}

}  // namespace otg::opencl
