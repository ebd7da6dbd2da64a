// SPDX-License-Identifier: BSD-3-Clause
#include "truth/certificate_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "scenes/concave_meshes.h"
#include "scenes/mesh_builder.h"

namespace otg::truth {
namespace {

/// Which cells of a cube are solid, with a rim of empty ones.
class Cells {
 public:
  explicit Cells(int n) : n_(n), solid_(static_cast<std::size_t>(n * n * n), false) {}
  bool at(int i, int j, int k) const {
    if (std::min({i, j, k}) < 0 || std::max({i, j, k}) >= n_) return false;
    return solid_[index(i, j, k)];
  }
  void set(int i, int j, int k, bool value) { solid_[index(i, j, k)] = value; }
  bool hasNeighbour(int i, int j, int k) const {
    return at(i - 1, j, k) || at(i + 1, j, k) || at(i, j - 1, k) || at(i, j + 1, k) || at(i, j, k - 1) ||
           at(i, j, k + 1);
  }

 private:
  std::size_t index(int i, int j, int k) const {
    const int place = (i * n_ + j) * n_ + k;
    return static_cast<std::size_t>(place);
  }
  int n_;
  std::vector<bool> solid_;
};

/// Whether the solid ones of the eight cells round a lattice point, and the empty ones, hang together by faces: else
/// the surface touches itself there.
template <class Filled>
bool manifoldAt(int i, int j, int k, const Filled& filled) {
  unsigned solid = 0;
  for (unsigned c = 0; c < 8; ++c) {
    if (filled(i - 1 + static_cast<int>(c & 1), j - 1 + static_cast<int>(c >> 1 & 1),
               k - 1 + static_cast<int>(c >> 2))) {
      solid |= 1u << c;
    }
  }
  const auto connected = [](unsigned cells) {
    if (cells == 0) return true;
    unsigned reached = cells & (~cells + 1);
    for (unsigned before = 0; before != reached;) {
      before = reached;
      for (unsigned c = 0; c < 8; ++c) {
        if ((reached >> c & 1) == 0) continue;
        for (const unsigned axis : {1u, 2u, 4u}) reached |= cells & 1u << (c ^ axis);
      }
    }
    return reached == cells;
  };
  return connected(solid) && connected(~solid & 0xffu);
}

template <class Filled>
bool manifold(const std::array<int, 3>& count, const Filled& filled) {
  for (int i = 0; i <= count[0]; ++i) {
    for (int j = 0; j <= count[1]; ++j) {
      for (int k = 0; k <= count[2]; ++k) {
        if (!manifoldAt(i, j, k, filled)) return false;
      }
    }
  }
  return true;
}

}  // namespace

scenes::MeshArrays extruded(const std::vector<Point2>& outline, double depth) {
  std::vector<scenes::ProfilePoint> polygon;
  polygon.reserve(outline.size());
  for (const Point2& p : outline) polygon.emplace_back(p.x, p.y);
  return scenes::transformed(scenes::makeProfile(polygon, depth), {{1, 0, 0, 0, 0, 1, 0, -1, 0}, {0, 0, 0}});
}

scenes::MeshArrays cellUnion(const Lines& lines, const std::function<bool(int, int, int)>& filled) {
  std::array<int, 3> count{};
  for (std::size_t d = 0; d < 3; ++d) count[d] = static_cast<int>(lines[d].size()) - 1;
  const auto solid = [&](int i, int j, int k) {
    return std::min({i, j, k}) >= 0 && i < count[0] && j < count[1] && k < count[2] && filled(i, j, k);
  };
  if (!manifold(count, solid)) throw std::logic_error("cells that meet in an edge or corner only");
  scenes::MeshBuilder builder;
  const auto at = [&](int i, int j, int k) {
    return Vec3d{lines[0][static_cast<std::size_t>(i)], lines[1][static_cast<std::size_t>(j)],
                 lines[2][static_cast<std::size_t>(k)]};
  };
  for (int i = 0; i < count[0]; ++i) {
    for (int j = 0; j < count[1]; ++j) {
      for (int k = 0; k < count[2]; ++k) {
        if (!solid(i, j, k)) continue;
        const int x = i + 1, y = j + 1, z = k + 1;
        if (!solid(i - 1, j, k)) builder.quad(at(i, j, k), at(i, j, z), at(i, y, z), at(i, y, k));
        if (!solid(x, j, k)) builder.quad(at(x, j, k), at(x, y, k), at(x, y, z), at(x, j, z));
        if (!solid(i, j - 1, k)) builder.quad(at(i, j, k), at(x, j, k), at(x, j, z), at(i, j, z));
        if (!solid(i, y, k)) builder.quad(at(i, y, k), at(i, y, z), at(x, y, z), at(x, y, k));
        if (!solid(i, j, k - 1)) builder.quad(at(i, j, k), at(i, y, k), at(x, y, k), at(x, j, k));
        if (!solid(i, j, z)) builder.quad(at(i, j, z), at(x, j, z), at(x, y, z), at(i, y, z));
      }
    }
  }
  return builder.finish();
}

scenes::MeshArrays randomCells(Random& random, int cellsPerSide, double size, double share) {
  const int n = cellsPerSide;
  Lines lines;
  for (std::vector<double>& line : lines) {
    line.push_back(0);
    for (int i = 0; i < n; ++i) line.push_back(line.back() + random.uniform(0.5, 1.5));
    const double length = line.back();
    for (double& x : line) x = size * (x / length - 0.5);
  }
  for (;;) {
    Cells cells(n);
    cells.set(random.below(n), random.below(n), random.below(n), true);
    int solid = 1;
    for (int tries = 0; tries < 100 * n * n * n && solid < share * n * n * n; ++tries) {
      const int i = random.below(n), j = random.below(n), k = random.below(n);
      if (cells.at(i, j, k) || !cells.hasNeighbour(i, j, k)) continue;
      cells.set(i, j, k, true);
      ++solid;
    }
    const auto filled = [&](int i, int j, int k) { return cells.at(i, j, k); };
    if (manifold({n, n, n}, filled)) return cellUnion(lines, filled);
  }
}

scenes::MeshArrays dentedBox(Random& random, const Vec3d& size, int n, double amplitude) {
  scenes::MeshArrays mesh = scenes::makeBox(size, n);
  for (Vec3f& v : mesh.vertices) {
    float* const p[3] = {&v.x, &v.y, &v.z};
    const double half[3] = {size.x / 2, size.y / 2, size.z / 2};
    int faces = 0, axis = 0;
    for (int k = 0; k < 3; ++k) {
      if (std::fabs(static_cast<double>(*p[k])) < half[k] * (1 - 1e-6)) continue;
      ++faces;
      axis = k;
    }
    if (faces != 1) continue;  // edges and corners stay, so that the box keeps its outline
    *p[axis] += static_cast<float>(random.uniform(-amplitude, amplitude));
  }
  return mesh;
}

scenes::MeshArrays scaled(const scenes::MeshArrays& mesh, double factor) {
  scenes::MeshArrays out = mesh;
  for (Vec3f& v : out.vertices) {
    v = scenes::toFloat(otgScale(Vec3d{v.x, v.y, v.z}, factor));
  }
  return out;
}

Vec3d extentOf(const scenes::MeshArrays& mesh) {
  const double inf = std::numeric_limits<double>::infinity();
  Vec3d low{inf, inf, inf}, high{-inf, -inf, -inf};
  for (const Vec3f& f : mesh.vertices) {
    const Vec3d v{f.x, f.y, f.z};
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return otgSub(high, low);
}

}  // namespace otg::truth
