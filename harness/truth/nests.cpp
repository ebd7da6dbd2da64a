// SPDX-License-Identifier: BSD-3-Clause
#include "truth/nests.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "truth/certificate_bodies.h"
#include "truth/tessellated_bodies.h"

namespace otg::truth {
namespace {

constexpr Transformd kUnmoved{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
constexpr double kPi = std::numbers::pi;

/// How far a body reaches along a world direction from its origin when turned so.
double reachOf(const PairBody& body, const Transformd& turned, const Vec3d& direction) {
  if (body.shape) {
    ConvexBody placed = *body.shape;
    placed.pose = turned;
    placed.pose.t = {0, 0, 0};
    return placed.reach(direction);
  }
  double most = -std::numeric_limits<double>::infinity();
  for (const Vec3f& v : body.mesh.vertices) {
    most = std::max(most, otgDot(direction, otgRotate(turned, Vec3d{v.x, v.y, v.z})));
  }
  return most;
}

/// The point whose products with the rows are the values.
Vec3d solve(const std::vector<Vec3d>& rows, const std::vector<double>& values) {
  const Vec3d bc = otgCross(rows[1], rows[2]), ca = otgCross(rows[2], rows[0]), ab = otgCross(rows[0], rows[1]);
  const double determinant = otgDot(rows[0], bc);
  const Vec3d sum = otgAdd(otgAdd(otgScale(bc, values[0]), otgScale(ca, values[1])), otgScale(ab, values[2]));
  return otgScale(sum, 1 / determinant);
}

Nest nestOf(std::vector<Wall> walls, std::vector<FreeAxis> free) {
  Nest nest;
  nest.walls = std::move(walls);
  nest.free = std::move(free);
  nest.base = kUnmoved;
  return nest;
}

FreeAxis alongZ(double depth) {
  return {{0, 0, 1}, -0.55 * depth, 0.55 * depth};
}

/// Lines of a grid from -1/2 to 1/2 with walls of the given thicknesses at either end.
std::vector<double> walled(double low, double high) {
  return {-0.5, -0.5 + low, 0.5 - high, 0.5};
}

/// The corners of a box-shaped hollow, three walls each.
void addCorners(Host& host, const Lines& lines, const std::vector<int>& upDown) {
  const auto wall = [&](std::size_t axis, int side) {
    const double sign = side == 0 ? 1 : -1;
    const Vec3d n{axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0};
    return Wall{n, sign * lines[axis][side == 0 ? 1 : 2]};
  };
  for (const int x : {0, 1}) {
    for (const int y : {0, 1}) {
      for (const int z : upDown) host.nests.push_back(nestOf({wall(0, x), wall(1, y), wall(2, z)}, {}));
    }
  }
}

}  // namespace

Transformd turnAbout(const Vec3d& u, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  return {
      {c + k * u.x * u.x, k * u.x * u.y - s * u.z, k * u.x * u.z + s * u.y, k * u.x * u.y + s * u.z, c + k * u.y * u.y,
       k * u.y * u.z - s * u.x, k * u.x * u.z - s * u.y, k * u.y * u.z + s * u.x, c + k * u.z * u.z},
      {0, 0, 0}};
}

Transformd product(const Transformd& outer, const Transformd& inner) {
  Transformd out{};
  for (int k = 0; k < 3; ++k) {
    const Vec3d column = otgRotate(outer, Vec3d{inner.r[k], inner.r[3 + k], inner.r[6 + k]});
    out.r[k] = column.x;
    out.r[3 + k] = column.y;
    out.r[6 + k] = column.z;
  }
  out.t = otgTransform(outer, inner.t);
  return out;
}

Host profileL(Random& random) {
  const double w = random.uniform(0.9, 1.2), h = random.uniform(0.9, 1.2), t = random.uniform(0.15, 0.35),
               depth = random.uniform(0.5, 1);
  Host host;
  host.mesh = extruded({{0, 0}, {w, 0}, {w, t}, {t, t}, {t, h}, {0, h}}, depth);
  host.nests.push_back(nestOf({{{0, 1, 0}, t}, {{1, 0, 0}, t}}, {alongZ(depth)}));
  return host;
}

Host profileU(Random& random) {
  const double w = random.uniform(0.9, 1.3), h = random.uniform(0.5, 1.2), t = random.uniform(0.1, 0.2),
               depth = random.uniform(0.5, 1);
  Host host;
  host.mesh = extruded({{0, 0}, {w, 0}, {w, h}, {w - t, h}, {w - t, t}, {t, t}, {t, h}, {0, h}}, depth);
  host.nests.push_back(nestOf({{{0, 1, 0}, t}, {{1, 0, 0}, t}}, {alongZ(depth)}));
  host.nests.push_back(nestOf({{{0, 1, 0}, t}, {{-1, 0, 0}, t - w}}, {alongZ(depth)}));
  return host;
}

Host profileT(Random& random) {
  const double w = random.uniform(1.2, 1.6), h = random.uniform(0.6, 1.2), t = random.uniform(0.15, 0.3),
               stem = random.uniform(0.1, 0.3), depth = random.uniform(0.5, 1), s = stem / 2;
  Host host;
  host.mesh = extruded({{-w / 2, 0}, {w / 2, 0}, {w / 2, t}, {s, t}, {s, h}, {-s, h}, {-s, t}, {-w / 2, t}}, depth);
  host.nests.push_back(nestOf({{{0, 1, 0}, t}, {{1, 0, 0}, s}}, {alongZ(depth)}));
  host.nests.push_back(nestOf({{{0, 1, 0}, t}, {{-1, 0, 0}, s}}, {alongZ(depth)}));
  return host;
}

Host room(Random& random) {
  const auto thickness = [&] { return random.uniform(0.08, 0.2); };
  Lines lines;
  for (std::vector<double>& line : lines) {
    const double low = thickness();
    line = walled(low, thickness());
  }
  const bool open = random.below(2) == 0;  // a skylight; else the hollow is closed
  Host host;
  host.mesh =
      cellUnion(lines, [&](int i, int j, int k) { return !(i == 1 && j == 1 && (k == 1 || (open && k == 2))); });
  addCorners(host, lines, open ? std::vector{0} : std::vector{0, 1});
  return host;
}

Host tray(Random& random) {
  const double floor = random.uniform(0.05, 0.1), height = random.uniform(0.15, 0.4);
  Lines lines;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    const double low = random.uniform(0.04, 0.12);
    lines[axis] = walled(low, random.uniform(0.04, 0.12));
  }
  lines[2] = {0, floor, floor + height};
  Host host;
  host.mesh = cellUnion(lines, [&](int i, int j, int k) { return !(i == 1 && j == 1 && k == 1); });
  addCorners(host, lines, {0});
  return host;
}

Host slot(Random& random) {
  const double w = random.uniform(0.8, 1.2), h = random.uniform(0.5, 1), floor = random.uniform(0.1, 0.2),
               depth = random.uniform(0.5, 1), wide = random.uniform(0.2, 0.35), s = wide / 2;
  Host host;
  host.mesh =
      extruded({{-w / 2, 0}, {w / 2, 0}, {w / 2, h}, {s, h}, {s, floor}, {-s, floor}, {-s, h}, {-w / 2, h}}, depth);
  const double clearance = wide * std::pow(10.0, random.uniform(-4, -1.3));
  for (const double side : {1.0, -1.0}) {
    Nest nest = nestOf({{{0, 1, 0}, floor}, {{side, 0, 0}, -s}}, {alongZ(depth)});
    nest.leastSides.x = nest.mostSides.x = wide - clearance;
    host.nests.push_back(nest);
  }
  return host;
}

Host steps(Random& random) {
  const int count = 3 + random.below(3);
  const double depth = random.uniform(0.6, 1);
  std::vector<Point2> outline{{0, 0}};
  std::vector<Nest> nests;
  double x = 0, y = 0;
  std::vector<Point2> up;
  for (int i = 0; i < count; ++i) {
    const double run = random.uniform(0.2, 0.35), rise = random.uniform(0.1, 0.3);
    const double tread = y + (i == 0 ? 0.15 : rise);
    if (i > 0) nests.push_back(nestOf({{{0, 1, 0}, y}, {{-1, 0, 0}, -x}}, {alongZ(depth)}));
    up.push_back({x, tread});
    up.push_back({x + run, tread});
    x += run;
    y = tread;
  }
  // Counter-clockwise: along the bottom, and back down the steps.
  outline.push_back({x, 0});
  outline.insert(outline.end(), up.rbegin(), up.rend());
  Host host;
  host.mesh = extruded(outline, depth);
  host.nests = std::move(nests);
  return host;
}

Host wedgeSlot(Random& random) {
  // A groove with flat bottom and walls that lean outward.
  const double lean = random.uniform(0.1, 0.7), bottom = random.uniform(0.02, 0.2) / 2, deep = random.uniform(0.3, 0.6),
               depth = random.uniform(0.5, 1), floor = 0.15, s = bottom + deep * std::tan(lean), w = s + 0.2;
  Host host;
  host.mesh = extruded({{-w, 0},
                        {w, 0},
                        {w, floor + deep},
                        {s, floor + deep},
                        {bottom, floor},
                        {-bottom, floor},
                        {-s, floor + deep},
                        {-w, floor + deep}},
                       depth);
  const double c = std::cos(lean), q = std::sin(lean);
  const Wall left{{c, q, 0}, -bottom * c + floor * q}, right{{-c, q, 0}, -bottom * c + floor * q};
  Nest nest = nestOf({left, right}, {alongZ(depth)});
  nest.mostSides.x = 0.3;
  host.nests.push_back(nest);
  nest.base = turnAbout({0, 0, 1}, -lean);
  host.nests.push_back(nest);
  nest.base = turnAbout({0, 0, 1}, lean);
  host.nests.push_back(nest);
  return host;
}

Host vBlock(Random& random) {
  const double deep = random.uniform(0.3, 0.5), floor = random.uniform(0.1, 0.2), depth = random.uniform(0.5, 1),
               w = deep + random.uniform(0.1, 0.3), h = floor + deep;
  Host host;
  host.mesh = extruded({{-w, 0}, {w, 0}, {w, h}, {deep, h}, {0, floor}, {-deep, h}, {-w, h}}, depth);
  const double r = std::sqrt(0.5);
  Nest nest = nestOf({{{r, r, 0}, r * floor}, {{-r, r, 0}, r * floor}}, {alongZ(depth)});
  nest.base = turnAbout({0, 0, 1}, kPi / 4);
  host.nests.push_back(nest);
  return host;
}

Host bin(Random& random) {
  // A row of boxes on a floor, none of which touches another: parts of one mesh.
  const int count = 2 + random.below(3);
  const double depth = random.uniform(0.5, 1);
  std::vector<scenes::MeshArrays> parts;
  std::vector<Point2> gaps;
  double x = 0;
  for (int i = 0; i < count; ++i) {
    const double w = random.uniform(0.2, 0.5), h = random.uniform(0.25, 0.5);
    parts.push_back(scenes::transformed(scenes::makeBox({w, h, depth}),
                                        {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x + w / 2, 0.002 + h / 2, 0}}));
    x += w;
    const double gap = random.uniform(0.25, 0.5);
    gaps.push_back({x, x + gap});
    x += gap;
  }
  parts.push_back(scenes::transformed(scenes::makeBox({x + 0.4, 0.2, depth + 0.2}),
                                      {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x / 2, -0.1, 0}}));
  Host host;
  host.mesh = scenes::merge(parts);
  for (int i = 0; i < count; ++i) {
    const Point2& gap = gaps[static_cast<std::size_t>(i)];
    Nest nest = nestOf({{{0, 1, 0}, 0}, {{1, 0, 0}, gap.x}}, {alongZ(depth)});
    const double clearance = std::pow(10.0, random.uniform(-3.5, -1));
    nest.leastSides.x = nest.mostSides.x = (gap.y - gap.x) * (1 - clearance);
    host.nests.push_back(nest);
    if (i + 1 == count) continue;
    nest.walls[1] = {{-1, 0, 0}, -gap.y};
    host.nests.push_back(nest);
  }
  return host;
}

