// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace otg {
namespace {

Vec3d minimum(const Vec3d& a, const Vec3d& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3d maximum(const Vec3d& a, const Vec3d& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
double norm(const Vec3d& v) {
  return std::sqrt(otgDot(v, v));
}
Vec3d unit(const Vec3d& v) {
  const double l = norm(v);
  return l > 0 ? otgScale(v, 1 / l) : Vec3d{0, 0, 0};
}

/// The inside stretch of an edge, in the direction from Topology::Edge::a to b.
struct EdgePiece {
  Vec3d from, to;                        ///< relative to the origin
  std::uint32_t fromElement, toElement;  ///< union-find elements at the ends
  bool fromVertex, toVertex;
};

/// Union-find elements: crossings first, then inside vertices of A, then of B.
class Builder {
 public:
  Builder(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, OverlapRegions& out)
      : meshes_(meshes), contour_(contour), inside_(inside), out_(out) {
    vertexBase_[0] = static_cast<std::uint32_t>(contour.crossings.size());
    vertexBase_[1] = vertexBase_[0] + static_cast<std::uint32_t>(inside.vertices[0].size());
    elements_ = vertexBase_[1] + static_cast<std::uint32_t>(inside.vertices[1].size());
  }

  void run() {
    out_.regions.clear();
    out_.pieces.clear();
    out_.points.clear();
    out_.anomalies = 0;
    if (elements_ == 0) return;
    out_.origin = elementPosition(0);
    unite();
    numberRegions();
    collectActive();
    for (int m = 0; m < 2; ++m) {
      for (const std::uint32_t t : out_.active[m]) clipTriangle(m, t);
    }
    collectPoints();
    group();
    measure();
  }

 private:
  Vec3d elementPosition(std::uint32_t e) const {  // in A's frame
    if (e < vertexBase_[0]) return contour_.crossings[e].point;
    const int m = e < vertexBase_[1] ? 0 : 1;
    return meshes_.vertex(m, inside_.vertices[m][e - vertexBase_[m]]);
  }
  Vec3d relative(const Vec3d& p) const { return otgSub(p, out_.origin); }

  std::uint32_t find(std::uint32_t e) {
    while (out_.parent[e] != e) {
      out_.parent[e] = out_.parent[out_.parent[e]];
      e = out_.parent[e];
    }
    return e;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) out_.parent[std::max(a, b)] = std::min(a, b);  // the smallest element names the set
  }

  std::uint32_t vertexElement(int m, std::uint32_t v) const {
    const std::uint32_t i = inside_.index[m].find(v);
    return i == FlatMap::kMissing ? kNone : vertexBase_[m] + i;
  }

  /// Calls fn(EdgePiece) for every inside stretch of the edge. Stretches whose ends contradict the vertices' flags are
  /// left out and counted.
  template <class Fn>
  void forEachPiece(int m, std::uint32_t edge, const Fn& fn) {
    const Topology::Edge& ends = meshes_.mesh(m).topology().edges[edge];
    const std::uint32_t a = vertexElement(m, ends.a), b = vertexElement(m, ends.b);
    const Contour::Range range = contour_.on(m, edge);
    if (range.begin == range.end) {
      if (a == kNone || b == kNone) return;
      fn(EdgePiece{relative(elementPosition(a)), relative(elementPosition(b)), a, b, true, true});
      return;
    }
    std::uint32_t open = a;
    bool openVertex = true, isOpen = a != kNone;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const std::uint32_t c = contour_.alongEdge[i];
      if (contour_.crossings[c].exits) {
        if (isOpen) {
          fn(EdgePiece{relative(elementPosition(open)), relative(elementPosition(c)), open, c, openVertex, false});
        } else {
          ++out_.anomalies;
        }
        isOpen = false;
      } else {
        if (isOpen) ++out_.anomalies;
        open = c;
        openVertex = false;
        isOpen = true;
      }
    }
    if (isOpen != (b != kNone)) ++out_.anomalies;
    if (isOpen && b != kNone) {
      fn(EdgePiece{relative(elementPosition(open)), relative(elementPosition(b)), open, b, openVertex, true});
    }
  }

  void unite() {
    out_.parent.resize(elements_);
    for (std::uint32_t e = 0; e < elements_; ++e) out_.parent[e] = e;
    for (const Chord& chord : contour_.chords) join(chord.start, chord.end);
    for (int m = 0; m < 2; ++m) {
      for (const std::uint32_t edge : contour_.crossedEdges[m]) {
        forEachPiece(m, edge, [&](const EdgePiece& p) { join(p.fromElement, p.toElement); });
      }
      const Adjacency& adjacency = meshes_.adjacency(m);
      const TriMesh& mesh = meshes_.mesh(m);
      for (std::uint32_t i = 0; i < inside_.vertices[m].size(); ++i) {
        const std::uint32_t v = inside_.vertices[m][i];
        for (std::uint32_t h = adjacency.first[v]; h < adjacency.first[v + 1]; ++h) {
          const std::uint32_t half = adjacency.halfEdges[h];
          if (contour_.firstOn[m].find(mesh.topology().edgeOf[half]) != FlatMap::kMissing) continue;
          const std::uint32_t w = vertexElement(m, otherEnd(mesh, half));
          if (w != kNone) join(vertexBase_[m] + i, w);
        }
      }
      // A contour that stays within one triangle whose corners are all inside hangs together with them.
      for (const Chord& chord : contour_.chords) {
        const Triangle& t = mesh.triangles()[m == 0 ? chord.triangleA : chord.triangleB];
        std::uint32_t corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = vertexElement(m, mesh.topology().weld[t.v[k]]);
        if (corner[0] != kNone && corner[1] != kNone && corner[2] != kNone) join(chord.start, corner[0]);
      }
    }
    anomaliesOfUnite_ = out_.anomalies;
  }

  static std::uint32_t otherEnd(const TriMesh& mesh, std::uint32_t half) {
    return mesh.topology().weld[mesh.triangles()[half / 3].v[(half % 3 + 1) % 3]];
  }

  void numberRegions() {
    out_.regionOf.assign(elements_, kNone);
    std::uint32_t count = 0;
    for (std::uint32_t e = 0; e < elements_; ++e) {
      const std::uint32_t root = find(e);
      if (out_.regionOf[root] == kNone) out_.regionOf[root] = count++;
      out_.regionOf[e] = out_.regionOf[root];
    }
    const double inf = std::numeric_limits<double>::infinity();
    Region empty{};
    empty.lo = {inf, inf, inf};
    empty.hi = {-inf, -inf, -inf};
    out_.regions.assign(count, empty);
    for (std::uint32_t e = 0; e < elements_; ++e) {
      Region& region = out_.regions[out_.regionOf[e]];
      const Vec3d p = relative(elementPosition(e));
      region.lo = minimum(region.lo, p);
      region.hi = maximum(region.hi, p);
    }
  }

  /// Triangles with a chord or an inside corner, and their chords.
  void collectActive() {
    for (int m = 0; m < 2; ++m) {
      out_.active[m].clear();
      out_.activeIndex[m].clear();
      out_.chordHead[m].clear();
      out_.chordNext[m].assign(contour_.chords.size(), kNone);
      const auto activate = [&](std::uint32_t t) {
        bool inserted = false;
        const std::uint32_t i =
            out_.activeIndex[m].insert(t, static_cast<std::uint32_t>(out_.active[m].size()), &inserted);
        if (inserted) {
          out_.active[m].push_back(t);
          out_.chordHead[m].push_back(kNone);
        }
        return i;
      };
      for (std::uint32_t c = 0; c < contour_.chords.size(); ++c) {
        const std::uint32_t i = activate(m == 0 ? contour_.chords[c].triangleA : contour_.chords[c].triangleB);
        out_.chordNext[m][c] = out_.chordHead[m][i];
        out_.chordHead[m][i] = c;
      }
      const Adjacency& adjacency = meshes_.adjacency(m);
      for (const std::uint32_t v : inside_.vertices[m]) {
        for (std::uint32_t h = adjacency.first[v]; h < adjacency.first[v + 1]; ++h) {
          activate(adjacency.halfEdges[h] / 3);
        }
      }
    }
  }

  struct Loop {  // what bounds the part of one triangle in one region
    std::uint32_t region;
    Vec3d sum{0, 0, 0};
    Vec3d lo, hi;
  };

  /// Area by the boundary: half the sum of p x q over the directed boundary segments.
  void clipTriangle(int m, std::uint32_t t) {
    const TriMesh& mesh = meshes_.mesh(m);
    const Topology& topology = mesh.topology();
    const Vec3d corner = relative(meshes_.vertex(m, mesh.triangles()[t].v[0]));
    loops_.clear();
    const auto add = [&](std::uint32_t element, const Vec3d& p, const Vec3d& q) {
      const std::uint32_t region = out_.regionOf[element];
      Loop* loop = nullptr;
      for (Loop& l : loops_) {
        if (l.region == region) loop = &l;
      }
      if (!loop) {
        loops_.push_back({region, {0, 0, 0}, p, p});
        loop = &loops_.back();
      }
      loop->sum = otgAdd(loop->sum, otgCross(otgSub(p, corner), otgSub(q, corner)));
      loop->lo = minimum(loop->lo, minimum(p, q));
      loop->hi = maximum(loop->hi, maximum(p, q));
    };
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t half = 3 * t + static_cast<std::uint32_t>(k);
      const std::uint32_t edge = topology.edgeOf[half];
      if (edge == kNone) continue;
      const bool forward = topology.weld[mesh.triangles()[t].v[k]] == topology.edges[edge].a;
      forEachPiece(m, edge, [&](const EdgePiece& p) {
        forward ? add(p.fromElement, p.from, p.to) : add(p.fromElement, p.to, p.from);
      });
    }
    for (std::uint32_t c = out_.chordHead[m][out_.activeIndex[m].find(t)]; c != kNone; c = out_.chordNext[m][c]) {
      const Vec3d p = relative(contour_.crossings[contour_.chords[c].start].point);
      const Vec3d q = relative(contour_.crossings[contour_.chords[c].end].point);
      m == 0 ? add(contour_.chords[c].start, p, q) : add(contour_.chords[c].start, q, p);
    }
    const Vec3d n = meshes_.normal(m, t);
    for (const Loop& loop : loops_) {
      const double area = 0.5 * otgDot(loop.sum, n);
      if (!(area > 0)) continue;  // slivers that rounding turned over
      out_.pieces.push_back(
          {loop.region, t, static_cast<std::uint8_t>(m), n, area, otgDot(n, corner), loop.lo, loop.hi});
    }
  }

