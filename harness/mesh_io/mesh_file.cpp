// SPDX-License-Identifier: BSD-3-Clause
// Choosing the reader by content and name, and what the readers share.
#include "mesh_io/mesh_file.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <new>
#include <unordered_map>

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

MeshFile read(const std::string& path, std::string_view bytes) {
  const std::string extension = lowerExtension(path);
  if (extension == ".ply") return readPly(bytes);
  if (extension == ".off") return readOff(bytes);
  if (extension == ".stl") return readStl(bytes);
  if (extension == ".obj") return readObj(bytes);
  if (extension == ".gltf" || extension == ".glb") return readWithAssimp(path);
  if (bytes.substr(0, 4) == "ply\n" || bytes.substr(0, 4) == "ply\r") return readPly(bytes);
  if (bytes.substr(0, 3) == "OFF") return readOff(bytes);
  return readWithAssimp(path);
}

struct PositionHash {
  std::size_t operator()(const std::array<std::uint64_t, 3>& key) const {
    std::uint64_t h = 0;
    for (const std::uint64_t part : key) {
      h = (h ^ part) * 0x9e3779b97f4a7c15u;
      h ^= h >> 32;
    }
    return h;
  }
};

}  // namespace

MeshInput MeshFile::input() const {
  MeshInput result;
  result.vertices = vertices.data();
  result.scalar = MeshInput::Scalar::kDouble;
  result.vertexCount = vertices.size();
  result.indices = triangles.data();
  result.triangleCount = triangles.size();
  return result;
}

void joinEqualVertices(MeshFile& mesh) {
  std::unordered_map<std::array<std::uint64_t, 3>, std::uint32_t, PositionHash> seen;
  seen.reserve(mesh.vertices.size());
  std::vector<std::uint32_t> newIndex(mesh.vertices.size());
  std::vector<Vec3d> kept;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3d& p = mesh.vertices[i];
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x == 0 ? 0.0 : x); };
    const auto [entry, isNew] = seen.try_emplace({bits(p.x), bits(p.y), bits(p.z)}, std::uint32_t(kept.size()));
    if (isNew) kept.push_back(p);
    newIndex[i] = entry->second;
  }
  mesh.vertices = std::move(kept);
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle.v) v = v < newIndex.size() ? newIndex[v] : kNone;
  }
}

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
