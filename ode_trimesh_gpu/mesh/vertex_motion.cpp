// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/vertex_motion.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/same_bits.h"
#include "mesh/containment.h"
#include "mesh/inspection.h"
#include "mesh/measure.h"
#include "mesh/topology.h"

namespace otg {
namespace {

/// As componentsWellWound() takes it for the rounding of any component's volume.
constexpr double kRelativeRounding = 1e-14;

double largestVolumeError(const Bounds& bounds, std::size_t triangles) {
  const Vec3d corner = bounds.empty() ? Vec3d{0, 0, 0} : relativeTo(bounds.max, bounds.middle());
  const double radius2 = otgDot(corner, corner);
  return kRelativeRounding * 4 * radius2 * std::sqrt(radius2) * static_cast<double>(triangles);
}

}  // namespace

std::shared_ptr<const VertexMotion::Links> VertexMotion::linksOf(const TriMesh& mesh) {
  const Topology& topology = mesh.topology();
  const auto vertices = static_cast<std::uint32_t>(mesh.vertices().size());
  const auto triangles = static_cast<std::uint32_t>(mesh.triangleCount());
  auto links = std::make_shared<Links>();
  links->weld = topology.weld;
  links->componentOf = topology.componentOf;
  if (!mesh.inputVertexOf_.empty()) {
    links->ownVertex.assign(mesh.inputVertexCount(), kNone);
    for (std::uint32_t v = 0; v < vertices; ++v) links->ownVertex[mesh.callerVertex(v)] = v;
  }
  std::vector<std::uint32_t>& firstUse = links->firstUse;
  firstUse.assign(std::size_t{vertices} + 1, 0);
  for (const Triangle& t : mesh.triangles())
    for (const std::uint32_t v : t.v) ++firstUse[v + 1];
  for (std::uint32_t v = 0; v < vertices; ++v) firstUse[v + 1] += firstUse[v];
  links->uses.resize(3 * std::size_t{triangles});
  std::vector<std::uint32_t> cursor(firstUse.begin(), firstUse.end() - 1);
  for (std::uint32_t t = 0; t < triangles; ++t)
    for (const std::uint32_t v : mesh.triangles()[t].v) links->uses[cursor[v]++] = t;

  std::vector<std::uint32_t>& ring = links->ring;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const std::uint32_t point = topology.weld[v];
    if (point == v) continue;
    if (ring.empty()) {
      ring.resize(vertices);
      for (std::uint32_t w = 0; w < vertices; ++w) ring[w] = w;
    }
    ring[v] = ring[point];
    ring[point] = v;
  }

  const std::size_t components = topology.componentCount();
  const bool each = components == 1 && std::find(topology.componentOf.begin(), topology.componentOf.end(), kNone) ==
                                           topology.componentOf.end();
  if (each) return links;
  std::vector<std::uint32_t>& componentFirst = links->componentFirst;
  componentFirst.assign(components + 1, 0);
  links->placeOf.assign(triangles, kNone);
  for (const std::uint32_t c : topology.componentOf)
    if (c != kNone) ++componentFirst[c + 1];
  for (std::size_t c = 0; c < components; ++c) componentFirst[c + 1] += componentFirst[c];
  links->byComponent.resize(componentFirst.back());
  cursor.assign(componentFirst.begin(), componentFirst.end() - 1);
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const std::uint32_t c = topology.componentOf[t];
    if (c == kNone) continue;
    links->placeOf[t] = cursor[c] - componentFirst[c];
    links->byComponent[cursor[c]++] = t;
  }
  return links;
}

VertexMotion::VertexMotion(const TriMesh& mesh, const VertexMotion* like) {
  const Topology& topology = mesh.topology();
  const auto vertices = static_cast<std::uint32_t>(mesh.vertices().size());
  const auto triangles = static_cast<std::uint32_t>(mesh.triangleCount());
  const bool shares = like != nullptr && like->links_->weld.data() == topology.weld.data() &&
                      like->links_->componentOf.data() == topology.componentOf.data();
  links_ = shares ? like->links_ : linksOf(mesh);

  head_.assign(std::bit_ceil(std::max<std::size_t>(16, vertices)), kNone);
  next_.assign(vertices, kNone);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (topology.weld[v] == v) enter(mesh, v);
  }
  blocks_.resize((vertices + kBlock - 1) / kBlock);
  for (std::uint32_t b = 0; b < blocks_.size(); ++b) blocks_[b] = blockOf(mesh, b);

  const std::size_t components = topology.componentCount();
  volume6_.resize(components);
  const std::vector<std::uint32_t>& byComponent = links_->byComponent;
  const bool each = links_->componentFirst.empty();
  for (std::uint32_t c = 0; c < components; ++c) {
    const std::size_t first = firstOf(c), count = each ? triangles : links_->componentFirst[c + 1] - first;
    volume6_[c].build(count, [&](std::size_t i) {
      return volume6(mesh.vertices(), mesh.triangles()[each ? i : byComponent[first + i]], mesh.origin());
    });
  }
  closedComponents_ =
      static_cast<std::uint32_t>(std::count(topology.componentClosed.begin(), topology.componentClosed.end(), 1));
  measureNesting(mesh, topology);
  vertexMark_.assign(vertices, 0);
  triangleMark_.assign(triangles, 0);
  placeInMoves_.resize(vertices);
}

