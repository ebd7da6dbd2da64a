// SPDX-License-Identifier: BSD-3-Clause
// Inner corners: where a convex shape is in several walls of a mesh at once, each of them has to be left.
#pragma once

#include <memory_resource>
#include <span>
#include <vector>

#include "collide/solid/regions.h"
#include "primitives/convex_patch.h"

namespace otg {

/// The planes of mesh A's surface in a region, and of what meets it at inner edges.
///
/// A contact is a point with one direction. A point of the shape that is behind two walls of an inner corner is in
/// both, and needs a contact for each.
class RegionWalls {
 public:
  explicit RegionWalls(std::pmr::memory_resource* memory)
      : memory_(memory), walls_(memory), sorted_(memory), points_(memory), vertices_(memory), onMesh_(memory) {}

  /// `triangles`: of mesh A in the region, where pieces stand for several. `isConvex`: the region by itself is left as
  /// a whole, so that only walls beside it count. False where there is nothing to do, or more than it is worth.
  bool read(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region, const PlacedShape& shape,
            std::span<const std::uint32_t> triangles, bool isConvex);

  /// No contact from `first` on requests more than takes its point of the shape out of the walls that face its way.
  /// Whether there are some that go, because their points are in none. Of a curved shape those at edges and vertices of
  /// the mesh stay as they are: these have to leave the shape.
  bool limitDepths(const PlacedShape& shape, std::vector<Contact>& contacts, std::size_t first) const;
  /// Adds contacts for walls in which the shape is still when it has moved as those from `first` on request. `closest`:
  /// two contacts of a wall are no nearer to each other.
  void complete(const PlacedShape& shape, double closest, std::vector<Contact>& contacts, std::size_t first);

 private:
  struct Bounds {
    Vec3d low, high;
    double beside(const Vec3d& p) const;
  };
  struct Wall {
    Vec3d normal;  ///< unit, outward
    double offset;
    Bounds bounds;           ///< of the surface that it stands for
    std::uint32_t triangle;  ///< one of the region's, in it or beside it
    bool counts;             ///< has to be left for itself
    double wayOut(const Vec3d& p) const { return offset - otgDot(normal, p); }
  };
  /// A point inside both, near a point of the region.
  struct Inside {
    Vec3d point, crossing;
    Vec3d stretch;  ///< from the crossing to the end of the edge's stretch inside
    std::uint32_t triangle;
  };
  struct Hold {
    Vec3d point;         ///< of the shape, behind the wall
    double way;          ///< out of the wall along its normal
    double apart;        ///< from points that hold it so far
    const Inside* from;  ///< null for points that are the shape's own
  };
  static constexpr int kNeverTried = -1;
  struct SortedWall {
    const Wall* wall;
    double depth;  ///< of the shape in it
    int triedAt;   ///< the move at which it was to be held last
  };
  bool add(const Wall& wall);
  void addInnerNeighbours(const PlacedShape& shape, std::uint32_t triangle, std::uint32_t named);
  void collect(const PlacedShape& shape, const Wall& wall, const Vec3d& move, std::pmr::vector<Hold>& out) const;
  void sortWalls(const PlacedShape& shape);
  bool isUnmet(const SortedWall& sorted, const Vec3d& move) const;
  std::pmr::vector<const Inside*> unmetPoints(const PlacedShape& shape, const Vec3d& move) const;
  bool isOn(const Wall& wall, const Vec3d& point) const;
  bool isInDoubt(const Contact& contact, const Vec3d& point) const;
  bool isHeldBy(const Wall& wall, const Vec3d& point, double moved, const Inside* from) const;
  bool hold(const PlacedShape& shape, const Wall& wall, const Vec3d& move, double closest,
            std::vector<Contact>& contacts, std::size_t first) const;
  static double depthIn(const PlacedShape& shape, const Vec3d& point);
  void waysAt(const PlacedShape& shape, const Vec3d& point, std::pmr::vector<Vec3d>& out) const;
  bool holdPoint(const PlacedShape& shape, const Inside& at, const Vec3d& move, double closest,
                 std::vector<Contact>& contacts, std::size_t first) const;

  std::pmr::memory_resource* memory_;
  const PlacedMeshes* meshes_ = nullptr;
  Vec3d origin_{};
  double rounding_ = 0, onPlane_ = 0, far_ = 0;
  Bounds region_{};
  std::pmr::vector<Wall> walls_;
  std::pmr::vector<SortedWall> sorted_;
  std::pmr::vector<Inside> points_;   ///< those of flat shapes on their edges
  std::pmr::vector<Vec3d> vertices_;  ///< of flat shapes
  std::pmr::vector<Inside> onMesh_;   ///< on edges and vertices of the mesh
};

/// What is left of contacts of which there is room for `most`: of each direction the deepest, then the deepest of all.
void keepEachDirection(std::vector<Contact>& contacts, std::size_t first, std::size_t most,
                       std::pmr::memory_resource* memory);

}  // namespace otg
