// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/solid_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "base/bounds.h"
#include "base/union_find.h"
#include "base/vectors.h"
#include "mesh/adjacency_links.h"
#include "mesh/containment.h"
#include "mesh/convexity.h"

namespace otg {
namespace {

/// So many parts there may be. Each is looked at with each of the other mesh.
constexpr std::size_t kMostParts = 64;

using Corners = Vec3d[3];

/// Of the corners of triangle t above the plane of triangle `of`.
struct Heights {
  Vec3d normal;
  double at[3];
  Heights(const Corners& t, const Corners& of) : normal(unit(otgCross(of[1] - of[0], of[2] - of[0]))), at{} {
    for (int k = 0; k < 3; ++k) at[k] = otgDot(normal, t[k] - of[0]);
  }
  double least() const { return std::min({at[0], at[1], at[2]}); }
  double most() const { return std::max({at[0], at[1], at[2]}); }
};

/// Whether the plane of `of` is between the two triangles, or one that stands on it along an edge of `of`.
bool areApart(const Corners& t, const Corners& of, double slack) {
  const Heights heights(t, of);
  if (heights.least() > slack || heights.most() < -slack) return true;
  for (int k = 0; k < 3; ++k) {
    const Vec3d inward = unit(otgCross(heights.normal, of[(k + 1) % 3] - of[k]));
    const auto isOutside = [&](const Vec3d& p) { return otgDot(inward, p - of[k]) < -slack; };
    if (isOutside(t[0]) && isOutside(t[1]) && isOutside(t[2])) return true;
  }
  return false;
}

/// Whether triangle t goes behind triangle `of`, from a line of more than `slack` that both have, and that is not at
/// the rim of `of`.
bool goesBehind(const Corners& t, const Corners& of, double slack) {
  const Heights heights(t, of);
  const Vec3d& n = heights.normal;
  const auto& height = heights.at;
  if (!(heights.least() < -slack) || heights.most() < -slack) return false;
  // Where t meets the plane.
  Vec3d ends[2];
  int count = 0;
  const auto add = [&](const Vec3d& p) {
    if (count < 2) ends[count++] = p;
  };
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (std::fabs(height[k]) <= slack) add(t[k]);
    if (std::fabs(height[k]) <= slack || std::fabs(height[next]) <= slack) continue;
    if ((height[k] < 0) == (height[next] < 0)) continue;
    add(t[k] + (t[next] - t[k]) * (height[k] / (height[k] - height[next])));
  }
  if (count < 2) return false;
  // What of that lies in `of`, without its rim.
  const Vec3d line = ends[1] - ends[0];
  double begin = 0, end = 1;
  for (int k = 0; k < 3; ++k) {
    const Vec3d inward = unit(otgCross(n, of[(k + 1) % 3] - of[k]));
    const double at0 = otgDot(inward, ends[0] - of[k]) - slack, at1 = otgDot(inward, ends[1] - of[k]) - slack;
    if (at0 < 0 && at1 < 0) return false;
    if (at0 < 0) begin = std::max(begin, at0 / (at0 - at1));
    if (at1 < 0) end = std::min(end, at0 / (at0 - at1));
  }
  return (end - begin) * norm(line) > slack;
}

/// Which components of a mesh overlap, and which are beside each other.
class Neighbours {
 public:
  Neighbours(const TriMesh& mesh, const BinaryTree& tree)
      : tree_(tree), mesh_(mesh), componentOf_(mesh_.topology().componentOf), slack_(roundingOfVertices(mesh_)) {
    const std::size_t count = mesh_.topology().componentCount();
    std::vector<Bounds> bounds(count);
    sizes_.assign(count, 0);
    for (std::uint32_t t = 0; t < mesh_.triangleCount(); ++t) {
      if (componentOf_[t] == kNone) continue;
      ++sizes_[componentOf_[t]];
      for (const std::uint32_t v : mesh_.triangles()[t].v) bounds[componentOf_[t]].add(mesh_.vertices()[v]);
    }
    findThoseThatMeet(bounds);
    if (std::find(meets_.begin(), meets_.end(), 1) == meets_.end()) return;
    const AdjacencyLinks& links = mesh_.adjacencyLinks();
    lastNear_.assign(count, kNone);
    lastOverlap_.assign(count, kNone);
    lists_.resize(count);
    for (std::uint32_t c = 0; c < count; ++c) {
      if (!meets_[c]) continue;
      for (std::uint32_t i = links.componentFirst[c]; i < links.componentFirst[c + 1]; ++i) {
        look(c, links.componentTriangles[i]);
      }
    }
  }

