// SPDX-License-Identifier: BSD-3-Clause
// The triangles on which a region's pieces lie, for regions whose points must each be measured on the surface itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <optional>
#include <vector>

#include "base/flat_map.h"
#include "collide/placed_meshes.h"
#include "collide/simd/surface_kernels.h"
#include "collide/solid/overlap_regions.h"

namespace otg {

/// A convex edge of such triangles.
struct RegionEdge {
  Vec3d middle, along;  ///< relative to the origin; unit
  double reach;         ///< half its length
  Vec3d faces[2];       ///< outward normals of its two faces
};

class RegionTriangles {
 public:
  explicit RegionTriangles(std::pmr::memory_resource* memory)
      : triangles_(memory),
        planes_(memory),
        faces_{FaceSet(memory), FaceSet(memory)},
        curved_(memory),
        edges_{std::pmr::vector<RegionEdge>(memory), std::pmr::vector<RegionEdge>(memory)},
        stretches_{StretchSet(memory), StretchSet(memory)},
        edgesAdded_(memory),
        exits_(memory),
        facesOver_(memory),
        distances_(memory),
        ahead_{std::pmr::vector<TriangleAhead>(memory), std::pmr::vector<TriangleAhead>(memory)},
        sameAs_(memory),
        slots_(memory),
        used_(memory) {}

  /// A face through which a point leaves a mesh.
  struct Exit {
    Vec3d normal;        ///< unit, outward
    double offset;       ///< of the face's plane
    double depth;        ///< of the point below that
    std::uint32_t face;  ///< its number in the mesh's part of the region
  };

  /// Only for regions whose pieces are parts of single triangles: none of cells.
  void collect(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region);

  /// How far in front of a triangle a point may lie that counts as on it.
  double behind() const { return behind_; }

  /// Whether a face is a facet of a curved surface.
  bool isCurved(int m, std::uint32_t face) const;

  /// Calls visit(edge) for all edges of mesh m that a stretch may pass, and few others, in the order of the triangles.
  /// Only for those at which no more is missing when it has been moved.
  template <class Visit>
  void forEachEdgePassed(int m, const Vec3d& middle, const Vec3d& along, double reach, const Moved& moved,
                         Visit visit) const {
    for (const std::uint32_t i : stretches_[m].passed(middle, along, reach, OTG_SOLID_LEAST_SINE, moved)) {
      visit(edges_[m][i]);
    }
  }

  /// By which faces of mesh m a point leaves it: those on which the nearest place of the surface lies. On a face that
  /// is one. In an inner corner the nearest place is on the edge or at the vertex there. All faces that meet in it hold
  /// the point. (On a convex edge it never is, seen from inside.) None if the point lies in front of them. None if the
  /// surface is not nearer than `limit`.
  const std::pmr::vector<Exit>& exitsOf(int m, const Vec3d& p, double limit = std::numeric_limits<double>::infinity());

  /// By which faces of mesh m a stretch from `from` to `to` leaves as a whole: it is over the face at one end at least,
  /// and below its plane. The depth is that of the end that is deeper. Of faces that face the same way the one with the
  /// least depth, the first of several. In the order of the triangles. Without those at which more is missing when the
  /// stretch has been moved, or with few of them.
  struct StretchExit {
    Exit exit;
    bool byEnd;  ///< the end `to` is the deeper one
  };
  const std::pmr::vector<StretchExit>& facesOver(int m, const Vec3d& from, const Vec3d& to, const Moved& moved);
  /// The first of these that has the least depth; infinite without any.
  StretchExit soonestOver(int m, const Vec3d& from, const Vec3d& to) const;

  /// The first of the shortest ways from a point, none of which may be longer than `far`: out of mesh 1 through the
  /// nearest of its triangles that face along, and out of mesh 0 against the direction. Those along `ending` do not
  /// count. None if all are longer than they may be.
  struct Shortest {
    std::size_t way;
    double out, back;
  };
  std::optional<Shortest> shortestWay(const Vec3d& from, const WaySet& ways, double far, const Vec3d& ending);

  /// Distance of a point from the triangles of mesh m that face along a unit direction, `limit` at most.
  double distanceToFacing(int m, const Vec3d& p, const Vec3d& direction, double limit) const;

 private:
  /// What most triangles are passed over by.
  struct Plane {
    Vec3d normal;
    double offset;
  };
  enum class Curved : std::uint8_t { kUnknown, kNo, kYes };
  void findSameNormals();
  /// The triangles that shortestWay() may go through.
  void lookFrom(const Vec3d& from, double far);

  double depthBelow(std::size_t i, const Vec3d& p) const { return planes_[i].offset - otgDot(planes_[i].normal, p); }
  double distanceOf(std::size_t i, const Vec3d& p) const;
  StretchExit stretchExit(int m, std::uint32_t face, const Vec3d& from, const Vec3d& to) const;

  void addTriangle(const PlacedMeshes& meshes, const Vec3d& origin, const Piece& piece);
  void addFace(int m, const RegionTriangle& t);
  void addEdges(const PlacedMeshes& meshes, const RegionTriangle& t, std::uint8_t mesh, std::uint32_t number);

  std::size_t begin_[3] = {0, 0, 0};  ///< of each mesh's triangles, and the end
  std::pmr::vector<RegionTriangle> triangles_;
  std::pmr::vector<Plane> planes_;           ///< of each triangle
  FaceSet faces_[2];                         ///< of each mesh, with bounds of all that counts as on a triangle
  mutable std::pmr::vector<Curved> curved_;  ///< of each triangle, where it has been requested
  std::pmr::vector<RegionEdge> edges_[2];    ///< of each mesh
  StretchSet stretches_[2];                  ///< of these
  FlatMap edgesAdded_;
  std::pmr::vector<Exit> exits_;
  std::pmr::vector<StretchExit> facesOver_;
  std::pmr::vector<double> distances_;
  std::pmr::vector<TriangleAhead> ahead_[2];  ///< of each mesh, what lookFrom() finds
  double lastLength_ = 0;                     ///< of the last way that shortestWay() found
  std::pmr::vector<std::size_t> sameAs_;      ///< of each triangle one that faces the same way: one for all that do
  std::pmr::vector<std::size_t> slots_;       ///< facesOver(): of these, where it is among those found
  std::pmr::vector<std::size_t> used_;        ///< which slots are taken
  double slack_ = 0;                          ///< how far beside a triangle still counts as on it
  double behind_ = 0;                         ///< behind()
};

}  // namespace otg
