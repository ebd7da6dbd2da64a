// SPDX-License-Identifier: BSD-3-Clause
// The near phase as published: a contact for each candidate pair, made without a branch and without testing first
// whether the triangles meet. Its result shows it. levels_near.cl has the kernels that test first.
//
// OTG_GROUP: work-items of a work-group; each has one pair. OTG_CONTACTS as in pair_record.h. Needs doubles.
#define OTG_LEAF 1
#include "pairwise/pair_record.h"
#include "shared/layout/published_given.h"

#ifdef OTG_WITH_DOUBLE
#define OTG_REAL_DOUBLE
#include "shared/contacts/contact_of_any.h"
#undef OTG_REAL_DOUBLE

__kernel __attribute__((reqd_work_group_size(OTG_GROUP, 1, 1))) void contactsFirst(OTG_GIVEN(ContactsFirst)) {
  const uint i = get_global_id(0);
  if (i >= count) return;
  const uint placeA = pair.a.soup + 3 * candidates[i].x, placeB = pair.b.soup + 3 * candidates[i].y;
  otg_vec3_d a[3], b[3];
  otgCornersInDouble(meshes, placeA, placeB, bInA, a, b);
  const otg_any_contact_d any = otgContactOfAny_d(a, b, 32 * 0x1p-53, 1e-280);
  if (any.answer == OTG_DISJOINT) return;
  const uint slot = otgTakeHit(counters, any.answer);
  if (slot >= hitCapacity) return;
  __global otg_record* record = (__global otg_record*)(results + OTG_RESULT_HEAD) + slot;
  record->a = as_uint(meshes[placeA].w);
  record->b = as_uint(meshes[placeB].w);
  record->pair = 0;
#if OTG_CONTACTS
  record->kind = any.answer == OTG_UNDECIDED ? OTG_RECORD_OPEN : any.contact.kind;
  otgStoreContact(any.contact, record);
#else
  record->kind = any.answer == OTG_UNDECIDED ? OTG_RECORD_OPEN : OTG_RECORD_HIT;
#endif
}
#endif
