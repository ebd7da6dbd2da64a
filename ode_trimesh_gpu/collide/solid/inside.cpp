// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/inside.h"

#include <algorithm>

#include "collide/solid/ray.h"

namespace otg {
namespace {

bool inBounds(const PlacedMeshes& meshes, int mesh, const Vec3d& p) {
  const Vec3d x = meshes.toLocal(mesh, p);
  const TriMesh& m = meshes.mesh(mesh);
  const double slack = 1e-9 * m.radius();
  return x.x >= m.boundsMin().x - slack && x.x <= m.boundsMax().x + slack && x.y >= m.boundsMin().y - slack &&
         x.y <= m.boundsMax().y + slack && x.z >= m.boundsMin().z - slack && x.z <= m.boundsMax().z + slack;
}

class Flood {
 public:
  Flood(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags, int mesh)
      : meshes_(meshes), contour_(contour), flags_(flags), mesh_(mesh) {}

  void run() {
    collectVotes();
    flags_.visited.clear();
    for (const std::uint32_t edge : contour_.crossedEdges[mesh_]) {
      const Topology::Edge& ends = meshes_.mesh(mesh_).topology().edges[edge];
      for (const std::uint32_t v : {ends.a, ends.b}) {
        if (vote(v) > 0 && flags_.visited.find(v) == FlatMap::kMissing) patch(v);
      }
    }
    wholeComponents();
  }

 private:
  /// Votes are counted up from a large offset so that they fit an unsigned value.
  static constexpr std::uint32_t kZero = 1u << 30;
  std::int64_t vote(std::uint32_t v) const {
    const std::uint32_t x = flags_.votes.find(v);
    return x == FlatMap::kMissing ? 0 : std::int64_t{x} - kZero;
  }

  void collectVotes() {
    flags_.votes.clear();
    for (const std::uint32_t edge : contour_.crossedEdges[mesh_]) {
      const Topology::Edge& ends = meshes_.mesh(mesh_).topology().edges[edge];
      const Contour::Range range = contour_.on(mesh_, edge);
      // Leaving at the first crossing: the edge began inside. Entering at the last: it ends inside.
      const bool startInside = contour_.crossings[contour_.alongEdge[range.begin]].exits;
      const bool endInside = !contour_.crossings[contour_.alongEdge[range.end - 1]].exits;
      flags_.votes.insert(ends.a, kZero) += startInside ? 1u : ~0u;
      flags_.votes.insert(ends.b, kZero) += endInside ? 1u : ~0u;
    }
  }

  /// Floods from a vertex that has more votes for inside; keeps the patch if it holds.
  void patch(std::uint32_t seed) {
    const TriMesh& mesh = meshes_.mesh(mesh_);
    const Topology& topology = mesh.topology();
    const Adjacency& adjacency = meshes_.adjacency(mesh_);
    std::vector<std::uint32_t>& patch = flags_.patch;
    patch.assign(1, seed);
    flags_.visited.insert(seed, 1);
    std::int64_t balance = 0;
    std::size_t against = 0;
    bool outside = false;
    for (std::size_t i = 0; i < patch.size() && !outside; ++i) {
      const std::uint32_t v = patch[i];
      const std::int64_t votes = vote(v);
      balance += votes;
      if (votes < 0) ++against;
      outside = !inBounds(meshes_, 1 - mesh_, meshes_.vertex(mesh_, v));
      for (std::uint32_t h = adjacency.first[v]; h < adjacency.first[v + 1]; ++h) {
        const std::uint32_t half = adjacency.halfEdges[h];
        if (contour_.firstOn[mesh_].find(topology.edgeOf[half]) != FlatMap::kMissing) continue;
        const Triangle& t = mesh.triangles()[half / 3];
        const std::uint32_t w = topology.weld[t.v[(half % 3 + 1) % 3]];
        bool inserted = false;
        flags_.visited.insert(w, 1, &inserted);
        if (inserted) patch.push_back(w);
      }
    }
    if (!outside && balance == 0) outside = !pointInside(meshes_, 1 - mesh_, meshes_.vertex(mesh_, seed));
    if (outside || balance < 0) {
      ++flags_.anomalies;
      return;
    }
    flags_.anomalies += against;
    for (const std::uint32_t v : patch) {
      flags_.index[mesh_].insert(v, static_cast<std::uint32_t>(flags_.vertices[mesh_].size()));
      flags_.vertices[mesh_].push_back(v);
    }
  }

  /// Components that no crossing tells anything of: inside if one of their vertices is.
  void wholeComponents() {
    const TriMesh& mesh = meshes_.mesh(mesh_);
    const Adjacency& adjacency = meshes_.adjacency(mesh_);
    const Topology& topology = mesh.topology();
    const std::size_t count = topology.componentCount();
    std::vector<std::uint8_t> crossed(count, 0);
    for (const Chord& chord : contour_.chords) {
      crossed[topology.componentOf[mesh_ == 0 ? chord.triangleA : chord.triangleB]] = 1;
    }
    for (std::uint32_t c = 0; c < count; ++c) {
      if (crossed[c] || adjacency.componentVertex[c] == kNone || !topology.componentClosed[c]) continue;
      if (isContained(c)) flags_.contained[mesh_].push_back(c);
    }
  }

  /// By vertices spread over the component: all in the other mesh's bounds, and more than three quarters of them
  /// inside. A body that merely touches the other has vertices on its surface, for which a ray may answer either way,
  /// and others.
  bool isContained(std::uint32_t component) const {
    const TriMesh& mesh = meshes_.mesh(mesh_);
    const Adjacency& adjacency = meshes_.adjacency(mesh_);
    const std::uint32_t first = adjacency.componentFirst[component];
    const std::uint32_t count = adjacency.componentFirst[component + 1] - first;
    const std::uint32_t samples = std::min(count, 16u);
    const auto sample = [&](std::uint32_t i) {
      const std::uint32_t t =
          adjacency.componentTriangles[first + static_cast<std::uint32_t>(std::uint64_t{i} * count / samples)];
      return meshes_.vertex(mesh_, mesh.triangles()[t].v[i % 3]);
    };
    for (std::uint32_t i = 0; i < samples; ++i) {
      if (!inBounds(meshes_, 1 - mesh_, sample(i))) return false;
    }
    std::uint32_t outside = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
      if (!pointInside(meshes_, 1 - mesh_, sample(i)) && 4 * ++outside >= samples) return false;
    }
    return true;
  }

  const PlacedMeshes& meshes_;
  const Contour& contour_;
  InsideFlags& flags_;
  int mesh_;
};

}  // namespace

void InsideFlags::clear() {
  for (int m = 0; m < 2; ++m) {
    vertices[m].clear();
    index[m].clear();
    contained[m].clear();
  }
  anomalies = 0;
}

void floodInside(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags) {
  flags.clear();
  for (int m = 0; m < 2; ++m) Flood(meshes, contour, flags, m).run();
}

}  // namespace otg
