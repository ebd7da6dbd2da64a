// SPDX-License-Identifier: BSD-3-Clause
#include "primitives/convex_contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/vectors.h"
#include "collide/consistent_contacts.h"
#include "collide/contact_copies.h"
#include "collide/convex/convex_pair_contacts.h"
#include "collide/convex/convex_parts.h"
#include "collide/pair_history.h"
#include "collide/pairwise/reduction.h"
#include "collide/shell/shell_contacts.h"
#include "collide/shell/shell_roles.h"
#include "collide/solid/ahead_scratch.h"
#include "collide/solid/look_ahead.h"
#include "collide/solid/region_refiner.h"
#include "collide/solid/solid_contacts.h"
#include "collide/stages.h"
#include "collide/surface/surface_contacts.h"
#include "primitives/convex_patch.h"
#include "primitives/cylinder_contacts.h"
#include "primitives/region_walls.h"
#include "primitives/sheet_block.h"
#include "queries/surface_side.h"

namespace otg {
namespace {

constexpr double kLeft = 0.005;           // of a way out: not worth a correction
constexpr double kRounding = 2.5e-7;      // of the shape's radius: what single precision may take off a depth
constexpr double kSamePlace = 0.01;       // of the region's diagonal
constexpr double kFacetsStickOut = 0.05;  // of the radius: at most
constexpr double kParallel = 1e-6;        // square of a sine: an edge is as near to the axis everywhere

class ShapeRefiner final : public RegionRefiner {
 public:
  ShapeRefiner(const Query& query, const ConvexShape& shape) : query_(query), shape_(shape) {}

  bool direct(const PlacedMeshes& meshes, const OverlapRegions& all, const Region& region,
              const RegionDirection& direction, RegionNormals& normals) override {
    meshes_ = &meshes;
    origin_ = all.origin;
    diagonal_ = region.diagonal;
    low_ = region.lo;
    high_ = region.hi;
    placed_.emplace(shape_, meshes.query().bInA, origin_);  // of a look ahead after the way
    memory_ = all.memory;
    patch_.emplace(memory_);
    walls_.emplace(memory_);
    settled_ = hasWalls_ = false;
    trusted_ = !direction.entangled && !direction.escaping && !region.contained && !region.bad;
    if (!trusted_) return false;
    const bool isConvex = patch_->read(meshes, all, region) || patch_->readDense(meshes, all, region, *placed_);
    hasWalls_ = walls_->read(meshes, all, region, *placed_, patch_->triangles(), isConvex);
    trusted_ = isConvex || !direction.pierced;
    if (!isConvex) return false;
    way_ = patch_->leave(*placed_, unit(region.push) * -1.0);
    settled_ = std::isfinite(way_.depth) && !(direction.pierced && direction.depth < way_.depth);
    trusted_ = settled_ || !direction.pierced;
    hasWalls_ = hasWalls_ && settled_;
    if (!settled_) return false;
    normals.fix(way_.direction * -1.0);
    return true;
  }

  /// Whether contacts of a region that is not convex went. What they asked for may be missing.
  bool hasDropped() const { return hasDropped_; }

  void refine(std::vector<Contact>& contacts, std::size_t first) override {
    correct(contacts, first);
    patch_.reset();
    walls_.reset();
  }

