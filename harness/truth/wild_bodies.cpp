// SPDX-License-Identifier: BSD-3-Clause
#include "truth/wild_bodies.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "scenes/mesh_builder.h"
#include "truth/certificate_bodies.h"

namespace otg::truth {
namespace {

constexpr double kPi = std::numbers::pi;

/// A convex polygon about the origin, counter-clockwise.
std::vector<Point2> section(Random& random, double radius) {
  const int n = 3 + random.below(6);
  const double first = random.uniform(0, 2 * kPi), flat = random.uniform(0.5, 1);
  std::vector<Point2> points;
  for (int i = 0; i < n; ++i) {
    const double angle = first + 2 * kPi * i / n;
    points.push_back({radius * std::cos(angle), radius * flat * std::sin(angle)});
  }
  return points;
}

/// A wave of a few periods round a circle.
class Wave {
 public:
  Wave(Random& random, double size) {
    for (int k = 0; k < 2; ++k) {
      periods_[k] = 2 + random.below(3);
      size_[k] = random.uniform(0, size);
      phase_[k] = random.uniform(0, 2 * kPi);
    }
  }
  double at(double angle) const {
    return size_[0] * std::sin(periods_[0] * angle + phase_[0]) + size_[1] * std::sin(periods_[1] * angle + phase_[1]);
  }

 private:
  double periods_[2], size_[2], phase_[2];
};

/// The section's point where it crosses the half plane at an angle about z.
Vec3d placed(const Point2& p, double radius, double z, double angle) {
  return {(radius + p.x) * std::cos(angle), (radius + p.x) * std::sin(angle), z + p.y};
}

}  // namespace

scenes::MeshArrays randomRing(Random& random, double radius) {
  const int steps = 8 + random.below(17);
  const std::vector<Point2> bar = section(random, radius * random.uniform(0.1, 0.3));
  const Wave out(random, 0.12 * radius), up(random, 0.15 * radius);
  const int n = static_cast<int>(bar.size());
  const auto point = [&](int i, int j) {
    const double angle = 2 * kPi * (i % steps) / steps;
    return placed(bar[static_cast<std::size_t>(j)], radius + out.at(angle), up.at(angle), angle);
  };
  scenes::MeshBuilder builder;
  scenes::addTube(builder, steps, n, point);
  return builder.finish();
}

scenes::MeshArrays randomSpring(Random& random) {
  const int perTurn = 8 + random.below(9), steps = static_cast<int>(random.uniform(1.2, 3.5) * perTurn);
  const double thick = random.uniform(0.04, 0.1), rise = thick * random.uniform(2.3, 5),
               radius = random.uniform(0.25, 0.5);
  const std::vector<Point2> bar = section(random, thick);
  const int n = static_cast<int>(bar.size());
  const auto at = [&](int i, const Point2& p) {
    const double turn = static_cast<double>(i) / perTurn;
    return placed(p, radius, rise * (turn - 0.5 * steps / perTurn), 2 * kPi * turn);
  };
  const auto point = [&](int i, int j) { return at(i, bar[static_cast<std::size_t>(j)]); };
  scenes::MeshBuilder builder;
  scenes::addTube(builder, steps, n, point);
  scenes::addFan(builder, at(0, {0, 0}), n, [&](int j) { return point(0, j); });
  scenes::addFan(builder, at(steps, {0, 0}), n, [&](int j) { return point(steps, n - 1 - j); });
  return builder.finish();
}

scenes::MeshArrays turnedBody(Random& random) {
  const int rings = 3 + random.below(6), segments = 6 + random.below(27);
  std::vector<Point2> profile;  // radius and height, from below
  double z = 0, radius = 0.3;
  for (int i = 0; i <= rings; ++i) {
    profile.push_back({radius, z});
    // Some rings lie above each other, and some in one plane.
    const int step = random.below(4);
    if (step != 0 || i % 2 == 0) z += random.uniform(0.03, 0.3);
    if (step != 1) radius = random.uniform(0.08, 0.5);
  }
  const auto point = [&](int i, int j) {
    const double angle = 2 * kPi * j / segments;
    const Point2& p = profile[static_cast<std::size_t>(i)];
    return Vec3d{p.x * std::cos(angle), p.x * std::sin(angle), p.y - 0.5 * z};
  };
  scenes::MeshBuilder builder;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < segments; ++j) {
      const int k = (j + 1) % segments;
      builder.quad(point(i, j), point(i, k), point(i + 1, k), point(i + 1, j));
    }
  }
  // Ends that are cups or cones.
  const double low = random.uniform(-0.1, 0.6), high = random.uniform(-0.1, 0.6);
  const double first = profile[1].y, last = z - profile[profile.size() - 2].y;
  const auto end = [&](double share, double thick) { return share * (share > 0 ? 0.5 * thick : 1); };
  scenes::addFan(builder, {0, 0, -0.5 * z + end(low, first)}, segments,
                 [&](int j) { return point(0, segments - 1 - j); });
  scenes::addFan(builder, {0, 0, 0.5 * z - end(high, last)}, segments, [&](int j) { return point(rings, j); });
  return builder.finish();
}

