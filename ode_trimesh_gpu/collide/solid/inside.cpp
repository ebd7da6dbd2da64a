// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/inside.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "collide/inside_test.h"

namespace otg {
namespace {

/// The bounds of mesh `mesh`, a little enlarged, for points in A's frame.
class Bounds {
 public:
  Bounds(const PlacedMeshes& meshes, int mesh) : meshes_(meshes), mesh_(mesh) {
    const TriMesh& m = meshes.mesh(mesh);
    everything_ = !meshes.isSolid(mesh);
    const double slack = 1e-9 * m.radius();
    const Vec3f &lo = m.boundsMin(), &hi = m.boundsMax();
    lo_ = {lo.x - slack, lo.y - slack, lo.z - slack};
    hi_ = {hi.x + slack, hi.y + slack, hi.z + slack};
  }
  bool contain(const Vec3d& p) const {
    if (everything_) return true;
    const Vec3d x = meshes_.toLocal(mesh_, p);
    return x.x >= lo_.x && x.x <= hi_.x && x.y >= lo_.y && x.y <= hi_.y && x.z >= lo_.z && x.z <= hi_.z;
  }
  /// Surely all of a ball? False says nothing.
  bool containBall(const Vec3d& p, double radius) const {
    if (everything_) return true;
    const Vec3d x = meshes_.toLocal(mesh_, p);
    return x.x - radius >= lo_.x && x.x + radius <= hi_.x && x.y - radius >= lo_.y && x.y + radius <= hi_.y &&
           x.z - radius >= lo_.z && x.z + radius <= hi_.z;
  }

 private:
  const PlacedMeshes& meshes_;
  int mesh_;
  bool everything_;  ///< behind a sheet there is no end
  Vec3d lo_, hi_;
};

class Flood {
 public:
  Flood(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags, int mesh)
      : meshes_(meshes),
        contour_(contour),
        flags_(flags),
        mesh_(mesh),
        adjacency_(meshes.adjacency(mesh)),
        bounds_(meshes, 1 - mesh) {}

