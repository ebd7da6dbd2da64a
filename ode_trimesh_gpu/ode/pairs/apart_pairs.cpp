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

GeomObject& youngerOf(GeomObject& x, GeomObject& y) {
  return x.serial < y.serial ? y : x;
}

}  // namespace

Nearness nearnessOf(const MeshGeom& side1, const MeshGeom& side2, PairPoses& poses) {
  GeomObject &first = *side1.object, &second = *side2.object;
  if (side1.mesh == nullptr || side2.mesh == nullptr || !poses.first.rigid || !poses.second.rigid) {
    return Nearness::kMayMeet;
  }
  const TriMesh &mesh1 = side1.mesh->mesh(), &mesh2 = side2.mesh->mesh();
  if (mesh1.triangleCount() == 0 || mesh2.triangleCount() == 0) return Nearness::kMayMeet;
  if (first.joined.join != nullptr || second.joined.join != nullptr) return Nearness::kMayMeet;
  // What was computed ahead is counted where it is found.
  const PrefetchedPairs* const ready = youngerOf(first, second).prefetched.get();
  if (ready != nullptr && !ready->empty()) return Nearness::kMayMeet;
  const Transformd between = relativePose(poses.first.transform, poses.second.transform);
  const bool asksNoMore = (isSolid(mesh1) && isSolid(mesh2)) || isPairwiseGeom(first) || isPairwiseGeom(second);
  const double defect = poses.first.defect + poses.second.defect * (1 + poses.first.defect);
  const auto isFar = [&] { return isFarApart(*side1.mesh, *side2.mesh, between); };
  if (!asksNoMore) return isFar() ? Nearness::kFar : Nearness::kMayMeet;
  if (areBoxesApart(mesh1, mesh2, between, defect)) return isFar() ? Nearness::kFar : Nearness::kApart;
  constexpr double kOrdinary = 1e18;  // balls that are not apart, of bodies that single precision holds
  poses.areNear = static_cast<double>(mesh1.radius()) + static_cast<double>(mesh2.radius()) < kOrdinary;
  return Nearness::kMayMeet;
}

void endApart(const MeshGeom& side1, const MeshGeom& side2) {
  GeomObject& younger = youngerOf(*side1.object, *side2.object);
  const GeomObject& older = &younger == side1.object ? *side2.object : *side1.object;
  younger.memory.forget(older.serial);
}

}  // namespace otg
