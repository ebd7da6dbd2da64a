// SPDX-License-Identifier: BSD-3-Clause
// The description of an overlap (kernels/solid/large/points.cl) as the kernels see it that make contacts from it, and
// the regions that they have in common. See shared/layout/overlap_contacts_layout.h.
#ifndef OTG_OVERLAP_FOUND_H
#define OTG_OVERLAP_FOUND_H
#include "solid/large/mesh.h"
//
#include "solid/region.h"
//
#include "shared/layout/overlap_contacts_layout.h"

#define OTG_WORK_UNITS (sizeof(otg_region_work) / OTG_ARENA_UNIT)

#define OTG_PAIR_MESH __local const otg_overlap_mesh

/// The description of one pair.
typedef struct {
  __global const otg_overlap_state* head;
  __global const otg_found_cell* cells;
  __global const otg_found_inside *vertices, *clusters, *small;
  __global const otg_found_crossing* crossings;
  __global const otg_found_point* points;
  uint region;  ///< number of the one that the work-group looks at
  int works;    ///< there is a description, and it is whole
} otg_found_lists;

/// `place`: of a region; see otg_overlap_task. It is not its slot in the arena.
OTG_INLINED otg_found_lists otgListsOf(__global const uchar* out, uint pairs, uint unitRoom, uint tableRoom,
                                       uint place) {
  otg_found_lists l;
  l.head = (__global const otg_overlap_state*)(out + sizeof(otg_overlap_totals)) + place / OTG_OVERLAP_REGIONS;
  l.region = place % OTG_OVERLAP_REGIONS;
  __global const uint* counts = l.head->counts;
  const otg_overlap_parts p =
      otgPartsOf(counts[OTG_OVERLAP_CELLS], counts[OTG_OVERLAP_VERTICES], counts[OTG_OVERLAP_CLUSTERS],
                 counts[OTG_OVERLAP_CROSSINGS], counts[OTG_OVERLAP_SMALL]);
  const uint units = p.points + otgUnitsOf(counts[OTG_OVERLAP_MOST_POINTS], sizeof(otg_found_point));
  l.works = counts[OTG_OVERLAP_WHY] == 0 && counts[OTG_OVERLAP_CHORDS] > 0 &&
            counts[OTG_OVERLAP_POINTS] <= counts[OTG_OVERLAP_MOST_POINTS] && l.head->firstUnit <= unitRoom &&
            unitRoom - l.head->firstUnit >= units && ((__global const otg_overlap_totals*)out)->tables <= tableRoom;
  __global const uchar* body = out + OTG_OVERLAP_HEAD(pairs) + (size_t)(l.works ? l.head->firstUnit : 0) * 16;
  l.cells = (__global const otg_found_cell*)body;
  l.vertices = (__global const otg_found_inside*)(body + (size_t)p.vertices * 16);
  l.clusters = (__global const otg_found_inside*)(body + (size_t)p.clusters * 16);
  l.crossings = (__global const otg_found_crossing*)(body + (size_t)p.crossings * 16);
  l.small = (__global const otg_found_inside*)(body + (size_t)p.small * 16);
  l.points = (__global const otg_found_point*)(body + (size_t)p.points * 16);
  return l;
}
OTG_INLINED otg_found_lists otgListsFor(__global const uchar* out, __global const otg_overlap_task* tasks, uint place) {
  return otgListsOf(out, tasks->pairs, tasks->unitRoom, tasks->tableRoom, place);
}
/// Whether the pair has so many large regions.
OTG_INLINED int otgIsLargeRegion(const otg_found_lists* l) {
  return l->works && l->region < min(l->head->counts[OTG_OVERLAP_LARGE], (uint)OTG_OVERLAP_REGIONS);
}

OTG_INLINED __global otg_region_work* otgRegionAt(__global uchar* arena, uint slot) {
  return (__global otg_region_work*)(arena + (size_t)slot * OTG_WORK_UNITS * OTG_ARENA_UNIT);
}

/// What is known of a region after overlapArena, for work-groups with its pieces before them.
OTG_INLINED otg_solid_work otgWorkOf(__global uchar* arena, uint slot) {
  otg_solid_work w = otgGoOnWith(arena, slot * OTG_WORK_UNITS);
  w.isGathered = 1;
  w.isUneven = 0;  // those are left to the CPU
  return w;
}

/// Whether contacts of the region at a place are made here. All lanes call it, and all get what one of them sees: other
/// work-groups of the kernel may be giving the region up.
OTG_INLINED int otgIsWorked(__global const otg_region_work* r, __local int* answer) {
  if (get_local_id(0) == 0) {
    *answer = (r->status & (OTG_FOUND_COUNTS | OTG_FOUND_BAD)) == OTG_FOUND_COUNTS && !(r->pointFlags & OTG_REGION_BAD);
  }
  OTG_SYNC;
  return *answer;
}

/// The meshes of a region's pair. All lanes call it.
OTG_INLINED void otgMeshesOf(__global const float4* meshes, __global const otg_overlap_pair* pairs, uint place,
                             __local otg_overlap_mesh* mesh) {
  __global const otg_overlap_pair* pair = pairs + place / OTG_OVERLAP_REGIONS;
  for (uint k = get_local_id(0); k < 2; k += OTG_GROUP) {
    const otg_device_mesh place = pair->mesh[k];
    mesh[k] = otgOverlapMesh(meshes, &place, pair->bInA, (int)k);
  }
  OTG_SYNC;
}

/// `units` of the arena: the first, or OTG_NOT_THERE if there is no room. Of `begin` to `arenaUnits`. By one lane.
OTG_INLINED uint otgTakeFrom(__global otg_overlap_progress* progress, uint units, uint begin, uint arenaUnits) {
  const uint at = begin + atomic_add(&progress->arenaUnits, units);
  return at <= arenaUnits && arenaUnits - at >= units ? at : OTG_NOT_THERE;
}

OTG_INLINED uint otgUnitsFor(uint count, uint size) {
  return (count * size + OTG_ARENA_UNIT - 1) / OTG_ARENA_UNIT;
}

#endif  // OTG_OVERLAP_FOUND_H
