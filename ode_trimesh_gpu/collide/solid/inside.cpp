// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/inside.h"

#include <algorithm>

#include "collide/solid/ray.h"

namespace otg {
namespace {

/// The bounds of mesh `mesh`, a little enlarged, for points in A's frame.
class Bounds {
 public:
  Bounds(const PlacedMeshes& meshes, int mesh) : meshes_(meshes), mesh_(mesh) {
    const TriMesh& m = meshes.mesh(mesh);
    const double slack = 1e-9 * m.radius();
    const Vec3f &lo = m.boundsMin(), &hi = m.boundsMax();
    lo_ = {lo.x - slack, lo.y - slack, lo.z - slack};
    hi_ = {hi.x + slack, hi.y + slack, hi.z + slack};
  }
  bool contain(const Vec3d& p) const {
    const Vec3d x = meshes_.toLocal(mesh_, p);
    return x.x >= lo_.x && x.x <= hi_.x && x.y >= lo_.y && x.y <= hi_.y && x.z >= lo_.z && x.z <= hi_.z;
  }

 private:
  const PlacedMeshes& meshes_;
  int mesh_;
  Vec3d lo_, hi_;
};

class Flood {
 public:
  Flood(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags, int mesh)
      : meshes_(meshes), contour_(contour), flags_(flags), mesh_(mesh), bounds_(meshes, 1 - mesh) {}

  void run() {
    flags_.patch_[mesh_].reset(meshes_.mesh(mesh_).vertices().size());
    collectVotes();
    for (const std::uint32_t edge : contour_.crossedEdges[mesh_]) {
      const Topology::Edge& ends = meshes_.mesh(mesh_).topology().edges[edge];
      for (const std::uint32_t v : {ends.a, ends.b}) {
        if (vote(v) > 0 && !flags_.patch_[mesh_].has(v)) patch(v);
      }
    }
    wholeComponents();
  }

 private:
  std::int32_t vote(std::uint32_t v) const {
    return flags_.votes.has(v) ? static_cast<std::int32_t>(flags_.votes.find(v)) : 0;
  }
  void count(std::uint32_t v, bool inside) {
    flags_.votes.set(v, static_cast<std::uint32_t>(vote(v) + (inside ? 1 : -1)));
  }

  void collectVotes() {
    flags_.votes.reset(meshes_.mesh(mesh_).vertices().size());
    for (const std::uint32_t edge : contour_.crossedEdges[mesh_]) {
      const Topology::Edge& ends = meshes_.mesh(mesh_).topology().edges[edge];
      const Contour::Range range = contour_.on(mesh_, edge);
      // Leaving at the first crossing: the edge began inside. Entering at the last: it ends inside.
      count(ends.a, contour_.crossings[contour_.alongEdge[range.begin]].exits);
      count(ends.b, !contour_.crossings[contour_.alongEdge[range.end - 1]].exits);
    }
  }

  /// Floods from a vertex that has more votes for inside; keeps the patch if it holds.
  void patch(std::uint32_t seed) {
    const Topology& topology = meshes_.mesh(mesh_).topology();
    const Adjacency& adjacency = meshes_.adjacency(mesh_);
    std::vector<std::uint32_t>& vertices = flags_.vertices[mesh_];
    std::vector<Vec3d>& positions = flags_.positions[mesh_];
    EpochArray& patchOf = flags_.patch_[mesh_];
    const auto begin = static_cast<std::uint32_t>(vertices.size());
    const auto id = static_cast<std::uint32_t>(flags_.patches[mesh_].size());
    vertices.push_back(seed);
    patchOf.set(seed, id);
    std::int64_t balance = 0;
    std::size_t against = 0;
    bool outside = false;
    for (std::size_t i = begin; i < vertices.size() && !outside; ++i) {
      const std::uint32_t v = vertices[i];
      const Vec3d p = meshes_.vertex(mesh_, v);
      positions.push_back(p);
      outside = !bounds_.contain(p);
      // Only ends of crossed edges have votes, so an edge between two vertices of which one has none is not crossed.
      const bool nearContour = flags_.votes.has(v);
      if (nearContour) {
        const std::int32_t votes = vote(v);
        balance += votes;
        if (votes < 0) ++against;
      }
      for (std::uint32_t h = adjacency.first[v]; h < adjacency.first[v + 1]; ++h) {
        const std::uint32_t w = adjacency.neighbour[h];
        const std::uint32_t known = patchOf.find(w);
        if (known == id) continue;
        if (nearContour && flags_.votes.has(w) && contour_.isCrossed(mesh_, topology.edgeOf[adjacency.halfEdges[h]])) {
          continue;
        }
        if (known != EpochArray::kMissing) {
          outside = outside || known == InsideFlags::kOutside;  // an earlier flood stopped half-way here
          continue;
        }
        patchOf.set(w, id);
        vertices.push_back(w);
      }
    }
    if (!outside && balance == 0) outside = !pointInside(meshes_, 1 - mesh_, positions[begin]);
    if (outside || balance < 0) {
      ++flags_.anomalies;
      for (std::size_t i = begin; i < vertices.size(); ++i) patchOf.set(vertices[i], InsideFlags::kOutside);
      vertices.resize(begin);
      positions.resize(begin);
      return;
    }
    flags_.anomalies += against;
    flags_.patches[mesh_].push_back({begin, static_cast<std::uint32_t>(vertices.size())});
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
      if (!bounds_.contain(sample(i))) return false;
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
  Bounds bounds_;  ///< of the other mesh
};

}  // namespace

void floodInside(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags) {
  flags.anomalies = 0;
  for (int m = 0; m < 2; ++m) {
    flags.patches[m].clear();
    flags.vertices[m].clear();
    flags.positions[m].clear();
    flags.contained[m].clear();
    Flood(meshes, contour, flags, m).run();
  }
}

}  // namespace otg
