// SPDX-License-Identifier: BSD-3-Clause
// Choosing the reader by content and name.
#include "mesh_io/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <new>

#include "bvh/cooked_mesh.h"
#include "mesh_io/gltf_check.h"
#include "mesh_io/readers.h"
#include "mesh_io/text.h"

namespace otg::mesh_io {
namespace {

std::string readFile(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (error || !std::filesystem::exists(status)) throw LoadError(path + ": no such file");
  if (std::filesystem::is_directory(status)) throw LoadError(path + ": is a folder");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw LoadError(path + ": cannot be opened");
  std::string bytes;
  if (std::filesystem::is_regular_file(status)) bytes.reserve(std::filesystem::file_size(path, error));
  bytes.assign(std::istreambuf_iterator<char>(stream), {});
  if (stream.bad()) throw LoadError(path + ": reading failed");
  return bytes;
}

std::string lowerExtension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

bool isGltf(const std::string& path) {
  const std::string extension = lowerExtension(path);
  return extension == ".gltf" || extension == ".glb";
}

namespace {

/// The mesh of a cooked one, its vertices and triangles in the order in which they were given. Its tree is not taken
/// along.
MeshFile readCooked(std::string_view bytes) {
  const UncookedMesh cooked = uncookMesh({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
  if (!cooked.mesh) throw std::runtime_error(cooked.error);
  const TriMesh& mesh = cooked.mesh->mesh();
  // Where repair merged vertices, their numbers are not those of this mesh.
  const bool isOrdered = mesh.inputVertexCount() == mesh.vertices().size();
  const auto numberOf = [&](std::uint32_t v) { return isOrdered ? mesh.callerVertex(v) : v; };
  MeshFile file;
  file.vertices.resize(mesh.vertices().size());
  for (std::uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    const Vec3f p = mesh.vertices()[v];
    file.vertices[numberOf(v)] = {p.x, p.y, p.z};
  }
  file.triangles.resize(mesh.triangleCount());
  for (std::uint32_t t = 0; t < mesh.triangleCount(); ++t) {
    const Triangle& own = mesh.triangles()[t];
    file.triangles[mesh.callerTriangle(t)] = {{numberOf(own.v[0]), numberOf(own.v[1]), numberOf(own.v[2])}};
  }
  return file;
}

MeshFile read(const std::string& path, std::string_view bytes) {
  const std::string extension = lowerExtension(path);
  if (extension == ".ply") return readPly(bytes);
  if (extension == ".off") return readOff(bytes);
  if (extension == ".stl") return readStl(bytes);
  if (extension == ".obj") return readObj(bytes);
  if (isGltf(path)) {
    checkGltf(bytes, std::filesystem::path(path).parent_path().string());
    return readWithAssimp(path);
  }
  if (bytes.substr(0, 7) == "OTGMESH") return readCooked(bytes);
  if (bytes.substr(0, 4) == "ply\n" || bytes.substr(0, 4) == "ply\r") return readPly(bytes);
  if (bytes.substr(0, 3) == "OFF") return readOff(bytes);
  return readWithAssimp(path);
}

}  // namespace

MeshFile loadMeshFile(const std::string& path) {
  const std::string bytes = readFile(path);
  if (bytes.empty()) throw LoadError(path + ": the file is empty");
  try {
    return read(path, bytes);
  } catch (const std::bad_alloc&) {
    throw LoadError(path + ": not enough memory");
  } catch (const std::runtime_error& error) {
    throw LoadError(path + ": " + error.what());
  }
}

std::shared_ptr<const TriMesh> loadTriMesh(const std::string& path, const RepairOptions& repair, MeshOrder order) {
  const MeshFile file = loadMeshFile(path);
  MeshResult result = buildTriMesh(file.input(), repair, order);
  if (!result.mesh) throw LoadError(path + ": " + result.report.error);
  return result.mesh;
}

}  // namespace otg::mesh_io