  struct Neighbour {
    std::uint32_t component;
    bool overlaps;  ///< else it is beside
  };
  bool anyOverlap() const { return overlaps_ > 0; }
  bool anyBeside() const { return near_ > overlaps_; }
  /// Of each component, if any are near each other.
  const std::vector<std::vector<Neighbour>>& lists() const { return lists_; }

 private:
  /// Each pair of components is looked for from the one that has fewer triangles.
  bool isLater(std::uint32_t c, std::uint32_t than) const {
    return sizes_[c] != sizes_[than] ? sizes_[c] > sizes_[than] : c > than;
  }

  /// Marks the components whose boxes meet those of later ones.
  void findThoseThatMeet(const std::vector<Bounds>& bounds) {
    std::vector<std::uint32_t> order(bounds.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t c, std::uint32_t d) { return bounds[c].min.x < bounds[d].min.x; });
    meets_.assign(bounds.size(), 0);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Bounds& b = bounds[order[i]];
      for (std::size_t j = i + 1; j < order.size() && bounds[order[j]].min.x <= b.max.x; ++j) {
        const Bounds& o = bounds[order[j]];
        if (o.min.y > b.max.y || o.max.y < b.min.y || o.min.z > b.max.z || o.max.z < b.min.z) continue;
        meets_[isLater(order[i], order[j]) ? order[j] : order[i]] = 1;
      }
    }
  }

  void corners(std::uint32_t t, Corners& out) const {
    for (int k = 0; k < 3; ++k) {
      const Vec3f& p = mesh_.vertices()[mesh_.triangles()[t].v[k]];
      out[k] = {p.x, p.y, p.z};
    }
  }

  /// Calls visit(triangle) for those whose boxes come nearer to these bounds than the slack.
  template <class Visit>
  void search(const Vec3d& low, const Vec3d& high, const Visit& visit) {
    const Vec3f& o = mesh_.origin();
    const Vec3d origin{o.x, o.y, o.z}, middle = (low + high) * 0.5 - origin, half = (high - low) * 0.5;
    const auto meets = [&](double between, double reach, double other) {
      return std::fabs(between) <= reach + other + slack_;
    };
    stack_.assign(tree_.nodes.empty() ? 0 : 1, 0);
    while (!stack_.empty()) {
      const BvhNode& node = tree_.nodes[stack_.back()];
      stack_.pop_back();
      if (!meets(node.center.x - middle.x, half.x, node.extent.x) ||
          !meets(node.center.y - middle.y, half.y, node.extent.y) ||
          !meets(node.center.z - middle.z, half.z, node.extent.z)) {
        continue;
      }
      if (node.isLeaf()) {
        visit(node.triangle());
      } else {
        for (const std::int32_t child : {node.child, node.child + 1})
          stack_.push_back(static_cast<std::uint32_t>(child));
      }
    }
  }

  /// Looks for others at a triangle of component c.
  void look(std::uint32_t c, std::uint32_t t) {
    if (mesh_.isDegenerate(t)) return;
    Corners own;
    corners(t, own);
    const Vec3d low = minimum(own[0], minimum(own[1], own[2])), high = maximum(own[0], maximum(own[1], own[2]));
    search(low, high, [&](std::uint32_t other) {
      const std::uint32_t d = componentOf_[other];
      if (d == kNone || d == c || !isLater(d, c) || lastOverlap_[d] == c || mesh_.isDegenerate(other)) return;
      Corners others;
      corners(other, others);
      if (areApart(own, others, slack_) || areApart(others, own, slack_)) return;
      const bool overlaps = goesBehind(own, others, slack_) || goesBehind(others, own, slack_);
      if (lastNear_[d] != c) {
        lastNear_[d] = c;
        ++near_;
        lists_[c].push_back({d, overlaps});
        lists_[d].push_back({c, overlaps});
      }
      if (!overlaps) return;
      lastOverlap_[d] = c;
      ++overlaps_;
      std::find_if(lists_[c].rbegin(), lists_[c].rend(), [&](const Neighbour& n) {
        return n.component == d;
      })->overlaps = true;
      lists_[d].back().overlaps = true;  // while c is looked at it gets no other
    });
  }

  const BinaryTree& tree_;
  const TriMesh& mesh_;
  const SharedArray<std::uint32_t>& componentOf_;
  const double slack_;                ///< what overlaps by less is taken for touching
  std::vector<std::uint32_t> sizes_;  ///< of components, in triangles
  std::vector<std::uint8_t> meets_;
  std::vector<std::uint32_t> stack_;
  std::vector<std::uint32_t> lastNear_, lastOverlap_;  ///< of components: the last that was found near it, or in it
  std::vector<std::vector<Neighbour>> lists_;
  std::size_t near_ = 0, overlaps_ = 0;  ///< pairs of components; those that overlap are near each other
};

