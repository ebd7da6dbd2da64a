// SPDX-License-Identifier: BSD-3-Clause
// A convex edge of one mesh that lies across one of the other.
//
// Source: D. Gregorius, "The separating axis test between convex polyhedra" (2013): two edges are a face of the
// Minkowski difference where the arcs of their faces' normals cross on the unit sphere.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_EDGE_PAIR_D) : !defined(OTG_SHARED_EDGE_PAIR_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_EDGE_PAIR_D
#else
#define OTG_SHARED_EDGE_PAIR_F
#endif
#include "shared/contacts/solid_model.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {

/// An edge, a stretch of which is inside the other mesh.
template <class REAL>
struct EdgeOfPair {
  Vec3<REAL> middle, along;  ///< of the stretch
  REAL low, high;            ///< ends of the edge along it, from the middle
  Vec3<REAL> faces[2];       ///< outward normals
};
#define OTG_EDGE_OF_PAIR EdgeOfPair<REAL>
#else
#define OTG_EDGE_OF_PAIR OTG_NAME(otg_edge_of_pair)
typedef struct {
  OTG_VEC3 middle, along;
  REAL low, high;
  OTG_VEC3 faces[2];
} OTG_EDGE_OF_PAIR;
#endif

/// Whether A gets past B's edge along d, which is perpendicular to both.
OTG_GENERIC otg_int OTG_NAME(otgIsOutAcross)(const OTG_EDGE_OF_PAIR* a, const OTG_EDGE_OF_PAIR* b, OTG_VEC3 d) {
  return OTG_NAME(otgIsBetween)(a->faces[0], a->faces[1], OTG_NAME(otgScale)(d, OTG_REAL(-1))) &&
         OTG_NAME(otgIsBetween)(b->faces[0], b->faces[1], d);
}

/// Whether the two are across each other: a face of the Minkowski difference. If so, `direction` is perpendicular to
/// both, in the sense in which A gets out of B, and `depth` is how far A goes along it.
OTG_GENERIC otg_int OTG_NAME(otgAreAcross)(const OTG_EDGE_OF_PAIR* a, const OTG_EDGE_OF_PAIR* b, OTG_VEC3* direction,
                                           REAL* depth) {
  const OTG_VEC3 across = OTG_NAME(otgCross)(a->along, b->along);
  const OTG_VEC3 apart = OTG_NAME(otgSub)(b->middle, a->middle);
  const REAL sine = OTG_NAME(otgNorm)(across);
  OTG_VEC3 d;
  REAL u, v;
  if (sine < OTG_REAL(OTG_SOLID_LEAST_SINE)) return 0;
  d = OTG_NAME(otgScale)(across, 1 / sine);
  if (!OTG_NAME(otgIsOutAcross)(a, b, d)) d = OTG_NAME(otgScale)(d, OTG_REAL(-1));
  if (!OTG_NAME(otgIsOutAcross)(a, b, d)) return 0;
  // Nearest points of the two lines, within the edges.
  u = OTG_NAME(otgDot)(OTG_NAME(otgCross)(apart, b->along), across) / (sine * sine);
  v = OTG_NAME(otgDot)(OTG_NAME(otgCross)(apart, a->along), across) / (sine * sine);
  if (u < a->low || u > a->high || v < b->low || v > b->high) return 0;
  *direction = d;
  *depth = OTG_NAME(otgDot)(apart, d);
  return *depth > 0;
}

#undef OTG_EDGE_OF_PAIR
#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
