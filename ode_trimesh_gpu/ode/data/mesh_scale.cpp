// SPDX-License-Identifier: BSD-3-Clause
// Scaled geoms. What triangles do is decided by vertices in single precision: every stage, and every device, would have
// to round a scaled vertex in the same way. So a scaled mesh has vertices and normals of its own, made once for all
// geoms that have the same data and the same scale. It shares with the data's mesh all that depends on triangles alone,
// and the trees: boxes are scaled while a tree is walked (bvh/box_scale.h).
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/fork_gate.h"
#include "ode/data/mesh_data.h"

namespace otg {
namespace {

Vec3f scaledPoint(const Vec3f& p, const MeshScale& scale) {
  return {p.x * scale[0], p.y * scale[1], p.z * scale[2]};
}

bool mirrors(const MeshScale& scale) {
  return ((scale[0] < 0) != (scale[1] < 0)) != (scale[2] < 0);
}

/// Null if a vertex is no finite float any more. Shares with `from` what does not depend on the places of vertices; a
/// mirrored mesh, which has its triangles in the same order but turned round, with another one of these, if there is.
std::shared_ptr<CollisionMesh> makeScaled(const CollisionMesh& from, const MeshScale& scale,
                                          const CollisionMesh* mirrored) {
  const TriMesh& mesh = from.mesh();
  std::vector<Vec3f> vertices = verticesOfCaller(mesh);
  for (Vec3f& v : vertices) v = scaledPoint(v, scale);
  MeshInput input;
  input.vertices = vertices.data();
  input.vertexCount = vertices.size();
  const MeshResult moved = mirrors(scale) && mirrored != nullptr ? moveVertices(mirrored->mesh(), input)
                                                                 : moveVertices(mesh, input, mirrors(scale));
  return moved.mesh == nullptr ? nullptr
                               : std::make_shared<CollisionMesh>(moved.mesh, from, Vec3f{scale[0], scale[1], scale[2]});
}

std::shared_ptr<CollisionMesh> heldOf(const std::shared_ptr<CollisionMesh>& mesh) {
  return mesh;
}
std::shared_ptr<CollisionMesh> heldOf(const std::weak_ptr<CollisionMesh>& mesh) {
  return mesh.lock();
}

/// Any mesh with mirrored vertices; null if there is none.
template <class Meshes>
std::shared_ptr<CollisionMesh> anyMirrored(const Meshes& meshes) {
  for (const auto& [scale, entry] : meshes) {
    if (!mirrors(scale)) continue;
    if (std::shared_ptr<CollisionMesh> mesh = heldOf(entry)) return mesh;
  }
  return nullptr;
}

/// Moves of several meshes, undone together unless they are finished.
class MovesTogether {
 public:
  MovesTogether() = default;
  ~MovesTogether() {
    for (CollisionMesh* const mesh : begun_) mesh->undoMove();
  }
  MovesTogether(const MovesTogether&) = delete;
  MovesTogether& operator=(const MovesTogether&) = delete;
  /// CollisionMesh::beginMove().
  bool begin(CollisionMesh& mesh, std::span<const MovedVertex> moved, long images) {
    begun_.reserve(begun_.size() + 1);
    if (!mesh.beginMove(moved, images)) return false;
    begun_.push_back(&mesh);
    return true;
  }
  /// Of an image of a mesh that has begun.
  bool beginImage(CollisionMesh& image, const CollisionMesh& of, std::span<const MovedVertex> moved) {
    if (image.boxScale() == nullptr) return begin(image, moved, 0);
    begun_.reserve(begun_.size() + 1);
    if (!image.followMove(of, moved)) return false;
    begun_.push_back(&image);
    return true;
  }
  void finish() noexcept {
    for (CollisionMesh* const mesh : begun_) mesh->finishMove();
    begun_.clear();
  }

 private:
  std::vector<CollisionMesh*> begun_;
};

}  // namespace

}  // namespace otg

std::shared_ptr<otg::CollisionMesh> dxGpuTriMeshData::scaledMesh(const otg::MeshScale& scale) {
  const otg::CallLock lock(scaledMutex_);
  std::weak_ptr<otg::CollisionMesh>& known = scaled_[scale];
  std::shared_ptr<otg::CollisionMesh> mesh = known.lock();
  if (mesh == nullptr) {
    mesh = otg::makeScaled(*mesh_, scale, otg::anyMirrored(scaled_).get());
    known = mesh;
  }
  std::erase_if(scaled_, [](const auto& entry) { return entry.second.expired(); });
  return mesh;
}

dxGpuTriMeshData::ScalesInUse dxGpuTriMeshData::scalesInUse() const {
  ScalesInUse scales;
  const otg::CallLock lock(mutex_);
  for (const auto& [serial, user] : users_) {
    if (user.geom == nullptr || otg::isOne(user.scaled->scale)) continue;
    ScaleInUse& scale = scales[user.scaled->scale];
    scale.mesh = user.scaled->scaled;
    ++scale.geoms;
  }
  return scales;
}

dxGpuTriMeshData::ScaledMeshes dxGpuTriMeshData::scaledFrom(const otg::CollisionMesh& mesh) const {
  ScaledMeshes made;
  for (const auto& [scale, now] : scalesInUse()) {
    made.add(scale, otg::makeScaled(mesh, scale, otg::anyMirrored(made.meshes).get()));
  }
  return made;
}

bool dxGpuTriMeshData::moveInPlace(const std::vector<PlacedVertex>& placed) {
  // See CollisionMesh::beginMove() for the copy.
  { const std::shared_ptr<const otg::CollisionMesh> ordered = mesh_; }
  if (mesh_.use_count() != 1) return false;
  std::vector<otg::MovedVertex> moved;
  /// Whether all places are finite numbers at a scale; `moved` then has those of a mesh with that scale, whose vertices
  /// have the same numbers.
  const auto takeMoves = [&](const otg::MeshScale& scale) {
    moved.clear();
    moved.reserve(placed.size());
    for (const PlacedVertex& p : placed) {
      const std::uint32_t own = mesh_->ownVertex(p.vertex);
      const otg::Vec3f to = otg::scaledPoint(p.to, scale);
      if (!(std::isfinite(to.x) && std::isfinite(to.y) && std::isfinite(to.z))) return false;
      if (own != otg::kNone) moved.push_back({own, to});
    }
    return true;
  };
  const ScalesInUse scales = scalesInUse();
  // No one but the geoms may hold an image: a batch in the background goes on with the mesh that it was given.
  const auto isAlone = [](const ScaleInUse& now) {
    { const std::shared_ptr<const otg::CollisionMesh> ordered = now.mesh; }
    return now.mesh != nullptr && now.mesh.use_count() == now.geoms + 1;
  };
  long images = 0;
  for (const auto& [scale, now] : scales) images += isAlone(now) && now.mesh->boxScale() != nullptr ? 1 : 0;
  otg::MovesTogether moves;
  takeMoves({1, 1, 1});
  if (!moves.begin(*mesh_, moved, images)) return false;
  otg::ValidationReport report = mesh_->mesh().report();
  ScaledMeshes next;
  for (const auto& [scale, now] : scales) {
    const bool inPlace = isAlone(now) && takeMoves(scale) && moves.beginImage(*now.mesh, *mesh_, moved);
    next.add(scale, inPlace ? now.mesh : otg::makeScaled(*mesh_, scale, otg::anyMirrored(next.meshes).get()));
  }
  moves.finish();
  commit(std::move(report), std::move(next));
  return true;
}
