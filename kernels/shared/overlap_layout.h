// SPDX-License-Identifier: BSD-3-Clause
// The overlap of one pair of solids on a device (kernels/overlap_*): what its kernels leave for each other and for the
// host. Only with doubles and 64-bit atomics.
#ifndef OTG_SHARED_OVERLAP_LAYOUT_H
#define OTG_SHARED_OVERLAP_LAYOUT_H
#include "shared/fixed_sum.h"
#include "shared/solid_layout.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Lanes that look at one cluster together: one to a vertex.
#define OTG_CLUSTER_LANES 16

#define OTG_OVERLAP_REGIONS 8  ///< more regions than this are the host's

/// A crossing of an edge with a triangle of the other mesh, in a hash table. While `key` is 0 the slot is free.
typedef struct {
  otg_ulong key;  ///< (edge << 1 | mesh) + 1, triangle
  double t, point[3];
  // Of the region whose root this crossing is: bounds as ordered numbers, the smallest chord's triangles, the largest
  // area of a part (its bits), vertices and chords.
  otg_ulong low[3], high[3], first, largest;
  otg_uint load;
  otg_uint seen;            ///< hits that it ends; two
  otg_uint exits;           ///< as Crossing::exits
  otg_uint link;            ///< the next one of its edge, in any order: slot + 1, or 0
  otg_uint previous, next;  ///< along the edge: slot or OTG_NOT_THERE
  otg_uint rank;            ///< along the edge
  otg_uint triangle;
} otg_crossing;

/// Of a hit: its triangles, or OTG_NOT_THERE if they are apart; the crossings in which its chord starts and ends, or
/// OTG_NOT_THERE; and the next hits of the same triangles: number + 1, or 0.
typedef struct {
  otg_uint a, b, start, end, link[2];
} otg_overlap_hit;

/// Where the arrays by element and by mesh begin. Elements are slots of crossings, then clusters, then vertices.
typedef struct {
  otg_uint slots;        ///< of the table of crossings: a power of two
  otg_uint clusters[2];  ///< elements
  otg_uint vertices[2];
  otg_uint elements;  ///< all
  // In the array of marks, which is 0 between queries: by edge the first crossing of its list (slot + 1), by triangle
  // the first hit of its list (number + 1), by vertex its votes, by cluster whether an edge of it is crossed.
  otg_uint edgeMarks[2], triangleMarks[2], voteMarks[2], mixedMarks[2];
  otg_uint cellPlaces, outUnits;  ///< room for cells, and of the results behind the head, in units of 16 bytes
} otg_overlap_sizes;

/// Votes of a vertex: whether there is one for inside, and one for outside.
#define OTG_VOTE_IN 1u
#define OTG_VOTE_OUT 2u

/// Sums of the surface in one cell of a region's grid: zero where there is none.
typedef struct {
  otg_long vector[3], area, gross, moment;
  otg_ulong low[3], high[3];  ///< bounds as ordered numbers, the lower ones inverted
  otg_uint name;              ///< inverted: see PieceCells
  otg_uint used;
} otg_surface_cell;

/// A cell in the results. `key`: place in the grid, main direction, mesh; region << 16.
typedef struct {
  otg_long vector[3], area, gross, moment;
  double lo[3], hi[3];
  otg_uint name, key, unused[2];
} otg_found_cell;

/// A candidate in the results, as PointSeed: the deepest of its key, or one of several that are equally deep.
typedef struct {
  double position[3], span[3];
  otg_uint key;  ///< place in the grid, kind, mesh, flat; region << 16
  otg_uint feature, ordinal;
  otg_uint triangle;  ///< of a crossing: the other mesh's
} otg_found_point;

typedef struct {
  double point[3];
  otg_uint region, unused;
} otg_found_crossing;

/// A vertex (number << 1 | mesh) or cluster that is inside; or the triangles of a hit of a small region.
typedef struct {
  otg_uint what, region;
} otg_found_inside;

/// What is known of a region. Regions are numbered in any order; `first` tells theirs.
typedef struct {
  otg_ulong first;      ///< triangles of its smallest chord
  double lo[3], hi[3];  ///< relative to the origin
  double largest;
  otg_uint load, unused;
} otg_found_region;

enum {
  OTG_OVERLAP_CROSSINGS = 0,
  OTG_OVERLAP_INTERSECTING = 1,
  OTG_OVERLAP_CHORDS = 2,
  OTG_OVERLAP_REGION_COUNT = 3,
  OTG_OVERLAP_VERTICES = 4,  ///< inside, in clusters with a crossed edge
  OTG_OVERLAP_CLUSTERS = 5,  ///< inside, the others
  OTG_OVERLAP_CELLS = 6,
  OTG_OVERLAP_SMALL = 7,  ///< hits of small regions
  OTG_OVERLAP_POINTS = 8,
  OTG_OVERLAP_WHY = 9,      ///< OTG_SOLID_*: the host has to do the pair
  OTG_OVERLAP_DONE = 10,    ///< work-groups of the last kernel that are through
  OTG_OVERLAP_SHARED = 11,  ///< 1: an edge is crossed in two regions
  OTG_OVERLAP_COUNTS = 16
};
#define OTG_OVERLAP_MOST_SMALL (OTG_OVERLAP_REGIONS * OTG_SOLID_LARGE_REGION)

/// The state of one query, and the head of its results. All zero when it begins.
typedef struct {
  otg_uint counts[OTG_OVERLAP_COUNTS];
  otg_uint counters[OTG_COUNTERS_READ];  ///< in the results: the first counters of the query
  otg_ulong first;                       ///< triangles of the smallest chord, inverted
  double origin[3];
  otg_uint roots[OTG_OVERLAP_REGIONS];
  double up[OTG_OVERLAP_REGIONS][3];              ///< in which A is pushed, as far as the regions' surfaces tell
  otg_found_region regions[OTG_OVERLAP_REGIONS];  ///< in the results
} otg_overlap_state;

/// The results: the state, cells, vertices, clusters, crossings, hits of small regions, points. Each begins at a
/// multiple of 16 bytes.
OTG_INLINE otg_uint otgUnitsOf(otg_uint count, otg_uint size) {
  return (count * size + 15) / 16;
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_crossing) % 8 == 0 && sizeof(otg_overlap_hit) == 24 && sizeof(otg_overlap_state) % 16 == 0);
static_assert(sizeof(otg_surface_cell) == 104 && sizeof(otg_found_cell) == 112 && sizeof(otg_found_point) == 64);
static_assert(sizeof(otg_found_crossing) == 32 && sizeof(otg_found_inside) == 8 && sizeof(otg_found_region) == 72);
}  // namespace otg
#endif
#endif  // OTG_SHARED_OVERLAP_LAYOUT_H
