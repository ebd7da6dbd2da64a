// SPDX-License-Identifier: BSD-3-Clause
// Whether two triangles meet that double arithmetic leaves open, exactly: as collide/near_phase.cpp. Needs doubles.
#ifndef OTG_EXACT_DECISION_H
#define OTG_EXACT_DECISION_H
#include "pairwise/pair_record.h"
#include "solid/inlined.h"
//
#include "shared/tests/triangle_exact.h"

/// Whether the predicate of six points can be decided exactly.
OTG_INLINED int otgIsExactHere(const otg_vec3_d* p) {
  int good = 1;
  OTG_ROLLED
  for (int i = 0; i < 6; ++i) {
    good = good && otgIsExactCoordinate(p[i].x) && otgIsExactCoordinate(p[i].y) && otgIsExactCoordinate(p[i].z);
  }
  return good;
}

/// OTG_RECORD_HIT or OTG_RECORD_APART, or OTG_RECORD_OPEN. Corners of A's triangle, then of B's.
OTG_INLINED int otgDecideExactly(const otg_vec3_d* corners) {
  if (!otgIsExactHere(corners)) return OTG_RECORD_OPEN;
  if (otgIsWithoutArea(&corners[3].x)) return OTG_RECORD_APART;
  return otgTrianglesMeetExact(&corners[0].x, &corners[3].x) ? OTG_RECORD_HIT : OTG_RECORD_APART;
}

/// The record of a hit, made by otgMakeRecord, if that left it open: as if it had not, or open still.
OTG_INLINED void otgDecideRecord(__global const float4* meshes, uint placeA, uint placeB, otg_transform_d bInA,
                                 uint pair, __global otg_record* record) {
  otg_vec3_d corners[6];
  if (record->kind != OTG_RECORD_OPEN) return;
  otgCornersInDouble(meshes, placeA, placeB, bInA, corners, corners + 3);
  const int kind = otgDecideExactly(corners);
  record->kind = kind;
#if OTG_CONTACTS
  if (kind == OTG_RECORD_HIT) otgMakeRecord(meshes, placeA, placeB, 0, bInA, pair, record);
#endif
}

#endif  // OTG_EXACT_DECISION_H