 private:
  void correct(std::vector<Contact>& contacts, std::size_t first) {
    const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(first);
    if (settled_ && !(way_.depth > 0)) {  // the facets overlap, the round shape does not
      contacts.erase(begin, contacts.end());
      return;
    }
    std::optional<Contact> deepest;
    if (shape_.isCurved() && !settled_ && begin != contacts.end()) {
      deepest = *std::max_element(begin, contacts.end(),
                                  [](const Contact& x, const Contact& y) { return x.depth < y.depth; });
    }
    // Where all ends lie beside the round shape, or beside the walls, that may be for the facets, or for ways out that
    // bend: a body that is deeper than facets stick out keeps what they say.
    const auto keepOne = [&] {
      if (deepest && contacts.size() == first && deepest->depth > kFacetsStickOut * shape_.radius) {
        contacts.push_back(*deepest);
      }
    };
    if (shape_.isCurved()) {
      contacts.erase(
          std::remove_if(begin, contacts.end(), [&](Contact& c) { return !(settled_ ? onPatch(c) : onSurface(c)); }),
          contacts.end());
      keepOne();
      if (settled_) {
        addDeepest(contacts, first);
        if (onLine()) keepEnds(contacts, first);
      }
    } else if (settled_ && (way_.overEdges || contacts.size() == first || patch_->isDense())) {
      // Cells of many triangles give depths less well than the planes of all.
      for (auto it = begin; it != contacts.end(); ++it) it->depth = std::min(it->depth, way_.depth);
      addDeepest(contacts, first);
    }
    if (settled_ && !shape_.isCurved()) undoRounding(contacts, first);
    if (hasWalls_ && !settled_ && walls_->limitDepths(*placed_, contacts, first)) hasDropped_ = true;
    keepOne();
    if (hasWalls_) walls_->complete(*placed_, kSamePlace * diagonal_, contacts, first);
    keepEachDirection(contacts, first, static_cast<std::size_t>(query_.options.solid.contactsPerRegion), memory_);
  }

  /// How much of the shape's axis lies along the way out.
  double slope() const { return std::fabs(placed_->directionToLocal(way_.direction).z); }
  /// Contacts lie along a line of the round side.
  bool onLine() const { return shape_.kind == ConvexShape::Kind::kCapsule || slope() < PlacedShape::kOnSide; }

  void place(Contact& c, const Vec3d& middle, double depth) const {
    c.position = middle + origin_;
    c.depth = depth;
  }
  /// Within the region's bounds: where the lines of two edges are nearest may be beyond the edges' ends. The line of a
  /// round side that is last to leave a face may be beside that face.
  Vec3d inRegion(const Vec3d& p) const {
    return {std::clamp(p.x, low_.x, high_.x), std::clamp(p.y, low_.y, high_.y), std::clamp(p.z, low_.z, high_.z)};
  }

  /// With the direction fixed: place and depth on the round shape and the patch's planes.
  bool onPatch(Contact& c) const {
    const Vec3d d = way_.direction, p = placed_->rearNear(d, c.position - origin_);
    const double ahead = patch_->wayOut(p, d);
    if (!(ahead > 0) || !std::isfinite(ahead)) return false;
    const double behind = std::max(0.0, placed_->exitDistance(p, d * -1.0));
    const double depth = std::min(ahead + behind, way_.depth);
    place(c, inRegion(p + d * (0.5 * (ahead - behind))), depth);
    return true;
  }

  /// Where an edge of the mesh is deepest in the round shape, about: where it is nearest to the axis, or in the middle
  /// of what is between the cylinder's side and an end. `from` if that is beside the region, or the edge is beside the
  /// shape. The middle of the stretch that facets cut out of the edge is another place.
  Vec3d deepestOn(std::uint32_t edge, const Vec3d& from) const {
    const Topology::Edge& ends = meshes_->mesh(0).topology().edges[edge];
    const Vec3d a = meshes_->vertex(0, ends.a) - origin_, along = meshes_->vertex(0, ends.b) - origin_ - a;
    const Vec3d start = placed_->toLocal(a), d = placed_->directionToLocal(along);
    const double across = d.x * d.x + d.y * d.y;
    if (!(across > kParallel * otgDot(d, d))) return from;
    const double nearest = -(start.x * d.x + start.y * d.y) / across;
    const double x = start.x + nearest * d.x, y = start.y + nearest * d.y;
    const double reach = std::sqrt(std::max(0.0, shape_.radius * shape_.radius - x * x - y * y) / across);
    double low = std::max(nearest - reach, 0.0), high = std::min(nearest + reach, 1.0);
    if (d.z != 0) {
      const double oneEnd = (-shape_.length - start.z) / d.z, other = (shape_.length - start.z) / d.z;
      low = std::max(low, std::min(oneEnd, other));
      high = std::min(high, std::max(oneEnd, other));
    }
    if (!(low < high)) return from;
    const Vec3d at = a + along * (low <= nearest && nearest <= high ? nearest : 0.5 * (low + high));
    return inRegion(at) == at ? at : from;
  }

