// SPDX-License-Identifier: BSD-3-Clause
// What one work-group knows of an uneven region: in local memory, and in the arena.
#ifndef OTG_UNEVEN_SCRATCH_H
#define OTG_UNEVEN_SCRATCH_H
#include "solid/region.h"
//
#define OTG_REAL_DOUBLE
#include "shared/contacts/shortest_translation.h"
#include "shared/contacts/uneven_model.h"
#undef OTG_REAL_DOUBLE

// OTG_UNEVEN_FACES: pieces of the largest region.
#define OTG_UNEVEN_POINTS OTG_SOLID_MOST_POINTS  ///< points that are looked at; the CPU thins more than these
#define OTG_UNEVEN_HALF_SPACES 32                ///< that the translation satisfies

/// A whole triangle of the surface, relative to the region's origin: as RegionTriangle.
typedef struct {
  double corner[9], normal[3], offset, inward[9], edge[3];
  uint triangle;
  uint sameAs;  ///< one face that faces the same way: one for all that do
  uint curved, unused;
} otg_uneven_face;

/// A convex edge of these: as RegionEdge.
typedef struct {
  double middle[3], along[3], reach, faces[6];
} otg_uneven_edge;

/// A way out of a part: as Way in collide/solid/leaving.cpp.
typedef struct {
  double at[3], normal[3], depth;
  uint curved;
  uint group;  ///< sameAs of its face; OTG_NOT_THERE across an edge
} otg_uneven_way;

/// A direction in which candidates leave, and the deepest of them.
typedef struct {
  double normal[3], depth;
} otg_uneven_direction;

/// The region, in each lane.
typedef struct {
  __global otg_uneven_face* faces;  ///< A's, then B's
  __global otg_uneven_edge* edges;
  __global otg_uneven_way* ways;
  __global otg_uneven_direction* directions;
  __global otg_solid_point* candidates;
  uint facesOfA, faceCount, edgesOfA, edgeCount;
  double slack, behind;  ///< as in RegionTriangles
  otg_vec3_d origin;
} otg_uneven;

typedef struct {
  ushort points[OTG_UNEVEN_POINTS];  ///< looked at: vertices and stretches, which are parts, then crossings
  // By part.
  uint first[OTG_UNEVEN_POINTS];       ///< of its ways
  ushort count[OTG_UNEVEN_POINTS];     ///< of them; 0: it needs not leave
  ushort together[OTG_UNEVEN_POINTS];  ///< the first ones, which hold it all at once
  double soonest[OTG_UNEVEN_POINTS];
  ushort ordered[OTG_UNEVEN_POINTS];  ///< the deepest part first
  ushort taken[OTG_UNEVEN_POINTS];    ///< the way that holds it, or its count: all together
  // By face.
  ushort order[OTG_UNEVEN_FACES], before[OTG_UNEVEN_FACES];
  otg_half_space_d spaces[OTG_UNEVEN_HALF_SPACES];
  uint4 counts[(OTG_GROUP + 3) / 4];  ///< a word for each lane: OTG_COUNTS
  double reduce[OTG_GROUP];
  double out[3];  ///< the translation
  uint parts, crossings, leaving, spaceCount, directions, next, allocated, bad;
} otg_uneven_scratch;

/// Faces of a mesh: the first, and behind the last.
OTG_INLINED uint otgFirstFace(const otg_uneven* u, uint mesh) {
  return mesh == 0 ? 0 : u->facesOfA;
}
OTG_INLINED uint otgEndOfFaces(const otg_uneven* u, uint mesh) {
  return mesh == 0 ? u->facesOfA : u->faceCount;
}

OTG_INLINED double otgBelowFace(__global const otg_uneven_face* f, otg_vec3_d p) {
  return f->offset - otgDot_d(otgLoad(f->normal), p);
}

/// How far a point of its plane lies beside a face.
OTG_INLINED double otgBesideFace(__global const otg_uneven_face* f, otg_vec3_d p) {
  double most = -INFINITY;
  for (uint k = 0; k < 3; ++k) most = otgMax_d(f->edge[k] - otgDot_d(otgLoad(f->inward + 3 * k), p), most);
  return most;
}

OTG_INLINED double otgDistanceOfFace(__global const otg_uneven_face* f, otg_vec3_d p) {
  return otgDistanceOfTriangle_d(otgLoad(f->corner), otgLoad(f->corner + 3), otgLoad(f->corner + 6), p);
}

/// Room for so many bytes in the arena: where, or null. All lanes call it.
OTG_INLINED __global uchar* otgTakeRoom(__local otg_uneven_scratch* s, uint bytes, __global uint* counters,
                                        __global uchar* arena, uint arenaUnits) {
  const uint units = (bytes + OTG_ARENA_UNIT - 1) / OTG_ARENA_UNIT;
  OTG_SYNC;
  if (get_local_id(0) == 0) s->allocated = atomic_add(counters + OTG_COUNT_ARENA, units);
  OTG_SYNC;
  const uint begin = s->allocated;
  OTG_SYNC;
  return begin <= arenaUnits && arenaUnits - begin >= units ? arena + (size_t)begin * OTG_ARENA_UNIT : 0;
}

#endif  // OTG_UNEVEN_SCRATCH_H
