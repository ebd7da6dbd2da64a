// SPDX-License-Identifier: BSD-3-Clause
#include "collide/solid/contour.h"

#include <algorithm>
#include <cmath>

#include "base/vectors.h"
#include "shared/contacts/solid_model.h"
#include "shared/tests/sos.h"

namespace otg {
namespace {

/// The lines along a triangle's edges: directions, and moments about an origin.
struct EdgeLines {
  Vec3d along[3], moment[3];
  double length = 0, turn = 0;  ///< the largest sum of a direction's coordinates; of a moment's coordinate's two terms

  void set(const Vec3d* corners, const Vec3d& origin) {
    length = turn = 0;
    Vec3d p = corners[0] - origin;
    const Vec3d first = p;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d q = k == 2 ? first : corners[k + 1] - origin, d = corners[(k + 1) % 3] - corners[k];
      const double yz = p.y * q.z, zy = p.z * q.y, zx = p.z * q.x, xz = p.x * q.z, xy = p.x * q.y, yx = p.y * q.x;
      along[k] = d;
      moment[k] = {yz - zy, zx - xz, xy - yx};
      length = std::max(length, std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z));
      turn =
          std::max({turn, std::fabs(yz) + std::fabs(zy), std::fabs(zx) + std::fabs(xz), std::fabs(xy) + std::fabs(yx)});
      p = q;
    }
  }
};

/// otgOrient3Filter() of one triangle and many points.
class PlaneFilter {
 public:
  void set(const Vec3d* corners) {
    from_ = corners[0];
    const Vec3d u = corners[1] - from_, v = corners[2] - from_;
    const double yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z, xy = u.x * v.y, yx = u.y * v.x;
    normal_ = {yz - zy, zx - xz, xy - yx};
    sums_ = {std::fabs(yz) + std::fabs(zy), std::fabs(zx) + std::fabs(xz), std::fabs(xy) + std::fabs(yx)};
  }
  /// 1 where the normal points, -1 behind, 0 where double arithmetic cannot decide.
  int operator()(const Vec3d& point) const {
    const Vec3d w = point - from_;
    const double det = w.x * normal_.x + w.y * normal_.y + w.z * normal_.z;
    const double permanent = std::fabs(w.x) * sums_.x + std::fabs(w.y) * sums_.y + std::fabs(w.z) * sums_.z;
    const double bound = 8.0e-16 * permanent + OTG_TINY_DETERMINANT;
    return det > bound ? 1 : det < -bound ? -1 : 0;
  }

 private:
  Vec3d from_{0, 0, 0}, normal_{0, 0, 0};
  Vec3d sums_{0, 0, 0};  ///< of the sizes of the terms in the normal's coordinates
};

struct PairCorners {
  Vec3d a[3], b[3];
};

class Tracer {
 public:
  Tracer(const PlacedMeshes& meshes, Contour& contour) : meshes_(meshes), contour_(contour) {}