scenes::MeshArrays spikyBall(Random& random) {
  scenes::MeshArrays mesh = scenes::makeSphere(0.5, random.below(3));
  const double least = random.uniform(0.3, 0.9);
  for (Vec3f& v : mesh.vertices) {
    const double factor = random.uniform(least, 1.2);
    v = scenes::toFloat({factor * v.x, factor * v.y, factor * v.z});
  }
  return mesh;
}

scenes::MeshArrays bumpyBall(Random& random) {
  const int level = 3 + random.below(3);
  const double amplitude = random.uniform(0.1, 0.6);
  return scenes::makeLump(0.5, level, amplitude, static_cast<std::uint32_t>(random.below(1 << 30)));
}

scenes::MeshArrays roughGround(Random& random) {
  const int n = 3 + random.below(12);
  const double height = random.uniform(0.02, 0.4);
  std::vector<double> heights;
  for (int i = 0; i < (n + 1) * (n + 1); ++i) heights.push_back(random.uniform(0, height));
  return scenes::makeGround(2, 0.3, n, [&](double x, double y) {
    const auto index = [&](double c) { return static_cast<int>(std::lround((c + 1) / 2 * n)); };
    return heights[static_cast<std::size_t>(index(y) * (n + 1) + index(x))];
  });
}

scenes::MeshArrays barFrame(Random& random) {
  Lines lines;
  std::array<int, 3> windows{};
  for (std::size_t d = 0; d < 3; ++d) {
    windows[d] = 1 + random.below(2);
    double x = 0;
    lines[d].push_back(0);
    for (int i = 0; i < 2 * windows[d] + 1; ++i) {
      x += i % 2 == 0 ? random.uniform(0.05, 0.15) : random.uniform(0.2, 0.5);
      lines[d].push_back(x);
    }
    for (double& c : lines[d]) c -= 0.5 * x;
  }
  return cellUnion(lines, [](int i, int j, int k) { return (i % 2) + (j % 2) + (k % 2) <= 1; });
}

scenes::MeshArrays thinBox(Random& random) {
  const double thin = std::pow(10.0, random.uniform(-3, -1.3));
  const bool isNeedle = random.below(3) == 0;
  return scenes::makeBox({random.uniform(0.5, 1), isNeedle ? thin : random.uniform(0.3, 1), thin}, 1 + random.below(4));
}

