// SPDX-License-Identifier: BSD-3-Clause
// The overlap of pairs of solids on a device (kernels/solid/large/): what its kernels leave for each other and for the
// CPU. Only with doubles and 64-bit atomics.
#ifndef OTG_SHARED_OVERLAP_LAYOUT_H
#define OTG_SHARED_OVERLAP_LAYOUT_H
#include "shared/layout/solid_layout.h"
#include "shared/math/fixed_sum.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// Lanes that look at one cluster together: one to a vertex.
#define OTG_CLUSTER_LANES 16

#define OTG_OVERLAP_REGIONS 8  ///< pairs with more large regions than this are left to the CPU

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
  otg_uint chord;  ///< the hit whose chord starts here
  otg_uint table;  ///< of the region whose root this crossing is, once it is large
  /// The number along the edge of the inside stretch that ends here (the edge leaves the other mesh), or begins at the
  /// last one; or OTG_NOT_THERE.
  otg_uint stretch;
} otg_crossing;

/// Of a hit: its triangles, or OTG_NOT_THERE if they are apart; the crossings in which its chord starts and ends, or
/// OTG_NOT_THERE; and the next hits of the same triangles: number + 1, or 0.
typedef struct {
  otg_uint a, b, start, end, link[2];
} otg_overlap_hit;

/// Where the arrays of one pair by element and by mesh begin, in its parts of the arrays. Elements are slots of
/// crossings, then clusters, then vertices.
typedef struct {
  otg_uint slots;        ///< of the table of crossings: a power of two
  otg_uint clusters[2];  ///< elements
  otg_uint vertices[2];
  otg_uint elements;  ///< all
  // In the array of marks, which is 0 between queries: by edge the first crossing of its list (slot + 1); by triangle
  // the first hit of its list (number + 1); by cluster whether an edge of it is crossed.
  otg_uint edgeMarks[2], triangleMarks[2], mixedMarks[2];
  otg_uint marks;  ///< all
} otg_overlap_sizes;

/// Slots for the crossings of so many hits: each has two at most.
OTG_INLINE otg_uint otgSlotsFor(otg_uint hits) {
  otg_uint slots = 2;
  while (slots < 2 * hits) slots *= 2;
  return slots;
}

/// What is counted of a mesh: how many of each it has.
typedef struct {
  otg_uint clusters, vertices, edges, triangles;
} otg_overlap_counts;

OTG_INLINE otg_overlap_sizes otgOverlapSizes(otg_uint slots, otg_overlap_counts a, otg_overlap_counts b) {
  otg_overlap_sizes s;
  s.slots = slots;
  s.clusters[0] = slots;
  s.clusters[1] = s.clusters[0] + a.clusters;
  s.vertices[0] = s.clusters[1] + b.clusters;
  s.vertices[1] = s.vertices[0] + a.vertices;
  s.elements = s.vertices[1] + b.vertices;
  s.mixedMarks[0] = 0;
  s.mixedMarks[1] = a.clusters;
  s.edgeMarks[0] = s.mixedMarks[1] + b.clusters;
  s.triangleMarks[0] = s.edgeMarks[0] + a.edges;
  s.edgeMarks[1] = s.triangleMarks[0] + a.triangles;
  s.triangleMarks[1] = s.edgeMarks[1] + b.edges;
  s.marks = s.triangleMarks[1] + b.triangles;
  return s;
}

/// One pair that is described, in the table of pairs. What its kernels number (hits, elements, marks) is numbered
/// within the pair; its parts of the arrays of all pairs begin at `first...`. Pairs are the second dimension of
/// launches.
typedef struct {
  otg_task_pose bInA;
  otg_device_mesh mesh[2];
  otg_overlap_sizes sizes;
  otg_uint number;        ///< of the pair in its batch; 0 for one alone
  otg_uint hits;          ///< how many
  otg_uint firstHit;      ///< of the lists by hit
  otg_uint firstSlot;     ///< of crossings
  otg_uint firstElement;  ///< of the sets
  otg_uint firstMark;
  /// Of the list of what is inside: clusters, then vertices, with room for all of the two meshes; and of the sums of
  /// votes, one for each element that is no crossing.
  otg_uint firstInside;
  otg_uint unused;
} otg_overlap_pair;

/// What the CPU says of a pair of a batch that is to be described; the rest of its entry in the table follows.
typedef struct {
  otg_uint number, hits, firstSlot, firstInside, firstMark;
} otg_listed_overlap;

/// Of all pairs of a submission. All zero when it begins.
typedef struct {
  otg_uint tables;  ///< of large regions: OTG_GRID_KEYS places each, in the arrays of cells and of depths
  otg_uint units;   ///< of the results, of 16 bytes
  otg_uint done;    ///< pairs that are through
  otg_uint unused;
} otg_overlap_totals;

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

/// A vertex (number << 1 | mesh) or cluster that is inside. Or what the CPU describes small regions from: the
/// triangles of a hit; and of edges and triangles that are crossed in large regions as well, with these bits in
/// `region`,
///   OTG_FOUND_TRIANGLE: a triangle of B; the first of A's that meet it in large regions
///   OTG_FOUND_BEHIND: edge << 1 | mesh; number << OTG_BEHIND_BITS | others of a stretch, its number among those of
///   small regions, and behind how many of large ones it lies OTG_FOUND_EDGE: edge << 1 | mesh; the first of the
///   triangles that cross it in large regions
typedef struct {
  otg_uint what, region;
} otg_found_inside;
#define OTG_FOUND_KIND 0xc0000000u
#define OTG_FOUND_TRIANGLE 0x40000000u
#define OTG_FOUND_BEHIND 0x80000000u
#define OTG_FOUND_EDGE 0xc0000000u
#define OTG_BEHIND_BITS 15

