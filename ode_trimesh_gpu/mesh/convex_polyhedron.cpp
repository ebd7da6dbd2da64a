// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/convex_polyhedron.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/grid_place.h"
#include "base/vectors.h"

namespace otg {

std::uint32_t ConvexPolyhedron::support(const Vec3d& direction) const {
  if (x_.empty()) return climb(starts_[cellOf(direction)], direction);
  double along[kMostScanned];
  const std::size_t n = x_.size();
  for (std::size_t i = 0; i < n; ++i) along[i] = direction.x * x_[i] + direction.y * y_[i] + direction.z * z_[i];
  std::size_t best = 0;
  for (std::size_t i = 1; i < n; ++i) best = along[i] > along[best] ? i : best;
  return static_cast<std::uint32_t>(best);
}

ConvexPolyhedron::Reach ConvexPolyhedron::reach(const Vec3d& direction) const {
  if (x_.empty()) {
    return {otgDot(vertices_[support(otgScale(direction, -1.0))], direction),
            otgDot(vertices_[support(direction)], direction)};
  }
  Reach reach{0, 0};
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double along = direction.x * x_[i] + direction.y * y_[i] + direction.z * z_[i];
    reach.least = i == 0 || along < reach.least ? along : reach.least;
    reach.most = i == 0 || along > reach.most ? along : reach.most;
  }
  return reach;
}

/// On a convex body a vertex is farthest of all if it is farther than its neighbours.
std::uint32_t ConvexPolyhedron::climb(std::uint32_t from, const Vec3d& direction) const {
  double most = otgDot(vertices_[from], direction);
  for (;;) {
    std::uint32_t next = from;
    for (std::uint32_t i = firstCornerAt_[from]; i < firstCornerAt_[from + 1]; ++i) {
      const double along = otgDot(vertices_[neighbours_[i]], direction);
      if (along > most) {
        most = along;
        next = neighbours_[i];
      }
    }
    if (next == from) return from;
    from = next;
  }
}

std::size_t ConvexPolyhedron::cellOf(const Vec3d& direction) const {
  const double d[3] = {direction.x, direction.y, direction.z};
  std::size_t axis = std::fabs(d[1]) > std::fabs(d[0]) ? 1 : 0;
  if (std::fabs(d[2]) > std::fabs(d[axis])) axis = 2;
  const double scale = 0.5 * static_cast<double>(cells_) / std::fabs(d[axis]), half = 0.5 * static_cast<double>(cells_);
  const auto place = [&](double value) { return gridPlace(half + scale * value, cells_); };
  const std::size_t side = 2 * axis + (d[axis] < 0 ? 1 : 0);
  return (side * cells_ + place(d[(axis + 1) % 3])) * cells_ + place(d[(axis + 2) % 3]);
}

/// Merges triangles to faces, then keeps the corners of the faces.
class PolyhedronBuilder {
 public:
  PolyhedronBuilder(const TriMesh& mesh, Convexity convexity)
      : mesh_(mesh), topology_(mesh.topology()), rounding_(roundingOfVertices(mesh)) {
    out_.convexity_ = convexity;
  }

  /// Null where the faces do not come out as those of a body.
  std::unique_ptr<const ConvexPolyhedron> run() {
    growFaces();
    findCorners();
    if (!walkLoops() || !measureFaces()) return nullptr;
    linkCorners();
    if (!isThickAndConvex()) return nullptr;
    collectDirections();
    fillStarts();
    findBox();
    if (out_.faceCount() <= ConvexPolyhedron::kMostPlanes) describe(out_.geometry_.emplace());
    static std::atomic<std::uint64_t> stamps{0};
    out_.stamp_ = stamps.fetch_add(1, std::memory_order_relaxed) + 1;
    return std::make_unique<const ConvexPolyhedron>(std::move(out_));
  }

 private:
  using Corner = ConvexPolyhedron::Corner;

  Vec3d place(std::uint32_t v) const {
    const Vec3f& p = mesh_.vertices()[v];
    return {p.x, p.y, p.z};
  }
  Vec3d crossOf(std::uint32_t t) const {
    const auto& v = mesh_.triangles()[t].v;
    return otgCross(place(v[1]) - place(v[0]), place(v[2]) - place(v[0]));
  }
  std::uint32_t startOf(std::uint32_t half) const { return topology_.weld[mesh_.triangles()[half / 3].v[half % 3]]; }
  static std::uint32_t nextIn(std::uint32_t half) { return half - half % 3 + (half + 1) % 3; }
  bool isRim(std::uint32_t half) const {
    return out_.faceOfTriangle_[half / 3] != out_.faceOfTriangle_[topology_.twin[half] / 3];
  }
  /// The half-edge after this one on the rim of its face.
  std::uint32_t nextOnRim(std::uint32_t half) const {
    half = nextIn(half);
    while (!isRim(half)) half = nextIn(topology_.twin[half]);
    return half;
  }