  /// With a direction of its own: the far end on the mesh is right, the near one is measured on the round shape.
  bool onSurface(Contact& c) const {
    if (!trusted_) return true;  // bodies deep in each other: the round shape is not the question
    const Vec3d onMesh = c.position - origin_ - c.normal * (0.5 * c.depth);
    const Vec3d at = c.feature == ContactFeature::kMiddleA ? deepestOn(c.element, onMesh) : onMesh;
    const double depth = placed_->exitDistance(at, c.normal);
    if (!(depth > 0)) return false;
    place(c, at + c.normal * (0.5 * depth), at == onMesh ? std::min(depth, c.depth) : depth);
    return true;
  }

  /// Where the shape is last to leave the patch.
  Vec3d rearPoint() const {
    const Vec3d rear = placed_->rear(way_.direction);
    if (!way_.overEdges || !(otgDot(way_.alongShape, way_.alongShape) > 0)) return rear;
    // Of the shape's edge or side the point that is nearest to the mesh's edge.
    const Vec3d n = otgCross(way_.alongShape, way_.alongMesh);
    const double nn = otgDot(n, n);
    if (!(nn > 1e-12)) return rear;
    const double t = otgDot(otgCross(way_.onMesh - rear, way_.alongMesh), n) / nn;
    return rear + way_.alongShape * t;
  }

  /// The contact at which the least way out is decided, unless there is one as deep.
  void addDeepest(std::vector<Contact>& contacts, std::size_t first) const {
    const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(first);
    Contact deepest{};
    deepest.triangleA = patch_->anyTriangle();
    deepest.coherence = 1;
    if (contacts.size() > first) {
      deepest = *std::max_element(begin, contacts.end(),
                                  [](const Contact& x, const Contact& y) { return x.depth < y.depth; });
      if (deepest.depth >= way_.depth * (1 - 1e-6)) return;
    }
    const Vec3d d = way_.direction;
    deepest.normal = d * -1.0;
    place(deepest, inRegion(rearPoint() + d * (0.5 * way_.depth)), way_.depth);
    contacts.erase(
        std::remove_if(begin, contacts.end(),
                       [&](const Contact& c) { return norm(c.position - deepest.position) < kSamePlace * diagonal_; }),
        contacts.end());
    contacts.push_back(deepest);
  }

  /// The vertices of the shape's mesh are rounded to single precision, the way out is not.
  void undoRounding(std::vector<Contact>& contacts, std::size_t first) const {
    double deepest = 0;
    for (std::size_t i = first; i < contacts.size(); ++i) deepest = std::max(deepest, contacts[i].depth);
    const double missing = way_.depth - deepest;
    if (!(missing > kLeft * way_.depth) || missing > kRounding * double{shape_.mesh->mesh().radius()}) return;
    for (std::size_t i = first; i < contacts.size(); ++i) contacts[i].depth += missing;
  }

  /// Of contacts along a line the deepest and the outermost.
  void keepEnds(std::vector<Contact>& contacts, std::size_t first) const {
    if (contacts.size() - first < 2) return;
    const auto begin = contacts.begin() + static_cast<std::ptrdiff_t>(first);
    const auto along = [&](const Contact& c) { return placed_->toLocal(c.position - origin_).z; };
    const auto [low, high] = std::minmax_element(
        begin, contacts.end(), [&](const Contact& x, const Contact& y) { return along(x) < along(y); });
    const auto most =
        std::max_element(begin, contacts.end(), [](const Contact& x, const Contact& y) { return x.depth < y.depth; });
    const auto isFar = [&](const Contact& c) { return std::fabs(along(c) - along(*most)) > kSamePlace * diagonal_; };
    std::pmr::vector<Contact> kept(memory_);
    for (const auto& end : {low, high}) {
      if (isFar(*end)) kept.push_back(*end);
    }
    // Between ends that are as deep it holds nothing.
    if (kept.size() < 2 || most->depth > 1.02 * std::max(low->depth, high->depth)) kept.push_back(*most);
    contacts.erase(begin, contacts.end());
    contacts.insert(contacts.end(), kept.begin(), kept.end());
  }

