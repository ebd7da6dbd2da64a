// SPDX-License-Identifier: BSD-3-Clause
// The C API of cooked meshes, and their files.
#include "ode_trimesh_gpu/cook.h"

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "bvh/cooked_mesh.h"
#include "ode/base/status.h"
#include "ode/data/mesh_data.h"

namespace otg {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// Null if there is no such file; errno says why.
File openFile(const char* path, std::uint64_t& size) {
  std::error_code error;
  size = std::filesystem::file_size(path, error);  // says no to folders, which fopen does not
  if (error) errno = error.value();
  return File(error ? nullptr : std::fopen(path, "rb"));
}

bool writeFile(const std::string& path, const std::vector<unsigned char>& bytes) {
  File file(std::fopen(path.c_str(), "wb"));
  if (file == nullptr) return false;
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  return std::fclose(file.release()) == 0 && written;
}

/// Calls with(mesh) while no one changes it. Returns a status.
template <class With>
int withMesh(dGpuTriMeshDataID g, const With& with) {
  if (!dxGpuTriMeshData::isLive(g)) return dGPUTRIMESH_ERROR_ARGUMENT;
  const UseHold use(&g->uses);
  if (!use.good()) return dGPUTRIMESH_ERROR_BUSY;
  return g->mesh() == nullptr ? static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT) : with(*g->mesh());
}

}  // namespace
}  // namespace otg

dsizeint dGpuTriMeshDataCook(dGpuTriMeshDataID g, void* buffer, dsizeint capacity) {
  dsizeint size = 0;
  otg::guarded([&] {
    if (buffer == nullptr && capacity > 0) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    return otg::withMesh(g, [&](const otg::CollisionMesh& mesh) {
      const std::vector<unsigned char> bytes = otg::cookMesh(mesh);
      size = bytes.size();
      if (buffer != nullptr && size <= capacity) std::memcpy(buffer, bytes.data(), size);
      return static_cast<int>(dGPUTRIMESH_OK);
    });
  });
  return size;
}

int dGpuTriMeshDataUncook(dGpuTriMeshDataID g, const void* buffer, dsizeint size) {
  return otg::guarded([&] {
    if (!dxGpuTriMeshData::isLive(g) || buffer == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    otg::UncookedMesh uncooked = otg::uncookMesh({static_cast<const unsigned char*>(buffer), size});
    return g->take(std::move(uncooked.mesh), std::move(uncooked.error));
  });
}

int dGpuTriMeshDataSave(dGpuTriMeshDataID g, const char* path) {
  return otg::guarded([&] {
    if (path == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    std::vector<unsigned char> bytes;
    const int status = otg::withMesh(g, [&](const otg::CollisionMesh& mesh) {
      bytes = otg::cookMesh(mesh);
      return static_cast<int>(dGPUTRIMESH_OK);
    });
    if (status != dGPUTRIMESH_OK) return status;
    const std::string partial = std::string(path) + ".partial";
    if (!otg::writeFile(partial, bytes)) {
      std::remove(partial.c_str());
      return static_cast<int>(dGPUTRIMESH_ERROR_FILE);
    }
    return static_cast<int>(std::rename(partial.c_str(), path) == 0 ? dGPUTRIMESH_OK : dGPUTRIMESH_ERROR_FILE);
  });
}

int dGpuTriMeshDataLoad(dGpuTriMeshDataID g, const char* path) {
  return otg::guarded([&] {
    if (!dxGpuTriMeshData::isLive(g) || path == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_ARGUMENT);
    std::uint64_t size = 0;
    const otg::File file = otg::openFile(path, size);
    if (file == nullptr) return static_cast<int>(dGPUTRIMESH_ERROR_FILE);
    otg::UncookedMesh uncooked = otg::uncookFile(file.get(), size);
    if (std::ferror(file.get()) != 0) return static_cast<int>(dGPUTRIMESH_ERROR_FILE);
    return g->take(std::move(uncooked.mesh), std::move(uncooked.error));
  });
}
