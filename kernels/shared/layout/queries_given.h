// SPDX-License-Identifier: BSD-3-Clause
// What the kernels of kernels/queries/ are given. They need doubles.
#ifndef OTG_SHARED_QUERIES_GIVEN_H
#define OTG_SHARED_QUERIES_GIVEN_H
#include "shared/layout/distance_layout.h"
#include "shared/layout/elements.h"
#include "shared/layout/point_layout.h"
#include "shared/layout/ray_layout.h"

#ifndef __OPENCL_VERSION__
namespace otg {
#endif

/// A point is three of the former, a ray OTG_RAY_DOUBLES of the latter. Both are in the mesh's frame.
OTG_DOUBLE_ELEMENT(otg_point_double)
OTG_DOUBLE_ELEMENT(otg_ray_double)
/// The result for one item of an array: see point_layout.h and ray_layout.h.
OTG_WORD_ELEMENT(otg_array_answer)
/// The result for a pair of meshes: see distance_layout.h.
OTG_TWO_WORD_ELEMENT(otg_distance_answer)

// clang-format off

/// `place`: of the mesh.
#define OTG_GIVEN_PointArray(X, AND)    \
  X(value, otg_device_mesh, place) AND  \
  X(read, otg_mesh_unit, meshes) AND    \
  X(read, otg_point_double, points) AND \
  X(value, otg_uint, count)
OTG_PART(PointArray)

#define OTG_GIVEN_NearestPoints(X, AND) \
  X(part, PointArray, array) AND        \
  X(write, otg_array_answer, answers)
OTG_STRUCTURE(NearestPoints, "nearestPoints")

/// `bounds`: of the mesh. `alone`: the kernel is the first to write results.
#define OTG_GIVEN_InsidePoints(X, AND)   \
  X(part, PointArray, array) AND         \
  X(value, otg_point_bounds, bounds) AND \
  X(value, otg_uint, alone) AND          \
  X(write, otg_array_answer, answers)
OTG_STRUCTURE(InsidePoints, "insidePoints")

/// `place`: of the mesh. `cullBack`: triangles hit from behind do not count.
#define OTG_GIVEN_CastRays(X, AND)     \
  X(value, otg_device_mesh, place) AND \
  X(read, otg_mesh_unit, meshes) AND   \
  X(read, otg_ray_double, rays) AND    \
  X(value, otg_uint, count) AND        \
  X(value, otg_uint, cullBack) AND     \
  X(write, otg_array_answer, answers)
OTG_STRUCTURE(CastRays, "castRays")

/// `stackSize`: places of `stack` and of `stackGaps`.
#define OTG_GIVEN_BatchDistance(X, AND)      \
  X(read, otg_distance_task, tasks) AND      \
  X(read, otg_device_mesh, places) AND       \
  X(read, otg_mesh_unit, meshes) AND         \
  X(write, otg_distance_answer, answers) AND \
  X(value, otg_uint, stackSize) AND          \
  X(local, otg_node_pair, stack) AND         \
  X(local, float, stackGaps)
OTG_STRUCTURE(BatchDistance, "batchDistance")

// clang-format on

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_QUERIES_GIVEN_H