/// Components that cannot be apart: a cavity, and what is around it.
UnionFind bodiesOf(const TriMesh& mesh) {
  const Topology& topology = mesh.topology();
  UnionFind bodies(topology.componentCount());
  if (std::ranges::all_of(topology.componentVolume, [](double volume) { return volume > 0; })) return bodies;
  for (const Nesting& nesting : nestingsOf(topology, mesh.vertices(), mesh.triangles())) {
    if (topology.componentVolume[nesting.inner] < 0) bodies.unite(nesting.inner, nesting.outer);
  }
  return bodies;
}

/// Gives parts to bodies one after the other: next comes the one that overlaps those of most parts, of these the
/// largest. Each goes to the part whose bodies it touches most, of those in which it overlaps none.
/// Source: D. Brelaz, "New methods to color the vertices of a graph", 1979.
class PartNumbers {
 public:
  PartNumbers(const TriMesh& mesh, const Neighbours& neighbours)
      : lists_(neighbours.lists()), bodies_(bodiesOf(mesh)), partOf_(lists_.size(), kNone), blocked_(lists_.size()) {
    members_.resize(lists_.size());
    volumes_.resize(lists_.size());
    for (std::uint32_t c = 0; c < lists_.size(); ++c) {
      members_[bodies_.find(c)].push_back(c);
      volumes_[c] = std::fabs(mesh.topology().componentVolume[c]);
      if (bodies_.find(c) == c) next_.insert(keyOf(c));
    }
  }

  /// Of each component, from 0.
  std::vector<std::uint32_t> run() {
    while (!next_.empty()) {
      const std::uint32_t body = std::get<2>(*next_.begin());
      next_.erase(next_.begin());
      const std::uint32_t part = partFor(body);
      for (const std::uint32_t c : members_[body]) partOf_[c] = part;
      for (const std::uint32_t c : members_[body]) {
        for (const Neighbours::Neighbour& n : lists_[c]) {
          if (n.overlaps) block(bodies_.find(n.component), part);
        }
      }
    }
    return std::move(partOf_);
  }

 private:
  using Key = std::tuple<std::ptrdiff_t, double, std::uint32_t>;
  Key keyOf(std::uint32_t body) const {
    return {-static_cast<std::ptrdiff_t>(blocked_[body].size()), -volumes_[body], body};
  }

  void block(std::uint32_t body, std::uint32_t part) {
    if (partOf_[body] != kNone || blocked_[body].contains(part)) return;
    next_.erase(keyOf(body));
    blocked_[body].insert(part);
    next_.insert(keyOf(body));
  }

  std::uint32_t partFor(std::uint32_t body) const {
    std::map<std::uint32_t, std::size_t> touched;
    for (const std::uint32_t c : members_[body]) {
      for (const Neighbours::Neighbour& n : lists_[c]) {
        if (!n.overlaps && partOf_[n.component] != kNone) ++touched[partOf_[n.component]];
      }
    }
    std::uint32_t best = 0;
    while (blocked_[body].contains(best)) ++best;
    std::size_t most = 0;
    for (const auto& [part, touches] : touched) {
      if (touches <= most || blocked_[body].contains(part)) continue;
      best = part;
      most = touches;
    }
    return best;
  }

