// SPDX-License-Identifier: BSD-3-Clause
// A region's surface and points as blocks of four, and what is found of all of them many times: how far it is through
// the planes, which way the surface about a point faces, how far the points reach.
//
// Results are the same bit for bit for every instruction set.
#pragma once

#include <memory_resource>
#include <span>
#include <vector>

#include "collide/simd/surface_kernels_args.h"
#include "collide/simd/wide_kernels.h"

namespace otg {

/// Flat parts of a surface.
class PlaneSet {
 public:
  explicit PlaneSet(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : blocks_(memory) {}
  void clear();
  void reserve(std::size_t count) { blocks_.reserve((count + kSurfaceLanes - 1) / kSurfaceLanes); }
  void add(const Vec3d& normal, double offset, const Vec3d& lo, const Vec3d& hi);
  struct Way {
    double nearest, convex;
    double either() const;  ///< nearest if there is one, else convex; infinity if nothing faces along
  };
  /// Way from a point along a unit direction through the nearest plane that faces along. The plane's part, enlarged by
  /// `slack` to all sides, must hold the place where it is met; and through the nearest plane that faces along.
  Way wayOut(const Vec3d& from, const Vec3d& direction, double slack) const;
  /// The same with parts enlarged by round corners.
  Way wayOutRound(const Vec3d& from, const Vec3d& direction, double slack) const;
  /// Number of the first of those that face along with the least sum of the way and the distances of its part along the
  /// axes; the largest number where none does.
  std::uint32_t facing(const Vec3d& from, const Vec3d& direction) const;

 private:
  std::pmr::vector<PlaneBlock> blocks_;
  std::size_t count_ = 0;
};

/// Vector areas with their bounds.
class AreaSet {
 public:
  explicit AreaSet(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : blocks_(memory) {}
  void clear();
  void reserve(std::size_t count) { blocks_.reserve((count + kSurfaceLanes - 1) / kSurfaceLanes); }
  void add(const Vec3d& lo, const Vec3d& hi, const Vec3d& vector, double area);
  struct Sum {
    Vec3d vector;
    double area;
  };
  /// Sum of those nearer than `radius`, each times (1 - d^2 / radius^2)^2, d the distance from the point to its bounds.
  Sum about(const Vec3d& point, double radius) const;

 private:
  std::pmr::vector<AreaBlock> blocks_;
  std::size_t count_ = 0;
};

class PointSet {
 public:
  explicit PointSet(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : blocks_(memory) {}
  void clear();
  void reserve(std::size_t count) { blocks_.reserve((count + kSurfaceLanes - 1) / kSurfaceLanes); }
  void add(const Vec3d& p);
  /// Length of the range of direction . point; 0 without points.
  double extent(const Vec3d& direction) const;
  /// The longest way of all points: to the nearest of the first barriers and to the nearest of the second, `far` where
  /// there are none, both no shorter than 0, summed. Stops when it is at least `enough`.
  double farthestWay(std::span<const Barrier> first, std::span<const Barrier> second, double far, double enough) const;

 private:
  std::pmr::vector<PointBlock> blocks_;
  std::size_t count_ = 0;
};

class BoxSet {
 public:
  explicit BoxSet(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : blocks_(memory) {}
  void clear();
  void add(const Vec3d& lo, const Vec3d& hi);
  /// The ranges of direction . x, box by box.
  void ranges(const Vec3d& direction, std::pmr::vector<double>& lo, std::pmr::vector<double>& hi) const;

 private:
  std::pmr::vector<BoxBlock> blocks_;
  std::size_t count_ = 0;
};

/// Whole triangles of a surface.
class FaceSet {
 public:
  explicit FaceSet(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : blocks_(memory), groups_(memory), found_(memory) {}
  struct Face {
    Vec3d normal;
    double offset;
    Vec3d inward[3];
    double edge[3];
    Vec3d lo, hi;
    double reach;  ///< no place over it that is below its plane by x is farther from its bounds than this times x
  };
  void clear();
  void reserve(std::size_t count);
  void add(const Face& face);
  std::size_t size() const { return count_; }
  /// Those whose bounds are at most that far from a point, ascending. What is found lasts until the next call.
  std::span<const std::uint32_t> near(const Vec3d& point, double radius) const;
  /// One whose bounds are near to a point; there must be one at all.
  std::uint32_t nearest(const Vec3d& point) const;
  /// Those over which a stretch lies at one end at least, and below whose planes it lies: RegionTriangles::facesOver().
  /// And at which, when it has been moved, no more of the way is missing than that, and few others. Ascending. What is
  /// found lasts until the next call.
  std::span<const std::uint32_t> over(const Vec3d& from, const Vec3d& to, double slack, const Moved& moved = {}) const;
  /// Of those the one below whose plane the stretch lies least.
  struct Soonest {
    double depth;        ///< of the deeper end, 0 or more; infinity without any
    std::uint32_t face;  ///< the first of that depth
  };
  Soonest soonest(const Vec3d& from, const Vec3d& to, double slack) const;

 private:
  void addToGroup(const Face& face);

  std::pmr::vector<FaceBlock> blocks_;
  std::pmr::vector<FaceGroups> groups_;
  mutable std::pmr::vector<std::uint32_t> found_;
  std::size_t count_ = 0;
};

/// Directions in which points may leave, with lengths that no way may exceed.
class WaySet {
 public:
  explicit WaySet(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) : blocks_(memory) {}
  void add(const Vec3d& direction, double length);
  std::span<const WayBlock> blocks() const { return blocks_; }

 private:
  std::pmr::vector<WayBlock> blocks_;
  std::size_t count_ = 0;
};

/// Stretches of edges.
class StretchSet {
 public:
  explicit StretchSet(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : blocks_(memory), found_(memory) {}
  void clear();
  void reserve(std::size_t count) { blocks_.reserve((count + kSurfaceLanes - 1) / kSurfaceLanes); }
  void add(const Vec3d& middle, const Vec3d& along, double reach);
  /// All that pass a stretch, seen along the common perpendicular, ascending, and few others. The angle between passing
  /// ones has a sine of `leastSine` at least. When the stretch has been moved, no more of the way past them is missing
  /// than that. What is found lasts until the next call.
  std::span<const std::uint32_t> passed(const Vec3d& middle, const Vec3d& along, double reach, double leastSine,
                                        const Moved& moved = {}) const;

 private:
  std::pmr::vector<StretchBlock> blocks_;
  mutable std::pmr::vector<std::uint32_t> found_;
  std::size_t count_ = 0;
};

/// The same by one instruction set, for tests.
void exitThroughPlanes(SimdLevel level, PlaneExitArgs& args);
void exitThroughRoundPlanes(SimdLevel level, PlaneExitArgs& args);
void findFacingPlane(SimdLevel level, FacingPlaneArgs& args);
void sumLocalAreas(SimdLevel level, LocalAreaArgs& args);
void findExtent(SimdLevel level, ExtentArgs& args);
void findFarthestWay(SimdLevel level, FarthestWayArgs& args);
void findBoxRanges(SimdLevel level, BoxRangesArgs& args);
void findNearFaces(SimdLevel level, NearFacesArgs& args);
void findNearestFace(SimdLevel level, NearFacesArgs& args);
void findFacesOver(SimdLevel level, FacesOverArgs& args);
void findSoonestFace(SimdLevel level, SoonestFaceArgs& args);
void findShortestWay(SimdLevel level, ShortestWayArgs& args);
void findShortestWay(ShortestWayArgs& args);
void findStretchesPassed(SimdLevel level, StretchesPassedArgs& args);

}  // namespace otg
