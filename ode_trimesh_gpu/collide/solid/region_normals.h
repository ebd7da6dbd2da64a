// SPDX-License-Identifier: BSD-3-Clause
// In which direction a region pushes at one of its points.
#pragma once

#include <optional>
#include <vector>

#include "collide/simd/surface_kernels.h"
#include "collide/solid/regions.h"

namespace otg {

/// Contact normals of one region: one direction for flat regions, localised by distance where the region is curved, the
/// escape direction where the surfaces do not say where out is.
class RegionNormals {
 public:
  /// `escape` is requested only when it is needed; it may be any unit vector.
  RegionNormals(const OverlapRegions& all, const Region& region);

  /// Serve this direction everywhere instead.
  void fix(const Vec3d& direction) { fixed_ = direction; }
  bool isFixed() const { return fixed_.has_value(); }
  /// What to return where the two surfaces contradict each other in an incoherent region.
  void setEscape(const Vec3d& direction) { escape_ = direction; }

  /// Direction of the region's vector area; zero if that vanishes.
  const Vec3d& mean() const { return mean_; }
  Vec3d at(const Vec3d& point) const;
  /// Whether what counts of one side at least is all but flat.
  bool isFlat() const { return isFlat_; }

 private:
  struct Element {  // a piece, or a cell full of pieces of one mesh
    Vec3d lo, hi;
    Vec3d vector;   ///< sum of outward normal times area
    double area;    ///< sum of |..|
    double offset;  ///< sum of the planes' offsets times area
    std::uint8_t mesh;
    double weight = 1;  ///< how much it says about where out is
  };
  bool isLump() const { return otgIsLump(region_.thickness, region_.diagonal) != 0; }
  Vec3d local(const Vec3d& point) const;
  double shareOfMean() const;
  Vec3d notAgainstMean(const Vec3d& n) const;
  void cluster(const OverlapRegions& all);
  void weighByDepth();
  void chooseBetweenSides(const Vec3d& a, const Vec3d& b, const double coherence[2]);

  const Region& region_;
  Vec3d mean_{0, 0, 0};
  Vec3d weighted_{0, 0, 0};  ///< the mean with the weights of the elements
  std::optional<Vec3d> fixed_, escape_;
  std::optional<Vec3d> everywhere_;  ///< the result for all points, where it is known before they are
  double shareOfB_ = 0.5;            ///< how much B's surface counts where the sides differ; A's counts the rest
  double radius_;
  bool isFlat_ = false;
  std::pmr::memory_resource* memory_;
  std::pmr::vector<Element> elements_;
  AreaSet areas_[2];  ///< the elements of either mesh with their weights
};

}  // namespace otg