  void pair(const TrianglePair& pair) {
    const Triangle& ta = meshes_.mesh(0).triangles()[pair.a];
    const Triangle& tb = meshes_.mesh(1).triangles()[pair.b];
    PairCorners& c = corners_;
    const bool isNewA = pair.a != triangleA_;
    for (int k = 0; k < 3; ++k) {
      if (isNewA) c.a[k] = meshes_.vertex(0, ta.v[k]);
      c.b[k] = meshes_.vertex(1, tb.v[k]);
    }
    if (isNewA) {
      triangleA_ = pair.a;
      linesA_.set(c.a, c.a[0]);
      planeA_.set(c.a);
    }
    int sideA[3], sideB[3];
    PlaneFilter planeB;
    planeB.set(c.b);
    for (int k = 0; k < 3; ++k) {
      sideA[k] = planeB(c.a[k]);
      if (sideA[k] == 0) sideA[k] = exactSide(0, k);
    }
    if (sideA[0] == sideA[1] && sideA[1] == sideA[2]) return;
    for (int k = 0; k < 3; ++k) {
      sideB[k] = planeA_(c.b[k]);
      if (sideB[k] == 0) sideB[k] = exactSide(1, k);
    }
    if (sideB[0] == sideB[1] && sideB[1] == sideB[2]) return;

    // Edge-edge signs, each needed for both triangles: [edge of A][edge of B].
    int sign[3][3] = {};
    EdgeLines lines;
    lines.set(c.b, c.a[0]);
    const double bound =
        kLineError * (linesA_.length * lines.turn + lines.length * linesA_.turn) + OTG_TINY_DETERMINANT;
    const auto edges = [&](int i, int j) {
      if (sign[i][j] != 0) return sign[i][j];
      const double det = otgDot(linesA_.along[i], lines.moment[j]) + otgDot(lines.along[j], linesA_.moment[i]);
      sign[i][j] = std::fabs(det) > bound ? (det > 0 ? 1 : -1) : exactEdges(i, j);
      return sign[i][j];
    };
    std::uint32_t start = kNone, end = kNone;
    int found = 0;
    const auto note = [&](std::uint32_t id, bool starts) {
      ++found;
      (starts ? start : end) = id;
    };
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if (sideA[k] != sideA[next] && edges(k, 0) == edges(k, 1) && edges(k, 1) == edges(k, 2)) {
        const bool exits = sideA[next] > 0;
        note(add(0, 3 * pair.a + static_cast<std::uint32_t>(k), pair.b, exits, c.b), exits);
      }
      if (sideB[k] != sideB[next] && edges(0, k) == edges(1, k) && edges(1, k) == edges(2, k)) {
        const bool exits = sideB[next] > 0;
        note(add(1, 3 * pair.b + static_cast<std::uint32_t>(k), pair.a, exits, c.a), !exits);
      }
    }
    if (found == 0) return;
    if (found != 2 || start == kNone || end == kNone) {
      ++contour_.anomalies;
      return;
    }
    contour_.chords.push_back({pair.a, pair.b, start, end});
  }

  /// Prefetches the memory that a pair needs: first its triangles' edges, next what they lead to.
  void prefetch(const TrianglePair& pair, int stage) const {
    for (int m = 0; m < 2; ++m) {
      const TriMesh& mesh = meshes_.mesh(m);
      const Topology& topology = mesh.topology();
      const std::uint32_t t = m == 0 ? pair.a : pair.b;
      if (stage == 0) {
        __builtin_prefetch(&topology.edgeOf[3 * std::size_t{t}]);
        __builtin_prefetch(&mesh.triangles()[t]);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t edge = topology.edgeOf[3 * std::size_t{t} + k], v = mesh.triangles()[t].v[k];
        __builtin_prefetch(&mesh.vertices()[v]);
        __builtin_prefetch(&topology.weld[v]);
        if (edge == kNone) continue;
        __builtin_prefetch(&topology.edges[edge]);
        contour_.lastOn[m].prefetch(edge);
      }
    }
  }

  /// Orders the crossings of every edge and checks that they alternate.
  void sortAlongEdges() {
    const std::vector<Crossing>& all = contour_.crossings;
    std::vector<std::uint32_t>& along = contour_.alongEdge;
    for (int m = 0; m < 2; ++m) {
      for (const std::uint32_t edge : contour_.crossedEdges[m]) {
        const auto begin = static_cast<std::uint32_t>(along.size());
        for (std::uint32_t c = contour_.lastOn[m].find(edge); c != kNone; c = contour_.previousOn[c])
          along.push_back(c);
        const auto end = static_cast<std::uint32_t>(along.size());
        std::sort(along.begin() + begin, along.end(), [&](std::uint32_t x, std::uint32_t y) {
          return all[x].t != all[y].t ? all[x].t < all[y].t : all[x].triangle < all[y].triangle;
        });
        orderTies(begin, end);
        alternate(begin, end);
        contour_.firstOn[m].set(edge, begin);
      }
    }
  }

 private:
  /// Of the sum of six products with a moment's two terms each: 12 roundings of 2^-53, rounded up.
  static constexpr double kLineError = 2e-15;

  /// Of corner k of a triangle with respect to the other one.
  [[gnu::noinline]] int exactSide(int mesh, int k) const {
    const PairCorners& c = corners_;
    return mesh == 0 ? otgSosSideOfA(&c.b[0].x, &c.b[1].x, &c.b[2].x, &c.a[k].x)
                     : otgSosSideOfB(&c.a[0].x, &c.a[1].x, &c.a[2].x, &c.b[k].x);
  }

  /// As otgSosEdges; of parallel edges no sign is needed.
  [[gnu::noinline]] int exactEdges(int i, int j) const {
    const PairCorners& c = corners_;
    const int sign = otgSosEdges(&c.a[i].x, &c.a[(i + 1) % 3].x, &c.b[j].x, &c.b[(j + 1) % 3].x);
    return sign == 0 ? 1 : sign;
  }

  /// Insertion sort of the few that lie in one point: the comparison with tolerance need not be transitive.
  void orderTies(std::uint32_t begin, std::uint32_t end) {
    const std::vector<Crossing>& all = contour_.crossings;
    std::vector<std::uint32_t>& along = contour_.alongEdge;
    for (std::uint32_t i = begin + 1; i < end; ++i) {
      for (std::uint32_t j = i; j > begin; --j) {
        const Crossing &x = all[along[j]], &y = all[along[j - 1]];
        if (x.t - y.t > OTG_SOLID_ONE_POINT || !otgCrossesBefore(x.drift, x.exits, y.drift, y.exits)) break;
        std::swap(along[j], along[j - 1]);
      }
    }
  }

  /// Crossings that are closer together than their rounding may have come out in the wrong order. So may those of two
  /// faces of one mesh that lie on each other, as of a box that stands on another one. Of an odd number the first and
  /// the last are of the kind of which there are more.
  void alternate(std::uint32_t begin, std::uint32_t end) {
    std::vector<Crossing>& all = contour_.crossings;
    std::vector<std::uint32_t>& along = contour_.alongEdge;
    const auto exits = [&](std::uint32_t i) { return all[along[i]].exits; };
    std::uint32_t leaving = 0;
    for (std::uint32_t i = begin; i < end; ++i) leaving += exits(i) ? 1 : 0;
    bool expected = 2 * leaving == end - begin ? exits(begin) : 2 * leaving > end - begin;
    for (std::uint32_t i = begin; i < end; ++i, expected = !expected) {
      if (exits(i) == expected) continue;
      std::uint32_t j = i + 1;
      while (j < end && exits(j) != expected) ++j;
      if (j < end && std::fabs(all[along[j]].t - all[along[i]].t) < OTG_SOLID_CLOSE_POINTS) {
        std::rotate(along.begin() + i, along.begin() + j, along.begin() + j + 1);
      } else {
        ++contour_.anomalies;
        break;
      }
    }
  }

  std::uint32_t add(int mesh, std::uint32_t halfEdge, std::uint32_t triangle, bool exits, const Vec3d* other) {
    const TriMesh& m = meshes_.mesh(mesh);
    const Topology& topology = m.topology();
    const std::uint32_t edge = topology.edgeOf[halfEdge];
    const std::uint32_t last = contour_.lastOn[mesh].find(edge);
    for (std::uint32_t c = last; c != kNone; c = contour_.previousOn[c]) {
      if (contour_.crossings[c].triangle == triangle) return c;
    }
    const auto id = static_cast<std::uint32_t>(contour_.crossings.size());
    contour_.lastOn[mesh].set(edge, id);
    contour_.previousOn.push_back(last);
    if (last == kNone) contour_.crossedEdges[mesh].push_back(edge);
    const Topology::Edge& ends = topology.edges[edge];
    const Triangle& t = m.triangles()[halfEdge / 3];
    const bool forward = topology.weld[t.v[halfEdge % 3]] == ends.a;
    const Vec3d p = meshes_.vertex(mesh, ends.a), q = meshes_.vertex(mesh, ends.b);
    Vec3d drift;
    const double at = otgHitPlane(mesh, p, q, other, &drift);
    contour_.crossings.push_back(
        {edge, triangle, static_cast<std::uint8_t>(mesh), exits == forward, at, p + (q - p) * at, drift});
    return id;
  }

  const PlacedMeshes& meshes_;
  Contour& contour_;
  // Of the last pair; pairs of one triangle of A come in a row.
  std::uint32_t triangleA_ = kNone;
  PairCorners corners_;
  EdgeLines linesA_;
  PlaneFilter planeA_;
};

}  // namespace

