// SPDX-License-Identifier: BSD-3-Clause
// Where out is when the surfaces of a region do not say it: deep overlaps, entangled and contained bodies.
#pragma once

#include <list>

#include "collide/solid/edge_pair.h"
#include "collide/solid/extent.h"
#include "collide/solid/inside.h"
#include "collide/solid/region_normals.h"
#include "collide/solid/regions.h"

namespace otg {

/// Adds a region for every component that lies wholly inside the other mesh.
void addContained(const PlacedMeshes& meshes, const InsideFlags& inside, OverlapRegions& regions);

/// What the pair's motion and history say, all in A's frame.
struct PairMotion {
  Vec3d back{0, 0, 0};        ///< unit direction against A's approach, zero if unknown
  double step = 0;            ///< how far A moved relative to B since the last query, 0 if unknown
  Vec3d escape{0, 0, 0};      ///< direction that still holds, or zero
  Vec3d deepNormal{0, 0, 0};  ///< direction of the last deep region, or zero
  bool isJammed = false;      ///< all regions leave along `escape`
};

/// Where a pair leaves whose regions contradict each other: the direction in which the last of them is soonest out.
class EscapeOfAll {
 public:
  /// Copies the regions. The query of the meshes has to outlive this object.
  void add(const PlacedMeshes& meshes, const OverlapRegions& regions) { overlaps_.push_back({meshes, regions}); }
  /// Zero without regions.
  Vec3d direction(const PairMotion& motion) const;

 private:
  struct Overlap {
    PlacedMeshes meshes;
    OverlapRegions regions;
  };
  std::list<Overlap> overlaps_;
};

struct RegionDirection {
  bool entangled = false;  ///< incoherent or broken: depths of the whole pair are not to be trusted
  bool escaping = false;   ///< `direction` is where the body is leaving
  bool deep = false;       ///< `direction` is the way out of a deep overlap
  bool pierced = false;    ///< it leads through another surface than that which the region crosses
  Vec3d direction{0, 0, 0};
  double depth = 0;  ///< of the way out along it, where that is known: the deepest contact has no less
};

/// Chooses one direction for the whole region where that is needed, and passes it to `normals`.
RegionDirection directRegion(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
                             const PairMotion& motion, RegionNormals& normals, RegionExtent& extent);

}  // namespace otg
