// SPDX-License-Identifier: BSD-3-Clause
// Formulas by which the parts of an uneven region leave it: whole triangles of its surface, and what lies on them.
// docs/contacts.md describes the model.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_UNEVEN_MODEL_D) : !defined(OTG_SHARED_UNEVEN_MODEL_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_UNEVEN_MODEL_D
#else
#define OTG_SHARED_UNEVEN_MODEL_F
#endif
#include "shared/contacts/solid_model.h"
#include "shared/tests/triangle_distance.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Cosines from which on two faces face the same way, and two half-spaces are one.
#define OTG_UNEVEN_SAME_NORMAL (1 - 1e-12)
/// Factor for distances that round.
#define OTG_UNEVEN_SURELY (1 + 1e-8)
/// The same for limits of ways.
#define OTG_UNEVEN_WITHIN (1 + 1e-6)
/// A face is that of a curved surface beside another one whose normal is turned by less than 20 degrees. It is turned
/// by more than rounding.
#define OTG_UNEVEN_SHARP 0.94
#define OTG_UNEVEN_TURNED (1 - 1e-6)
/// The translation that parts request is so many times the deepest part's way, at most. A body that is jammed between
/// two walls is not requested to leave them at their end.
#define OTG_UNEVEN_LONGEST 10
/// Through a face that faces along by less no way leads.
#define OTG_UNEVEN_LEAST_COSINE 0.05

/// Unit, in a triangle's plane, from one of its edges to the inside.
OTG_GENERIC OTG_VEC3 OTG_NAME(otgInward)(OTG_VEC3 normal, OTG_VEC3 from, OTG_VEC3 to) {
  return OTG_NAME(otgUnit)(OTG_NAME(otgCross)(normal, OTG_NAME(otgSub)(to, from)));
}

OTG_GENERIC REAL OTG_NAME(otgDistanceOfTriangle)(OTG_VEC3 a, OTG_VEC3 b, OTG_VEC3 c, OTG_VEC3 p) {
  return OTG_NAME(otgNorm)(OTG_NAME(otgSub)(OTG_NAME(otgPointOnTriangle)(a, b, c, p), p));
}

/// What is as far as the nearest face counts as that; no face does whose plane is farther.
OTG_GENERIC REAL OTG_NAME(otgAsNear)(REAL nearest, REAL slack) {
  return nearest * (1 + OTG_REAL(1e-9)) + slack;
}

OTG_GENERIC int OTG_NAME(otgIsTurned)(REAL cosine) {
  return cosine > OTG_REAL(OTG_UNEVEN_SHARP) && cosine < OTG_REAL(OTG_UNEVEN_TURNED);
}

/// How far a stretch whose ends lie so far below a face is to go.
OTG_GENERIC REAL OTG_NAME(otgDeeperEnd)(REAL first, REAL last) {
  const REAL deeper = first < last ? last : first;
  return deeper < 0 ? OTG_REAL(0) : deeper;
}

/// The way along a direction through a face, below whose plane its beginning lies by `depth`.
OTG_GENERIC REAL OTG_NAME(otgWayThrough)(REAL depth, REAL cosine) {
  const REAL way = depth / cosine;
  return way > 0 ? way : OTG_REAL(0);
}

/// How far a contact that is to go so far may request to go. From the distance of its point from the surface that faces
/// its way. No surface farther than otgEnoughToGo matters.
OTG_GENERIC REAL OTG_NAME(otgEnoughToGo)(REAL way) {
  return OTG_REAL(OTG_UNEVEN_WITHIN) * way / OTG_REAL(OTG_SOLID_NEIGHBOURHOOD);
}
OTG_GENERIC REAL OTG_NAME(otgNeighbourhood)(REAL way, REAL distance) {
  const REAL most = OTG_REAL(OTG_SOLID_NEIGHBOURHOOD) * distance;
  return most < way ? most : way;
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
