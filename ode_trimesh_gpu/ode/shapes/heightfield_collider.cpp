// SPDX-License-Identifier: BSD-3-Clause
#include "ode/shapes/heightfield_collider.h"

#include <algorithm>
#include <cmath>

#include "collide/stages.h"
#include "ode/pairs/pair_task.h"
#include "ode/shapes/height_samples.h"
#include "ode/shapes/primitive_history.h"

namespace otg {
namespace {

/// Bounds in the field's frame.
struct Bounds {
  Vec3d low, high;
};

Bounds boundsInField(const TriMesh& mesh, const Transformd& fieldInMesh) {
  const Vec3f &a = mesh.boundsMin(), &b = mesh.boundsMax();
  const Vec3d middle{0.5 * (double{a.x} + b.x), 0.5 * (double{a.y} + b.y), 0.5 * (double{a.z} + b.z)};
  const Vec3d half{0.5 * (double{b.x} - a.x), 0.5 * (double{b.y} - a.y), 0.5 * (double{b.z} - a.z)};
  const Vec3d at = otgRotateBack(fieldInMesh, otgSub(middle, fieldInMesh.t));
  const double(&r)[9] = fieldInMesh.r;
  const auto reach = [&](int axis) {
    return std::fabs(r[axis]) * half.x + std::fabs(r[3 + axis]) * half.y + std::fabs(r[6 + axis]) * half.z;
  };
  // Contacts are decided in the mesh's frame: the roundings between the frames are on the safe side.
  const double slack = 1e-12 * (std::fabs(fieldInMesh.t.x) + std::fabs(fieldInMesh.t.y) + std::fabs(fieldInMesh.t.z) +
                                static_cast<double>(mesh.radius()));
  const Vec3d d{reach(0) + slack, reach(1) + slack, reach(2) + slack};
  return {otgSub(at, d), otgAdd(at, d)};
}

/// The samples of the cells between two places along one axis; false if there are none. A stretch that holds many cells
/// begins and ends at a multiple of a power of two. So a body that moves has the same ground for a while.
bool cellsBetween(double low, double high, int samples, bool wraps, bool rounded, int& first, int& last) {
  constexpr double kMost = 1 << 29;
  if (!(low > -kMost && high < kMost)) return false;
  if (!wraps && !(high >= 0 && low <= samples - 1)) return false;
  first = static_cast<int>(std::floor(low));
  last = std::max(static_cast<int>(std::ceil(high)), first + 1);
  if (rounded) {
    int step = 1;
    while (8 * step <= last - first) step *= 2;
    const auto floorTo = [step](int n) { return n >= 0 ? n / step * step : -((-n + step - 1) / step * step); };
    first = floorTo(first);
    last = -floorTo(-last);
  }
  if (wraps) return true;
  first = std::clamp(first, 0, samples - 2);
  last = std::clamp(last, first + 1, samples - 1);
  return true;
}

bool samplesWithin(const HeightSamples& samples, const Bounds& bounds, double margin, bool rounded,
                   SampleRange& range) {
  const double dx = samples.columnWidth(), dz = samples.rowDepth();
  return cellsBetween((bounds.low.x - margin + samples.halfWidth()) / dx,
                      (bounds.high.x + margin + samples.halfWidth()) / dx, samples.columns(), samples.wraps(), rounded,
                      range.firstColumn, range.lastColumn) &&
         cellsBetween((bounds.low.z - margin + samples.halfDepth()) / dz,
                      (bounds.high.z + margin + samples.halfDepth()) / dz, samples.rows(), samples.wraps(), rounded,
                      range.firstRow, range.lastRow);
}

constexpr std::size_t kMostSamples = std::size_t{1} << 23;
std::size_t countOf(const SampleRange& range) {
  return static_cast<std::size_t>(range.lastColumn - range.firstColumn + 1) *
         static_cast<std::size_t>(range.lastRow - range.firstRow + 1);
}

/// Where ODE has the lower end of the field: its lowest height or what the program has set, less the thickness.
double bottomOf(dHeightfieldDataID data) {
  const dGeomID probe = dCreateHeightfield(nullptr, data, 0);
  dReal box[6];
  dGeomGetAABB(probe, box);
  dGeomDestroy(probe);
  return static_cast<double>(box[2]);
}

/// The ground that the mesh could touch. A null mesh: nothing is that high. Walls where the field goes on, and the
/// bottom, are so far away that no way out leads through them; for a mesh from below it is the surface that is.
HeightBlockMesh groundUnder(const PrimitiveTask& task, HeightSamples& samples, Vec3d& corner, int& status) {
  const TriMesh& mesh = task.side.mesh->mesh();
  const double radius = static_cast<double>(mesh.radius());
  const Bounds bounds = boundsInField(mesh, task.other);
  SampleRange under, range;
  HeightBlock block;
  if (!samplesWithin(samples, bounds, 0, false, under)) return {};
  if (countOf(under) > kMostSamples) {
    status = dGPUTRIMESH_ERROR_MEMORY;
    return {};
  }
  samples.read(under, block);
  const auto [low, high] = std::minmax_element(block.heights.begin(), block.heights.end());
  const double lowest = *low, highest = *high;
  if (!(bounds.low.y <= highest)) return {};  // or no number at all
  const double deep = highest - bounds.low.y, margin = std::max(0.5 * radius, deep);
  if (!samplesWithin(samples, bounds, margin, true, range)) return {};
  if (countOf(range) > kMostSamples) {
    status = dGPUTRIMESH_ERROR_MEMORY;
    return {};
  }
  samples.read(range, block);
  const double lowestOfBlock = *std::min_element(block.heights.begin(), block.heights.end());
  const double needed = std::max(2 * radius, deep);
  const double step = std::exp2(std::ceil(std::log2(needed)));
  block.bottom = std::floor((std::min(lowestOfBlock, bounds.low.y) - needed) / step) * step;
  if (0.5 * (bounds.low.y + bounds.high.y) < lowest) {
    const double bottom = bottomOf(dGeomHeightfieldGetHeightfieldData(task.o2));
    if (bounds.high.y < bottom) return {};
    if (0.5 * (bounds.low.y + bounds.high.y) < bottom) {
      block.bottom = bottom;
      const double top = std::ceil((highest + needed) / step) * step;
      block.heights.assign(block.heights.size(), top);
    }
  }
  corner = {range.firstColumn * samples.columnWidth() - samples.halfWidth(), 0,
            range.firstRow * samples.rowDepth() - samples.halfDepth()};
  HeightBlockMesh ground = samples.ground(range, std::move(block));
  if (ground.mesh == nullptr) status = dGPUTRIMESH_ERROR_MESH;
  return ground;
}

/// The mesh against the ground under it.
struct GroundQuery {
  std::shared_ptr<const CollisionMesh> mesh;
  Query query;
  Vec3d origin{0, 0, 0};  ///< of the ground's frame in the field's
};

/// False if nothing can touch.
bool prepareQuery(const PrimitiveTask& task, GroundQuery& ground, int& status) {
  const dHeightfieldDataID data = dGeomHeightfieldGetHeightfieldData(task.o2);
  if (data == nullptr) return false;
  const std::shared_ptr<HeightSamples> samples = samplesOf(data);
  if (samples == nullptr) {
    warnOfUnknownHeights(data);
    status = dGPUTRIMESH_ERROR_UNSUPPORTED;
    return false;
  }
  Vec3d corner{0, 0, 0};
  const HeightBlockMesh block = groundUnder(task, *samples, corner, status);
  if (block.mesh == nullptr) return false;
  ground.mesh = block.mesh;
  ground.origin = otgAdd(corner, block.origin);
  ground.query.a = task.side.mesh;
  ground.query.b = ground.mesh.get();
  ground.query.bInA = task.other;
  ground.query.bInA.t = otgTransform(task.other, ground.origin);
  return true;
}

}  // namespace

WorldPose readHeightfieldPose(dGeomID field) noexcept {
  // These take a geom that is not placeable for one at the origin, and are exact: the products are with 0 and 1.
  dVector3 at, axes[3];
  dGeomGetRelPointPos(field, 0, 0, 0, at);
  dGeomVectorToWorld(field, 1, 0, 0, axes[0]);
  dGeomVectorToWorld(field, 0, 1, 0, axes[1]);
  dGeomVectorToWorld(field, 0, 0, 1, axes[2]);
  WorldPose pose{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      pose.transform.r[3 * row + column] = static_cast<double>(axes[column][row]);
    }
  }
  pose.transform.t = {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
  judgePose(pose);
  return pose;
}

std::span<const Contact> heightfieldContacts(const PrimitiveTask& task, int most, Workspace& workspace, int& status) {
  workspace.reduced.clear();
  GroundQuery ground;
  if (!prepareQuery(task, ground, status)) {
    forgetPrimitive(task);
    return {};
  }
  Query& query = ground.query;
  query.options = pairOptions(task.side.object->params, task.side.object->params);
  query.options.maxContacts = most;
  const Vec3f& c = task.side.mesh->mesh().center();
  query.relativeVelocity = relativeVelocity(task, otgTransform(task.pose, Vec3d{c.x, c.y, c.z}));
  PrimitiveHistory history(task, ground.origin);
  query.history = history.get();
  findIntersectingPairs(query, workspace);
  collideIntersecting(query, workspace);
  for (Contact& contact : workspace.reduced) contact.triangleB = kNone;
  history.keep(!workspace.reduced.empty());
  return workspace.reduced;
}

std::vector<std::uint32_t> trianglesOnHeightfield(const PrimitiveTask& task, Workspace& workspace, int& status) {
  GroundQuery ground;
  if (!prepareQuery(task, ground, status)) return {};
  findIntersectingPairs(ground.query, workspace);
  std::vector<std::uint32_t> found;
  for (const TrianglePair& pair : workspace.intersecting) {
    if (found.empty() || found.back() != pair.a) found.push_back(pair.a);
  }
  return found;
}

}  // namespace otg