/// What is known of a large region. Those of a pair are numbered in any order; `first` gives theirs.
typedef struct {
  otg_ulong first;      ///< triangles of its smallest chord
  double lo[3], hi[3];  ///< relative to the origin
  double largest;
  otg_uint load;
  otg_uint pair;  ///< its place in the table of pairs
} otg_found_region;

enum {
  OTG_OVERLAP_CROSSINGS = 0,
  OTG_OVERLAP_INTERSECTING = 1,
  OTG_OVERLAP_CHORDS = 2,
  OTG_OVERLAP_REGION_COUNT = 3,  ///< large and small ones
  OTG_OVERLAP_VERTICES = 4,      ///< inside, in clusters with a crossed edge
  OTG_OVERLAP_CLUSTERS = 5,      ///< inside, the others
  OTG_OVERLAP_CELLS = 6,         ///< in the results: all
  OTG_OVERLAP_SMALL = 7,         ///< hits of small regions, and what else the CPU needs of these
  OTG_OVERLAP_POINTS = 8,
  OTG_OVERLAP_WHY = 9,           ///< OTG_SOLID_*: the CPU has to do the pair
  OTG_OVERLAP_DONE = 10,         ///< work-groups of the last kernel that are through
  OTG_OVERLAP_SHARED = 11,       ///< 1: an edge is crossed in two regions
  OTG_OVERLAP_MOST_POINTS = 12,  ///< so many candidates will be the deepest of their key, at most
  OTG_OVERLAP_AT_ODDS = 13,      ///< 1: crossings of an edge or votes contradict each other
  OTG_OVERLAP_MIXED = 14,        ///< clusters with a crossed edge
  OTG_OVERLAP_LARGE = 15,        ///< large regions
  OTG_OVERLAP_COUNTS = 16
};

/// The state of one pair, and the head of its results. All zero when it begins.
typedef struct {
  otg_uint counts[OTG_OVERLAP_COUNTS];
  otg_uint counters[OTG_COUNTERS_READ];  ///< in the results: the first counters of the query
  otg_ulong first;                       ///< triangles of the smallest chord, inverted
  double origin[3];
  otg_uint firstUnit;  ///< of its results
  otg_uint corners;    ///< a bit for each large region that goes round an inner corner, as Region::roundCorner
  otg_uint unused[2];
  /// By mesh, a bit for each of its closed components: set if it has a chord. Not of solids of one component.
  otg_uint crossedParts[2][OTG_SOLID_MOST_PARTS / 32];
  // Of large regions:
  otg_uint roots[OTG_OVERLAP_REGIONS];
  otg_uint cells[OTG_OVERLAP_REGIONS];            ///< how many there are
  double up[OTG_OVERLAP_REGIONS][3];              ///< in which A is pushed, as far as the regions' surfaces show
  otg_found_region regions[OTG_OVERLAP_REGIONS];  ///< in the results
} otg_overlap_state;

/// The results: the totals, the states of all pairs, and where a pair's own begin (firstUnit) its cells, vertices,
/// clusters, crossings, hits of small regions, points. Each begins at a multiple of 16 bytes.
OTG_INLINE otg_uint otgUnitsOf(otg_uint count, otg_uint size) {
  return (count * size + 15) / 16;
}
#define OTG_OVERLAP_HEAD(pairs) (sizeof(otg_overlap_totals) + (pairs) * sizeof(otg_overlap_state))

/// Where the parts of a pair's results begin, from its first unit on.
typedef struct {
  otg_uint vertices, clusters, crossings, small, points;
} otg_overlap_parts;

OTG_INLINE otg_overlap_parts otgPartsOf(otg_uint cells, otg_uint vertices, otg_uint clusters, otg_uint crossings,
                                        otg_uint small) {
  otg_overlap_parts p;
  p.vertices = otgUnitsOf(cells, sizeof(otg_found_cell));
  p.clusters = p.vertices + otgUnitsOf(vertices, sizeof(otg_found_inside));
  p.crossings = p.clusters + otgUnitsOf(clusters, sizeof(otg_found_inside));
  p.small = p.crossings + otgUnitsOf(crossings, sizeof(otg_found_crossing));
  p.points = p.small + otgUnitsOf(small, sizeof(otg_found_inside));
  return p;
}

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_crossing) % 8 == 0 && sizeof(otg_overlap_hit) == 24 && sizeof(otg_overlap_state) % 16 == 0);
static_assert(sizeof(otg_surface_cell) == 104 && sizeof(otg_found_cell) == 112 && sizeof(otg_found_point) == 64);
static_assert(sizeof(otg_overlap_totals) == 16 && sizeof(otg_listed_overlap) == 20 &&
              sizeof(otg_overlap_pair) % 8 == 0);
static_assert(sizeof(otg_found_crossing) == 32 && sizeof(otg_found_inside) == 8 && sizeof(otg_found_region) == 72);
}  // namespace otg
#endif
#endif  // OTG_SHARED_OVERLAP_LAYOUT_H
