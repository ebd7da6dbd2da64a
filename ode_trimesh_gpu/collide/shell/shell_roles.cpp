// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shell/shell_roles.h"

#include <algorithm>
#include <array>

#include "base/vectors.h"
#include "collide/pair_history.h"
#include "collide/shell/ground_sides.h"

namespace otg {
namespace {

constexpr float kTerrain = 4;  ///< radii of the visitor

GroundKind kindOf(const TriMesh& mesh) {
  if (mesh.meshClass() == MeshClass::kSolid) return GroundKind::kSolid;
  return isSheet(mesh) ? GroundKind::kSheet : GroundKind::kShell;
}

/// Whether a sheet of several pieces has them face all ways: what is behind one may be in front of another one.
bool isScattered(const CollisionMesh& sheet) {
  return sheet.mesh().topology().componentCount() > 1 && !facesOneWay(sheet);
}

/// Whether the visitor's middle is behind all triangles of a piece that it touches.
bool touchesBack(const ShellRoles& roles, std::span<const TrianglePair> meeting) {
  constexpr std::size_t kMost = 32;  // of many pieces some are touched from behind
  struct Piece {
    std::uint32_t component;
    bool isInFront;
  };
  std::array<Piece, kMost> pieces;
  std::size_t count = 0;
  const Topology& topology = roles.ground->mesh().topology();
  const std::vector<Vec3d>& normals = roles.ground->adjacency().normal;
  const Vec3d middle = roles.middle();
  for (const TrianglePair& pair : meeting) {
    const std::uint32_t triangle = roles.groundIsA ? pair.a : pair.b;
    const Vec3f& corner = roles.ground->mesh().vertices()[roles.ground->mesh().triangles()[triangle].v[0]];
    const auto end = pieces.begin() + static_cast<std::ptrdiff_t>(count);
    auto piece = std::find_if(pieces.begin(), end,
                              [&](const Piece& p) { return p.component == topology.componentOf[triangle]; });
    if (piece == end) {
      if (count == kMost) return true;
      *piece = {topology.componentOf[triangle], false};
      ++count;
    }
    const Vec3d off = otgSub(middle, Vec3d{corner.x, corner.y, corner.z});
    piece->isInFront = piece->isInFront || otgDot(normals[triangle], off) > 0;
  }
  return !std::all_of(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(count),
                      [](const Piece& p) { return p.isInFront; });
}

/// Whether a ground would be a solid but for faults, and the visitor is outside of it, or was when the pair was first
/// seen. One inside may be meant to be.
bool isNearlySolid(const Query& query, const CollisionMesh& ground, const Vec3d& middle) {
  if (ground.outwardSides().empty()) return false;
  const SolidHistory::State before = stateBefore(query);
  const Vec3d& from = before.side != 0 ? before.front : middle;
  const Vec3f& center = ground.mesh().center();
  const double reach = 4 * static_cast<double>(ground.mesh().radius());
  const Vec3d far = otgAdd(Vec3d{center.x, center.y, center.z}, Vec3d{0.37 * reach, 0.29 * reach, 0.88 * reach});
  std::vector<double> crossings;
  return !crossesOddly(ground, from, far, 0, crossings);
}

}  // namespace

bool facesOneWay(const CollisionMesh& sheet) {
  constexpr double kOneWay = 0.7;  // of all areas
  constexpr std::size_t kMost = 64;
  const Adjacency& adjacency = sheet.adjacency();
  const Topology& topology = sheet.mesh().topology();
  Vec3d sum{0, 0, 0};
  double area = 0;
  const std::size_t count = adjacency.clusters.size() - 1;  // the last ends the others
  for (std::size_t i = 0; i < count; i += count / kMost + 1) {
    const std::uint32_t vertex = adjacency.clusterVertices[adjacency.clusters[i].first];
    const std::uint32_t component = topology.componentOf[adjacency.halfEdges[adjacency.first[vertex]] / 3];
    if (topology.componentClosed[component] != 0) continue;
    sum = otgAdd(sum, adjacency.clusters[i].sum.vector);
    area += adjacency.clusters[i].sum.area;
  }
  return otgDot(sum, sum) >= kOneWay * kOneWay * area * area;
}

bool isGround(const TriMesh& a, const TriMesh& b) {
  if (a.radius() != b.radius()) return a.radius() > b.radius();
  if (kindOf(a) != kindOf(b)) return kindOf(a) < kindOf(b);
  return a.triangleCount() >= b.triangleCount();
}

bool areShells(const TriMesh& a, const TriMesh& b) {
  if (isSolid(a) && isSolid(b)) return false;
  return !isSolid(isGround(a, b) ? b : a) || !haveSolidContacts(a, b);
}

namespace {

/// Whether contacts of shells need no look at what meets. Of two solids never.
bool areAlwaysShells(const Query& query) {
  return areShells(query.a->mesh(), query.b->mesh()) || stateBefore(query).side < 0;
}

bool hasNoShells(const Query& query) {
  return query.options.contacts != ContactModel::kSolid || (isSolid(query.a->mesh()) && isSolid(query.b->mesh()));
}

}  // namespace

bool mayBeShells(const Query& query) {
  return !hasNoShells(query) && (areAlwaysShells(query) || isSolidOnPieces(query));
}

bool areShells(const Query& query, std::span<const TrianglePair> meeting) {
  if (hasNoShells(query)) return false;
  if (areAlwaysShells(query)) return true;
  return isSolidOnPieces(query) && (meeting.empty() || touchesBack(shellRoles(query), meeting));
}

bool isSolidOnPieces(const Query& query) {
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  if (isSolid(a) == isSolid(b) || areShells(a, b)) return false;
  return isScattered(isGround(a, b) ? *query.a : *query.b);
}

ShellRoles shellRoles(const Query& query) {
  ShellRoles roles;
  roles.groundIsA = isGround(query.a->mesh(), query.b->mesh());
  roles.ground = roles.groundIsA ? query.a : query.b;
  roles.visitor = roles.groundIsA ? query.b : query.a;
  roles.visitorInGround = roles.groundIsA ? query.bInA : inverseOf(query.bInA);
  roles.kind = kindOf(roles.ground->mesh());
  roles.isScattered = roles.kind == GroundKind::kSheet && isScattered(*roles.ground);
  if (roles.isScattered) roles.kind = GroundKind::kShell;
  if (roles.visitor->mesh().meshClass() != MeshClass::kSolid && isNearlySolid(query, *roles.ground, roles.middle())) {
    roles.kind = GroundKind::kSolid;
    roles.isScattered = false;
  }
  roles.size = static_cast<double>(roles.visitor->mesh().radius());
  roles.isTerrain = roles.ground->mesh().radius() >= kTerrain * roles.visitor->mesh().radius();
  return roles;
}

}  // namespace otg