Bounds VertexMotion::blockOf(const TriMesh& mesh, std::uint32_t block) const {
  Bounds out;
  const auto end = static_cast<std::uint32_t>(std::min<std::size_t>(mesh.vertices().size(), (block + 1) * kBlock));
  for (std::uint32_t v = block * kBlock; v < end; ++v) {
    if (isUsed(v)) out.add(mesh.vertices()[v]);
  }
  return out;
}

/// Of the vertices in use. Blocks that reach less far than what was found are not looked into.
double VertexMotion::largestDistance2(const TriMesh& mesh, const Vec3f& center) const {
  double largest = 0;
  std::uint32_t farthest = 0;
  const auto reach2 = [&](const Bounds& b) {
    // The same operations as distance2() with coordinates that are no nearer: no less than it gives for any vertex.
    const auto farther = [](float lo, float hi, float c) { return double{hi} - c > double{c} - lo ? hi : lo; };
    return distance2(
        {farther(b.min.x, b.max.x, center.x), farther(b.min.y, b.max.y, center.y), farther(b.min.z, b.max.z, center.z)},
        center);
  };
  const auto look = [&](std::uint32_t block) {
    const auto end = static_cast<std::uint32_t>(std::min<std::size_t>(mesh.vertices().size(), (block + 1) * kBlock));
    for (std::uint32_t v = block * kBlock; v < end; ++v) {
      if (isUsed(v)) largest = std::max(largest, distance2(mesh.vertices()[v], center));
    }
  };
  double most = -1;
  for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
    if (blocks_[b].empty() || reach2(blocks_[b]) <= most) continue;
    most = reach2(blocks_[b]);
    farthest = b;
  }
  if (most >= 0) look(farthest);
  for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
    if (!blocks_[b].empty() && reach2(blocks_[b]) > largest) look(b);
  }
  return largest;
}

void VertexMotion::enter(const TriMesh& mesh, std::uint32_t point) {
  std::uint32_t& bucket = bucketOf(mesh.vertices()[point]);
  next_[point] = bucket;
  bucket = point;
}

void VertexMotion::leave(const TriMesh& mesh, std::uint32_t point) {
  std::uint32_t* link = &bucketOf(mesh.vertices()[point]);
  while (*link != point) link = &next_[*link];
  *link = next_[point];
}

/// Whether another point lies where this one does.
bool VertexMotion::occupied(const TriMesh& mesh, std::uint32_t point) const {
  const Vec3f& p = mesh.vertices()[point];
  for (std::uint32_t q = head_[hashPosition(p) & (head_.size() - 1)]; q != kNone; q = next_[q]) {
    if (mesh.vertices()[q] == p) return true;
  }
  return false;
}

void VertexMotion::plan(const TriMesh& mesh, std::span<const MovedVertex> moved) {
  if (++plan_ == 0) {
    vertexMark_.assign(vertexMark_.size(), 0);
    triangleMark_.assign(triangleMark_.size(), 0);
    plan_ = 1;
  }
  moves_.clear();
  triangles_.clear();
  moves_.reserve(moved.size());
  for (const MovedVertex& move : moved) {
    if (vertexMark_[move.vertex] == plan_) {
      moves_[placeInMoves_[move.vertex]].to = move.to;
      continue;
    }
    vertexMark_[move.vertex] = plan_;
    placeInMoves_[move.vertex] = static_cast<std::uint32_t>(moves_.size());
    moves_.push_back(move);
  }
  std::erase_if(moves_, [&](const MovedVertex& move) { return sameBits(mesh.vertices()[move.vertex], move.to); });
  before_.resize(moves_.size());
  for (const MovedVertex& move : moves_) {
    for (std::uint32_t i = links_->firstUse[move.vertex]; i < links_->firstUse[move.vertex + 1]; ++i) {
      if (triangleMark_[links_->uses[i]] == plan_) continue;
      triangleMark_[links_->uses[i]] = plan_;
      triangles_.push_back(links_->uses[i]);
    }
  }
}

