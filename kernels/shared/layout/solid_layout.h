// SPDX-License-Identifier: BSD-3-Clause
// What devices need for the contact model `solid`: the part of a mesh that it looks at, and what one of its kernels
// leaves for the next. Only with doubles.
#ifndef OTG_SHARED_SOLID_LAYOUT_H
#define OTG_SHARED_SOLID_LAYOUT_H
#include "shared/layout/device_layout.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// A solid or a sheet has a section behind its rings (otg_device_mesh), in units of 16 bytes:
///   the bounds, lowest corner and highest; in w the numbers of vertices and edges
///   OTG_SOLID_SAMPLES places of vertices spread over it (see isContained in collide/solid/inside.cpp); in w how many,
///   then the unit at which the clusters begin, from the bounds on, and how many these are; then where the samples of
///   its closed components begin (those of the only one: here), and how many components these are
///   four units a triangle: corners as welded vertices, and the number of its closed component or OTG_NOT_THERE; its
///   edges, and its caller's number; its unit normal and its area in double
///   one unit a vertex: where it is; OTG_VERTEX_FLAT and the number of its cluster
///   one unit an edge: its ends a and b, a half-edge, and whether it is flat (all as Topology and Adjacency)
///   one word a vertex, and one more: the first of its outgoing half-edges in the list that follows; then that list;
///   from the next even word on the vertex at the other end of each of them and its edge
///   OTG_CLUSTER_UNITS a cluster, and for one more that ends the last: bounds, with the first vertex and neighbour;
///   vector area, area and moment in double (as Adjacency::Cluster)
///   two units a vertex: its star in double
///   one word for each vertex of the clusters, then one for each neighbour
///   OTG_SOLID_SAMPLES units for each closed component, as above, where there are others beside it
#define OTG_SOLID_SAMPLES 16
#define OTG_SOLID_CLUSTERS_AT 3
#define OTG_SOLID_CLUSTER_COUNT 4
#define OTG_SOLID_PARTS_AT 5
#define OTG_SOLID_PART_COUNT 6
#define OTG_SOLID_MOST_PARTS 64  ///< meshes of more closed components have no section
#define OTG_CLUSTER_UNITS 5
#define OTG_SOLID_TRIANGLES (2 + OTG_SOLID_SAMPLES)
#define OTG_VERTEX_FLAT 0x80000000u
// Kinds of edges by their two faces: in one plane, or meeting at an inner corner (Adjacency::edgeKind).
#define OTG_EDGE_FLAT 1
#define OTG_EDGE_INNER 2
#define OTG_EDGE_HOLLOW 3

/// The part of one triangle that lies inside the other mesh: as Piece in collide/solid/overlap_regions.h.
typedef struct {
  double normal[3], vector[3], area, offset, lo[3], hi[3];
  otg_uint mesh, triangle;
  otg_uint unused[2];
} otg_solid_piece;

/// A place where a contact may sit, as SupportPoint there, and what comes of it.
typedef struct {
  double position[3], along[3], surfaceNormal[3], reach;
  double faceNormal[3];                             ///< of a crossing: outward, of the other mesh's face there
  double at[3], probe[3], normal[3], shift, limit;  ///< `at`: the candidate's place, as a rule `position`
  otg_ulong order;                                  ///< kind, mesh, SupportPoint::rank, ordinal: ties are settled by it
  otg_uint kind, mesh, feature, ordinal, triangleA, triangleB;
  otg_uint flat;
  otg_uint corner;     ///< of a middle: its edge is convex; of a crossing: it is an inner corner's
  double passes;       ///< how far a stretch must go along the normal past one of the other mesh; 0 if it passes none
  double depth, rank;  ///< of a candidate, as estimated; depth -1: it is none
} otg_solid_point;

/// A piece, or several of them, as a plane that is read again and again.
typedef struct {
  double normal[3], offset;  ///< the plane of its vector area
  double meanOffset;         ///< the same by its area: for the way out of deep regions
  double lo[3], hi[3];
  double weighted[3], weightedArea;  ///< how it counts for normals
} otg_solid_face;

