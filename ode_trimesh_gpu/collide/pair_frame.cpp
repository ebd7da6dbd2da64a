// SPDX-License-Identifier: BSD-3-Clause
#include "collide/pair_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vectors.h"
#include "collide/rotation_tolerance.h"
#include "shared/tests/pair_bounds.h"
#include "shared/tests/triangle_exact.h"

namespace otg {
namespace {

constexpr double kFloatUnit = 0x1p-24;
constexpr double kDoubleUnit = 0x1p-53;

float roundUp(double x) {
  float f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

}  // namespace

FilterError<float> floatFilterError(float delta) {
  return {roundUp(10 * kFloatUnit), delta, 1e-30f};
}

PairFrame makePairFrame(const Query& query) {
  const TriMesh& a = query.a->mesh();
  const TriMesh& b = query.b->mesh();
  const Transformd& m = query.bInA;
  PairFrame frame{};

  const PairBounds<double> bounds =
      otgPairBounds<double>(m, rotationDefect(m), asDouble(a.origin()), a.radius(), asDouble(b.origin()), b.radius());
  for (int i = 0; i < 9; ++i) {
    frame.boxes.r[i] = static_cast<float>(m.r[i]);
    frame.boxes.absR[i] = std::fabs(frame.boxes.r[i]);
    frame.trianglesInA.r[i] = frame.boxes.r[i];
  }
  frame.boxes.t = {static_cast<float>(bounds.t.x), static_cast<float>(bounds.t.y), static_cast<float>(bounds.t.z)};
  frame.trianglesInA.t = frame.boxes.t;

  frame.boxes.eps = roundUp(bounds.eps);
  frame.floatError = floatFilterError(roundUp(bounds.delta));
  // In units of roundoff: A's corner one rounding; B's one, the rotation's coefficient, its product and two sums three
  // more, and two with t, which has one of its own. 2.1 times that, rounded up for what rounds here.
  frame.nearError = {floatFilterError(roundUp(4.2 * bounds.placement + 1e-36)), roundUp(2.2 * kFloatUnit),
                     roundUp(2.2 * 7 * kFloatUnit * std::max(1.0, bounds.rowNorm))};
  frame.doubleError = {10 * kDoubleUnit, 0.0, OTG_TINY_DETERMINANT};
  frame.finite = std::isfinite(bounds.scale) && bounds.scale < OTG_LARGEST_SCALE;
  return frame;
}

}  // namespace otg