Settling drawSettling(Random& random) {
  const int draw = random.below(4);
  return draw == 0 ? Settling::kAligned : draw == 1 ? Settling::kFree : Settling::kSettled;
}

const char* nameOf(Settling settling) {
  return settling == Settling::kAligned ? "aligned" : settling == Settling::kSettled ? "settled" : "free";
}

Transformd settled(Random& random, Settling settling, const Transformd& base) {
  if (settling == Settling::kFree) return random.rotation();
  if (settling == Settling::kAligned) return base;
  const Vec3d axis = random.direction();
  return product(turnAbout(axis, std::pow(10.0, random.uniform(-5, -2))), base);
}

PairBody makeMover(Random& random, MoverKind kind, bool shape, const Vec3d& sides) {
  PairBody body;
  body.pose = kUnmoved;
  const double least = std::min({sides.x, sides.y, sides.z}), x = sides.x / 2, y = sides.y / 2, z = sides.z / 2;
  switch (kind) {
    case MoverKind::kBox:
      body.mesh = scenes::makeBox(sides, shape ? 1 : 1 + random.below(2));
      if (shape) body.shape = boxBody(otgScale(sides, 0.5));
      break;
    case MoverKind::kCylinder:
      body.mesh = scenes::makeCylinder(x, sides.y, shape ? 64 : 12 + 4 * random.below(6));
      if (shape) body.shape = cylinderBody(x, y);
      break;
    case MoverKind::kSphere:
      body.mesh = scenes::makeSphere(x, 2);
      if (shape) body.shape = ballBody(x);
      break;
    case MoverKind::kCapsule:
      body.mesh = scenes::makeCapsule(least / 3, sides.y / 2, 16, 4);
      if (shape) body.shape = capsuleBody(least / 3, sides.y / 4);
      break;
    case MoverKind::kPrism:
      body.mesh = extruded({{-x, -y}, {x, -y}, {x * random.uniform(-0.5, 0.5), y}}, sides.z);
      if (shape) body.shape = polyhedronBody(body.mesh);
      break;
    case MoverKind::kTetrahedron:
      body.mesh = scenes::makeTetrahedron({-x, -y, -z}, {x, -y, -z}, {0, -y, z}, {0.1 * x, y, 0});
      if (shape) body.shape = polyhedronBody(body.mesh);
      break;
    case MoverKind::kL:
      if (shape) throw std::logic_error("ODE has no shape of this form");
      body.mesh = extruded({{-x, -y}, {x, -y}, {x, -0.3 * y}, {-0.2 * x, -0.3 * y}, {-0.2 * x, y}, {-x, y}}, sides.z);
      break;
  }
  return body;
}