  const Query& query_;
  const ConvexShape& shape_;
  const PlacedMeshes* meshes_ = nullptr;  ///< of the region
  std::optional<PlacedShape> placed_;
  std::pmr::memory_resource* memory_ = nullptr;
  // In the region's memory.
  std::optional<ConvexPatch> patch_;
  std::optional<RegionWalls> walls_;
  Vec3d origin_{};
  double diagonal_ = 0;
  Vec3d low_{}, high_{};  ///< of the region
  bool trusted_ = false, settled_ = false, hasWalls_ = false;
  bool hasDropped_ = false;  ///< of any region
  WayOut way_;
};

/// workspace.intersecting -> contacts of the model of two solids in workspace.reduced, in the mesh's own numbers. False
/// where there are none of it.
bool regionContacts(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  Query refined = query;
  ShapeRefiner refiner(refined, shape);
  refined.refiner = &refiner;
  if (!solidContacts(refined, workspace)) return false;
  if (isCornered(query.a) || refiner.hasDropped()) lookAhead(refined, workspace);
  dropCopies(workspace.contacts, smallerSize(query), emptyMemory(workspace));
  finishContacts(query, workspace);
  return true;
}

/// At the rim of a sheet, where the contour does not close: as with a solid that the sheet near the shape bounds.
bool rimContacts(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  if (surfaceKind(query.a->mesh()) != SurfaceKind::kSheet) return false;
  const Vec3f &low = shape.mesh->mesh().boundsMin(), &high = shape.mesh->mesh().boundsMax();
  const Vec3d middle{0.5 * (double{low.x} + high.x), 0.5 * (double{low.y} + high.y), 0.5 * (double{low.z} + high.z)};
  Transformd frame = query.bInA;
  frame.t = otgTransform(frame, middle);
  const Vec3d half{high.x - middle.x, high.y - middle.y, high.z - middle.z};
  const double size = norm(half);
  const SheetBlock block = sheetBlock(*query.a, frame, half + Vec3d{size, size, size}, 4 * size);
  if (block.mesh == nullptr) return false;
  Query filled = query;
  filled.a = block.mesh.get();
  findIntersectingPairs(filled, workspace);
  if (!regionContacts(filled, shape, workspace)) return false;
  for (Contact& contact : workspace.reduced) contact.triangleA = block.triangleOf[contact.triangleA];
  limitByMotion(query, workspace.reduced);
  return true;
}

/// Of a flat shape on a mesh of convex parts. Depths are those of the shape itself, and not of its vertices as single
/// precision has them.
bool collideParts(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  if (shape.isCurved() || !collideConvexParts(query, workspace)) return false;
  const ConvexPolyhedron& hull = *query.b->convex();
  for (Contact& c : workspace.reduced) {
    const Vec3d out = otgRotateBack(query.bInA, c.normal);
    c.depth += otgDot(out, shape.support(out)) - otgDot(out, hull.vertices()[hull.support(out)]);
    c.depth = std::max(c.depth, 0.0);
  }
  return true;
}

}  // namespace

void convexContacts(const Query& query, const ConvexShape& shape, Workspace& workspace) {
  if (isPairwise(query)) {
    findIntersectingPairs(query, workspace);
    pairwiseContacts(query, workspace);
    reduceContacts(query, workspace);
  } else if (!(shape.isCurved() ? collideCylinder(query, shape, workspace) : collideConvexPair(query, workspace)) &&
             !collideSurface(query, shape, workspace) && !collideParts(query, shape, workspace)) {
    findIntersectingPairs(query, workspace);
    if (areShells(query, workspace.intersecting)) {
      shellContacts(query, workspace);
    } else if (!regionContacts(query, shape, workspace) && !rimContacts(query, shape, workspace)) {
      findIntersectingPairs(query, workspace);  // the rim may have left the workspace with another mesh's pairs
      shellContacts(query, workspace);
    }
  }
  for (Contact& contact : workspace.reduced) contact.triangleB = kNone;
}

}  // namespace otg