Contour::Range Contour::on(int mesh, std::uint32_t edge) const {
  const std::uint32_t begin = firstOn[mesh].find(edge);
  if (begin == EpochArray::kMissing) return {0, 0};
  std::uint32_t end = begin + 1;
  while (end < alongEdge.size() && crossings[alongEdge[end]].edge == edge && crossings[alongEdge[end]].mesh == mesh) {
    ++end;
  }
  return {begin, end};
}

void traceContour(const PlacedMeshes& meshes, const std::vector<TrianglePair>& intersecting, Contour& contour) {
  contour.crossings.clear();
  contour.chords.clear();
  contour.alongEdge.clear();
  contour.previousOn.clear();
  contour.anomalies = 0;
  for (int m = 0; m < 2; ++m) {
    contour.firstOn[m].reset(meshes.mesh(m).topology().edgeCount());
    contour.lastOn[m].reset(meshes.mesh(m).topology().edgeCount());
    contour.crossedEdges[m].clear();
  }
  Tracer tracer(meshes, contour);
  for (std::size_t i = 0; i < intersecting.size(); ++i) {
    if (i + 8 < intersecting.size()) tracer.prefetch(intersecting[i + 8], 0);
    if (i + 4 < intersecting.size()) tracer.prefetch(intersecting[i + 4], 1);
    tracer.pair(intersecting[i]);
  }
  tracer.sortAlongEdges();
}

}  // namespace otg