  /// From the largest triangle that has no face yet over all that lie in its plane: always its own, so that a curved
  /// surface of many small triangles is not taken for a face.
  void growFaces() {
    const auto count = static_cast<std::uint32_t>(mesh_.triangleCount());
    std::vector<double> size(count);
    std::vector<std::uint32_t> order(count), open;
    for (std::uint32_t t = 0; t < count; ++t) {
      const Vec3d cross = crossOf(t);
      size[t] = otgDot(cross, cross);
      order[t] = t;
    }
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t x, std::uint32_t y) { return size[x] != size[y] ? size[x] > size[y] : x < y; });
    out_.faceOfTriangle_.assign(count, kNone);
    for (const std::uint32_t seed : order) {
      if (out_.faceOfTriangle_[seed] != kNone) continue;
      const Vec3d normal = unit(crossOf(seed)), origin = place(mesh_.triangles()[seed].v[0]);
      const auto belongs = [&](std::uint32_t t) {
        if (out_.faceOfTriangle_[t] != kNone || !(otgDot(crossOf(t), normal) > 0)) return false;
        return std::all_of(std::begin(mesh_.triangles()[t].v), std::end(mesh_.triangles()[t].v),
                           [&](std::uint32_t v) { return std::fabs(otgDot(place(v) - origin, normal)) <= rounding_; });
      };
      out_.faceOfTriangle_[seed] = faceCount_;
      open.assign(1, seed);
      while (!open.empty()) {
        const std::uint32_t t = open.back();
        open.pop_back();
        for (std::uint32_t half = 3 * t; half < 3 * t + 3; ++half) {
          const std::uint32_t other = topology_.twin[half] / 3;
          if (!belongs(other)) continue;
          out_.faceOfTriangle_[other] = faceCount_;
          open.push_back(other);
        }
      }
      ++faceCount_;
    }
  }

  /// Where three faces meet; and where an edge between two is not straight, all vertices on it.
  void findCorners() {
    std::vector<std::uint8_t> rims(mesh_.vertices().size(), 0);
    const auto halves = static_cast<std::uint32_t>(3 * mesh_.triangleCount());
    for (std::uint32_t half = 0; half < halves; ++half) {
      std::uint8_t& count = rims[startOf(half)];
      if (isRim(half) && count < 3) ++count;
    }
    isCorner_.resize(rims.size());
    std::transform(rims.begin(), rims.end(), isCorner_.begin(), [](std::uint8_t n) { return n >= 3; });
    std::vector<std::uint32_t> between;
    for (std::uint32_t half = 0; half < halves; ++half) {
      // From one side alone, so that both sides get the same.
      if (rims[startOf(half)] < 3 || !isRim(half)) continue;
      if (out_.faceOfTriangle_[half / 3] > out_.faceOfTriangle_[topology_.twin[half] / 3]) continue;
      between.clear();
      std::uint32_t at = nextOnRim(half);
      for (; rims[startOf(at)] < 3; at = nextOnRim(at)) between.push_back(startOf(at));
      const Vec3d from = place(startOf(half)), along = unit(place(startOf(at)) - from);
      const bool isStraight = std::all_of(between.begin(), between.end(), [&](std::uint32_t v) {
        return norm(otgCross(place(v) - from, along)) <= rounding_;
      });
      if (isStraight) continue;
      for (const std::uint32_t v : between) isCorner_[v] = true;
    }
  }

  bool walkLoops() {
    const auto halves = static_cast<std::uint32_t>(3 * mesh_.triangleCount());
    std::vector<std::uint32_t> numberOf(mesh_.vertices().size(), kNone), firstRim(faceCount_, kNone);
    std::vector<std::size_t> rims(faceCount_, 0);
    for (std::uint32_t half = 0; half < halves; ++half) {
      if (!isRim(half)) continue;
      const std::uint32_t face = out_.faceOfTriangle_[half / 3];
      ++rims[face];
      if (firstRim[face] == kNone && isCorner_[startOf(half)]) firstRim[face] = half;
    }
    for (std::uint32_t v = 0; v < isCorner_.size(); ++v) {
      if (!isCorner_[v]) continue;
      numberOf[v] = static_cast<std::uint32_t>(out_.vertices_.size());
      out_.vertices_.push_back(place(v));
      out_.meshVertex_.push_back(v);
    }
    out_.leastTriangle_.assign(out_.vertices_.size(), kNone);
    for (std::uint32_t half = 0; half < halves; ++half) {
      const std::uint32_t v = numberOf[startOf(half)];
      if (v != kNone) out_.leastTriangle_[v] = std::min(out_.leastTriangle_[v], half / 3);
    }
    for (std::uint32_t face = 0; face < faceCount_; ++face) {
      const std::uint32_t first = firstRim[face];
      const auto begin = static_cast<std::uint32_t>(out_.corners_.size());
      out_.faces_.push_back({{}, 0, begin});
      if (first == kNone) return false;
      std::size_t walked = 0;
      std::uint32_t half = first;
      do {
        if (++walked > rims[face]) return false;
        if (isCorner_[startOf(half)]) {
          const std::uint32_t across = out_.faceOfTriangle_[topology_.twin[half] / 3];
          out_.corners_.push_back({numberOf[startOf(half)], 0, face, across, half / 3, kNone, false});
        }
        Corner& corner = out_.corners_.back();
        if (const std::uint32_t edge = topology_.edgeOf[half]; edge < corner.edge) {
          corner.edge = edge;
          corner.isForward = topology_.edges[edge].a == startOf(half);
        }
        half = nextOnRim(half);
      } while (half != first);
      if (walked != rims[face] || out_.corners_.size() < begin + 3) return false;
      for (std::size_t i = begin; i < out_.corners_.size(); ++i) {
        out_.corners_[i].next = out_.corners_[i + 1 < out_.corners_.size() ? i + 1 : begin].vertex;
      }
    }
    out_.faces_.push_back({{}, 0, static_cast<std::uint32_t>(out_.corners_.size())});
    return true;
  }

  bool measureFaces() {
    for (std::uint32_t f = 0; f < faceCount_; ++f) {
      ConvexPolyhedron::Face& face = out_.faces_[f];
      const Vec3d origin = out_.vertices_[out_.corners_[face.corner].vertex];
      Vec3d sum{0, 0, 0};
      for (const Corner& c : out_.corners(f)) {
        sum = sum + otgCross(out_.vertices_[c.vertex] - origin, out_.vertices_[c.next] - origin);
      }
      face.normal = unit(sum);
      if (!(norm(face.normal) > 0)) return false;
      face.offset = otgDot(face.normal, origin);
      for (const Corner& c : out_.corners(f)) {
        face.offset = std::max(face.offset, otgDot(face.normal, out_.vertices_[c.vertex]));
      }
    }
    return true;
  }

  void linkCorners() {
    out_.firstCornerAt_.assign(out_.vertices_.size() + 1, 0);
    for (const Corner& c : out_.corners_) ++out_.firstCornerAt_[c.vertex + 1];
    for (std::size_t v = 0; v < out_.vertices_.size(); ++v) out_.firstCornerAt_[v + 1] += out_.firstCornerAt_[v];
    std::vector<std::uint32_t> next(out_.firstCornerAt_.begin(), out_.firstCornerAt_.end() - 1);
    out_.cornersAt_.resize(out_.corners_.size());
    out_.neighbours_.resize(out_.corners_.size());
    for (std::uint32_t c = 0; c < out_.corners_.size(); ++c) {
      const std::uint32_t to = next[out_.corners_[c].vertex]++;
      out_.cornersAt_[to] = c;
      out_.neighbours_[to] = out_.corners_[c].next;
    }
  }

  /// Where no edge is concave, the faces are those of the body. Else no face may be exceeded by any vertex, which takes
  /// time for each of both.
  bool isThickAndConvex() {
    constexpr double kMostProducts = 2e8;
    const bool all = out_.convexity_ != Convexity::kExact;
    const auto products = static_cast<double>(faceCount_) * static_cast<double>(out_.vertices_.size());
    if (all && products > kMostProducts) return false;
    for (std::uint32_t f = 0; all && f < faceCount_; ++f) {
      const Vec3d normal = out_.faces_[f].normal;
      double most = out_.faces_[f].offset;
      for (const Vec3d& v : out_.vertices_) most = std::max(most, otgDot(normal, v));
      if (most > out_.faces_[f].offset + rounding_) return false;
    }
    // A thin body is thin across one of its large faces.
    const auto thickness = [&](const Vec3d& normal) {
      double least = otgDot(normal, out_.vertices_[0]), most = least;
      for (const Vec3d& v : out_.vertices_) {
        least = std::min(least, otgDot(normal, v));
        most = std::max(most, otgDot(normal, v));
      }
      return most - least;
    };
    constexpr std::uint32_t kMeasured = 16;
    for (std::uint32_t f = 0; f < std::min(faceCount_, kMeasured); ++f) {
      if (!(thickness(out_.faces_[f].normal) > kLeastThickness * rounding_)) return false;
    }
    return true;
  }

  void collectDirections() {
    constexpr double kParallel = 1 - 1e-12;
    for (const Corner& c : out_.corners_) {
      if (c.vertex > c.next) continue;
      const Vec3d along = unit(out_.vertices_[c.next] - out_.vertices_[c.vertex]);
      const bool isKnown = std::any_of(out_.directions_.begin(), out_.directions_.end(),
                                       [&](const Vec3d& d) { return std::fabs(otgDot(d, along)) >= kParallel; });
      if (isKnown) continue;
      if (out_.directions_.size() == ConvexPolyhedron::kMostDirections) {
        out_.directions_.clear();
        return;
      }
      out_.directions_.push_back(along);
    }
  }

  void findBox() {
    constexpr std::size_t kFaces = 6, kVertices = 8;
    if (faceCount_ != kFaces || out_.vertices_.size() != kVertices) return;
    Vec3d low = out_.vertices_[0], high = low;
    for (const Vec3d& v : out_.vertices_) {
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const auto isEnd = [](double x, double least, double most) { return x == least || x == most; };
    for (const Vec3d& v : out_.vertices_) {
      if (!isEnd(v.x, low.x, high.x) || !isEnd(v.y, low.y, high.y) || !isEnd(v.z, low.z, high.z)) return;
    }
    ConvexPolyhedron::Box box{(low + high) * 0.5, (high - low) * 0.5, {{kNone, kNone}, {kNone, kNone}, {kNone, kNone}}};
    for (std::uint32_t f = 0; f < faceCount_; ++f) {
      const Vec3d& n = out_.faces_[f].normal;
      const double along[3] = {n.x, n.y, n.z};
      constexpr double kAcross = 0.9;
      for (int axis = 0; axis < 3; ++axis) {
        if (std::fabs(along[axis]) > kAcross) box.face[axis][along[axis] > 0] = f;
      }
    }
    for (const auto& pair : box.face) {
      if (pair[0] == kNone || pair[1] == kNone) return;
    }
    out_.box_ = box;
  }

  void fillStarts() {
    const std::size_t n = out_.vertices_.size();
    if (n <= ConvexPolyhedron::kMostScanned) {
      for (const Vec3d& v : out_.vertices_) {
        out_.x_.push_back(v.x);
        out_.y_.push_back(v.y);
        out_.z_.push_back(v.z);
      }
      return;
    }
    out_.cells_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(n) / 6)), 2, 256);
    const double step = 2.0 / static_cast<double>(out_.cells_);
    std::uint32_t last = 0;
    for (std::size_t side = 0; side < 6; ++side) {
      for (std::size_t i = 0; i < out_.cells_; ++i) {
        for (std::size_t j = 0; j < out_.cells_; ++j) {
          double d[3];
          d[side / 2] = side % 2 ? -1 : 1;
          d[(side / 2 + 1) % 3] = -1 + step * (static_cast<double>(i) + 0.5);
          d[(side / 2 + 2) % 3] = -1 + step * (static_cast<double>(j) + 0.5);
          last = out_.climb(last, {d[0], d[1], d[2]});
          out_.starts_.push_back(last);
        }
      }
    }
  }

  void describe(ConvexGeometry& body) const {
    body.kind = ConvexGeometry::Kind::kPolyhedron;
    body.vertices = out_.vertices_;
    body.bound();
    for (std::uint32_t f = 0; f < out_.faceCount(); ++f) {
      body.faceNormals.push_back(out_.face(f).normal);
      body.faceOffsets.push_back(out_.face(f).offset);
    }
  }

  const TriMesh& mesh_;
  const Topology& topology_;
  const double rounding_;
  std::uint32_t faceCount_ = 0;
  std::vector<std::uint8_t> isCorner_;
  ConvexPolyhedron out_;
};

std::unique_ptr<const ConvexPolyhedron> buildConvexPolyhedron(const TriMesh& mesh) {
  const Convexity convexity = convexityOf(mesh);
  if (convexity == Convexity::kNone) return nullptr;
  return PolyhedronBuilder(mesh, convexity).run();
}

}  // namespace otg
