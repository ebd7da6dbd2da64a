// SPDX-License-Identifier: BSD-3-Clause
// Who is the ground and who the visitor, where one of two meshes is a shell: neither closed nor a solid.
#pragma once

#include <span>

#include "collide/query.h"

namespace otg {

/// What determines the front of the ground: its own winding for a solid, its winding and the side of the visitor for a
/// sheet. For all others it is a point of space in front. A ground that would be a solid but for a few faults
/// (mesh/outward_sides.h) counts as one for visitors outside that are no solids.
enum class GroundKind { kSolid, kSheet, kShell };

struct ShellRoles {
  const CollisionMesh* ground = nullptr;
  const CollisionMesh* visitor = nullptr;
  bool groundIsA = true;
  GroundKind kind = GroundKind::kSolid;
  bool isScattered = false;    ///< the ground is a sheet of pieces that face all ways, and counts as a shell
  bool isTerrain = false;      ///< the ground is at least four times as large as the visitor
  Transformd visitorInGround;  ///< takes the visitor's points to the ground's frame
  double size = 0;             ///< the visitor's radius

  /// A vertex of the visitor in the ground's frame.
  Vec3d vertex(std::uint32_t v) const {
    const Vec3f& p = visitor->mesh().vertices()[v];
    return otgTransform(visitorInGround, Vec3d{p.x, p.y, p.z});
  }
  /// The middle of the visitor's bounds in the ground's frame.
  Vec3d middle() const {
    const Vec3f& c = visitor->mesh().center();
    return otgTransform(visitorInGround, Vec3d{c.x, c.y, c.z});
  }
};

/// Whether most of a sheet faces one way, by some of its clusters, because each query needs it. Closed components have
/// an outside of their own, and do not count.
bool facesOneWay(const CollisionMesh& sheet);

/// The larger mesh is the ground. Of two that are equally large a solid, then a sheet, then the one with more
/// triangles, then A.
bool isGround(const TriMesh& a, const TriMesh& b);

/// Whether such a pair gets contacts of shells from the start: the visitor is no solid, or the two have no contacts
/// of solids at all. Of the rest a pair of a solid and a sheet gets them where the solid touches the sheet's rim.
bool areShells(const TriMesh& a, const TriMesh& b);
/// A solid on a sheet of pieces that face all ways: what is behind one may be in front of another one.
bool isSolidOnPieces(const Query& query);
/// Whether the query may get contacts of shells from the start: areShells(), a solid on pieces, or one that has come to
/// a sheet from behind (sideBehind()).
bool mayBeShells(const Query& query);
/// Whether it does, given the pairs of triangles that intersect. A solid on pieces does not where it touches them from
/// the front alone.
bool areShells(const Query& query, std::span<const TrianglePair> meeting);

ShellRoles shellRoles(const Query& query);

}  // namespace otg
