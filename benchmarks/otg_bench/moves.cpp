// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/moves.h"

#include <algorithm>

#include "cli/query_options.h"
#include "dispatch/dispatcher.h"
#include "otg_bench/geoms.h"
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

/// A mesh on the device, and a small box at its first vertex, so that a query has little else to do.
class MovingMesh {
 public:
  explicit MovingMesh(const BenchMesh& entry)
      : places_(entry.mesh->vertices().begin(), entry.mesh->vertices().end()),
        size_(entry.mesh->radius()),
        data_(meshData(*entry.mesh, entry.name)) {
    const double side = 1e-3 * static_cast<double>(size_);
    const scenes::MeshArrays box = scenes::makeBox({side, side, side});
    box_ = dGpuTriMeshDataCreate();
    dGpuTriMeshDataBuildSingle(box_, box.vertices.data(), sizeof(Vec3f), static_cast<int>(box.vertices.size()),
                               box.triangles.data(), static_cast<int>(3 * box.triangles.size()), sizeof(Triangle));
    pair_ = {dCreateGpuTriMesh(nullptr, data_), dCreateGpuTriMesh(nullptr, box_)};
    dGeomSetPosition(pair_.o2, static_cast<dReal>(places_[0].x), static_cast<dReal>(places_[0].y),
                     static_cast<dReal>(places_[0].z));
    for (const dGeomID geom : {pair_.o1, pair_.o2}) dGeomGpuTriMeshSetBackend(geom, dGPUTRIMESH_BACKEND_OPENCL);
  }
  ~MovingMesh() {
    dGeomDestroy(pair_.o1);
    dGeomDestroy(pair_.o2);
    dGpuTriMeshDataDestroy(data_);
    dGpuTriMeshDataDestroy(box_);
  }
  MovingMesh(const MovingMesh&) = delete;
  MovingMesh& operator=(const MovingMesh&) = delete;

  int vertexCount() const { return static_cast<int>(places_.size()); }
  /// Vertices `first`, `first + step`, ...: back and forth by a ten-thousandth of the mesh's size.
  void move(int first, int step, int count) {
    const float by = (round_++ % 2 == 0 ? 1e-4f : -1e-4f) * size_;
    std::vector<int> numbers;
    std::vector<Vec3f> moved;
    for (int i = 0; i < count; ++i) {
      const int number = first + i * step;
      Vec3f& place = places_[static_cast<std::size_t>(number)];
      place = otgAdd(place, Vec3f{by, 0, 0});
      numbers.push_back(number);
      moved.push_back(place);
    }
    const int status = dGpuTriMeshDataUpdateListSingle(data_, moved.data(), 0, numbers.data(), count);
    if (status != dGPUTRIMESH_OK) throw InputError(dGpuTriMeshErrorString(status));
  }
  double queryMs() {
    return timeOnce([&] { dCollide(pair_.o1, pair_.o2, kPlaces, contacts_, sizeof(dContactGeom)); });
  }

 private:
  static constexpr int kPlaces = 16;
  std::vector<Vec3f> places_;
  float size_;
  dGpuTriMeshDataID data_, box_ = nullptr;
  dGpuTriMeshPair pair_{};
  dContactGeom contacts_[kPlaces];
  int round_ = 0;
};

}  // namespace

Json sentRows(const BenchOptions& options) {
  Json rows = Json::array();
  const int index = opencl::defaultDevice(findDevices());
  if (index < 0 || dispatcher().open(std::vector<int>{index}, {}, Costs::kIfStored) == 0) return rows;
  const scenes::OdeSession session;
  const int repeat = options.repeat > 0 ? options.repeat : 9;
  for (const BenchMesh& entry : benchMeshes(options)) {
    MovingMesh mesh(entry);
    const int all = mesh.vertexCount(), some = std::max(1, all / 100);
    mesh.move(0, 1, 1);  // the first move has the whole mesh sent
    mesh.queryMs();
    mesh.queryMs();
    const auto add = [&](const char* moved, int first, int step, int count) {
      std::vector<double> times;
      const std::uint64_t bytes = deviceSum(&dGpuTriMeshDevice::mesh_bytes_sent);
      const std::uint64_t uploads = deviceSum(&dGpuTriMeshDevice::mesh_uploads);
      for (int i = 0; i < repeat; ++i) {
        if (count > 0) mesh.move(first, step, count);
        times.push_back(mesh.queryMs());
      }
      rows.push_back({{"mesh", entry.name},
                      {"moved", moved},
                      {"vertices", count},
                      {"bytes_sent",
                       (deviceSum(&dGpuTriMeshDevice::mesh_bytes_sent) - bytes) / static_cast<std::uint64_t>(repeat)},
                      {"whole", deviceSum(&dGpuTriMeshDevice::mesh_uploads) > uploads},
                      {"query_ms", median(times)}});
    };
    add("nothing", 0, 1, 0);
    add("one", all / 2, 1, 1);
    add("side by side", all / 3, 1, some);
    add("all over", 0, all / some, some);
    add("all", 0, 1, all);
  }
  return rows;
}

}  // namespace otg::cli
