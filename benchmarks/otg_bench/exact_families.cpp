// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/exact_families.h"

#include <array>
#include <cmath>

namespace otg::cli {
namespace {

using scenes::MeshArrays;
using truth::Random;
using Corners = std::array<Vec3d, 3>;

Vec3d inCube(Random& random, double half) {
  const double x = random.uniform(-half, half), y = random.uniform(-half, half), z = random.uniform(-half, half);
  return {x, y, z};
}

Transformd moved(const Vec3d& by) {
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, by};
}

Transformd anyPose(Random& random, double reach) {
  Transformd pose = random.rotation();
  pose.t = inCube(random, reach);
  return pose;
}

/// One of the 24 turns that map the axes onto each other.
Transformd quarterTurn(Random& random) {
  const int first = random.below(3), second = (first + 1 + random.below(2)) % 3;
  double x[3] = {0, 0, 0}, y[3] = {0, 0, 0};
  x[first] = random.sign();
  y[second] = random.sign();
  const Vec3d u{x[0], x[1], x[2]}, v{y[0], y[1], y[2]}, w = otgCross(u, v);
  return {{u.x, v.x, w.x, u.y, v.y, w.y, u.z, v.z, w.z}, {0, 0, 0}};
}

/// A turn about z, as it is rounded.
Transformd turnAboutZ(double angle, const Vec3d& by) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {{c, -s, 0, s, c, 0, 0, 0, 1}, by};
}

void addTriangle(MeshArrays& soup, const Corners& corners) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  for (const Vec3d& p : corners) {
    soup.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  soup.triangles.push_back({{first, first + 1, first + 2}});
}

template <class Draw>
MeshArrays soupOf(const Draw& draw) {
  MeshArrays soup;
  for (int i = 0; i < kExactTriangles; ++i) addTriangle(soup, draw());
  return soup;
}

Corners anyTriangle(Random& random, double size) {
  const Vec3d middle = inCube(random, 0.5 * size);
  Corners out;
  for (Vec3d& p : out) p = otgAdd(middle, inCube(random, 0.5 * size));
  return out;
}

/// With corners on a grid, so that means of corners are exact.
Corners gridTriangle(Random& random) {
  Corners out;
  for (Vec3d& p : out) {
    const auto coordinate = [&] { return (random.below(512) - 256) / 256.0; };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    p = {x, y, z};
  }
  return out;
}

Corners cornersOf(const MeshArrays& soup, int triangle) {
  Corners out;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f& v = soup.vertices[soup.triangles[static_cast<std::size_t>(triangle)].v[k]];
    out[k] = {v.x, v.y, v.z};
  }
  return out;
}

ExactScene makeAny(Random& random) {
  const auto draw = [&] { return anyTriangle(random, 1); };
  return {soupOf(draw), soupOf(draw), anyPose(random, 0.3)};
}

/// B up to a million times as small as A.
ExactScene makeOfTwoSizes(Random& random) {
  const double size = std::exp2(-random.below(20));
  ExactScene scene{soupOf([&] { return anyTriangle(random, 1); }), soupOf([&] { return anyTriangle(random, size); }),
                   random.rotation()};
  // About a point of A.
  const Corners at = cornersOf(scene.a, random.below(kExactTriangles));
  scene.bInA.t = otgScale(otgAdd(at[0], otgAdd(at[1], at[2])), 1.0 / 3);
  return scene;
}

ExactScene makeOnLattice(Random& random) {
  const int size = 3 + random.below(3);
  const auto draw = [&] {
    Corners out;
    for (Vec3d& p : out) {
      const int x = random.below(size), y = random.below(size), z = random.below(size);
      p = {x - 0.5 * (size - 1), y - 0.5 * (size - 1), z - 0.5 * (size - 1)};
    }
    return out;
  };
  ExactScene scene{soupOf(draw), soupOf(draw), quarterTurn(random)};
  const int x = random.below(5), y = random.below(5), z = random.below(5);
  scene.bInA.t = {0.5 * x - 1, 0.5 * y - 1, 0.5 * z - 1};
  return scene;
}

/// All in one plane, or off it by single bits.
ExactScene makeCoplanar(Random& random) {
  const auto draw = [&] {
    Corners out = anyTriangle(random, 1);
    for (Vec3d& p : out) p.z = 0;
    return out;
  };
  ExactScene scene{soupOf(draw), soupOf(draw), {}};
  const double heights[] = {0, 0, 0x1p-60, -0x1p-52, 0x1p-1074};
  const Vec3d by{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), heights[random.below(5)]};
  scene.bInA = random.below(3) == 0 ? moved(by) : turnAboutZ(random.uniform(-3, 3), by);
  return scene;
}

/// Corners of B on faces and edges of A, exactly, or to within rounding under a rotation.
ExactScene makeTouching(Random& random) {
  ExactScene scene{soupOf([&] { return gridTriangle(random); }), {}, moved({0, 0, 0})};
  const bool turned = random.below(2) == 0;
  if (turned) scene.bInA = anyPose(random, 0.2);
  scene.b = soupOf([&] {
    const Corners on = cornersOf(scene.a, random.below(kExactTriangles));
    const int u = random.below(5), v = random.below(5 - u);
    Corners out = gridTriangle(random);
    out[0] = otgAdd(otgScale(on[0], u / 4.0), otgAdd(otgScale(on[1], v / 4.0), otgScale(on[2], (4 - u - v) / 4.0)));
    if (random.below(3) == 0) out[1] = otgScale(otgAdd(on[0], on[1]), 0.5);
    if (turned) {
      for (Vec3d& p : out) p = otgRotateBack(scene.bInA, otgSub(p, scene.bInA.t));
    }
    return out;
  });
  return scene;
}

