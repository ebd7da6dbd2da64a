// SPDX-License-Identifier: BSD-3-Clause
// Two meshes in one frame.
#pragma once

#include <cstdint>

#include "base/vectors.h"
#include "collide/query.h"

namespace otg {

/// Corners of triangles and vertices of both meshes in A's frame.
class PlacedMeshes {
 public:
  explicit PlacedMeshes(const Query& query)
      : query_(query),
        mesh_{&query.a->mesh(), &query.b->mesh()},
        adjacency_{&query.a->adjacency(), &query.b->adjacency()},
        vertices_{mesh_[0]->vertices().data(), mesh_[1]->vertices().data()} {}
  const TriMesh& mesh(int m) const { return *mesh_[m]; }
  /// False for a sheet, whose inside is what lies behind it.
  bool isSolid(int m) const { return mesh_[m]->meshClass() == MeshClass::kSolid; }
  const CollisionMesh& tree(int m) const { return m == 0 ? *query_.a : *query_.b; }
  const Adjacency& adjacency(int m) const { return *adjacency_[m]; }
  Vec3d vertex(int m, std::uint32_t v) const {
    const Vec3f& p = vertices_[m][v];
    const Vec3d x{p.x, p.y, p.z};
    return m == 0 ? x : otgTransform(query_.bInA, x);
  }
  Vec3d normal(int m, std::uint32_t triangle) const {
    const Vec3d& n = adjacency(m).normal[triangle];
    return m == 0 ? n : otgRotate(query_.bInA, n);
  }
  /// A's frame to the frame of mesh m and back.
  Vec3d toLocal(int m, const Vec3d& p) const { return m == 0 ? p : otgRotateBack(query_.bInA, p - query_.bInA.t); }
  Vec3d fromLocal(int m, const Vec3d& p) const { return m == 0 ? p : otgTransform(query_.bInA, p); }
  Vec3d directionToLocal(int m, const Vec3d& d) const { return m == 0 ? d : otgRotateBack(query_.bInA, d); }
  Vec3d directionFromLocal(int m, const Vec3d& d) const { return m == 0 ? d : otgRotate(query_.bInA, d); }
  const Query& query() const { return query_; }

 private:
  const Query& query_;
  const TriMesh* mesh_[2];
  const Adjacency* adjacency_[2];
  const Vec3f* vertices_[2];
};

}  // namespace otg