Pressed press(Random& random, const Nest& nest, Settling settling, const OverlapRange& overlaps, PairBody& mover) {
  mover.pose = product(settled(random, settling, nest.base), mover.pose);
  const Vec3d sides = extentOf(mover.mesh);
  const double least = std::min({sides.x, sides.y, sides.z});
  Pressed pressed{least * std::pow(10.0, random.uniform(overlaps.leastPower, overlaps.mostPower)), 0};
  std::vector<Vec3d> rows;
  std::vector<double> values;
  const int deepest = random.below(static_cast<int>(nest.walls.size()));
  for (std::size_t i = 0; i < nest.walls.size(); ++i) {
    const Wall& wall = nest.walls[i];
    double in = pressed.depth;
    if (static_cast<int>(i) != deepest) {
      const int draw = random.below(4);
      if (draw == 0) {
        in = -least * random.uniform(0.01, 0.2);  // clear of this wall
      } else if (draw == 1) {
        in *= std::pow(10.0, random.uniform(-2, 0));
      } else {
        in *= random.uniform(0.3, 1);
      }
    }
    pressed.walls += in > 0;
    rows.push_back(wall.normal);
    values.push_back(wall.offset - in + reachOf(mover, mover.pose, otgScale(wall.normal, -1.0)));
  }
  for (const FreeAxis& axis : nest.free) {
    rows.push_back(axis.axis);
    values.push_back(random.uniform(axis.low, axis.high));
  }
  mover.pose.t = solve(rows, values);
  return pressed;
}

}  // namespace otg::truth