  const std::vector<std::vector<Neighbours::Neighbour>>& lists_;
  UnionFind bodies_;
  std::vector<std::uint32_t> partOf_;                ///< of components
  std::vector<std::set<std::uint32_t>> blocked_;     ///< of bodies, which are named by their first components
  std::vector<std::vector<std::uint32_t>> members_;  ///< likewise
  std::vector<double> volumes_;
  std::set<Key> next_;
};

/// A mesh of the triangles in part.triangleOf. False if that is no solid.
bool makeMesh(const TriMesh& whole, SolidParts::Part& part) {
  std::vector<std::uint32_t> ownOf(whole.vertices().size(), kNone);
  for (const std::uint32_t t : part.triangleOf) {
    for (const std::uint32_t v : whole.triangles()[t].v) ownOf[v] = 0;
  }
  std::vector<Vec3f> vertices;
  for (std::uint32_t v = 0; v < ownOf.size(); ++v) {
    if (ownOf[v] == kNone) continue;
    ownOf[v] = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(whole.vertices()[v]);
    part.vertexOf.push_back(v);
  }
  std::vector<Triangle> triangles;
  triangles.reserve(part.triangleOf.size());
  for (const std::uint32_t t : part.triangleOf) {
    const auto& v = whole.triangles()[t].v;
    triangles.push_back({{ownOf[v[0]], ownOf[v[1]], ownOf[v[2]]}});
  }
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  input.indices = triangles.data();
  input.triangleCount = triangles.size();
  part.mesh = buildTriMesh(input).mesh;
  if (part.mesh == nullptr || part.mesh->meshClass() != MeshClass::kSolid) return false;
  // Where its surfaces touch along edges, the part may have copies of vertices.
  std::vector<std::uint32_t> vertexOf;
  for (std::uint32_t v = 0; v < part.mesh->vertices().size(); ++v) {
    vertexOf.push_back(part.vertexOf[part.mesh->callerVertex(v)]);
  }
  part.vertexOf = std::move(vertexOf);
  return true;
}

}  // namespace

bool mayHaveParts(const TriMesh& mesh) {
  return mesh.meshClass() == MeshClass::kSolid && mesh.topology().componentCount() > 1;
}

namespace {

/// Parts of the components with the same number. None where they are too many, or one would be no solid.
SolidParts makeParts(const TriMesh& mesh, std::span<const std::uint32_t> partOfComponent) {
  SolidParts out;
  const std::size_t count = *std::max_element(partOfComponent.begin(), partOfComponent.end()) + std::size_t{1};
  if (count > kMostParts) return out;
  out.parts.resize(count);
  out.partOf.assign(mesh.triangleCount(), kNone);
  out.numberOf.assign(mesh.triangleCount(), kNone);
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    const std::uint32_t component = mesh.topology().componentOf[t];
    if (component == kNone) continue;
    std::vector<std::uint32_t>& own = out.parts[partOfComponent[component]].triangleOf;
    out.partOf[t] = partOfComponent[component];
    out.numberOf[t] = static_cast<std::uint32_t>(own.size());
    own.push_back(t);
  }
  for (SolidParts::Part& part : out.parts) {
    if (!makeMesh(mesh, part)) return {};
  }
  return out;
}

/// Each component by itself, if they are few and convex, and none lies beside another one. Else none.
SolidParts makeConvexParts(const TriMesh& mesh, const Neighbours& neighbours) {
  std::vector<std::uint32_t> each(mesh.topology().componentCount());
  if (each.size() > kMostParts || neighbours.anyBeside()) return {};
  std::iota(each.begin(), each.end(), 0u);
  SolidParts parts = makeParts(mesh, each);
  const bool areConvex = std::all_of(parts.parts.begin(), parts.parts.end(), [](const SolidParts::Part& part) {
    return convexityOf(*part.mesh) != Convexity::kNone;
  });
  return areConvex ? parts : SolidParts{};
}

}  // namespace

SolidParts takeSolidApart(const TriMesh& mesh, const BinaryTree& tree) {
  if (!mayHaveParts(mesh)) return {};
  const Neighbours neighbours(mesh, tree);
  if (!neighbours.anyOverlap()) return {};
  SolidParts convex = makeConvexParts(mesh, neighbours);
  return convex.parts.empty() ? makeParts(mesh, PartNumbers(mesh, neighbours).run()) : convex;
}

}  // namespace otg