bool VertexMotion::move(TriMesh& mesh) {
  if (mesh.report_.mayTouchAlongEdges()) return false;
  Array<Vec3f>& vertices = mesh.vertices_;
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    const std::uint32_t v = moves_[i].vertex;
    if (mesh.topology_.weld[v] == v) leave(mesh, v);
    before_[i] = vertices[v];
    vertices[v] = moves_[i].to;
  }
  bool done = false;
  try {
    done = tryMove(mesh);
  } catch (...) {
    for (std::size_t i = 0; i < moves_.size(); ++i) vertices[moves_[i].vertex] = before_[i];
    throw;
  }
  if (done) {
    rehash(mesh, true);
  } else {
    for (std::size_t i = 0; i < moves_.size(); ++i) vertices[moves_[i].vertex] = before_[i];
  }
  return done;
}

/// The hash of what the caller gave, if it is known, goes along.
void VertexMotion::rehash(TriMesh& mesh, bool forth) noexcept {
  std::uint64_t* const hash = mesh.verticesHash_.made();
  if (hash == nullptr) return;
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    const std::uint32_t v = mesh.callerVertex(moves_[i].vertex);
    const std::uint64_t change = vertexHash(v, moves_[i].to) - vertexHash(v, before_[i]);
    *hash += forth ? change : 0 - change;
  }
}

void VertexMotion::undo(TriMesh& mesh) noexcept {
  rehash(mesh, false);
  for (std::size_t i = 0; i < moves_.size(); ++i) mesh.vertices_[moves_[i].vertex] = before_[i];
  mesh.boundsMin_ = measuresBefore_.boundsMin;
  mesh.boundsMax_ = measuresBefore_.boundsMax;
  mesh.center_ = measuresBefore_.center;
  mesh.radius_ = measuresBefore_.radius;
  mesh.topology_.componentVolume = std::move(measuresBefore_.componentVolume);
  mesh.mass_.reset();
}

/// Whether vertices that were one point still are, and no two points have met. Enters the moved points again.
bool VertexMotion::keepsPoints(const TriMesh& mesh) {
  const SharedArray<std::uint32_t>& weld = mesh.topology_.weld;
  for (const MovedVertex& move : moves_) {
    const std::uint32_t point = weld[move.vertex];
    if (!(mesh.vertices()[move.vertex] == mesh.vertices()[point])) return false;
    if (point != move.vertex) continue;
    if (!links_->ring.empty()) {
      for (std::uint32_t v = links_->ring[point]; v != point; v = links_->ring[v]) {
        if (!(mesh.vertices()[v] == mesh.vertices()[point])) return false;
      }
    }
    if (occupied(mesh, point)) return false;
    enter(mesh, point);
  }
  return true;
}

bool VertexMotion::keepsArea(const TriMesh& mesh) const {
  return std::all_of(triangles_.begin(), triangles_.end(), [&](std::uint32_t t) {
    return isDegenerateTriangle(mesh.vertices(), mesh.triangles()[t]) == mesh.isDegenerate(t);
  });
}

/// The volumes of all components. False where one is so thin, or has turned in such a way, that the mesh is no longer
/// what it was.
bool VertexMotion::volumesAfter(const TriMesh& mesh, const Bounds& bounds, std::vector<double>& volumes) {
  const Topology& topology = mesh.topology_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> terms;  // component, place in it
  terms.reserve(triangles_.size());
  for (const std::uint32_t t : triangles_) {
    if (topology.componentOf[t] == kNone) continue;
    terms.emplace_back(topology.componentOf[t], links_->placeOf.empty() ? t : links_->placeOf[t]);
  }
  if (volume6_.size() > 1) std::sort(terms.begin(), terms.end());
  std::vector<std::uint32_t> changed;
  for (std::size_t i = 0; i < terms.size();) {
    const std::uint32_t c = terms[i].first;
    changed.clear();
    for (; i < terms.size() && terms[i].first == c; ++i) changed.push_back(terms[i].second);
    volume6_[c].update(changed, [&](std::size_t place) {
      const std::size_t t = links_->byComponent.empty() ? place : links_->byComponent[firstOf(c) + place];
      return volume6(mesh.vertices(), mesh.triangles()[t], mesh.origin());
    });
  }
  const double error = largestVolumeError(bounds, mesh.triangleCount());
  bool anyThin = false;
  for (std::size_t c = 0; c < volume6_.size(); ++c) {
    volumes[c] = volume6_[c].total() / 6;
    anyThin = anyThin || std::abs(volumes[c]) <= error;
  }
  if (closedComponents_ == 0) return true;
  std::vector<std::uint32_t> moved;
  for (const auto& [c, place] : terms) {
    if (moved.empty() || moved.back() != c) moved.push_back(c);
  }
  if (closedComponents_ > 1) {
    for (const std::uint32_t t : triangles_) {
      const std::uint32_t c = topology.componentOf[t];
      if (c == kNone) continue;
      for (const std::uint32_t v : mesh.triangles()[t].v) reach_[c].add(mesh.vertices()[v]);
    }
  }
  if (!anyThin && (closedComponents_ == 1 || staysApart(mesh, moved))) {  // nothing is nested in anything
    for (std::size_t c = 0; c < volumes.size(); ++c) {
      if ((topology.componentClosed[c] && volumes[c] > 0) != (wellWound_[c] != 0)) return false;
    }
    return true;
  }
  Topology now;
  now.weld = topology.weld;
  now.componentOf = topology.componentOf;
  now.componentClosed = topology.componentClosed;
  now.componentVolume = std::vector<double>(volumes);
  const std::vector<std::uint8_t> before = std::move(wellWound_);
  measureNesting(mesh, now);
  return wellWound_ == before;
}