  void collectPoints() {
    for (int m = 0; m < 2; ++m) {
      const Adjacency& adjacency = meshes_.adjacency(m);
      for (std::uint32_t i = 0; i < inside_.vertices[m].size(); ++i) {
        const std::uint32_t v = inside_.vertices[m][i];
        SupportPoint p = pointOf(m, vertexBase_[m] + i, PointKind::kVertex, v);
        Vec3d sum{0, 0, 0};
        for (std::uint32_t h = adjacency.first[v]; h < adjacency.first[v + 1]; ++h) {
          sum = otgAdd(sum, adjacency.normal[adjacency.halfEdges[h] / 3]);
        }
        p.surfaceNormal = meshes_.directionFromLocal(m, unit(sum));
        (m == 0 ? p.triangleA : p.triangleB) = adjacency.halfEdges[adjacency.first[v]] / 3;
        out_.points.push_back(p);
      }
      for (const std::uint32_t edge : contour_.crossedEdges[m]) pointsOfEdge(m, edge);
    }
    out_.anomalies = anomaliesOfUnite_;  // every pass over the edges counts the same ones again
  }

  SupportPoint pointOf(int m, std::uint32_t element, PointKind kind, std::uint32_t feature) const {
    SupportPoint p{};
    p.position = relative(elementPosition(element));
    p.region = out_.regionOf[element];
    p.mesh = static_cast<std::uint8_t>(m);
    p.kind = kind;
    p.feature = feature;
    p.triangleA = p.triangleB = kNone;
    return p;
  }

