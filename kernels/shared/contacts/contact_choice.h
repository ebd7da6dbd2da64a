// SPDX-License-Identifier: BSD-3-Clause
// Where a contact lies for the choices between contacts: its bin of the six-dimensional binning, and its point in the
// grid in which spread is measured.
//
// Bounds of positions are those of the positions rounded to single precision: a device finds them with atomic minima
// and maxima of 32 bits. Distances are whole numbers, so that no rounding decides which contact is farther.
#if defined(OTG_REAL_DOUBLE) ? !defined(OTG_SHARED_CONTACT_CHOICE_D) : !defined(OTG_SHARED_CONTACT_CHOICE_F)
#ifdef OTG_REAL_DOUBLE
#define OTG_SHARED_CONTACT_CHOICE_D
#else
#define OTG_SHARED_CONTACT_CHOICE_F
#endif
#include "shared/math/vec3.h"
//
#include "shared/math/generic_begin.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

#define OTG_MAX_BINS 64  ///< along an axis; 64^6 bins are 36 bits of key
#define OTG_SPREAD 1023  ///< steps of the spread's grid along an axis

/// Bin of a contact. `low` and `high`: bounds of the positions. An axis along which all positions agree says nothing:
/// its coordinate is the middle of the cube. Halves are subtracted so that bounds near the largest float do not
/// overflow. `score`: squared distance from the centre of the cube; the contact of the highest score stays.
OTG_GENERIC otg_ulong OTG_NAME(otgBinOf)(OTG_VEC3 position, OTG_VEC3 normal, const float* low, const float* high,
                                         const otg_int* bins, REAL* score) {
  REAL u[6], sum = 0;
  otg_ulong key = 0;
  u[0] = position.x;
  u[1] = position.y;
  u[2] = position.z;
  u[3] = normal.x;
  u[4] = normal.y;
  u[5] = normal.z;
  for (int k = 0; k < 6; ++k) {
    const REAL from = k < 3 ? OTG_REAL(low[k % 3]) : OTG_REAL(-1), to = k < 3 ? OTG_REAL(high[k % 3]) : OTG_REAL(1);
    const REAL radius = OTG_REAL(0.5) * to - OTG_REAL(0.5) * from;
    const otg_int n = bins[k] < 1 ? 1 : bins[k] > OTG_MAX_BINS ? OTG_MAX_BINS : bins[k];
    REAL scaled, last;
    otg_int cell;
    u[k] = radius > 0 ? (OTG_REAL(0.5) * u[k] - OTG_REAL(0.5) * from) / radius : OTG_REAL(0.5);
    sum = sum + (u[k] - OTG_REAL(0.5)) * (u[k] - OTG_REAL(0.5));
    // The upper face belongs to the last bin, and a normal that rounding made longer than 1 to the outermost one. The
    // comparison that is false for NaN comes before the cast, which would be undefined for it.
    scaled = u[k] * OTG_REAL(n);
    last = OTG_REAL(n) - 1;
    cell = scaled > 0 ? OTG_INT(scaled < last ? scaled : last) : 0;
    key = key * OTG_MAX_BINS + OTG_UINT(cell);
  }
  *score = sum;
  return key;
}

/// The six coordinates of a contact in the grid, each 0 to OTG_SPREAD: positions in steps of the bounds' diagonal over
/// OTG_SPREAD, normals so that opposite ones are as far apart as opposite corners. A squared distance fits in 22 bits.
OTG_GENERIC void OTG_NAME(otgSpreadPoint)(OTG_VEC3 position, OTG_VEC3 normal, const float* low, const float* high,
                                          otg_int* point) {
  const OTG_VEC3 from = OTG_NAME(otgVec)(OTG_REAL(low[0]), OTG_REAL(low[1]), OTG_REAL(low[2]));
  const OTG_VEC3 to = OTG_NAME(otgVec)(OTG_REAL(high[0]), OTG_REAL(high[1]), OTG_REAL(high[2]));
  const OTG_VEC3 size = OTG_NAME(otgSub)(to, from), d = OTG_NAME(otgSub)(position, from);
  const REAL diagonal = OTG_SQRT(OTG_NAME(otgDot)(size, size));
  const REAL scale = diagonal > 0 ? OTG_REAL(OTG_SPREAD) / diagonal : OTG_REAL(0);
  REAL x[6];
  x[0] = d.x * scale;
  x[1] = d.y * scale;
  x[2] = d.z * scale;
  x[3] = OTG_REAL(0.5 * OTG_SPREAD) * normal.x + OTG_REAL(0.5 * OTG_SPREAD);
  x[4] = OTG_REAL(0.5 * OTG_SPREAD) * normal.y + OTG_REAL(0.5 * OTG_SPREAD);
  x[5] = OTG_REAL(0.5 * OTG_SPREAD) * normal.z + OTG_REAL(0.5 * OTG_SPREAD);
  for (int k = 0; k < 6; ++k) {
    const REAL nearest = x[k] + OTG_REAL(0.5);
    point[k] = nearest > 0 ? OTG_INT(nearest < OTG_REAL(OTG_SPREAD) ? nearest : OTG_REAL(OTG_SPREAD)) : 0;
  }
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#include "shared/math/generic_end.h"
#endif
