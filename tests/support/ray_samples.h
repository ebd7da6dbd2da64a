// SPDX-License-Identifier: BSD-3-Clause
// Rays for tests of casting: ordinary ones, and those on which searches go wrong.
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/vectors.h"
#include "queries/closest_point.h"
#include "queries/ray_cast.h"
#include "support/draw.h"
#include "support/mesh_samples.h"

namespace otg::samples {

/// From anywhere to anywhere; through faces, edges, corners, and along them; along axes, nearly too; from the surface
/// itself, from far away, and from beyond all measure; some of them with an end.
inline std::vector<LongRay> raysFor(const TriMesh& mesh, std::uint32_t seed, std::size_t count) {
  test::Draw draw(seed);
  std::vector<LongRay> rays;
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  const Vec3d middle{0.5 * lo.x + 0.5 * hi.x, 0.5 * lo.y + 0.5 * hi.y, 0.5 * lo.z + 0.5 * hi.z};
  const double radius = std::max(double{mesh.radius()}, 1e-30), infinity = std::numeric_limits<double>::infinity();
  const auto unit = [](const Vec3d& v) {
    const double size = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
    if (!(size > 0 && size < std::numeric_limits<double>::infinity())) return Vec3d{0, 0, 1};
    const Vec3d part = otgScale(v, 1 / size);
    return otgScale(part, 1 / norm(part));
  };
  const auto axis = [&](std::size_t i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    return i % 3 == 0 ? Vec3d{sign, 0, 0} : i % 3 == 1 ? Vec3d{0, sign, 0} : Vec3d{0, 0, sign};
  };
  for (std::size_t i = 0; i < count; ++i) {
    Vec3d a{}, b{}, c{};
    if (mesh.triangleCount() > 0) {
      const auto t = static_cast<std::uint32_t>(draw.uniform(0, static_cast<double>(mesh.triangleCount())));
      Vec3d p[3];
      cornersOf(mesh, t, p);
      a = p[0], b = p[1], c = p[2];
    }
    const double u = draw.uniform(0, 1), v = draw.uniform(0, 1 - u), away = std::pow(10, draw.uniform(-3, 1)) * radius;
    const Vec3d onFace = otgAdd(a, otgAdd(otgScale(otgSub(b, a), u), otgScale(otgSub(c, a), v)));
    const Vec3d onEdge = otgAdd(a, otgScale(otgSub(b, a), i % 4 < 2 ? 0.5 : u));
    const Vec3d anywhere = otgAdd(middle, otgScale(draw.inBox(1), 2 * radius)), way = draw.direction();
    const auto from = [&](const Vec3d& target, const Vec3d& d) {
      return MeshRay{otgSub(target, otgScale(d, away)), d};
    };
    MeshRay ray;
    switch (i % 16) {
      case 0:
      case 1:
        ray = {anywhere, unit(otgSub(onFace, anywhere))};
        break;
      case 2:
        ray = {anywhere, way};
        break;
      case 3:
        ray = from(onEdge, way);
        break;
      case 4:
        ray = from(a, way);
        break;
      case 5:
        ray = from(onFace, axis(i / 16));
        break;
      case 6:
        ray = from(onEdge, axis(i / 16));
        break;
      case 7:
        ray = from(a, axis(i / 16));
        break;
      case 8:  // along an edge
        ray = from(a, unit(otgSub(b, a)));
        break;
      case 9:  // in a face
        ray = from(onFace, unit(otgSub(otgScale(otgAdd(b, c), 0.5), a)));
        break;
      case 10:  // nearly so
        ray = from(onFace, unit(otgAdd(unit(otgSub(b, a)), otgScale(way, std::pow(10, draw.uniform(-17, -3))))));
        break;
      case 11:
        ray = {onFace, way};
        break;
      case 12:
        ray = {i % 32 < 16 ? a : onEdge, i % 64 < 32 ? way : axis(i / 64)};
        break;
      case 13: {  // far, up to where the mesh is but a point
        const Vec3d far = otgAdd(middle, otgScale(way, radius * std::pow(10, draw.uniform(0, 18))));
        ray = {far, unit(otgSub(onFace, far))};
        break;
      }
      case 14: {  // nearly along an axis: parts of the direction next to nothing
        Vec3d d = axis(i / 16);
        const double next = std::pow(10, draw.uniform(-320, -6));
        if (d.x == 0) d.x = next;
        if (d.y == 0) d.y = -next;
        ray = from(i % 32 < 16 ? onFace : a, d);
        break;
      }
      default: {  // along a box's face
        const Vec3d d = axis(i / 16);
        ray = from({i % 32 < 16 ? double{lo.x} : double{hi.x}, onFace.y, onFace.z}, d);
      }
    }
    const double length = i % 7 == 0 ? draw.uniform(0, 4) * radius : i % 7 == 1 ? away : infinity;
    rays.push_back({ray, length});
  }
  for (const double far : {1e30, 1e99, 1e101, 1e160, 1e300}) {
    rays.push_back({{{far, -far, 0.3 * far}, unit({-1, 1, -0.3})}, infinity});
    rays.push_back({{{middle.x, -far, middle.z}, {0, 1, 0}}, infinity});
  }
  rays.push_back({{middle, {0, 0, 1}}, 0});
  return rays;
}

inline std::vector<NamedMesh> meshesToHit() {
  std::vector<NamedMesh> meshes = ordinaryMeshes();
  for (NamedMesh& bad : pathologicalMeshes()) meshes.push_back(std::move(bad));
  meshes.push_back({"flat and fine", scenes::build(scenes::makeBox({1, 1, 0.25}, 16))});
  scenes::MeshArrays away = scenes::makeLump(1, 4, 0.3, 5);
  for (Vec3f& v : away.vertices) v = {v.x + 3e4f, v.y - 1e4f, v.z + 2e3f};
  meshes.push_back({"a solid far from its origin", scenes::build(away)});
  // Slivers: what their crossings say of where a ray meets them is off by more than they are wide.
  Soup slivers;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3f p{unit(random), unit(random), unit(random)}, q{unit(random), unit(random), unit(random)};
    const float t = 0.5f + 0.5f * unit(random), hair = std::ldexp(1.0f, -4 - i % 22);
    slivers.add(p, q,
                {p.x + t * (q.x - p.x) + hair * unit(random), p.y + t * (q.y - p.y) + hair * unit(random),
                 p.z + t * (q.z - p.z) + hair * unit(random)});
  }
  meshes.push_back({"slivers", slivers.build()});
  scenes::MeshArrays twice = scenes::makeLump(1, 3, 0.3, 5);
  const std::vector<Triangle> once = twice.triangles;
  for (const Triangle& t : once) twice.triangles.push_back({{t.v[1], t.v[2], t.v[0]}});
  meshes.push_back({"every triangle twice", scenes::build(twice)});
  return meshes;
}

}  // namespace otg::samples