typedef struct {
  double origin[3], lo[3], hi[3], push[3];
  double areaA, areaB, diagonal, thickness, coherence;
  // What solidWays adds: directions, and the least depth of the deepest contact.
  double shareOfB, weighted[3], fixed[3], leastDepth;
  otg_uint pieces, pieceCount, points, pointCount;  ///< places in the arena
  otg_uint next;                                    ///< region, or OTG_NOT_THERE
  otg_uint faces, planes, picks;  ///< places in the arena; picks (ushort): OTG_NOT_THERE where all points stay
  otg_uint faceCount[2], planeCount[2];
  otg_uint candidates;  ///< of an uneven region at first: the most that it may have
  otg_uint flags;       ///< OTG_REGION_*
} otg_solid_region;

enum {
  OTG_REGION_COUNTS = 1,  ///< it is not too small to have contacts
  OTG_REGION_FLAT = 2,    ///< one face holds it
  OTG_REGION_FIXED = 4,   ///< `fixed` is the normal everywhere
  OTG_REGION_DEEP = 8,
  OTG_REGION_GATHERED = 16,  ///< planes stand for several pieces
  OTG_REGION_CORNERS = 32,   ///< it has points that are not flat
  OTG_REGION_BAD = 64,       ///< the CPU has to do the pair
  OTG_REGION_UNEVEN = 128    ///< each point leaves by the faces nearest to it
};

/// Candidates are looked at in parts of so many of one region: the region's place in the arena, and the first of them.
#define OTG_SOLID_CHUNK 32
/// An uneven region is one part. In place of the first candidate it has its pair's number, and this.
#define OTG_CHUNK_UNEVEN 0x80000000u

/// A pair of triangles that intersect, and how the chord in which they do ends.
typedef struct {
  otg_uint a, b;
  otg_uint halfEdge[2];  ///< that pass through the other triangle: half-edge << 1 | mesh, or OTG_NOT_THERE
  otg_uint how[2];       ///< 1: the half-edge leaves the other mesh; 2: the chord starts here
  otg_uint unused[2];
} otg_solid_hit;

/// Pairs wait for either of the two large kernels in so many lists, the largest first. Those of the first lists are
/// for the kernels with the larger limits, if there are two of each.
#define OTG_SOLID_BINS 8
#define OTG_SOLID_LARGE_BINS 2

#define OTG_SOLID_REGIONS 8  ///< more regions than this in one pair are left to the CPU

/// A piece of the arena is counted in units of this many bytes.
#define OTG_ARENA_UNIT 16

/// Why the CPU has to do a pair (any is enough; the values say where to look): flags << OTG_PAIR_WHY.
enum {
  OTG_SOLID_TOO_MANY = 1,
  OTG_SOLID_INEXACT = 2,    ///< coordinates too large or small for exact arithmetic
  OTG_SOLID_BROKEN = 4,     ///< crossings or votes contradict each other
  OTG_SOLID_CONTAINED = 8,  ///< a body may be inside the other
  OTG_SOLID_TIE = 16,       ///< too many crossings of one edge to be put in order
  OTG_SOLID_ODD = 32,       ///< a region that is bad, entangled or large
  OTG_SOLID_BY_CELLS = 64,  ///< besides: of a size for kernels/solid/large/
  OTG_SOLID_AT_ODDS = 128,  ///< besides: perhaps of that size, and what is broken these can show
  OTG_SOLID_OPEN = 256      ///< besides, where nothing is inexact: a contour with a sheet does not close
};

/// With fewer hits a pair that is at odds is hardly of that size.
#define OTG_SOLID_ODD_HITS 96

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_solid_hit) == 32 && sizeof(otg_solid_piece) == 128 && sizeof(otg_solid_point) == 256 &&
              sizeof(otg_solid_region) == 256);
}  // namespace otg
#endif
#endif  // OTG_SHARED_SOLID_LAYOUT_H