  void run() {
    flags_.clusterOf[mesh_] = &adjacency_.clusterOf;
    flags_.vertexPatch[mesh_].reset(meshes_.mesh(mesh_).vertices().size());
    flags_.clusterPatch[mesh_].reset(adjacency_.clusters.size());
    collectVotes();
    for (const std::uint32_t edge : contour_.crossedEdges[mesh_]) {
      const Topology::Edge& ends = meshes_.mesh(mesh_).topology().edges[edge];
      for (const std::uint32_t v : {ends.a, ends.b}) {
        if (vote(v) > 0 && !flags_.vertexPatch[mesh_].has(v)) patch(v);
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
    if (adjacency_.clusterOf[v] != kNone) flags_.mixed.set(adjacency_.clusterOf[v], 1);
  }

  void collectVotes() {
    flags_.votes.reset(meshes_.mesh(mesh_).vertices().size());
    flags_.mixed.reset(adjacency_.clusters.size());
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
    std::vector<std::uint32_t>& vertices = flags_.vertices[mesh_];
    std::vector<std::uint32_t>& clusters = flags_.clusters[mesh_];
    std::vector<Vec3d>& positions = flags_.positions[mesh_];
    const auto vertexBegin = static_cast<std::uint32_t>(vertices.size());
    const auto clusterBegin = static_cast<std::uint32_t>(clusters.size());
    id_ = static_cast<std::uint32_t>(flags_.patches[mesh_].size());
    outside_ = false;
    balance_ = 0;
    against_ = 0;
    reach(seed);
    std::size_t v = vertexBegin, c = clusterBegin;
    while (!outside_ && (v < vertices.size() || c < clusters.size())) {
      prefetch(v, c);
      v < vertices.size() ? visitVertex(vertices[v++]) : visitCluster(clusters[c++]);
    }
    if (!outside_ && balance_ == 0)
      outside_ = !meshes_.isSolid(1 - mesh_) || !vertexInside(meshes_, 1 - mesh_, positions[vertexBegin]);
    if (outside_ || balance_ < 0) {
      ++flags_.anomalies;
      for (std::size_t i = vertexBegin; i < vertices.size(); ++i) {
        flags_.vertexPatch[mesh_].set(vertices[i], InsideFlags::kOutside);
      }
      for (std::size_t i = clusterBegin; i < clusters.size(); ++i) {
        flags_.clusterPatch[mesh_].set(clusters[i], InsideFlags::kOutside);
      }
      vertices.resize(vertexBegin);
      positions.resize(vertexBegin);
      clusters.resize(clusterBegin);
      return;
    }
    flags_.anomalies += against_;
    flags_.patches[mesh_].push_back({vertexBegin, static_cast<std::uint32_t>(vertices.size()), clusterBegin,
                                     static_cast<std::uint32_t>(clusters.size())});
  }

  /// Prefetches the memory of what is on the lists a few places behind `v` and `c`.
  void prefetch(std::size_t v, std::size_t c) const {
    const std::vector<std::uint32_t>& vertices = flags_.vertices[mesh_];
    const std::vector<std::uint32_t>& clusters = flags_.clusters[mesh_];
    if (v + 8 < vertices.size()) {
      __builtin_prefetch(&adjacency_.first[vertices[v + 8]]);
      __builtin_prefetch(&meshes_.mesh(mesh_).vertices()[vertices[v + 8]]);
    }
    if (v + 4 < vertices.size()) __builtin_prefetch(&adjacency_.spokes[adjacency_.first[vertices[v + 4]]]);
    if (v >= vertices.size() && c + 4 < clusters.size()) {
      __builtin_prefetch(&adjacency_.clusters[clusters[c + 4]]);
      const Adjacency::Cluster& next = adjacency_.clusters[clusters[c + 2]];
      __builtin_prefetch(adjacency_.clusterNeighbours.data() + next.firstNeighbour);
      __builtin_prefetch(adjacency_.clusterVertices.data() + next.first);
    }
  }

  /// Puts a vertex of a mixed cluster, or a whole cluster, on its list.
  void reach(std::uint32_t v) { reach(flags_.vertexPatch[mesh_], v, flags_.vertices[mesh_]); }
  void reachCluster(std::uint32_t c) { reach(flags_.clusterPatch[mesh_], c, flags_.clusters[mesh_]); }
  void reach(EpochArray& patchOf, std::uint32_t i, std::vector<std::uint32_t>& list) {
    const std::uint32_t known = patchOf.find(i);
    if (known != EpochArray::kMissing) {
      outside_ = outside_ || known == InsideFlags::kOutside;  // an earlier flood stopped half-way here
      return;
    }
    patchOf.set(i, id_);
    list.push_back(i);
  }

  void visitVertex(std::uint32_t v) {
    const Vec3d p = meshes_.vertex(mesh_, v);
    flags_.positions[mesh_].push_back(p);
    outside_ = outside_ || !bounds_.contain(p);
    // Only ends of crossed edges have votes, so an edge of which one end has none is not crossed.
    const bool nearContour = flags_.votes.has(v);
    if (nearContour) {
      const std::int32_t votes = vote(v);
      balance_ += votes;
      if (votes < 0) ++against_;
    }
    for (std::uint32_t h = adjacency_.first[v]; h < adjacency_.first[v + 1]; ++h) {
      const std::uint32_t w = adjacency_.spokes[h].vertex, c = adjacency_.clusterOf[w];
      if (c != kNone && !flags_.mixed.has(c)) {
        reachCluster(c);
      } else if (!nearContour || !flags_.votes.has(w) || !contour_.isCrossed(mesh_, adjacency_.spokes[h].edge)) {
        reach(w);
      }
    }
  }

  void visitCluster(std::uint32_t c) {
    const Adjacency::Cluster &cluster = adjacency_.clusters[c], &next = adjacency_.clusters[c + 1];
    const Vec3d lo{cluster.lo.x, cluster.lo.y, cluster.lo.z}, hi{cluster.hi.x, cluster.hi.y, cluster.hi.z};
    const Vec3d diagonal = hi - lo;
    if (!bounds_.containBall(meshes_.fromLocal(mesh_, (lo + hi) * 0.5), 0.5 * norm(diagonal))) {
      for (std::uint32_t i = cluster.first; i < next.first; ++i) {
        outside_ = outside_ || !bounds_.contain(meshes_.vertex(mesh_, adjacency_.clusterVertices[i]));
      }
    }
    __builtin_prefetch(&adjacency_.first[adjacency_.clusterVertices[cluster.first]]);
    bool besideMixed = false;
    for (std::uint32_t i = cluster.firstNeighbour; i < next.firstNeighbour; ++i) {
      const std::uint32_t d = adjacency_.clusterNeighbours[i];
      if (flags_.mixed.has(d)) {
        besideMixed = true;
      } else {
        reachCluster(d);
      }
    }
    if (!besideMixed) return;
    for (std::uint32_t i = cluster.first; i < next.first; ++i) {
      __builtin_prefetch(&adjacency_.spokes[adjacency_.first[adjacency_.clusterVertices[i]]]);
    }
    for (std::uint32_t i = cluster.first; i < next.first; ++i) {
      const std::uint32_t v = adjacency_.clusterVertices[i];
      for (std::uint32_t h = adjacency_.first[v]; h < adjacency_.first[v + 1]; ++h) {
        const std::uint32_t w = adjacency_.spokes[h].vertex;
        if (adjacency_.clusterOf[w] == kNone || flags_.mixed.has(adjacency_.clusterOf[w])) reach(w);
      }
    }
  }

  /// Components of which no crossing shows anything: inside if one of their vertices is.
  void wholeComponents() {
    if (!meshes_.isSolid(1 - mesh_)) return;
    const TriMesh& mesh = meshes_.mesh(mesh_);
    const Adjacency& adjacency = meshes_.adjacency(mesh_);
    const Topology& topology = mesh.topology();
    const std::size_t count = topology.componentCount();
    std::vector<std::uint8_t>& crossed = flags_.crossed;
    crossed.assign(count, 0);
    for (const Chord& chord : contour_.chords) {
      crossed[topology.componentOf[mesh_ == 0 ? chord.triangleA : chord.triangleB]] = 1;
    }
    for (std::uint32_t c = 0; c < count; ++c) {
      if (crossed[c] || adjacency.componentVertex[c] == kNone || !topology.componentClosed[c]) continue;
      if (isContained(c)) flags_.contained[mesh_].push_back(c);
    }
  }

  /// Vertices spread over the component, all in the other mesh's bounds, and one inside by exact signs: no crossing
  /// means that the others are where that one is.
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
    return vertexInside(meshes_, 1 - mesh_, sample(0));
  }

  const PlacedMeshes& meshes_;
  const Contour& contour_;
  InsideFlags& flags_;
  int mesh_;
  const Adjacency& adjacency_;
  Bounds bounds_;  ///< of the other mesh
  // Of the patch that is being flooded.
  std::uint32_t id_ = 0;
  bool outside_ = false;
  std::int64_t balance_ = 0;
  std::size_t against_ = 0;
};

}  // namespace

void floodInside(const PlacedMeshes& meshes, const Contour& contour, InsideFlags& flags) {
  flags.anomalies = 0;
  for (int m = 0; m < 2; ++m) {
    flags.patches[m].clear();
    flags.vertices[m].clear();
    flags.positions[m].clear();
    flags.clusters[m].clear();
    flags.contained[m].clear();
    Flood(meshes, contour, flags, m).run();
  }
}

}  // namespace otg