void VertexMotion::measureNesting(const TriMesh& mesh, const Topology& topology) {
  const std::vector<std::uint32_t> depths = nestingDepths(topology, mesh.vertices(), mesh.triangles());
  wellWound_ = componentsWellWound(topology, depths, mesh.vertices(), mesh.triangles());
  apart_ = std::all_of(depths.begin(), depths.end(), [](std::uint32_t depth) { return depth == 0; });
  if (closedComponents_ < 2) return;
  reach_.assign(topology.componentCount(), Bounds());
  farthest_.assign(topology.componentCount(), {});
  for (std::size_t t = 0; t < mesh.triangleCount(); ++t) {
    const std::uint32_t c = topology.componentOf[t];
    if (c == kNone) continue;
    for (const std::uint32_t v : mesh.triangles()[t].v) {
      const Vec3f& p = mesh.vertices()[v];
      const Bounds& b = reach_[c];
      const bool beyond[6] = {p.x<b.min.x, p.y<b.min.y, p.z<b.min.z, p.x> b.max.x, p.y> b.max.y, p.z> b.max.z};
      for (int k = 0; k < 6; ++k) {
        if (beyond[k]) farthest_[c][k] = v;
      }
      reach_[c].add(p);
    }
  }
}

/// Whether no component lies in another one, given that none did: what lies in another one has all of its vertices in
/// its bounds. False also where that would take long to find out.
bool VertexMotion::staysApart(const TriMesh& mesh, std::span<const std::uint32_t> changed) const {
  const std::size_t components = reach_.size();
  if (!apart_ || changed.size() * components > mesh.triangleCount()) return false;
  const auto mayLieIn = [&](std::uint32_t inner, const Bounds& outer) {
    return std::all_of(farthest_[inner].begin(), farthest_[inner].end(), [&](std::uint32_t v) {
      const Vec3f& p = mesh.vertices()[v];
      return p.x >= outer.min.x && p.y >= outer.min.y && p.z >= outer.min.z && p.x <= outer.max.x &&
             p.y <= outer.max.y && p.z <= outer.max.z;
    });
  };
  const SharedArray<std::uint8_t>& closed = mesh.topology().componentClosed;
  for (const std::uint32_t c : changed) {
    if (!closed[c]) continue;
    for (std::uint32_t d = 0; d < components; ++d) {
      if (d != c && closed[d] && (mayLieIn(c, reach_[d]) || mayLieIn(d, reach_[c]))) return false;
    }
  }
  return true;
}

bool VertexMotion::tryMove(TriMesh& mesh) {
  if (!keepsPoints(mesh)) return false;
  std::uint32_t last = kNone;
  for (const MovedVertex& move : moves_) {
    const std::uint32_t block = move.vertex / kBlock;
    if (block != last) blocks_[block] = blockOf(mesh, block);  // all vertices are in their places by now
    last = block;
  }
  Bounds bounds;
  for (const Bounds& block : blocks_) {
    if (block.empty()) continue;
    bounds.add(block.min);
    bounds.add(block.max);
  }
  if (!sameBits(originAfterMove(bounds, mesh.origin_), mesh.origin_)) return false;
  if (!keepsArea(mesh)) return false;
  std::vector<double> volumes(volume6_.size());
  if (!volumesAfter(mesh, bounds, volumes)) return false;
  measuresBefore_ = {mesh.boundsMin_, mesh.boundsMax_, mesh.center_, mesh.radius_,
                     std::move(mesh.topology_.componentVolume)};
  mesh.boundsMin_ = bounds.min;
  mesh.boundsMax_ = bounds.max;
  mesh.center_ = middleAsFloat(bounds);
  mesh.radius_ = radiusFrom(largestDistance2(mesh, mesh.center_));
  mesh.topology_.componentVolume = std::move(volumes);
  mesh.mass_.reset();
  return true;
}

}  // namespace otg
