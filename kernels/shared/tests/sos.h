// SPDX-License-Identifier: BSD-3-Clause
// Signs that are never zero: simulation of simplicity by a symbolic translation of mesh A.
//
// A is thought to be moved by (e, e^2, e^3) for an infinitesimal e > 0. That is a rigid motion, so whatever the signs
// say together is the intersection of two real, slightly displaced meshes: every pair of triangles has zero or two
// crossings, contours close, and vertex-on-face, coplanar, aligned and identical placements need no tolerance. A
// determinant that is exactly zero takes the sign of the first non-zero coordinate of its gradient with respect to that
// translation. The gradient vanishes only for parallel edges, and of those no sign is ever needed: an edge parallel to
// an edge of a triangle has both ends on the same side of its plane.
//
// Source of the idea: H. Edelsbrunner and E. Muecke, "Simulation of Simplicity", ACM TOG 9(1), 1990.
#ifndef OTG_SHARED_SOS_H
#define OTG_SHARED_SOS_H
#include "shared/tests/triangle_exact.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Exact sign of coordinate k of (p1 - p0) x (q1 - q0).
OTG_INLINE int otgCrossSign(const double* p0, const double* p1, const double* q0, const double* q1, int k) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  double l = (p1[i] - p0[i]) * (q1[j] - q0[j]), r = (p1[j] - p0[j]) * (q1[i] - q0[i]);
  double det = l - r, bound = 4.0e-16 * (fabs(l) + fabs(r)) + OTG_TINY_DETERMINANT;
  if (det > bound) return 1;
  if (det < -bound) return -1;
  return OTG_EXACT_MINOR(p1[i], p0[i], q1[j], q0[j], p1[j], p0[j], q1[i], q0[i]);
}

/// Sign of the first non-zero coordinate of (p1 - p0) x (q1 - q0); 0 for parallel vectors.
OTG_INLINE int otgCrossLexicographicSign(const double* p0, const double* p1, const double* q0, const double* q1) {
  for (int k = 0; k < 3; ++k) {
    int s = otgCrossSign(p0, p1, q0, q1, k);
    if (s != 0) return s;
  }
  return 0;
}

/// Side of a vertex of A with respect to a triangle of B: 1 where its normal points (outside), -1 behind. Never 0
/// unless the triangle has no area.
OTG_INLINE int otgSosSideOfA(const double* b0, const double* b1, const double* b2, const double* a) {
  int s = otgOrient3(b0, b1, b2, a);
  return s != 0 ? s : otgCrossLexicographicSign(b0, b1, b0, b2);
}

/// Side of a vertex of B with respect to a triangle of A.
OTG_INLINE int otgSosSideOfB(const double* a0, const double* a1, const double* a2, const double* b) {
  int s = otgOrient3(a0, a1, a2, b);
  return s != 0 ? s : -otgCrossLexicographicSign(a0, a1, a0, a2);
}

/// Orientation of edge a0 a1 of A and edge b0 b1 of B: sign of det[a1 - a0, b0 - a0, b1 - a0].
OTG_INLINE int otgSosEdges(const double* a0, const double* a1, const double* b0, const double* b1) {
  int s = otgOrient3(a0, a1, b0, b1);
  return s != 0 ? s : otgCrossLexicographicSign(a0, a1, b0, b1);
}

/// How the segment from p to q, of A, passes through a triangle of B: 1 leaves, -1 enters, 0 passes it by.
OTG_INLINE int otgSosPassOfA(const double* p, const double* q, const double* b0, const double* b1, const double* b2) {
  const int from = otgSosSideOfA(b0, b1, b2, p), to = otgSosSideOfA(b0, b1, b2, q);
  int s0, s1, s2;
  if (from == to) return 0;
  s0 = otgSosEdges(p, q, b0, b1) < 0;
  s1 = otgSosEdges(p, q, b1, b2) < 0;
  s2 = otgSosEdges(p, q, b2, b0) < 0;
  return s0 == s1 && s1 == s2 ? (to > 0 ? 1 : -1) : 0;
}

/// The same of a segment of B and a triangle of A.
OTG_INLINE int otgSosPassOfB(const double* p, const double* q, const double* a0, const double* a1, const double* a2) {
  const int from = otgSosSideOfB(a0, a1, a2, p), to = otgSosSideOfB(a0, a1, a2, q);
  int s0, s1, s2;
  if (from == to) return 0;
  s0 = otgSosEdges(a0, a1, p, q) < 0;
  s1 = otgSosEdges(a1, a2, p, q) < 0;
  s2 = otgSosEdges(a2, a0, p, q) < 0;
  return s0 == s1 && s1 == s2 ? (to > 0 ? 1 : -1) : 0;
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_SOS_H
