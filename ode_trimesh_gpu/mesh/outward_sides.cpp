// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/outward_sides.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "base/vectors.h"

namespace otg {
namespace {

class Mender {
 public:
  Mender(const TriMesh& mesh, const Topology& topology)
      : mesh_(mesh),
        topology_(topology),
        first_(mesh.firstCopies()),
        sides_(mesh.triangleCount(), 1),
        excess_(topology_.edgeCount(), 0) {}

  OutwardSides run() {
    for (std::uint32_t t = 0; t < sides_.size(); ++t) add(t, 1);
    turnOddOnes();
    // Beside triangles without area, which do not count, there are other rims.
    const bool areOfRims = mesh_.report().degenerateTriangles == 0;
    if (!closeRims()) return {{}, areOfRims};
    const bool isWhole = areOfRims && first_.empty() && turned_ == 0;
    if (isWhole && filled_.empty() && cuts_.empty()) return {{}, true};
    std::vector<Triangle> triangles = mended();
    double area = 0, areaOfHoles = 0;
    for (const Triangle& t : triangles) area += areaOf(t);
    for (const Triangle& t : filled_) areaOfHoles += areaOf(t);
    if (areaOfHoles > kMouth * area) return {};
    triangles.insert(triangles.end(), filled_.begin(), filled_.end());
    MeshInput input;
    input.vertices = mesh_.vertices().data();
    input.vertexCount = mesh_.vertices().size();
    input.indices = triangles.data();
    input.triangleCount = triangles.size();
    if (triangles.empty() || !buildTriMesh(input).report.solid) return {};
    for (std::uint32_t t = 0; t < sides_.size() && !first_.empty(); ++t) sides_[t] = sides_[first_[t]];
    return {std::move(sides_), false};
  }

 private:
  /// Of an edge with a vertex on it.
  struct Cut {
    std::uint32_t triangle, from, to, middle;
  };

  bool counts(std::uint32_t t) const { return !mesh_.isDegenerate(t) && (first_.empty() || first_[t] == t); }

  std::uint32_t from(std::uint32_t half) const { return topology_.weld[mesh_.triangles()[half / 3].v[half % 3]]; }

  /// +1 where the half-edge goes along its edge, else -1.
  int way(std::uint32_t half) const {
    return from(half) == topology_.weld[topology_.edges[topology_.edgeOf[half]].a] ? 1 : -1;
  }

  void add(std::uint32_t t, int times) {
    if (!counts(t)) return;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) excess_[topology_.edgeOf[h]] += times * way(h);
  }

  /// A triangle that is turned round goes the way of its neighbour along each edge.
  void turnOddOnes() {
    for (std::uint32_t t = 0; t < sides_.size(); ++t) {
      bool isOdd = counts(t);
      for (std::uint32_t h = 3 * t; isOdd && h < 3 * t + 3; ++h) isOdd = excess_[topology_.edgeOf[h]] == 2 * way(h);
      if (!isOdd) continue;
      add(t, -2);
      sides_[t] = -1;
      ++turned_;
    }
  }

  /// An edge of a rim: its first vertex as the triangle has it, and the two ends as they are welded.
  struct Rim {
    std::uint32_t vertex, triangle, from, to;
    bool isDone = false;
  };

  /// Closes all that is open; false where that is not possible.
  bool closeRims() {
    std::vector<Rim> open;
    for (std::uint32_t t = 0; t < sides_.size(); ++t) {
      for (std::uint32_t h = 3 * t; counts(t) && h < 3 * t + 3; ++h) {
        int& excess = excess_[topology_.edgeOf[h]];
        const int step = way(h) * sides_[t];
        if (excess * step <= 0) continue;
        excess -= step;
        std::uint32_t ends[2] = {h, h % 3 == 2 ? h - 2 : h + 1};
        if (sides_[t] < 0) std::swap(ends[0], ends[1]);
        open.push_back({mesh_.triangles()[t].v[ends[0] % 3], t, from(ends[0]), from(ends[1])});
      }
    }
    std::ranges::stable_sort(open, {}, &Rim::from);
    for (std::size_t i = kMostAtVertex; i < open.size(); ++i) {
      if (open[i - kMostAtVertex].from == open[i].from) return false;
    }
    return open.empty() || closeLoops(open);
  }

  /// Rims may share vertices. A way that comes to a vertex again has gone round one of them. It goes on along the line
  /// that it has come by, as cracks do.
  bool closeLoops(std::vector<Rim>& open) {
    std::vector<std::uint32_t> placeOf(mesh_.vertices().size(), kNone);  // on the way
    std::vector<Rim> way;
    for (Rim& start : open) {
      for (Rim* next = start.isDone ? nullptr : &start; next != nullptr; next = nextOf(way, open)) {
        next->isDone = true;
        placeOf[next->from] = static_cast<std::uint32_t>(way.size());
        way.push_back(*next);
        const std::uint32_t begin = placeOf[next->to];
        if (begin == kNone) continue;
        const std::vector<Rim> loop(way.begin() + begin, way.end());
        for (const Rim& rim : loop) placeOf[rim.from] = kNone;
        way.resize(begin);
        if (!close(loop)) return false;
      }
    }
    return way.empty();
  }

  /// Null at the end of the way.
  Rim* nextOf(const std::vector<Rim>& way, std::vector<Rim>& open) const {
    Rim* best = nullptr;
    double most = -1;
    if (way.empty()) return nullptr;
    const std::uint32_t corner = way.back().to;
    for (auto rim = std::ranges::lower_bound(open, corner, {}, &Rim::from); rim != open.end() && rim->from == corner;
         ++rim) {
      const double straight = std::fabs(otgDot(alongOf(*rim), alongOf(way.back())));
      if (rim->isDone || straight <= most) continue;
      most = straight;
      best = &*rim;
    }
    return best;
  }

