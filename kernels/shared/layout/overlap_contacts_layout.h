// SPDX-License-Identifier: BSD-3-Clause
// Contacts of the large regions of single pairs of solids on a device (kernels/solid/large/arena.cl and what follows
// it): what its kernels leave for each other and for the CPU. Only with doubles and 64-bit atomics.
#ifndef OTG_SHARED_OVERLAP_CONTACTS_LAYOUT_H
#define OTG_SHARED_OVERLAP_CONTACTS_LAYOUT_H
#include "shared/contacts/escape_turns.h"
#include "shared/layout/overlap_layout.h"
#ifndef __OPENCL_VERSION__
#include "shared/contacts/solid_model.h"
#endif

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// A region of more pieces, points or candidates than these is left to the CPU.
#define OTG_WORK_PIECES 1024
#define OTG_WORK_POINTS 1024
#define OTG_WORK_CANDIDATES 512

#define OTG_OVERLAP_MAIN_FACES 6  ///< OTG_SOLID_DEEP_FACES

#define OTG_WAY_DIRECTIONS (OTG_ESCAPE_DIRECTIONS + OTG_ESCAPE_TURNS * OTG_ESCAPE_SIDES)

/// As PairMotion: what the pair was doing.
typedef struct {
  double back[3], escape[3], deepNormal[3], step;
} otg_overlap_motion;

/// The request for one pair, beside its entry in the table of pairs. Its regions are OTG_OVERLAP_REGIONS places, from
/// the first on that belong to its number. What holds for all pairs, too.
typedef struct {
  otg_overlap_motion motion;
  otg_uint most;                 ///< contacts of one region
  otg_uint pairs;                ///< that were described together
  otg_uint unitRoom, tableRoom;  ///< for their descriptions: see otg_overlap_totals
} otg_overlap_task;

/// One region in the arena. Faces stand for pieces, or for several of them, where normals are concerned; the area and
/// vector area of each lie in `weightedArea` and `weighted` at first, and its weight in `meanOffset`.
typedef struct {
  otg_solid_region region;
  double mainDirections[2][OTG_OVERLAP_MAIN_FACES][3];    ///< of the faces of a deep region
  double turned[OTG_ESCAPE_TURNS * OTG_ESCAPE_SIDES][3];  ///< directions around the best
  /// The highest and the lowest along each direction, as ordered numbers, the latter inverted.
  otg_ulong highest[OTG_WAY_DIRECTIONS], lowest[OTG_WAY_DIRECTIONS];
  otg_ulong ways[OTG_WAY_DIRECTIONS];  ///< bits of a double that is not negative
  double direction[3];                 ///< the way out of a deep or entangled region
  otg_uint mainCount[2];
  otg_uint deepPlanes, deepCount[2];  ///< place in the arena; A's, then B's from the number of A's pieces on
  otg_uint pieceCount[2];
  otg_uint place;       ///< OTG_OVERLAP_REGIONS for each pair; OTG_NOT_THERE: none
  otg_uint status;      ///< OTG_FOUND_*, as far as pieces show
  otg_uint pointFlags;  ///< OTG_REGION_CORNERS, OTG_REGION_BAD, and OTG_REGION_UNEVEN with it
  otg_uint unused[4];
} otg_region_work;

/// What a region came to.
enum {
  OTG_FOUND_DONE = 1,    ///< its contacts are there
  OTG_FOUND_COUNTS = 2,  ///< it is not too small to have any
  OTG_FOUND_ESCAPING = 4,
  OTG_FOUND_ENTANGLED = 8,
  OTG_FOUND_DEEP = 16,
  OTG_FOUND_TURNS = 32,  ///< directions around the best were not looked at, and have to be
  OTG_FOUND_BAD = 64,    ///< the CPU has to do it, or the arena was too small
  OTG_FOUND_APART = 128  ///< and describes it by its single triangles: the description is of no use
};
typedef struct {
  double direction[3];  ///< as RegionDirection
  otg_uint status, count;
  otg_uint first, unused;  ///< of its contacts
} otg_found_contacts;

/// Counters of one submission, zero when it begins.
typedef struct {
  otg_uint arenaUnits;  ///< behind the regions
  otg_uint slots;       ///< large regions that were listed, of several pairs
  otg_uint small;       ///< hits of small regions
  otg_uint done;        ///< pairs that are through
} otg_overlap_progress;

/// The results: this, then for each pair its head, then the contacts of regions, so many places for each; and then the
/// hits of small regions.
typedef struct {
  otg_overlap_totals totals;
  otg_overlap_progress progress;
} otg_contacts_sums;
typedef struct {
  otg_overlap_state state;
  otg_found_contacts regions[OTG_OVERLAP_REGIONS];
  otg_uint small, firstSmall, unused[2];
} otg_contacts_head;
#define OTG_CONTACTS_HEADS(pairs) (sizeof(otg_contacts_sums) + (pairs) * sizeof(otg_contacts_head))

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_overlap_task) == 96 && sizeof(otg_region_work) % 16 == 0 && sizeof(otg_found_contacts) == 40 &&
              OTG_OVERLAP_MAIN_FACES == OTG_SOLID_DEEP_FACES && OTG_WAY_DIRECTIONS >= 2 + 2 * OTG_SOLID_DEEP_FACES &&
              sizeof(otg_contacts_head) % 16 == 0);
}  // namespace otg
#endif
#endif  // OTG_SHARED_OVERLAP_CONTACTS_LAYOUT_H
