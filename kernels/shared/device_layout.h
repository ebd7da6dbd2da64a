// SPDX-License-Identifier: BSD-3-Clause
// What host and device hand each other: structures and the places of counters.
#ifndef OTG_SHARED_DEVICE_LAYOUT_H
#define OTG_SHARED_DEVICE_LAYOUT_H
#include "shared/box_test.h"
#include "shared/plane_test.h"
#include "shared/vec3.h"

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
} otg_device_mesh;

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

/// A hit in a batch: the number of the pair, and the places of the two triangles in their soups.
typedef struct {
  otg_uint pair, a, b;
} otg_batch_hit;

/// Counters of one query. They are zero when it begins; the last kernel copies them to the head of the results and
/// zeroes them for the next one.
enum {
  OTG_COUNT_LEVEL0 = 0,          ///< pairs of nodes left by the cut
  OTG_COUNT_LEVEL1 = 1,          ///< by the first level
  OTG_COUNT_LEVEL2 = 2,          ///< by the second level
  OTG_COUNT_LEAVES = 3,          ///< pairs of leaves that these three found
  OTG_COUNT_HITS = 4,            ///< pairs of triangles that intersect or that single precision cannot decide
  OTG_COUNT_SEED_TICKET = 5,     ///< pairs of level 2 that work-groups of the tail have taken
  OTG_COUNT_DONE = 6,            ///< work-groups of the last kernel that are through
  OTG_COUNT_UNDECIDED = 7,       ///< of the hits: those that single precision cannot decide
  OTG_COUNT_BOX_TESTS = 8,       ///< and 9: low and high word
  OTG_COUNT_TRIANGLE_TESTS = 10  ///< and 11
};
#define OTG_COUNTERS 16

/// Bytes before the first record of the results: the counters.
#define OTG_RESULT_HEAD 64

/// What became of a hit. The first four are the kinds of contact of pairwise_contact.h.
enum {
  OTG_RECORD_NO_CONTACT = 0,  ///< the triangles intersect, but this pair has no contact
  OTG_RECORD_FACE_A = 1,
  OTG_RECORD_FACE_B = 2,
  OTG_RECORD_COPLANAR = 3,
  OTG_RECORD_APART = 4,  ///< they do not intersect
  OTG_RECORD_HIT = 5,    ///< they intersect, and no contact was made
  OTG_RECORD_OPEN = 6    ///< undecided: the host decides
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

/// The flag of an undecided pair in the list of hits, beside the place of A's triangle (meshes have fewer than 2^28).
#define OTG_HIT_UNDECIDED 0x80000000u

#ifndef __OPENCL_VERSION__
static_assert(sizeof(otg_device_mesh) == 32);
static_assert(sizeof(otg_device_pair) == 88 + 12 + 64);
static_assert(sizeof(otg_batch_pair) == 64 && sizeof(otg_batch_hit) == 12);
static_assert(sizeof(otg_pair_record) == 16 && sizeof(otg_contact_record) == 72);
}  // namespace otg
#endif
#endif  // OTG_SHARED_DEVICE_LAYOUT_H
