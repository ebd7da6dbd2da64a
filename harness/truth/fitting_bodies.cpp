// SPDX-License-Identifier: BSD-3-Clause
#include "truth/fitting_bodies.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "scenes/concave_meshes.h"

namespace otg::truth {
namespace {

constexpr double kPi = std::numbers::pi;

double acuteAngle(Random& random) {
  return random.uniform(6.5, 40) * kPi / 180;
}

/// Lengths of two prisms, and how far one of them is moved: within the other, or over its end.
void drawLengths(Random& random, double& host, double& mover, FittingPair& pair) {
  host = random.uniform(0.5, 1);
  mover = random.uniform(0.3, 1.2);
  const int kind = random.below(3);
  const double within = 0.5 * std::fabs(host - mover);
  pair.along = kind == 0 ? 0 : kind == 1 ? random.uniform(0, within) : random.uniform(0, 0.4 * (host + mover));
}

void add(scenes::MeshArrays& mesh, const Vec3d& p) {
  mesh.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
}

/// A ring of n vertices at a height, whose sides are so far from the axis.
void addRing(scenes::MeshArrays& mesh, int n, double distance, double z) {
  const double radius = distance / std::cos(kPi / n);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kPi * i / n;
    add(mesh, {radius * std::cos(angle), radius * std::sin(angle), z});
  }
}

/// Triangles between two rings that begin at vertices a and b: outward is to the left of the way from a to b, seen from
/// the axis.
void join(scenes::MeshArrays& mesh, int n, int a, int b) {
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    const auto number = [](int v) { return static_cast<std::uint32_t>(v); };
    mesh.triangles.push_back({{number(a + i), number(a + j), number(b + j)}});
    mesh.triangles.push_back({{number(a + i), number(b + j), number(b + i)}});
  }
}

/// Triangles from a ring to one vertex; `up`: counter-clockwise seen from +z.
void fan(scenes::MeshArrays& mesh, int n, int ring, int apex, bool up) {
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    const auto number = [](int v) { return static_cast<std::uint32_t>(v); };
    const Triangle t = up ? Triangle{{number(ring + i), number(ring + j), number(apex)}}
                          : Triangle{{number(ring + j), number(ring + i), number(apex)}};
    mesh.triangles.push_back(t);
  }
}

}  // namespace

FittingPair wedgeInGroove(Random& random) {
  FittingPair pair;
  const double angle = pair.angle = acuteAngle(random), slope = std::tan(angle);
  double host, mover;
  drawLengths(random, host, mover, pair);
  const double deep = random.uniform(0.3, 0.6), high = random.uniform(0.2, 0.8);
  const double side = deep * slope + random.uniform(0.1, 0.3), floor = random.uniform(0.1, 0.2);
  pair.host = scenes::makeProfile({{-side, -floor},
                                   {side, -floor},
                                   {side, deep},
                                   {deep * slope, deep},
                                   {0, 0},
                                   {-deep * slope, deep},
                                   {-side, deep}},
                                  host);
  const double blunt = random.below(2) == 0 ? 0 : high * std::pow(10.0, random.uniform(-4, -1));
  std::vector<scenes::ProfilePoint> wedge{{blunt * slope, blunt}, {high * slope, high}, {-high * slope, high}};
  if (blunt > 0) wedge.push_back({-blunt * slope, blunt});
  pair.mover = scenes::makeProfile(wedge, mover);
  pair.what = fmt::format("half angle {:.0f} degrees{}", angle * 180 / kPi, blunt > 0 ? ", blunt" : "");
  return pair;
}

FittingPair tileOnRidge(Random& random) {
  FittingPair pair;
  const double angle = pair.angle = acuteAngle(random), slope = std::tan(angle);
  double host, mover;
  drawLengths(random, host, mover, pair);
  const double deep = random.uniform(0.4, 0.8), high = deep * random.uniform(0.3, 1.2),
               thick = random.uniform(0.05, 0.15);
  const double beside = thick / std::cos(angle), above = thick / std::sin(angle);
  pair.host = scenes::makeProfile({{-deep * slope, -deep}, {deep * slope, -deep}, {0, 0}}, host);
  pair.mover = scenes::makeProfile({{0, 0},
                                    {high * slope, -high},
                                    {high * slope + beside, -high},
                                    {0, above},
                                    {-high * slope - beside, -high},
                                    {-high * slope, -high}},
                                   mover);
  pair.what = fmt::format("half angle {:.0f} degrees", angle * 180 / kPi);
  return pair;
}

FittingPair hatOnPyramid(Random& random) {
  FittingPair pair;
  const int n = 3 + random.below(4);
  const double angle = pair.angle = acuteAngle(random), slope = std::tan(angle);
  const double deep = random.uniform(0.4, 0.8), high = deep * random.uniform(0.3, 0.9),
               thick = random.uniform(0.05, 0.15);
  const double top = random.below(2) == 0 ? 0 : deep * random.uniform(0.05, 0.2);
  scenes::MeshArrays& host = pair.host;
  addRing(host, n, deep * slope, -deep);
  if (top > 0) {
    addRing(host, n, top * slope, -top);
    join(host, n, 0, n);
  }
  add(host, {0, 0, -top});
  add(host, {0, 0, -deep});
  const int last = top > 0 ? 2 * n : n;
  fan(host, n, top > 0 ? n : 0, last, true);
  fan(host, n, 0, last + 1, false);
  scenes::MeshArrays& hat = pair.mover;
  addRing(hat, n, high * slope, -high);                            // the rim's inner side
  addRing(hat, n, high * slope + thick / std::cos(angle), -high);  // and its outer one
  add(hat, {0, 0, 0});
  add(hat, {0, 0, thick / std::sin(angle)});
  fan(hat, n, 0, 2 * n, false);
  fan(hat, n, n, 2 * n + 1, true);
  join(hat, n, 0, n);
  pair.what =
      fmt::format("{} sides, half angle {:.0f} degrees{}", n, angle * 180 / kPi, top > 0 ? ", with a flat top" : "");
  return pair;
}

}  // namespace otg::truth