/// Triangles of B that have one, two or three corners with one of A in common.
ExactScene makeShared(Random& random) {
  ExactScene scene{soupOf([&] { return anyTriangle(random, 1); }), {}, moved({0, 0, 0})};
  const int near = random.below(3);
  if (near == 1) scene.bInA = turnAboutZ(random.below(2) == 0 ? 1e-9 : 1e-16, {0, 0, 0});
  if (near == 2) scene.bInA.t = {0x1p-40, 0, -0x1p-53};
  scene.b = soupOf([&] {
    const Corners of = cornersOf(scene.a, random.below(kExactTriangles));
    Corners out = anyTriangle(random, 1);
    const int shared = 1 + random.below(3), first = random.below(3);
    for (int k = 0; k < shared; ++k) out[static_cast<std::size_t>(k)] = of[static_cast<std::size_t>((first + k) % 3)];
    return out;
  });
  return scene;
}

/// Long triangles of the least heights, through one region; half of them in a plane.
ExactScene makeNeedles(Random& random) {
  const int thin = -10 - random.below(40);
  const bool flat = random.below(2) == 0;
  const float height = std::ldexp(1.0F, -random.below(150));
  const auto draw = [&] {
    const Vec3d from = inCube(random, 0.5), along = inCube(random, 1);
    const Vec3d side = otgScale(inCube(random, 1), std::ldexp(1.0, thin));
    Corners out{from, otgAdd(from, along), otgAdd(otgAdd(from, otgScale(along, random.uniform(-0.2, 1.2))), side)};
    for (Vec3d& p : out) {
      if (flat) p.z = random.below(3) == 0 ? static_cast<double>(height) : 0;
    }
    return out;
  };
  ExactScene scene{soupOf(draw), soupOf(draw), {}};
  scene.bInA = flat ? turnAboutZ(random.below(2) == 0 ? 0 : random.uniform(-3, 3), {0.01, 0, 0}) : anyPose(random, 0.1);
  return scene;
}

/// Small soups, each with one triangle up to 10^12 sizes away.
ExactScene makeOutliers(Random& random) {
  const auto withOutlier = [&] {
    MeshArrays soup = soupOf([&] { return anyTriangle(random, 1); });
    soup.triangles.pop_back();
    const double away = std::exp2(10 + random.below(31));
    Corners far = anyTriangle(random, 1);
    const Vec3d by = otgScale(random.direction(), away);
    for (Vec3d& p : far) p = otgAdd(p, by);
    addTriangle(soup, far);
    return soup;
  };
  ExactScene scene{withOutlier(), withOutlier(), {}};
  scene.bInA = random.below(3) == 0 ? moved(inCube(random, 0.2)) : anyPose(random, 0.2);
  return scene;
}

/// Nearly quarter turns: entries from 2^-30 down to the least double where a turn has zeros, others off by one bit.
ExactScene makeNearTurns(Random& random) {
  ExactScene scene = makeOnLattice(random);
  const int least = 30 + random.below(1044);
  for (double& r : scene.bInA.r) {
    if (r == 0 && random.below(3) != 0) {
      r = random.sign() * std::ldexp(random.uniform(1, 2), -30 - random.below(least - 29));
    } else if (r != 0 && random.below(4) == 0) {
      r = std::nextafter(r, random.sign());
    }
  }
  if (random.below(3) == 0) scene.bInA.t.x += random.sign() * std::ldexp(1.0, -random.below(1075));
  return scene;
}

/// Meshes far from their origins, brought back by the pose: corners of B are rounded to what A's frame has.
ExactScene makeFar(Random& random) {
  const double away = std::exp2(random.below(24));
  const Vec3d ofA = otgScale(random.direction(), random.below(2) == 0 ? away : 0);
  const Vec3d ofB = otgScale(random.direction(), away);
  const auto around = [&](const Vec3d& middle) {
    return soupOf([&] {
      Corners out = anyTriangle(random, 1);
      for (Vec3d& p : out) p = otgAdd(p, middle);
      return out;
    });
  };
  ExactScene scene{around(ofA), around(ofB), random.below(3) == 0 ? quarterTurn(random) : random.rotation()};
  scene.bInA.t = otgSub(otgAdd(ofA, inCube(random, 0.2)), otgRotate(scene.bInA, ofB));
  return scene;
}

constexpr ExactFamily kFamilies[] = {{"any", &makeAny},
                                     {"two sizes", &makeOfTwoSizes},
                                     {"lattice", &makeOnLattice},
                                     {"coplanar", &makeCoplanar},
                                     {"touching", &makeTouching},
                                     {"shared corners", &makeShared},
                                     {"needles", &makeNeedles},
                                     {"outliers", &makeOutliers},
                                     {"near turns", &makeNearTurns},
                                     {"far from origin", &makeFar}};

}  // namespace

std::span<const ExactFamily> exactFamilies() {
  return kFamilies;
}

void scaleScene(ExactScene& scene, int exponent) {
  const double by = std::ldexp(1.0, exponent);
  for (MeshArrays* mesh : {&scene.a, &scene.b}) {
    for (Vec3f& v : mesh->vertices) v = otgScale(v, static_cast<float>(by));
  }
  scene.bInA.t = otgScale(scene.bInA.t, by);
}

}  // namespace otg::cli
