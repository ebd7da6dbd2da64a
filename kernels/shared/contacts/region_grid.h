// SPDX-License-Identifier: BSD-3-Clause
// How large regions of the contact model `solid` are laid out in cells: collide/solid/region_cells.h, and on devices
// kernels/solid/large/. In OpenCL C only with OTG_REAL_DOUBLE; without it there is nothing in it.
#if !defined(OTG_SHARED_REGION_GRID_H) && (!defined(__OPENCL_VERSION__) || defined(OTG_REAL_DOUBLE))
#define OTG_SHARED_REGION_GRID_H
#include "shared/math/fixed_sum.h"
#include "shared/math/vec3.h"

#ifndef __OPENCL_VERSION__
namespace otg {
using otg_grid_point = Vec3d;
#else
typedef otg_vec3_d otg_grid_point;
#endif

/// Cells along a region's diagonal: finer than the reach of the local normals (a quarter of it).
#define OTG_PIECE_GRID 8.0
#define OTG_POINT_GRID 6.0

/// Cells of a grid, and keys in it: cell, main direction and mesh of pieces; cell, kind, mesh and flat of points.
#define OTG_GRID_CELLS 512
#define OTG_GRID_KEYS (16 * OTG_GRID_CELLS)

/// A cluster counts as one part if its vector area is at least 0.9 (squared here) of its area.
#define OTG_FLAT_CLUSTER 0.81

/// Parts of a surface are named by triangle or, with this, by vertex.
#define OTG_NAME_OF_VERTEX 0x80000000u

OTG_INLINE otg_uint otgGridAlong(double x, double scale) {
  const double c = x * scale;
  return c > 0 ? (c < 8 ? OTG_UINT(c) : 7u) : 0u;
}

/// The cell of a point in a grid of 8 x 8 x 8. Its lowest corner is `lo`, with `scale` cells for one unit of length.
OTG_INLINE otg_uint otgGridCell(otg_grid_point p, otg_grid_point lo, double scale) {
  return otgGridAlong(p.x - lo.x, scale) | otgGridAlong(p.y - lo.y, scale) << 3 | otgGridAlong(p.z - lo.z, scale) << 6;
}

/// 0 to 5: which axis a direction is nearest to, and in which sense.
OTG_INLINE otg_uint otgMainDirection(otg_grid_point d) {
  const double x = d.x < 0 ? -d.x : d.x, y = d.y < 0 ? -d.y : d.y, z = d.z < 0 ? -d.z : d.z;
  if (x >= y && x >= z) return d.x < 0;
  if (y >= z) return 2 + (d.y < 0);
  return 4 + (d.z < 0);
}

/// Bits of the number of terms of one sum over a region of `load` vertices and chords: each vertex has a star, each
/// chord two triangles of which a part and three corners count.
OTG_INLINE otg_int otgTermBits(otg_uint load) {
  return otgBitsOf(16.0 * load);
}

/// Bits of a term of a moment: of the largest area (otgBitsOf), times how far the region reaches from the origin.
OTG_INLINE otg_int otgMomentBits(otg_int areaBits, otg_grid_point lo, otg_grid_point hi) {
  const double x = -lo.x < hi.x ? hi.x : -lo.x, y = -lo.y < hi.y ? hi.y : -lo.y, z = -lo.z < hi.z ? hi.z : -lo.z;
  const double most = x < y ? (y < z ? z : y) : (x < z ? z : x);
  return areaBits + otgBitsOf(2 * most);
}

#ifndef __OPENCL_VERSION__
}  // namespace otg
#endif
#endif  // OTG_SHARED_REGION_GRID_H
