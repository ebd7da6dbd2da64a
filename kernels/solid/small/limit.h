// SPDX-License-Identifier: BSD-3-Clause
// The contacts of a pair of solids that stay when there are more than places, as collide/pairwise/limit_contacts.cpp.
#ifndef OTG_SOLID_LIMIT_H
#define OTG_SOLID_LIMIT_H
#include "solid/choose.h"
//
#define OTG_REAL_DOUBLE
#include "shared/contacts/contact_choice.h"
#include "shared/contacts/uneven_model.h"
#undef OTG_REAL_DOUBLE

#define OTG_SPOT_TAKEN 0xffffffffu

/// As contactDeeper: a total order.
OTG_INLINED int otgDeeper(__global const otg_chosen_contact* x, __global const otg_chosen_contact* y) {
  if (x->depth != y->depth) return x->depth > y->depth;
  if (x->triangleA != y->triangleA) return x->triangleA < y->triangleA;
  if (x->triangleB != y->triangleB) return x->triangleB < y->triangleB;
  if ((x->feature & 0xff) != (y->feature & 0xff)) return (x->feature & 0xff) < (y->feature & 0xff);
  for (int k = 0; k < 3; ++k) {
    if (x->position[k] != y->position[k]) return x->position[k] < y->position[k];
  }
  for (int k = 0; k < 3; ++k) {
    if (x->normal[k] != y->normal[k]) return x->normal[k] < y->normal[k];
  }
  return x->region < y->region;
}

OTG_INLINED uint otgSpotDistance(uint2 p, uint2 q) {
  uint sum = 0;
  for (uint k = 0; k < 3; ++k) {
    const int x = (int)(p.x >> 10 * k & 0x3ff) - (int)(q.x >> 10 * k & 0x3ff);
    const int y = (int)(p.y >> 10 * k & 0x3ff) - (int)(q.y >> 10 * k & 0x3ff);
    sum += (uint)(x * x) + (uint)(y * y);
  }
  return sum;
}

/// Floats as unsigned integers in the same order.
OTG_INLINED uint otgOrderedBits(float x) {
  const uint bits = as_uint(x);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}
OTG_INLINED float otgFromOrderedBits(uint x) {
  return as_float(x & 0x80000000u ? x & 0x7fffffffu : ~x);
}

/// Writes the contacts that stay, deepest first, with their triangles in their callers' numbers; how many they are. All
/// lanes call it.
OTG_INLINED uint otgLimitContacts(__local otg_solid_choice* s, __global const otg_chosen_contact* found, uint count,
                                  uint places, OTG_MESH* a, OTG_MESH* b, __global otg_chosen_contact* out) {
  const uint lane = get_local_id(0), kept = min(count, places), some = count > places ? count : 0;
  for (uint i = lane; i < count; i += OTG_GROUP) {
    uint place = 0;
    for (uint j = 0; j < count; ++j) place += otgDeeper(found + j, found + i);
    OTG_SORTED(s)[place] = (ushort)i;
  }
  if (lane == 0) {
    for (int k = 0; k < 3; ++k) {
      s->low[k] = 0xffffffffu;
      s->high[k] = 0;
    }
    s->seeds = 0;
    s->seen = 0;
  }
  OTG_SYNC;
  for (uint i = lane; i < some; i += OTG_GROUP) {
    for (int k = 0; k < 3; ++k) {
      const uint x = otgOrderedBits((float)found[i].position[k]);
      atomic_min(s->low + k, x);
      atomic_max(s->high + k, x);
    }
  }
  OTG_SYNC;
  for (uint i = lane; i < count; i += OTG_GROUP) {
    __global const otg_chosen_contact* c = found + OTG_SORTED(s)[i];
    float low[3], high[3];
    int spot[6];
    for (int k = 0; k < 3; ++k) {
      low[k] = otgFromOrderedBits(s->low[k]);
      high[k] = otgFromOrderedBits(s->high[k]);
    }
    OTG_NEAREST(s)[i] = some > 0 ? 0xfffffffeu : OTG_SPOT_TAKEN;
    if (some == 0) continue;
    otgSpreadPoint_d(otgLoad(c->position), otgLoad(c->normal), low, high, spot);
    OTG_SPOT(s)
    [i] = (uint2)((uint)(spot[0] | spot[1] << 10 | spot[2] << 20), (uint)(spot[3] | spot[4] << 10 | spot[5] << 20));
  }
  OTG_SYNC;
  if (lane == 0) {  // the deepest of each region
    for (uint i = 0; i < some && s->seeds < places; ++i) {
      const uint bit = 1u << found[OTG_SORTED(s)[i]].region;
      if (s->seen & bit) continue;
      s->seen |= bit;
      OTG_NEAREST(s)[i] = OTG_SPOT_TAKEN;
      ++s->seeds;
    }
  }
  OTG_SYNC;
  const uint seeds = s->seeds;
  for (uint i = lane; i < some; i += OTG_GROUP) {
    if (OTG_NEAREST(s)[i] == OTG_SPOT_TAKEN) continue;
    uint nearest = 0xfffffffeu;
    for (uint j = 0; j < some; ++j) {
      if (OTG_NEAREST(s)[j] == OTG_SPOT_TAKEN) nearest = min(nearest, otgSpotDistance(OTG_SPOT(s)[i], OTG_SPOT(s)[j]));
    }
    OTG_NEAREST(s)[i] = nearest;
  }
  OTG_SYNC;
  const uint rounds = some > 0 ? places - seeds : 0;
  for (uint round = 0; round < rounds; ++round) {
    if (lane == 0) {
      uint best = OTG_NOT_THERE;
      for (uint i = 0; i < some; ++i) {
        if (OTG_NEAREST(s)[i] != OTG_SPOT_TAKEN && (best == OTG_NOT_THERE || OTG_NEAREST(s)[i] > OTG_NEAREST(s)[best]))
          best = i;
      }
      OTG_NEAREST(s)[best] = OTG_SPOT_TAKEN;
      s->seeds = best;
    }
    OTG_SYNC;
    const uint2 taken = OTG_SPOT(s)[s->seeds];
    for (uint i = lane; i < some; i += OTG_GROUP) {
      if (OTG_NEAREST(s)[i] != OTG_SPOT_TAKEN)
        OTG_NEAREST(s)[i] = min(OTG_NEAREST(s)[i], otgSpotDistance(OTG_SPOT(s)[i], taken));
    }
    OTG_SYNC;
  }
  for (uint i = lane; i < count; i += OTG_GROUP) {
    if (OTG_NEAREST(s)[i] != OTG_SPOT_TAKEN) continue;
    uint place = 0;
    for (uint j = 0; j < i; ++j) place += OTG_NEAREST(s)[j] == OTG_SPOT_TAKEN;
    otg_chosen_contact c = found[OTG_SORTED(s)[i]];
    c.triangleA = a->rings[c.triangleA].w;
    c.triangleB = b->rings[c.triangleB].w;
    out[place] = c;
  }
  return kept;
}

#endif  // OTG_SOLID_LIMIT_H
