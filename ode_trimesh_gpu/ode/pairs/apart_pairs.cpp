// SPDX-License-Identifier: BSD-3-Clause
#include "ode/pairs/apart_pairs.h"

#include "collide/boxes_apart.h"
#include "collide/pair_history.h"
#include "ode/pairs/prefetched_pairs.h"

namespace otg {
namespace {

bool isPairwiseGeom(const GeomObject& object) {
  return object.params.contact_model == dGPUTRIMESH_CONTACTS_PAIRWISE;
}

}  // namespace

bool comesToNothing(const MeshGeom& side1, const MeshGeom& side2, PairPoses& poses) {
  GeomObject &first = *side1.object, &second = *side2.object;
  if (side1.mesh == nullptr || side2.mesh == nullptr || !poses.first.rigid || !poses.second.rigid) return false;
  const TriMesh &mesh1 = side1.mesh->mesh(), &mesh2 = side2.mesh->mesh();
  if (mesh1.triangleCount() == 0 || mesh2.triangleCount() == 0) return false;
  if (first.joined.join != nullptr || second.joined.join != nullptr) return false;
  const bool areInOrder = first.serial < second.serial;
  const GeomObject& older = areInOrder ? first : second;
  GeomObject& younger = areInOrder ? second : first;
  // What was computed ahead is counted where it is found.
  const PrefetchedPairs* const ready = younger.prefetched.get();
  if (ready != nullptr && !ready->empty()) return false;
  const Transformd between = relativePose(poses.first.transform, poses.second.transform);
  const bool asksNoMore = (isSolid(mesh1) && isSolid(mesh2)) || isPairwiseGeom(first) || isPairwiseGeom(second);
  const double defect = poses.first.defect + poses.second.defect * (1 + poses.first.defect);
  const auto isFar = [&] { return isFarApart(*side1.mesh, *side2.mesh, between); };
  if (!asksNoMore) return isFar();
  // A query that finds nothing may still end what is remembered.
  if (areBoxesApart(mesh1, mesh2, between, defect)) return younger.memory.stampOf(older.serial) == 0 || isFar();
  constexpr double kOrdinary = 1e18;  // balls that are not apart, of bodies that single precision holds
  poses.areNear = static_cast<double>(mesh1.radius()) + static_cast<double>(mesh2.radius()) < kOrdinary;
  return false;
}

}  // namespace otg
