// SPDX-License-Identifier: BSD-3-Clause
// Everything that Assimp knows, glTF first of all: all meshes of the scene in one, each placed by its nodes.
#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <memory>
#include <string_view>

#include "mesh_io/readers.h"

namespace otg::mesh_io {
namespace {

void addNode(const aiScene& scene, const aiNode& node, const aiMatrix4x4t<double>& parent, MeshFile& mesh) {
  const aiMatrix4x4& m = node.mTransformation;
  const aiMatrix4x4t<double> local(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
                                   m.d3, m.d4);
  const aiMatrix4x4t<double> world = parent * local;
  // A mirroring node turns the winding round. One that is scaled to nothing shows nothing (contacts in files of `otg
  // simulate --glb`).
  const double determinant = aiMatrix3x3t<double>(world).Determinant();
  const bool mirrored = determinant < 0;
  for (unsigned i = 0; determinant != 0 && i < node.mNumMeshes; ++i) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[i]];
    if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;  // points and lines have no surface
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3t<double> p =
          world * aiVector3t<double>(part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z);
      mesh.vertices.push_back({p.x, p.y, p.z});
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;
      const unsigned second = mirrored ? 2 : 1, third = mirrored ? 1 : 2;
      mesh.triangles.push_back({{base + face.mIndices[0], base + face.mIndices[second], base + face.mIndices[third]}});
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) addNode(scene, *node.mChildren[i], world, mesh);
}

/// By its content a file of another name might pass for glTF, and nothing would have checked it.
void dropGltf(Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    const std::string_view extensions = importer.GetImporterInfo(i)->mFileExtensions;
    if (extensions.find("gltf") == std::string_view::npos) continue;
    const std::unique_ptr<Assimp::BaseImporter> dropped(importer.GetImporter(i));
    importer.UnregisterLoader(dropped.get());
  }
}

}  // namespace

MeshFile readWithAssimp(const std::string& path) {
  Assimp::Importer importer;
  if (!isGltf(path)) dropGltf(importer);
  // Triangulation only: every other step may drop, merge or reorder.
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) throw std::runtime_error(importer.GetErrorString());
  MeshFile mesh;
  addNode(*scene, *scene->mRootNode, aiMatrix4x4t<double>(), mesh);
  if (mesh.triangles.empty()) throw std::runtime_error("the file holds no triangles");
  joinEqualVertices(mesh);
  return mesh;
}

}  // namespace otg::mesh_io
