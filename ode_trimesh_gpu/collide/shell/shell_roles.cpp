// SPDX-License-Identifier: BSD-3-Clause
#include "collide/shell/shell_roles.h"

#include "collide/pair_history.h"

namespace otg {
namespace {

constexpr float kTerrain = 4;  ///< radii of the visitor

GroundKind kindOf(const TriMesh& mesh) {
  if (mesh.meshClass() == MeshClass::kSolid) return GroundKind::kSolid;
  return isSheet(mesh) ? GroundKind::kSheet : GroundKind::kShell;
}

/// Whether a sheet of several pieces has them face all ways: what is behind one may be in front of another one. By some
/// of its clusters, because each query needs it.
bool isScattered(const CollisionMesh& sheet) {
  constexpr double kOneWay = 0.7;  // of all areas, what faces one way
  if (sheet.mesh().topology().componentCount() < 2) return false;
  Vec3d sum{0, 0, 0};
  double area = 0;
  const std::vector<Adjacency::Cluster>& clusters = sheet.adjacency().clusters;
  const std::size_t step = clusters.size() / 256 + 1;
  for (std::size_t i = 0; i + 1 < clusters.size(); i += step) {  // the last ends the others
    sum = otgAdd(sum, clusters[i].sum.vector);
    area += clusters[i].sum.area;
  }
  return otgDot(sum, sum) < kOneWay * kOneWay * area * area;
}

Transformd inverse(const Transformd& m) {
  Transformd out{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.r[3 * i + j] = m.r[3 * j + i];
  }
  out.t = otgScale(otgRotateBack(m, m.t), -1.0);
  return out;
}

}  // namespace

bool isGround(const TriMesh& a, const TriMesh& b) {
  if (a.radius() != b.radius()) return a.radius() > b.radius();
  if (kindOf(a) != kindOf(b)) return kindOf(a) < kindOf(b);
  return a.triangleCount() >= b.triangleCount();
}

bool areShells(const TriMesh& a, const TriMesh& b) {
  if (a.meshClass() == MeshClass::kSolid && b.meshClass() == MeshClass::kSolid) return false;
  const TriMesh& visitor = isGround(a, b) ? b : a;
  return visitor.meshClass() != MeshClass::kSolid || !haveSolidContacts(a, b);
}

bool areShells(const Query& query) {
  if (query.options.contacts != ContactModel::kSolid) return false;
  const TriMesh &a = query.a->mesh(), &b = query.b->mesh();
  if (a.meshClass() == MeshClass::kSolid && b.meshClass() == MeshClass::kSolid) return false;
  return areShells(a, b) || stateBefore(query).side < 0;
}

ShellRoles shellRoles(const Query& query) {
  ShellRoles roles;
  roles.groundIsA = isGround(query.a->mesh(), query.b->mesh());
  roles.ground = roles.groundIsA ? query.a : query.b;
  roles.visitor = roles.groundIsA ? query.b : query.a;
  roles.visitorInGround = roles.groundIsA ? query.bInA : inverse(query.bInA);
  roles.kind = kindOf(roles.ground->mesh());
  // A solid's pair with a sheet is that of two solids where it can be, which go by the winding.
  const bool isSolidVisitor = roles.visitor->mesh().meshClass() == MeshClass::kSolid;
  roles.isScattered = roles.kind == GroundKind::kSheet && !isSolidVisitor && isScattered(*roles.ground);
  if (roles.isScattered) roles.kind = GroundKind::kShell;
  roles.size = static_cast<double>(roles.visitor->mesh().radius());
  roles.isTerrain = roles.ground->mesh().radius() >= kTerrain * roles.visitor->mesh().radius();
  return roles;
}

}  // namespace otg