  /// The ends of the edge's inside stretches that are crossings, and their middles where something can rest on them.
  void pointsOfEdge(int m, std::uint32_t edge) {
    const TriMesh& mesh = meshes_.mesh(m);
    const Adjacency& adjacency = meshes_.adjacency(m);
    const std::uint32_t half = halfEdgeOf(mesh, adjacency, edge);
    const std::uint32_t triangle = half == kNone ? kNone : half / 3;
    Vec3d normal{0, 0, 0};
    if (half != kNone) {
      normal = adjacency.normal[half / 3];
      const std::uint32_t twin = mesh.topology().twin[half];
      if (twin != kNone) normal = unit(otgAdd(normal, adjacency.normal[twin / 3]));
      normal = meshes_.directionFromLocal(m, normal);
    }
    std::uint32_t stretch = 0;
    forEachPiece(m, edge, [&](const EdgePiece& piece) {
      const Vec3d d = otgSub(piece.to, piece.from);
      const double length = norm(d);
      const std::uint32_t k = stretch++;
      const auto crossing = [&](std::uint32_t element, const Vec3d& along, std::uint32_t ordinal) {
        SupportPoint p = pointOf(m, element, PointKind::kCrossing, edge);
        p.along = along;
        p.reach = length;
        p.surfaceNormal = normal;
        p.ordinal = ordinal;
        p.triangleA = m == 0 ? triangle : contour_.crossings[element].triangle;
        p.triangleB = m == 0 ? contour_.crossings[element].triangle : triangle;
        out_.points.push_back(p);
      };
      if (!piece.fromVertex) crossing(piece.fromElement, unit(d), 2 * k);
      if (!piece.toVertex) crossing(piece.toElement, unit(otgScale(d, -1.0)), 2 * k + 1);
      if (adjacency.flatEdge[edge] || (piece.fromVertex && piece.toVertex)) return;
      SupportPoint p =
          pointOf(m, piece.fromElement,
                  piece.fromVertex || piece.toVertex ? PointKind::kMiddle : PointKind::kMiddleOfContour, edge);
      p.position = otgScale(otgAdd(piece.from, piece.to), 0.5);
      p.surfaceNormal = normal;
      p.ordinal = k;
      (m == 0 ? p.triangleA : p.triangleB) = triangle;
      out_.points.push_back(p);
    });
  }

