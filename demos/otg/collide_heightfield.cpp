// SPDX-License-Identifier: BSD-3-Clause
#include "otg/collide_heightfield.h"

#include <fmt/format.h>
#include <ode_trimesh_gpu/ode_trimesh_gpu.h>

#include <algorithm>
#include <chrono>

#include "cli/input_file.h"
#include "cli/pose.h"
#include "mesh_io/mesh_file.h"
#include "scenes/height_grid_file.h"
#include "scenes/heightfield_geom.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

struct MeshDataDestroy {
  void operator()(dGpuTriMeshDataID data) const { dGpuTriMeshDataDestroy(data); }
};
struct GeomDestroy {
  void operator()(dGeomID geom) const { dGeomDestroy(geom); }
};
using MeshData = std::unique_ptr<dxGpuTriMeshData, MeshDataDestroy>;
using Geom = std::unique_ptr<dxGeom, GeomDestroy>;

MeshData loadMesh(const std::string& path) {
  const mesh_io::MeshFile file = mesh_io::loadMeshFile(findInput(path));
  MeshData data(dGpuTriMeshDataCreate());
  const int status = dGpuTriMeshDataBuildDouble(data.get(), file.vertices.data(), sizeof(Vec3d),
                                                static_cast<int>(file.vertices.size()), file.triangles.data(),
                                                static_cast<int>(3 * file.triangles.size()), sizeof(Triangle));
  if (status < 0) throw InputError(path + ": " + dGpuTriMeshDataGetErrorString(data.get()));
  return data;
}

dGpuTriMeshParams paramsOf(const QueryOptions& options) {
  dGpuTriMeshParams params;
  dGpuTriMeshParamsInit(&params);
  const auto chosen = options.collideOptions();
  params.contact_model =
      chosen.contacts == ContactModel::kPairwise ? dGPUTRIMESH_CONTACTS_PAIRWISE : dGPUTRIMESH_CONTACTS_AUTO;
  params.reduction = chosen.reduction.method == Reduction::kNone   ? dGPUTRIMESH_REDUCTION_NONE
                     : chosen.reduction.method == Reduction::kCone ? dGPUTRIMESH_REDUCTION_CONE
                                                                   : dGPUTRIMESH_REDUCTION_BINNING;
  std::copy(chosen.reduction.bins.begin(), chosen.reduction.bins.end(), params.bins);
  params.max_contacts = options.maxContacts;
  params.contacts_per_region = options.contactsPerRegion;
  params.region_merge = static_cast<dReal>(options.regionMerge);
  return params;
}

/// Options that say how a query of two meshes runs, and nothing of one with a heightfield.
void refuseOthers(const QueryOptions& options) {
  const std::string* const words[] = {&options.backend, &options.midphase, &options.nearphase, &options.descent,
                                      &options.build};
  for (const std::string* word : words) {
    if (!word->empty()) throw UsageError("with a heightfield the query runs on the CPU in the one way that there is");
  }
  if (scenes::namesHeightGrid(options.fileA)) throw UsageError("the heightfield goes second, the mesh first");
}

}  // namespace

int collideWithHeightfield(const QueryOptions& options, int repeat, bool json) {
  refuseOthers(options);
  const Transformd pose = parsePose(options.pose);
  const std::shared_ptr<const scenes::HeightGrid> grid = scenes::loadHeightGrid(options.fileB);
  const scenes::OdeSession session;
  const MeshData data = loadMesh(options.fileA);
  const Geom mesh(dCreateGpuTriMesh(nullptr, data.get()));
  const dGpuTriMeshParams params = paramsOf(options);
  if (!mesh || dGeomGpuTriMeshSetParams(mesh.get(), &params) != dGPUTRIMESH_OK) throw std::bad_alloc();
  const scenes::HeightfieldData heights(*grid);
  const Geom field(heights.makeGeom(nullptr, pose));

  std::vector<dContactGeom> contacts(static_cast<std::size_t>(options.maxContacts));
  std::vector<double> times;
  int count = 0;
  for (int i = 0; i <= repeat; ++i) {
    dGeomGpuTriMeshForgetHistory(mesh.get());  // each query as the first one
    const auto start = std::chrono::steady_clock::now();
    count = dCollide(mesh.get(), field.get(), options.maxContacts, contacts.data(), sizeof(dContactGeom));
    const auto end = std::chrono::steady_clock::now();
    if (i > 0) times.push_back(std::chrono::duration<double, std::milli>(end - start).count());
  }
  dGpuTriMeshStats stats;
  dGpuTriMeshStatsInit(&stats);
  dGeomGpuTriMeshGetStats(mesh.get(), &stats);
  if (stats.failed_queries > 0) throw InputError(dGpuTriMeshErrorString(dGpuTriMeshGetError()));

  Fnv1a hash;
  Json list = Json::array();
  for (int i = 0; i < count; ++i) {
    const dContactGeom& c = contacts[static_cast<std::size_t>(i)];
    hash.add(c.pos[0]), hash.add(c.pos[1]), hash.add(c.pos[2]);
    hash.add(c.normal[0]), hash.add(c.normal[1]), hash.add(c.normal[2]);
    hash.add(c.depth), hash.add(c.side1);
    list.push_back({{"position", {c.pos[0], c.pos[1], c.pos[2]}},
                    {"normal", {c.normal[0], c.normal[1], c.normal[2]}},
                    {"depth", c.depth},
                    {"triangle_a", c.side1},
                    {"triangle_b", Json()}});
  }
  if (json) {
    printJson({{"a", options.fileA},
               {"b", options.fileB},
               {"samples", {grid->columns, grid->rows}},
               {"contacts", list},
               {"timings_ms", {{"total", median(times)}}},
               {"backend", "cpu"},
               {"device", "host CPU, 1 thread"},
               {"repeat", repeat},
               {"hash", hash.hex()}});
    return kOk;
  }
  fmt::print("{:<26} {:>12}\n{:<26} {:>12.4f} ms\n{:<26} {}\n\n", "contacts", count, "total", median(times), "hash",
             hash.hex());
  std::vector<std::vector<std::string>> rows;
  for (int i = 0; i < count; ++i) {
    const dContactGeom& c = contacts[static_cast<std::size_t>(i)];
    rows.push_back({fmt::format("{:.6g} {:.6g} {:.6g}", c.pos[0], c.pos[1], c.pos[2]),
                    fmt::format("{:.4f} {:.4f} {:.4f}", c.normal[0], c.normal[1], c.normal[2]),
                    fmt::format("{:.6g}", c.depth), std::to_string(c.side1)});
  }
  printTable({"position (frame A)", "normal", "depth", "triangle A"}, rows);
  return kOk;
}

}  // namespace otg::cli