  Vec3d alongOf(const Rim& rim) const { return unit(at(rim.to) - at(rim.from)); }

  Vec3d at(std::uint32_t vertex) const {
    const Vec3f& p = mesh_.vertices()[vertex];
    return {p.x, p.y, p.z};
  }

  /// A crack, along a line, is closed by cutting the triangles at each side by the vertices of the other one. A hole of
  /// three edges is filled.
  bool close(const std::vector<Rim>& rims) {
    const auto farthest = [&](const Vec3d& from) {
      const auto distance = [&](const Rim& rim) { return norm(at(rim.vertex) - from); };
      return at(std::ranges::max_element(rims, {}, distance)->vertex);
    };
    const Vec3d begin = farthest(at(rims[0].vertex)), axis = unit(farthest(begin) - begin);
    double near = 0;
    for (const Rim& rim : rims) {
      const Vec3d p = at(rim.vertex);
      near = std::max({near, kRounding * std::fabs(p.x), kRounding * std::fabs(p.y), kRounding * std::fabs(p.z)});
    }
    const bool isCrack =
        std::ranges::all_of(rims, [&](const Rim& rim) { return norm(otgCross(axis, at(rim.vertex) - begin)) <= near; });
    if (!isCrack) {
      if (rims.size() == 3) filled_.push_back({{rims[1].vertex, rims[0].vertex, rims[2].vertex}});
      return rims.size() == 3;
    }
    const auto along = [&](const Rim& rim) { return otgDot(axis, at(rim.vertex) - begin); };
    const std::size_t most = cuts_.size() + kMostCuts * rims.size();
    std::vector<Rim> sorted = rims;
    std::ranges::sort(sorted, {}, along);
    for (std::size_t k = 0; k < rims.size(); ++k) {
      const Rim& next = rims[(k + 1) % rims.size()];
      const double low = std::min(along(rims[k]), along(next)), high = std::max(along(rims[k]), along(next));
      const auto first = std::ranges::upper_bound(sorted, low, {}, along);
      std::vector<Rim> between(first, std::max(first, std::ranges::lower_bound(sorted, high, {}, along)));
      if (along(next) < along(rims[k])) std::ranges::reverse(between);
      std::uint32_t from = rims[k].vertex;
      for (const Rim& middle : between) {
        cuts_.push_back({rims[k].triangle, from, next.vertex, middle.vertex});
        from = middle.vertex;
      }
      if (cuts_.size() > most) return false;
    }
    return true;
  }

  double areaOf(const Triangle& t) const { return norm(otgCross(at(t.v[1]) - at(t.v[0]), at(t.v[2]) - at(t.v[0]))); }

  /// The triangles that count, turned and cut.
  std::vector<Triangle> mended() {
    std::ranges::stable_sort(cuts_, {}, &Cut::triangle);
    std::vector<Triangle> out;
    auto next = cuts_.begin();
    for (std::uint32_t t = 0; t < sides_.size(); ++t) {
      if (!counts(t)) continue;
      const Triangle& of = mesh_.triangles()[t];
      const std::size_t first = out.size();
      out.push_back(sides_[t] > 0 ? of : Triangle{{of.v[0], of.v[2], of.v[1]}});
      for (; next != cuts_.end() && next->triangle == t; ++next) cut(*next, first, out);
    }
    return out;
  }

  /// Divides the one of a triangle's parts, which are out[first] and those after it, that has the edge.
  void cut(const Cut& of, std::size_t first, std::vector<Triangle>& out) const {
    // One edge is cut from its beginning on, and the rest of it comes last.
    for (std::size_t i = out.size(); i-- > first;) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Triangle part = out[i];
        const std::uint32_t a = part.v[k], b = part.v[(k + 1) % 3], c = part.v[(k + 2) % 3];
        if (topology_.weld[a] != topology_.weld[of.from] || topology_.weld[b] != topology_.weld[of.to]) continue;
        out[i] = {{a, of.middle, c}};
        out.push_back({{of.middle, b, c}});
        return;
      }
    }
  }

  static constexpr std::size_t kMostAtVertex = 8;  ///< rims
  /// Of a crack, for each of its edges. One is enough where no side goes back and forth.
  static constexpr std::size_t kMostCuts = 8;
  static constexpr double kRounding = 4 * 0x1p-23;  ///< of the coordinates
  static constexpr double kMouth = 0.05;            ///< of the area: larger holes may be the mouths of vessels

  const TriMesh& mesh_;
  const Topology& topology_;
  const std::span<const std::uint32_t> first_;
  std::vector<std::int8_t> sides_;
  std::vector<int> excess_;  ///< of each edge: triangles that go along it less those that go the other way
  std::vector<Triangle> filled_;
  std::vector<Cut> cuts_;
  std::size_t turned_ = 0;
};

}  // namespace

OutwardSides outwardSides(const TriMesh& mesh) {
  if (mesh.meshClass() == MeshClass::kSolid || mesh.triangleCount() == 0) return {};
  // Of two bodies that are flush their own vertices say which neighbour a hole is in. Welded files need positions.
  const std::size_t vertices = mesh.vertices().size();
  std::vector<std::uint32_t> own(vertices);
  std::iota(own.begin(), own.end(), 0U);
  if (std::ranges::equal(own, mesh.topology().weld)) return Mender(mesh, mesh.topology()).run();
  const Topology byIndices = buildTopology(mesh.vertices(), mesh.triangles(), std::move(own));
  OutwardSides sides = Mender(mesh, byIndices).run();
  if (sides.each.empty()) sides = Mender(mesh, mesh.topology()).run();
  // Rims by indices are no rims by positions.
  sides.areOfRims = false;
  return sides;
}

}  // namespace otg
