// SPDX-License-Identifier: BSD-3-Clause
// Machine parts: gear, block with a hole, bolt and nut.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scenes/mesh_builder.h"

namespace otg::scenes {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

Vec3d polar(double r, double angle, double z) {
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// The ISO metric thread, as the distance from the axis over the phase in turns; the middle of the crest is at phase 0.
struct Thread {
  double crest, root, pitch, length;
  int segments;

  // Corners of the profile: half of the crest's and of the groove's width, in pitches.
  static constexpr double kCrestHalf = 1.0 / 16, kRootStart = 3.0 / 8;
  static constexpr double kDepth = 5.0 / 16 * std::numbers::sqrt3;  ///< in pitches

  Thread(double outerRadius, double threadPitch, double threadLength, int turnSegments)
      : crest(outerRadius),
        root(outerRadius - kDepth * threadPitch),
        pitch(threadPitch),
        length(threadLength),
        segments(turnSegments) {}

  double radiusAtPhase(double phase) const {
    const double x = std::abs(phase - std::round(phase));
    const double t = std::clamp((x - kCrestHalf) / (kRootStart - kCrestHalf), 0.0, 1.0);
    return crest + t * (root - crest);
  }
  Vec3d end(double z, int j) const {
    return polar(radiusAtPhase(z / pitch - static_cast<double>(j % segments) / segments), angle(j), z);
  }
  double angle(int j) const { return kTwoPi * (j % segments) / segments; }

  /// Rows follow the helix, four to a turn (one for each corner of the profile); beyond the ends they fall onto the
  /// ends. After a whole turn, column `segments` of a row is column 0 of the fourth row above it, to the last bit.
  Vec3d point(int row, int j) const {
    constexpr double kCorner[4] = {-kCrestHalf, kCrestHalf, kRootStart, 1 - kRootStart};
    const int turn = row >= 0 ? row / 4 : -((3 - row) / 4), corner = row - 4 * turn;
    const double z = pitch * ((turn + static_cast<double>(j) / segments) + kCorner[corner]);
    const double snap = 1e-3 * pitch;  // no slivers where a row all but ends at an end
    if (z < snap) return end(0, j);
    if (z > length - snap) return end(length, j);
    return polar(corner < 2 ? crest : root, angle(j), z);
  }
  int firstRow() const { return -8; }
  int lastRow() const { return 4 * (static_cast<int>(std::ceil(length / pitch)) + 1); }
};

void addThread(MeshBuilder& builder, const Thread& thread, bool facesAxis) {
  for (int row = thread.firstRow(); row < thread.lastRow(); ++row) {
    for (int j = 0; j < thread.segments; ++j) {
      const Vec3d a = thread.point(row, j), b = thread.point(row, j + 1);
      const Vec3d c = thread.point(row + 1, j + 1), d = thread.point(row + 1, j);
      if (facesAxis)
        builder.quad(a, d, c, b);
      else
        builder.quad(a, b, c, d);
    }
  }
}

/// Point j of a hexagon with corners at multiples of 60 degrees. From axis to flat it is 3 / 2 of the thread's radius,
/// the proportion of an M16 bolt.
Vec3d hexagonPoint(const Thread& thread, double radius, double z, int j) {
  const double sixth = kTwoPi / 6, angle = thread.angle(j);
  const double fromFlat = angle - sixth * (std::floor(angle / sixth) + 0.5);
  return polar(1.5 * radius / std::cos(fromFlat), angle, z);
}

}  // namespace

MeshArrays makeGear(int teeth, double pitchRadius, double toothDepth, double width, double boreRadius) {
  // Four points for each tooth. The flanks pass the pitch circle at 0.24 of a tooth's share of the circle.
  const double share = kTwoPi / teeth, rootRadius = pitchRadius - toothDepth / 2,
               tipRadius = pitchRadius + toothDepth / 2;
  const int points = 4 * teeth;
  static constexpr double kAngle[4] = {-0.34, -0.14, 0.14, 0.34};
  const auto angle = [&](int j) {
    const int tooth = j % points / 4;
    return share * (tooth + kAngle[j % 4]);
  };
  const auto outline = [&](int j, double z) {
    return polar(j % 4 == 1 || j % 4 == 2 ? tipRadius : rootRadius, angle(j), z);
  };
  const auto bore = [&](int j, double z) { return polar(boreRadius, angle(j), z); };
  MeshBuilder builder;
  const double top = width / 2, bottom = -width / 2;
  for (int j = 0; j < points; ++j) {
    // Without a bore its points fall together on the axis, and half of these triangles vanish.
    builder.quad(outline(j, bottom), outline(j + 1, bottom), outline(j + 1, top), outline(j, top));
    builder.quad(bore(j, top), outline(j, top), outline(j + 1, top), bore(j + 1, top));
    builder.quad(bore(j + 1, bottom), outline(j + 1, bottom), outline(j, bottom), bore(j, bottom));
    builder.quad(bore(j + 1, bottom), bore(j, bottom), bore(j, top), bore(j + 1, top));
  }
  return builder.finish();
}

MeshArrays makeBlockWithHole(Vec3d size, double hole) {
  static constexpr double kSign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const auto outer = [&](int j, double z) {
    return Vec3d{kSign[j % 4][0] * size.x / 2, kSign[j % 4][1] * size.y / 2, z};
  };
  const auto inner = [&](int j, double z) { return Vec3d{kSign[j % 4][0] * hole / 2, kSign[j % 4][1] * hole / 2, z}; };
  const double top = size.z / 2, bottom = -size.z / 2;
  MeshBuilder builder;
  for (int j = 0; j < 4; ++j) {
    builder.quad(outer(j, bottom), outer(j + 1, bottom), outer(j + 1, top), outer(j, top));
    builder.quad(inner(j, top), outer(j, top), outer(j + 1, top), inner(j + 1, top));
    builder.quad(inner(j + 1, bottom), outer(j + 1, bottom), outer(j, bottom), inner(j, bottom));
    builder.quad(inner(j + 1, bottom), inner(j, bottom), inner(j, top), inner(j + 1, top));
  }
  return builder.finish();
}

MeshArrays makeBolt(double radius, double pitch, double length, int segments) {
  const Thread thread(radius, pitch, length, segments);
  const double headBottom = -1.25 * radius;
  const auto head = [&](double z, int j) { return hexagonPoint(thread, radius, z, j); };
  MeshBuilder builder;
  addThread(builder, thread, false);
  addFan(builder, {0, 0, length}, segments, [&](int j) { return thread.end(length, j); });
  addFan(builder, {0, 0, headBottom}, segments, [&](int j) { return head(headBottom, segments - j); });
  for (int j = 0; j < segments; ++j) {
    builder.quad(thread.end(0, j), head(0, j), head(0, j + 1), thread.end(0, j + 1));
    builder.quad(head(headBottom, j), head(headBottom, j + 1), head(0, j + 1), head(0, j));
  }
  return builder.finish();
}

MeshArrays makeNut(double radius, double pitch, double length, double clearance, int segments) {
  const Thread thread(radius + clearance, pitch, length, segments);
  const auto outside = [&](double z, int j) { return hexagonPoint(thread, radius, z, j); };
  MeshBuilder builder;
  addThread(builder, thread, true);
  for (int j = 0; j < segments; ++j) {
    builder.quad(outside(0, j), outside(0, j + 1), outside(length, j + 1), outside(length, j));
    builder.quad(thread.end(length, j), outside(length, j), outside(length, j + 1), thread.end(length, j + 1));
    builder.quad(thread.end(0, j + 1), outside(0, j + 1), outside(0, j), thread.end(0, j));
  }
  return builder.finish();
}

}  // namespace otg::scenes
