// SPDX-License-Identifier: BSD-3-Clause
// What the kernels over a region's surface take: plain data only (see collide/simd/wide_kernels.h for why).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

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

struct FacingPlaneArgs {
  const PlaneBlock* blocks;
  std::size_t count;
  Vec3d from, direction;  ///< direction: unit
  std::uint32_t plane;    ///< out: the first of the nearest that face along, or the largest number
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

/// A half-space before which points are to be; what it says of a point is how far that has to go.
struct Barrier {
  Vec3d normal;  ///< of any length
  double offset;
};

struct FarthestWayArgs {
  const PointBlock* blocks;
  std::size_t count;
  const Barrier* barriers[2];
  std::size_t barrierCount[2];
  double far;     ///< the way where there are none
  double enough;  ///< a point whose way is that long is the last that is looked at
  double way;  ///< out: the longest of all points: to the nearest barrier of either kind, none shorter than 0, summed
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

/// Four triangles, whole. Lanes that are not used lie infinitely far in front of every point.
struct FaceBlock {
  double normalX[kSurfaceLanes], normalY[kSurfaceLanes], normalZ[kSurfaceLanes];  ///< unit, outward
  double offset[kSurfaceLanes];                                                   ///< normal . x on the plane
  /// Of each edge: unit, in the plane, from the edge to the inside.
  double inwardX[3][kSurfaceLanes], inwardY[3][kSurfaceLanes], inwardZ[3][kSurfaceLanes];
  double edge[3][kSurfaceLanes];                                      ///< inward . x on each edge
  double loX[kSurfaceLanes], loY[kSurfaceLanes], loZ[kSurfaceLanes];  ///< bounds
  double hiX[kSurfaceLanes], hiY[kSurfaceLanes], hiZ[kSurfaceLanes];
};

/// Bounds of four groups of kFaceGroup blocks. Lanes that are not used lie infinitely far away.
inline constexpr std::size_t kFaceGroup = 4;
struct FaceGroups {
  double loX[kSurfaceLanes], loY[kSurfaceLanes], loZ[kSurfaceLanes];
  double hiX[kSurfaceLanes], hiY[kSurfaceLanes], hiZ[kSurfaceLanes];
  double reach[kSurfaceLanes];  ///< the largest FaceSet::Face::reach of a group
};

struct NearFacesArgs {
  const FaceBlock* blocks;
  std::size_t count;
  const FaceGroups* groups;
  std::size_t groupCount;  ///< elements of `groups`
  Vec3d point;
  double radius2;          ///< squared distance from the bounds
  std::uint32_t* found;    ///< room for all lanes; ascending
  std::size_t foundCount;  ///< out
  std::uint32_t nearest;   ///< out: one whose bounds are near, whatever their distance
};

/// A stretch that has been moved out of the other mesh, or nearly: at a face, or at a stretch that it passes, not more
/// than `missing` of its way is left.
struct Moved {
  Vec3d by{0, 0, 0};
  double missing = std::numeric_limits<double>::infinity();
};

struct FacesOverArgs {
  const FaceBlock* blocks;
  std::size_t count;
  const FaceGroups* groups;
  std::size_t groupCount;  ///< elements of `groups`
  Vec3d from, to;
  double slack, length;    ///< length: of the stretch
  double limit;            ///< none counts that is deeper
  Moved moved;             ///< and none where more is missing
  std::uint32_t* found;    ///< room for all lanes; ascending
  std::size_t foundCount;  ///< out
};

struct SoonestFaceArgs {
  const FaceBlock* blocks;
  std::size_t count;
  const FaceGroups* groups;
  std::size_t groupCount;  ///< elements of `groups`
  Vec3d from, to;
  double slack, length;  ///< length: of the stretch
  double depth;          ///< out: the least, infinity if there is none
  std::uint32_t face;    ///< out: the first of that depth
};

/// One triangle of a region's mesh, whole.
struct RegionTriangle {
  Vec3d corner[3];  ///< relative to OverlapRegions::origin
  Vec3d normal;     ///< unit, outward
  double offset;    ///< normal . x on its plane
  Vec3d inward[3];  ///< unit, in its plane, from each edge to the inside
  double edge[3];   ///< inward . x on each edge
};

/// Four directions in which a point may leave. Lanes that are not used have lengths below 0.
struct WayBlock {
  double x[kSurfaceLanes], y[kSurfaceLanes], z[kSurfaceLanes];  ///< unit
  double length[kSurfaceLanes];                                 ///< no longer way counts
};

/// A triangle below whose plane a point lies.
struct TriangleAhead {
  double depth;
  std::uint32_t triangle;
};

struct ShortestWayArgs {
  const WayBlock* ways;
  std::size_t count;
  const RegionTriangle* triangles;
  const TriangleAhead* ahead[2];  ///< of each mesh, the least depth first
  std::size_t aheadCount[2];
  Vec3d from, ending;  ///< ending: no way counts whose cosine with it is more than `mostEnding`
  double mostEnding;
  double leastCosine;  ///< of a way with the normal of a triangle that it goes through
  double slack;        ///< how far beside a triangle counts as on it
  double most;         ///< a way counts that is shorter
  double length;       ///< out: the shortest of all, out of mesh 1 along it and out of mesh 0 against it; or infinity
  double out, back;    ///< out: its parts
  std::uint32_t way;   ///< out: the first of that length
};

/// Four stretches of edges. Lanes that are not used have no direction.
struct StretchBlock {
  double x[kSurfaceLanes], y[kSurfaceLanes], z[kSurfaceLanes];                 ///< middle
  double alongX[kSurfaceLanes], alongY[kSurfaceLanes], alongZ[kSurfaceLanes];  ///< unit
  double reach[kSurfaceLanes];                                                 ///< half the length
};

struct StretchesPassedArgs {
  const StretchBlock* blocks;
  std::size_t count;
  Vec3d middle, along;
  double reach, leastSine;
  Moved moved;             ///< none counts where more is missing
  std::uint32_t* found;    ///< room for all lanes; ascending
  std::size_t foundCount;  ///< out
};

#define OTG_DECLARE_SURFACE_KERNELS(set)               \
  namespace set {                                      \
  void exitThroughPlanes(PlaneExitArgs& args);         \
  void exitThroughRoundPlanes(PlaneExitArgs& args);    \
  void findFacingPlane(FacingPlaneArgs& args);         \
  void sumLocalAreas(LocalAreaArgs& args);             \
  void findExtent(ExtentArgs& args);                   \
  void findFarthestWay(FarthestWayArgs& args);         \
  void findBoxRanges(BoxRangesArgs& args);             \
  void findNearFaces(NearFacesArgs& args);             \
  void findNearestFace(NearFacesArgs& args);           \
  void findFacesOver(FacesOverArgs& args);             \
  void findSoonestFace(SoonestFaceArgs& args);         \
  void findShortestWay(ShortestWayArgs& args);         \
  void findStretchesPassed(StretchesPassedArgs& args); \
  }
OTG_DECLARE_SURFACE_KERNELS(simd_baseline)
OTG_DECLARE_SURFACE_KERNELS(simd_avx2)
OTG_DECLARE_SURFACE_KERNELS(simd_avx512)
#undef OTG_DECLARE_SURFACE_KERNELS

}  // namespace otg
