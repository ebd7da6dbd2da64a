// SPDX-License-Identifier: BSD-3-Clause
#include "collide/pair_frame.h"

#include <cmath>
#include <limits>

#include "collide/rotation_tolerance.h"

namespace otg {
namespace {

constexpr double kFloatUnit = 0x1p-24;
constexpr double kDoubleUnit = 0x1p-53;

float roundUp(double x) {
  float f = static_cast<float>(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

double length(const Vec3f& v) {
  return std::sqrt(double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z);
}

}  // namespace

PairFrame makePairFrame(const Query& query) {
  const TriMesh& a = query.a->mesh();
  const TriMesh& b = query.b->mesh();
  const Transformd& m = query.bInA;
  PairFrame frame{};

  // The centred frames: x = v - center. Both the transform of B's centre and the difference are taken in double.
  const Vec3d centerB = otgTransform<double>(m, {b.center().x, b.center().y, b.center().z});
  const Vec3d t{centerB.x - a.center().x, centerB.y - a.center().y, centerB.z - a.center().z};

  double rowNorm = 0;
  for (int i = 0; i < 3; ++i) {
    double row = 0;
    for (int j = 0; j < 3; ++j) row += m.r[3 * i + j] * m.r[3 * i + j];
    rowNorm = std::max(rowNorm, std::sqrt(row));
  }
  const double defect = rotationDefect(m);
  const double ra = a.radius(), rb = b.radius() * rowNorm;
  const double tn = std::sqrt(t.x * t.x + t.y * t.y + t.z * t.z);
  const double scale = ra + rb + tn;

  for (int i = 0; i < 9; ++i) {
    frame.boxes.r[i] = static_cast<float>(m.r[i]);
    frame.boxes.absR[i] = std::fabs(frame.boxes.r[i]);
    frame.trianglesInA.r[i] = frame.boxes.r[i];
  }
  frame.boxes.t = {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z)};
  frame.trianglesInA.t = frame.boxes.t;

  // Boxes: a gap along a face or edge axis is a sum of at most 17 rounded terms whose magnitudes add up to `scale` at
  // most (rows of R have norm 1, so Cauchy-Schwarz bounds the rotated centre and extents by the radius); 21 u scale for
  // the face axes of B and 32 u scale for edge axes bound the whole.
  //
  // Where R is not orthonormal (a matrix is used as given) the tests still take the columns r_j of R for B's axes and
  // for each other's cross products. With E = R^T R - 1 and e for the extents of a box of B, B reaches
  // sum_k e_k |(1 + E)_kj| along r_j, not e_j: off by |e| |E| at most. Along a_i x r_j it reaches e_k |cof(R)_il| + ..,
  // not e_k |R_il| + ..; the singular values s of R differ from those of its cofactors by s2 s3 - s1, about half of
  // what E's eigenvalues add up to, so this is off by less than |e| |E| too (0.87, and 0.003 for the second order at
  // the largest defect). A box lies within the mesh's bounds, so |e| <= sqrt(3) radius: 2 > sqrt(3) covers both.
  const double placement = 16 * kDoubleUnit * (length(a.center()) + length(b.center()) * rowNorm + scale);
  frame.boxes.eps = roundUp(32 * kFloatUnit * scale + 2 * defect * b.radius() + placement + 1e-37);

  // Triangles: centring rounds once (u r), the transform costs at most 8 u scale on top of R's and t's own rounding.
  const double delta = 16 * kFloatUnit * scale + placement;
  frame.floatError = {roundUp(10 * kFloatUnit), roundUp(2.1 * delta), 1e-30f};
  frame.doubleError = {10 * kDoubleUnit, 0.0, 1e-290};
  // In float the cube of the size must not overflow (the filter would only answer "cannot tell", but inf - inf in a box
  // gap must not arise either).
  frame.finite = std::isfinite(scale) && scale < 1e37;
  return frame;
}

}  // namespace otg
