// SPDX-License-Identifier: BSD-3-Clause
// What the kernels over a region's surface take: plain data only (see collide/simd/wide_kernels.h for why).
#pragma once

#include <cstddef>

#include "shared/math/vec3.h"

namespace otg {

inline constexpr std::size_t kSurfaceLanes = 4;

/// Four flat parts of a surface. Lanes that are not used have normals of zero, which face nowhere.
struct PlaneBlock {
  double normalX[kSurfaceLanes], normalY[kSurfaceLanes], normalZ[kSurfaceLanes];  ///< unit
  double offset[kSurfaceLanes];                                                   ///< normal . x on the plane
  double loX[kSurfaceLanes], loY[kSurfaceLanes], loZ[kSurfaceLanes];              ///< bounds of the part
  double hiX[kSurfaceLanes], hiY[kSurfaceLanes], hiZ[kSurfaceLanes];
};

struct PlaneExitArgs {
  const PlaneBlock* blocks;
  std::size_t count;
  Vec3d from, direction;  ///< direction: unit
  double slack;           ///< how far from its part a plane may be left
  double nearest;         ///< out: way to the nearest plane that faces along and has its part there, or infinity
  double convex;          ///< out: way to the nearest plane that faces along, or infinity
};

/// Four parts of a surface as weighted vector areas. Lanes that are not used have areas of zero.
struct AreaBlock {
  double loX[kSurfaceLanes], loY[kSurfaceLanes], loZ[kSurfaceLanes];  ///< bounds of the part
  double hiX[kSurfaceLanes], hiY[kSurfaceLanes], hiZ[kSurfaceLanes];
  double x[kSurfaceLanes], y[kSurfaceLanes], z[kSurfaceLanes];  ///< vector area
  double area[kSurfaceLanes];
};

struct LocalAreaArgs {
  const AreaBlock* blocks;
  std::size_t count;
  Vec3d point;
  double radius;
  Vec3d vector;  ///< out: sum of vector areas, each times (1 - d^2 / radius^2)^2, d the distance to its bounds
  double area;   ///< out: likewise of the areas
};

/// Four points; lanes that are not used repeat another one.
struct PointBlock {
  double x[kSurfaceLanes], y[kSurfaceLanes], z[kSurfaceLanes];
};

struct ExtentArgs {
  const PointBlock* blocks;
  std::size_t count;
  Vec3d direction;
  double lo, hi;  ///< out: range of direction . point; infinity to -infinity without points
};

/// Four boxes; lanes that are not used repeat another one.
struct BoxBlock {
  double x[kSurfaceLanes], y[kSurfaceLanes], z[kSurfaceLanes];              ///< middle
  double halfX[kSurfaceLanes], halfY[kSurfaceLanes], halfZ[kSurfaceLanes];  ///< half the size
};

struct BoxRangesArgs {
  const BoxBlock* blocks;
  std::size_t count;
  Vec3d direction;
  double *lo, *hi;  ///< out: the range of direction . x for every box, kSurfaceLanes * count of them
};

#define OTG_DECLARE_SURFACE_KERNELS(set)            \
  namespace set {                                   \
  void exitThroughPlanes(PlaneExitArgs& args);      \
  void exitThroughRoundPlanes(PlaneExitArgs& args); \
  void sumLocalAreas(LocalAreaArgs& args);          \
  void findExtent(ExtentArgs& args);                \
  void findBoxRanges(BoxRangesArgs& args);          \
  }
OTG_DECLARE_SURFACE_KERNELS(simd_baseline)
OTG_DECLARE_SURFACE_KERNELS(simd_avx2)
OTG_DECLARE_SURFACE_KERNELS(simd_avx512)
#undef OTG_DECLARE_SURFACE_KERNELS

}  // namespace otg