scenes::MeshArrays blockPile(Random& random) {
  for (;;) {
    // All of them in one frame, perhaps with one floor; or each turned.
    const int kind = random.below(3);
    struct Block {
      Vec3d half;
      Transformd pose;
    };
    std::vector<Block> blocks;
    std::vector<scenes::MeshArrays> meshes;
    const int count = 2 + random.below(4);
    for (int i = 0; i < count; ++i) {
      const Vec3d half{random.uniform(0.1, 0.4), random.uniform(0.1, 0.4), random.uniform(0.05, 0.3)};
      Block block{half, {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}};
      if (kind == 2) block.pose = random.rotation();
      if (i > 0) {
        const Block& in = blocks[static_cast<std::size_t>(random.below(i))];
        block.pose.t =
            otgTransform(in.pose, {random.uniform(-in.half.x, in.half.x), random.uniform(-in.half.y, in.half.y),
                                   random.uniform(-in.half.z, in.half.z)});
      }
      if (kind == 1) block.pose.t.z = half.z;
      blocks.push_back(block);
      meshes.push_back(scenes::transformed(scenes::makeBox(otgScale(half, 2.0)), block.pose));
    }
    scenes::MeshArrays mesh = scenes::merge(meshes);
    if (scenes::build(mesh)->meshClass() == MeshClass::kSolid) return mesh;
  }
}

namespace {

/// Vertices at one place become one, as in files that were welded.
scenes::MeshArrays welded(const scenes::MeshArrays& mesh) {
  scenes::MeshBuilder builder;
  const auto corner = [&](std::uint32_t v) {
    return Vec3d{mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z};
  };
  for (const Triangle& t : mesh.triangles) builder.triangle(corner(t.v[0]), corner(t.v[1]), corner(t.v[2]));
  return builder.finish();
}

scenes::MeshArrays cubes(Random& random) {
  const int n = 2 + random.below(3);
  const double part = random.uniform(0.4, 0.9);
  std::vector<bool> full;
  for (int i = 0; i < n * n * n; ++i) full.push_back(i == 0 || random.uniform(0, 1) < part);
  scenes::MeshArrays mesh =
      scenes::makeCubes(n, [&](int x, int y, int z) { return full[static_cast<std::size_t>(x + n * (y + n * z))]; });
  const float scale = 1.0F / static_cast<float>(n);
  for (Vec3f& v : mesh.vertices) v = {v.x * scale - 0.5F, v.y * scale - 0.5F, v.z * scale - 0.5F};
  return mesh;
}

}  // namespace

scenes::MeshArrays flushBlocks(Random& random) {
  if (random.below(4) == 0) return cubes(random);
  // In 64ths, so that flush faces are in one plane exactly.
  struct Block {
    int low[3], high[3];
  };
  const auto side = [&] { return 24 + random.below(40); };
  std::vector<Block> blocks{{{0, 0, 0}, {side(), side(), 8 + random.below(24)}}};
  const int cuts = 1 + random.below(12);
  for (int i = 0; i < cuts; ++i) {
    Block& cut = blocks[static_cast<std::size_t>(random.below(static_cast<int>(blocks.size())))];
    const int axis = random.below(5) / 2;  // seldom along z
    const int length = cut.high[axis] - cut.low[axis];
    if (length < 4) continue;
    Block rest = cut;
    cut.high[axis] = rest.low[axis] = cut.low[axis] + 1 + random.below(length - 1);
    blocks.push_back(rest);
  }
  // As they are, with some missing, or with tops of their own.
  const int kind = random.below(3);
  std::vector<scenes::MeshArrays> meshes;
  for (Block& block : blocks) {
    if (kind == 1 && meshes.size() > 1 && random.below(4) == 0) continue;
    if (kind == 2) block.high[2] -= random.below(block.high[2] - block.low[2]);
    const auto at = [&](int k) { return (block.low[k] + block.high[k]) / 128.0 - 0.5; };
    const auto length = [&](int k) { return (block.high[k] - block.low[k]) / 64.0; };
    meshes.push_back(scenes::transformed(scenes::makeBox({length(0), length(1), length(2)}),
                                         {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {at(0), at(1), at(2)}}));
  }
  const scenes::MeshArrays all = scenes::merge(meshes);
  return random.below(2) == 0 ? welded(all) : all;
}

}  // namespace otg::truth