  static std::uint32_t halfEdgeOf(const TriMesh& mesh, const Adjacency& adjacency, std::uint32_t edge) {
    const std::uint32_t a = mesh.topology().edges[edge].a;
    for (std::uint32_t h = adjacency.first[a]; h < adjacency.first[a + 1]; ++h) {
      if (mesh.topology().edgeOf[adjacency.halfEdges[h]] == edge) return adjacency.halfEdges[h];
    }
    return kNone;
  }

  /// Stable counting sorts of pieces and points by region.
  void group() {
    const auto sortByRegion = [&](auto& items, auto begin, auto end) {
      std::stable_sort(items.begin(), items.end(), [](const auto& x, const auto& y) { return x.region < y.region; });
      std::uint32_t i = 0;
      for (std::uint32_t r = 0; r < out_.regions.size(); ++r) {
        out_.regions[r].*begin = i;
        while (i < items.size() && items[i].region == r) ++i;
        out_.regions[r].*end = i;
      }
    };
    sortByRegion(out_.pieces, &Region::pieceBegin, &Region::pieceEnd);
    sortByRegion(out_.points, &Region::pointBegin, &Region::pointEnd);
  }

  void measure() {
    for (Region& region : out_.regions) {
      Vec3d sumA{0, 0, 0}, sumB{0, 0, 0};
      double volume = 0;
      const Vec3d middle = otgScale(otgAdd(region.lo, region.hi), 0.5);
      for (std::uint32_t i = region.pieceBegin; i < region.pieceEnd; ++i) {
        const Piece& p = out_.pieces[i];
        Vec3d& sum = p.mesh == 0 ? sumA : sumB;
        (p.mesh == 0 ? region.areaA : region.areaB) += p.area;
        sum = otgAdd(sum, otgScale(p.normal, p.area));
        volume += (p.offset - otgDot(p.normal, middle)) * p.area / 3;
      }
      region.volume = volume;
      region.push = otgScale(otgSub(sumB, sumA), 0.5);
      region.diagonal = norm(otgSub(region.hi, region.lo));
      const double total = region.areaA + region.areaB;
      region.thickness = total > 0 ? std::max(0.0, 2 * volume / total) : 0;
      const double push = norm(region.push);
      region.coherence = std::min(
          1.0, std::max(region.areaA > 0 ? push / region.areaA : 0, region.areaB > 0 ? push / region.areaB : 0));
      region.bad = norm(otgAdd(sumA, sumB)) > 0.05 * total || volume < -1e-3 * total * region.diagonal;
    }
  }

  const PlacedMeshes& meshes_;
  const Contour& contour_;
  const InsideFlags& inside_;
  OverlapRegions& out_;
  std::uint32_t vertexBase_[2], elements_;
  std::vector<Loop> loops_;
  std::size_t anomaliesOfUnite_ = 0;
};

}  // namespace

void buildRegions(const PlacedMeshes& meshes, const Contour& contour, const InsideFlags& inside, OverlapRegions& out) {
  Builder(meshes, contour, inside, out).run();
}

}  // namespace otg
