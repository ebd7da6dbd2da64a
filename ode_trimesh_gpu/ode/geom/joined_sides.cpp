// SPDX-License-Identifier: BSD-3-Clause
#include "ode/geom/joined_sides.h"

#include <array>
#include <bit>

#include "base/vectors.h"

namespace otg {
namespace {

bool isSame(const Transformd& x, const Transformd& y) {
  using Bits = std::array<std::uint64_t, 12>;
  return std::bit_cast<Bits>(x) == std::bit_cast<Bits>(y);
}

/// From b's frame to a's. Exactly nothing for equal poses, whose matrices may be no perfect rotations.
Transformd between(const Transformd& a, const Transformd& b) {
  Transformd out{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  if (isSame(a, b)) return out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out.r[3 * i + j] = a.r[i] * b.r[j] + a.r[3 + i] * b.r[3 + j] + a.r[6 + i] * b.r[6 + j];
    }
  }
  out.t = otgRotateBack(a, otgSub(b.t, a.t));
  return out;
}

/// The joins of these geoms, in the frame of the first one's pose.
std::shared_ptr<MeshJoin> makeJoin(JoinedMesh&& joined, std::span<const JoinPart> given,
                                   std::span<const WorldPose> poses) {
  auto join = std::make_shared<MeshJoin>();
  join->mesh = std::move(joined.mesh);
  join->pose = poses[0].transform;
  join->sourceOf = std::move(joined.sourceOf);
  std::vector<std::uint32_t> numberOf(given.size(), kNone);
  for (const std::uint32_t p : joined.parts) {
    numberOf[p] = static_cast<std::uint32_t>(join->parts.size());
    constexpr double kFar = 1e300;
    join->parts.push_back({poses[p].transform,
                           between(poses[p].transform, join->pose),
                           {kFar, kFar, kFar},
                           {-kFar, -kFar, -kFar},
                           given[p].mesh->lifetime()});
  }
  const TriMesh& mesh = join->mesh->mesh();
  for (std::uint32_t i = 0; i < join->sourceOf.size(); ++i) {
    JoinedMesh::Source& source = join->sourceOf[i];
    source.part = numberOf[source.part];
    MeshJoin::Part& part = join->parts[source.part];
    for (const std::uint32_t v : mesh.triangles()[mesh.triangleOfCaller(i)].v) {
      const Vec3f& p = mesh.vertices()[v];
      part.low = minimum(part.low, {p.x, p.y, p.z});
      part.high = maximum(part.high, {p.x, p.y, p.z});
    }
  }
  return join;
}

}  // namespace

int joinGeoms(std::span<MeshGeom> geoms, std::span<const WorldPose> poses) {
  std::vector<JoinPart> given;
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    given.push_back({geoms[i].mesh, between(poses[0].transform, poses[i].transform)});
  }
  std::vector<std::shared_ptr<MeshJoin>> joins;
  std::vector<JoinedMesh> joined = joinMeshes(given);
  std::vector<JoinedPart> partOf(geoms.size());
  int count = 0;
  for (JoinedMesh& one : joined) {
    const std::vector<std::uint32_t> parts = one.parts;
    const std::shared_ptr<MeshJoin> join = makeJoin(std::move(one), given, poses);
    for (std::uint32_t k = 0; k < parts.size(); ++k, ++count) partOf[parts[k]] = {join, k};
  }
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    geoms[i].object->joined.leave();
    geoms[i].object->joined = std::move(partOf[i]);
  }
  return count;
}

void enterJoin(MeshGeom& side, WorldPose& pose) {
  const JoinedPart& joined = side.object->joined;
  if (joined.join == nullptr || joined.join->isBroken || side.mesh == nullptr || hasLastTransform(side)) return;
  const MeshJoin::Part& part = joined.join->parts[joined.part];
  const std::weak_ptr<const void> now = side.mesh->lifetime();
  if (now.owner_before(part.lifetime) || part.lifetime.owner_before(now)) {
    joined.join->isBroken = true;
    return;
  }
  side.join = joined.join;
  side.part = joined.part;
  side.mesh = side.join->mesh.get();
  // The very same for all pieces as long as they stay where they are.
  pose.transform = isSame(pose.transform, part.pose) ? side.join->pose : composed(pose.transform, part.toPart);
}

bool keepOwn(const MeshGeom& side, int sideOf, const Transformd& frame, const Transformd& at, const WorldBox& other,
             std::vector<Contact>& contacts) {
  if (side.join == nullptr) return false;
  const std::size_t before = contacts.size();
  std::erase_if(contacts, [&](Contact& c) {
    std::uint32_t& triangle = sideOf == 0 ? c.triangleA : c.triangleB;
    if (side.join->ownerOf(triangle, at, otgTransform(frame, c.position), other) != side.part) return true;
    triangle = side.join->sourceOf[triangle].triangle;
    return false;
  });
  return contacts.size() != before;
}

}  // namespace otg
