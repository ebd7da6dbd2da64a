// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/concave_meshes.h"

#include <stdexcept>

#include "scenes/mesh_builder.h"

namespace otg::scenes {
namespace {

/// Twice the area of the triangle, positive if it goes round counter-clockwise.
double turn(const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c) {
  return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
}

bool isInside(const ProfilePoint& p, const ProfilePoint& a, const ProfilePoint& b, const ProfilePoint& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

/// Triangles that fill the polygon, by its corners' numbers.
std::vector<Triangle> clipEars(const std::vector<ProfilePoint>& polygon) {
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < polygon.size(); ++i) left.push_back(i);
  std::vector<Triangle> triangles;
  while (left.size() > 2) {
    bool clipped = false;
    for (std::size_t i = 0; i < left.size() && !clipped; ++i) {
      const std::size_t before = (i + left.size() - 1) % left.size(), after = (i + 1) % left.size();
      const ProfilePoint &a = polygon[left[before]], &b = polygon[left[i]], &c = polygon[left[after]];
      bool isEar = turn(a, b, c) > 0;
      for (std::size_t k = 0; k < left.size() && isEar; ++k) {
        if (k != before && k != i && k != after) isEar = !isInside(polygon[left[k]], a, b, c);
      }
      if (!isEar) continue;
      triangles.push_back({{left[before], left[i], left[after]}});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
      clipped = true;
    }
    if (!clipped) throw std::invalid_argument("makeProfile: not a simple counter-clockwise polygon");
  }
  return triangles;
}

/// The corners of a box, by bits: 1 for x, 2 for y, 4 for z.
struct Corners {
  Vec3d lo, hi;
  Vec3d operator[](int k) const {
    return {(k & 1) != 0 ? hi.x : lo.x, (k & 2) != 0 ? hi.y : lo.y, (k & 4) != 0 ? hi.z : lo.z};
  }
};

/// The sides of a box, corners in order seen from outside: -x, +x, -y, +y, -z, +z.
constexpr int kSides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
constexpr int kTop = 5;

void addSide(MeshBuilder& builder, const Corners& box, int side, bool inward) {
  const int* k = kSides[side];
  if (inward) {
    builder.quad(box[k[0]], box[k[3]], box[k[2]], box[k[1]]);
  } else {
    builder.quad(box[k[0]], box[k[1]], box[k[2]], box[k[3]]);
  }
}

Vec3d middle(const Vec3f& a, const Vec3f& b) {
  const auto half = [](float x, float y) { return 0.5 * (static_cast<double>(x) + static_cast<double>(y)); };
  return {half(a.x, b.x), half(a.y, b.y), half(a.z, b.z)};
}

Vec3d toDouble(const Vec3f& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

MeshArrays makeProfile(const std::vector<ProfilePoint>& polygon, double width) {
  MeshBuilder builder;
  const auto at = [&](std::size_t i, double side) {
    const ProfilePoint& p = polygon[i % polygon.size()];
    return Vec3d{p.first, side * width / 2, p.second};
  };
  // Seen along +y the polygon is counter-clockwise, so the end at -y shows its front.
  for (const Triangle& t : clipEars(polygon)) {
    builder.triangle(at(t.v[0], -1), at(t.v[1], -1), at(t.v[2], -1));
    builder.triangle(at(t.v[0], 1), at(t.v[2], 1), at(t.v[1], 1));
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) builder.quad(at(i, -1), at(i, 1), at(i + 1, 1), at(i + 1, -1));
  return builder.finish();
}

MeshArrays makeCorner(double size, double wall, double width) {
  return makeProfile({{0, 0}, {size, 0}, {size, wall}, {wall, wall}, {wall, size}, {0, size}}, width);
}

MeshArrays makeRoom(Vec3d size, double wall) {
  MeshBuilder builder;
  const Vec3d half = otgScale(size, 0.5), outer = otgAdd(half, {wall, wall, wall});
  for (int side = 0; side < 6; ++side) {
    addSide(builder, {otgScale(outer, -1.0), outer}, side, false);
    addSide(builder, {otgScale(half, -1.0), half}, side, true);
  }
  return builder.finish();
}

MeshArrays makeTray(Vec3d size, double wall) {
  MeshBuilder builder;
  const Corners inner{{-size.x / 2, -size.y / 2, 0}, {size.x / 2, size.y / 2, size.z}};
  const Corners outer{{inner.lo.x - wall, inner.lo.y - wall, -wall}, {inner.hi.x + wall, inner.hi.y + wall, size.z}};
  for (int side = 0; side < 6; ++side) {
    if (side == kTop) continue;
    addSide(builder, outer, side, false);
    addSide(builder, inner, side, true);
  }
  const int* k = kSides[kTop];
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    builder.quad(outer[k[i]], outer[k[j]], inner[k[j]], inner[k[i]]);
  }
  return builder.finish();
}

MeshArrays subdivided(const MeshArrays& mesh, int levels) {
  if (levels == 0) return mesh;
  MeshBuilder builder;
  for (const Triangle& t : mesh.triangles) {
    const Vec3f &a = mesh.vertices[t.v[0]], &b = mesh.vertices[t.v[1]], &c = mesh.vertices[t.v[2]];
    const Vec3d ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    builder.triangle(toDouble(a), ab, ca);
    builder.triangle(ab, toDouble(b), bc);
    builder.triangle(ca, bc, toDouble(c));
    builder.triangle(ab, bc, ca);
  }
  return subdivided(builder.finish(), levels - 1);
}

}  // namespace otg::scenes
