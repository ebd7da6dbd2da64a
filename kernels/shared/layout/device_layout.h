// SPDX-License-Identifier: BSD-3-Clause
// What host and device hand each other: structures and the places of counters.
#ifndef OTG_SHARED_DEVICE_LAYOUT_H
#define OTG_SHARED_DEVICE_LAYOUT_H
#include "shared/math/vec3.h"
#include "shared/tests/box_test.h"
#include "shared/tests/plane_test.h"
#if defined(__OPENCL_VERSION__) && defined(OTG_WITH_DOUBLE)
#define OTG_REAL_DOUBLE
#include "shared/math/vec3.h"
#undef OTG_REAL_DOUBLE
#endif

#ifdef __OPENCL_VERSION__
typedef otg_box_frame_f otg_pair_boxes;
typedef otg_filter_error_f otg_pair_error;
typedef otg_vec3_f otg_pair_point;
#else
namespace otg {
using otg_pair_boxes = BoxFrame<float>;
using otg_pair_error = FilterError<float>;
using otg_pair_point = Vec3f;
#endif

/// Where one mesh lies in the buffer of all meshes. Places count units of 16 bytes.
typedef struct {
  otg_uint nodes;         ///< two units a node: centre and first, extent and count (as PackedNode)
  otg_uint soup;          ///< three units a triangle: corners in the mesh's own frame; in w the number, a flag, 0
  otg_uint cut;           ///< two units a node, as above, but with the node's number in place of first
  otg_uint cutCount;      ///< nodes in the cut
  otg_pair_point center;  ///< origin of the centred frame, mesh's own frame
  otg_uint depth;         ///< of the tree
  float radius;           ///< as TriMesh::radius
  otg_uint triangles;     ///< 0: an empty mesh, with nothing in the buffer
  otg_uint rings;         ///< a unit a triangle, by number: OTG_RING_* of its half-edges, and the caller's number
  otg_uint flags;         ///< OTG_MESH_*
} otg_device_mesh;

/// The triangles of one edge are linked in a ring: each half-edge names the next half-edge of the same edge, itself
/// where there is no other. The flag: there is one other.
#define OTG_RING_TWIN 0x80000000u
#define OTG_RING_HALF_EDGE 0x7fffffffu

/// More than OTG_MOST_ON_EDGE triangles share an edge: regions of contact are found by the CPU.
#define OTG_MESH_TANGLED 1
/// A solid of one component, with a section for the model `solid` behind its rings (solid_layout.h).
#define OTG_MESH_SOLID 2
/// A solid (MeshClass::kSolid); a sheet (isSheet in collide/solid/solid_contacts.h); either, with such a section.
#define OTG_MESH_CLOSED 4
#define OTG_MESH_SHEET 8
#define OTG_MESH_LISTED 16
#define OTG_MOST_ON_EDGE 16

/// Everything that kernels need to know about one pair of meshes in single precision.
typedef struct {
  otg_pair_boxes boxes;  ///< B's centred frame to A's
  otg_pair_error error;
  otg_device_mesh a, b;
} otg_device_pair;

/// One pair of a batch; what it is to be taken for otg_device_pair from.
typedef struct {
  float r[9];  ///< BoxFrame::r
  otg_pair_point t;
  float eps, delta;       ///< BoxFrame::eps, FilterError::delta
  otg_uint meshA, meshB;  ///< places in the batch's table of otg_device_mesh
} otg_batch_pair;

#ifdef __OPENCL_VERSION__
#ifdef OTG_WITH_DOUBLE
typedef otg_transform_d otg_task_pose;
#else
typedef struct {
  uint words[24];
} otg_task_pose;
#endif
#else
using otg_task_pose = Transformd;
#endif

/// One pair of a batch as it is sent.
typedef struct {
  otg_task_pose bInA;
  otg_uint meshA, meshB;  ///< places in the batch's table of otg_device_mesh
  otg_uint reduction;     ///< place in the table of otg_reduction
  otg_uint skip;          ///< 1: the pair is done elsewhere
} otg_batch_task;

/// How contacts are chosen.
typedef struct {
  otg_int bins[6];  ///< as ReductionOptions::bins
  otg_uint method;  ///< OTG_REDUCE_*
  otg_uint places;  ///< most contacts
} otg_reduction;

enum {
  OTG_REDUCE_NONE = 0,     ///< all contacts
  OTG_REDUCE_BINNING = 1,  ///< one for each bin
  OTG_REDUCE_BY_HOST = 2,  ///< only the CPU can
  OTG_REDUCE_SOLID = 3     ///< contacts of the model `solid`, bins[0] at most from each region; bins[2]: one more than
                           ///< the place in the table of how those of the model `pairwise` are chosen, should the pair
                           ///< get these; 0: by the CPU
};

/// What is known of a pair while its contacts are chosen.
typedef struct {
  otg_uint low[3], high[3];  ///< bounds of the contacts' positions as ordered floats (otgOrdered)
  otg_uint reduction;        ///< as otg_batch_task
  otg_uint ringsA, ringsB;   ///< as otg_device_mesh
  otg_uint intersecting;     ///< pairs of triangles
  otg_uint contacts;         ///< before reduction
  otg_uint kept, roots;      ///< contacts after reduction, regions that have contacts
  otg_uint count;            ///< contacts in the end
  otg_uint hits, firstHit;   ///< of a batch: how many, and where they are in the list if they lie side by side
} otg_pair_state;

/// Flags of a pair in the results.
enum {
  OTG_PAIR_REFUSED = 1,     ///< its pose is none that can be worked with
  OTG_PAIR_TO_HOST = 2,     ///< the CPU has to finish it, from its records
  OTG_PAIR_NO_FRAME = 4,    ///< too large for single precision, or too many hits: the CPU has to do all of it (with
                            ///< OTG_PAIR_TO_HOST)
  OTG_PAIR_INTERSECTS = 8,  ///< some pair of triangles does for certain
  OTG_PAIR_SKIPPED = 16,    ///< as otg_batch_task
  OTG_PAIR_MANY = 32,       ///< has more hits than one work-group keeps
  OTG_PAIR_PAIRWISE = 64    ///< in a batch of solids: gets contacts of the model `pairwise`
};
#define OTG_PAIR_LEFT_OUT (OTG_PAIR_REFUSED | OTG_PAIR_TO_HOST | OTG_PAIR_SKIPPED)
/// From this bit on: why the model `solid` left a pair to the CPU (kernels/solid/small/scratch.h).
#define OTG_PAIR_WHY 16

/// What the choice needs to know of each hit, one array after the other, each as long as the list of hits.
enum {
  OTG_LINK_PARENT = 0,    ///< union-find over hits of one region
  OTG_LINK_MARK = 1,      ///< of a root: 1 if the region is in the list of regions with contacts
  OTG_LINK_BIN_SLOT = 2,  ///< of a contact: the slot of its bin
  OTG_LINK_SCORE = 3,     ///< of a contact: the upper half of its score in the bin, plus one
  OTG_LINK_LATER = 4,     ///< 1: the region has a smaller pair of triangles than this one
  OTG_LINK_FIRST = 5,     ///< of a root: the hit of the region's smallest pair of triangles, plus one
  OTG_LINKS = 6
};
#define OTG_NOT_THERE 0xffffffffu

/// A hit in a batch: the number of the pair, and the places of the two triangles in their soups.
typedef struct {
  otg_uint pair, a, b;
} otg_batch_hit;

/// Counters of one query. They are zero when it begins; the last kernel copies them to the head of the results and
/// zeroes them for the next one.
enum {
  OTG_COUNT_LEVEL0 = 0,           ///< pairs of nodes left by the cut
  OTG_COUNT_LISTED = 0,           ///< of a batch: pairs with more hits than the first kernel of batch_reduce.cl takes
  OTG_COUNT_LEVEL1 = 1,           ///< by the first level
  OTG_COUNT_MANY = 1,             ///< of a batch: pairs with OTG_PAIR_MANY
  OTG_COUNT_LEVEL2 = 2,           ///< by the second level
  OTG_COUNT_OPEN_OF_BATCH = 2,    ///< in batches with contacts of the model `pairwise`: as OTG_COUNT_OPEN
  OTG_COUNT_ARENA = 2,            ///< in batches of solids: units of the arena
  OTG_COUNT_LEAVES = 3,           ///< pairs of leaves that these three found
  OTG_COUNT_CHUNKS = 3,           ///< in batches of solids: parts of the candidates for contacts
  OTG_COUNT_HITS = 4,             ///< pairs of triangles that intersect or that single precision cannot decide
  OTG_COUNT_SEED_TICKET = 5,      ///< pairs of level 2 that work-groups of the tail have taken
  OTG_COUNT_LEFT = 5,             ///< in batches of solids: records of pairs that are left to the CPU
  OTG_COUNT_DONE = 6,             ///< work-groups of the last kernel that are through
  OTG_COUNT_UNDECIDED = 7,        ///< of the hits: those that single precision cannot decide
  OTG_COUNT_BOX_TESTS = 8,        ///< and 9: low and high word
  OTG_COUNT_TRIANGLE_TESTS = 10,  ///< and 11
  OTG_COUNT_INTERSECTING = 12,    ///< pairs of triangles, of the pairs of meshes that the device finished
  OTG_COUNT_CONTACTS = 13,        ///< before reduction, of the same
  OTG_COUNT_REDUCED = 14,         ///< contacts in the end, of the same
  OTG_COUNT_OPEN = 15,            ///< of one pair of meshes: hits that double arithmetic leaves open
  OTG_COUNT_FLAGGED = 15,         ///< pairs of a batch that are refused or left to the CPU
  OTG_COUNT_CLASS = 16,           ///< and up: pairs of a batch by size, the largest first
  OTG_COUNT_SOLID = 48,           ///< and up: pairs of a batch of solids by OTG_SOLID_BINS, in two stages
  OTG_COUNT_PLACES = 64           ///< in batches of solids: places in the list of hits by pair
};
#define OTG_COUNTERS 72
#define OTG_CLASSES 32

/// Bytes before the results: the first counters.
#define OTG_RESULT_HEAD 64
#define OTG_COUNTERS_READ (OTG_RESULT_HEAD / 4)

/// Where the flags of pairs begin in results that have them, seen as words.
#define OTG_FLAGS (OTG_RESULT_HEAD / 4)

/// Bytes before the chosen contacts of so many pairs: the head, a flag for each pair, the place of its first contact
/// and how many it has.
#define OTG_RESULT_CONTACTS(pairs) ((OTG_RESULT_HEAD + 4 * 3 * (pairs) + 7) / 8 * 8)

/// The word in which a pair's place is; the next one is the number of its contacts.
#define OTG_PLACE(pairs, pair) (OTG_FLAGS + (pairs) + 2 * (pair))

/// What became of a hit. The first four are the kinds of contact of pairwise_contact.h.
enum {
  OTG_RECORD_NO_CONTACT = 0,  ///< the triangles intersect, but this pair has no contact
  OTG_RECORD_FACE_A = 1,
  OTG_RECORD_FACE_B = 2,
  OTG_RECORD_COPLANAR = 3,
  OTG_RECORD_APART = 4,  ///< they do not intersect
  OTG_RECORD_HIT = 5,    ///< they intersect, and no contact was made
  OTG_RECORD_OPEN = 6    ///< undecided: exact arithmetic decides, the CPU's if not the device's
};

typedef struct {
  otg_uint a, b;  ///< triangle numbers
  otg_int kind;
  otg_uint pair;  ///< its number in the batch; 0 for a query of one pair
} otg_pair_record;

/// The same with a contact, in A's frame; what comes after `pair` is set for the kinds 1 to 3.
typedef struct {
  otg_uint a, b;
  otg_int kind;
  otg_uint pair;
#if !defined(__OPENCL_VERSION__) || defined(OTG_WITH_DOUBLE)
  double position[3], normal[3], depth;
#endif
} otg_contact_record;

/// A chosen contact, byte for byte as otg::Contact has it.
typedef struct {
#if !defined(__OPENCL_VERSION__) || defined(OTG_WITH_DOUBLE)
  double position[3], normal[3], depth;
#endif
  otg_uint triangleA, triangleB, region;
  otg_uint feature;  ///< in the lowest byte; flags and padding are 0
  otg_uint element, ordinal;
#if !defined(__OPENCL_VERSION__) || defined(OTG_WITH_DOUBLE)
  double coherence;
#endif
} otg_chosen_contact;

/// The flag of an undecided pair in the list of hits, beside the place of A's triangle (meshes have fewer than 2^28).
#define OTG_HIT_UNDECIDED 0x80000000u

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_device_mesh) == 48);
static_assert(sizeof(otg_device_pair) == 88 + 12 + 96);
static_assert(sizeof(otg_batch_pair) == 64 && sizeof(otg_batch_hit) == 12);
static_assert(sizeof(otg_batch_task) == 112 && sizeof(otg_reduction) == 32 && sizeof(otg_pair_state) == 64);
static_assert(sizeof(otg_chosen_contact) == 88);
static_assert(sizeof(otg_pair_record) == 16 && sizeof(otg_contact_record) == 72);
}  // namespace otg
#endif
#endif  // OTG_SHARED_DEVICE_LAYOUT_H
