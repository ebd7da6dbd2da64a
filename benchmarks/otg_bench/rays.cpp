// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/rays.h"

#include <algorithm>
#include <cmath>

#include "cli/progress.h"
#include "dispatch/dispatcher.h"
#include "otg_bench/geoms.h"
#include "truth/contact_families.h"

namespace otg::cli {
namespace {

dGpuTriMeshRay rayFrom(const Vec3d& start, const Vec3d& direction) {
  return {{start.x, start.y, start.z, 0}, {direction.x, direction.y, direction.z, 0}, dInfinity};
}

Vec3d middleOf(const TriMesh& mesh) {
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  return {0.5 * (double{lo.x} + hi.x), 0.5 * (double{lo.y} + hi.y), 0.5 * (double{lo.z} + hi.z)};
}

/// A square picture of the mesh from four times its radius, filled by most meshes to a half; `count` rays of it.
std::vector<dGpuTriMeshRay> cameraRays(const TriMesh& mesh, int count) {
  const double radius = double{mesh.radius()};
  const Vec3d towards{-0.48, -0.6, -0.64}, right{0.78086880944303, -0.62469504755442, 0};  // unit vectors
  const Vec3d up = otgCross(right, towards), eye = otgSub(middleOf(mesh), otgScale(towards, 4 * radius));
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
  std::vector<dGpuTriMeshRay> rays;
  for (int i = 0; i < count; ++i) {
    const int column = i % side, row = i / side;
    const double x = 0.4 * ((column + 0.5) / side - 0.5), y = 0.4 * ((row + 0.5) / side - 0.5);
    rays.push_back(rayFrom(eye, otgAdd(towards, otgAdd(otgScale(right, x), otgScale(up, y)))));
  }
  return rays;
}

/// From anywhere in a box 1.2 times as large as the mesh's, in any direction.
std::vector<dGpuTriMeshRay> raysAround(const TriMesh& mesh, int count) {
  truth::Random random(1);
  const Vec3f &lo = mesh.boundsMin(), &hi = mesh.boundsMax();
  const Vec3d middle = middleOf(mesh),
              half{0.6 * (double{hi.x} - lo.x), 0.6 * (double{hi.y} - lo.y), 0.6 * (double{hi.z} - lo.z)};
  std::vector<dGpuTriMeshRay> rays;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    rays.push_back(rayFrom(otgAdd(middle, Vec3d{x * half.x, y * half.y, z * half.z}), random.direction()));
  }
  return rays;
}

/// What the device takes without what the CPU makes of its results.
double rawRayTime(const CollisionMesh& mesh, const std::vector<dGpuTriMeshRay>& rays, int repeat) {
  const auto slots = dispatcher().devices();
  std::vector<LongRay> inMesh;
  for (const dGpuTriMeshRay& ray : rays) {
    const Vec3d d{ray.direction[0], ray.direction[1], ray.direction[2]};
    inMesh.push_back(
        {{{ray.start[0], ray.start[1], ray.start[2]}, otgScale(d, 1 / std::sqrt(otgDot(d, d)))}, ray.length});
  }
  const auto fill = [&](std::size_t begin, std::size_t end, LongRay* to) {
    std::copy(inMesh.data() + begin, inMesh.data() + end, to);
  };
  const auto take = [](std::size_t, std::size_t, const LongRay*, const otg_uint*) {};
  const auto once = [&] { slots.front()->backend->castRays(mesh, false, inMesh.size(), fill, take); };
  once();
  return median(repeatTimes(repeat, [&] { return timeOnce(once); }));
}

Json rayRow(dGeomID geom, const std::vector<dGpuTriMeshRay>& rays, int alone, int repeat, bool withDevices) {
  const int count = static_cast<int>(rays.size());
  std::vector<unsigned char> expected, answers;
  int hits = 0;
  bool same = true;
  // The first call also uploads.
  const auto timed = [&](int backend, int threads, int most) {
    dGeomGpuTriMeshSetBackend(geom, backend);
    dGpuTriMeshSetThreadCount(threads);
    answers.assign(rays.size() * sizeof(dGpuTriMeshRayHit), 0);
    const auto ask = [&] {
      hits = dGeomGpuTriMeshCastRays(geom, rays.data(), count, 0, reinterpret_cast<dGpuTriMeshRayHit*>(answers.data()));
    };
    ask();
    if (expected.empty()) expected = answers;
    same = same && answers == expected;
    return median(repeatTimes(std::min(most, repeat), [&] { return timeOnce(ask); }));
  };
  const double all = timed(dGPUTRIMESH_BACKEND_CPU, 0, repeat);
  const Json one = count <= alone ? Json(timed(dGPUTRIMESH_BACKEND_CPU, 1, 3)) : Json();
  const Json device = withDevices ? Json(timed(dGPUTRIMESH_BACKEND_OPENCL, 0, repeat)) : Json();
  const std::uint64_t before = deviceSum(&dGpuTriMeshDevice::calls);
  const double automatic = timed(dGPUTRIMESH_BACKEND_AUTO, 0, repeat);
  Fnv1a hash;
  hash.add(expected.data(), expected.size());
  return {{"count", count},
          {"hits", hits},
          {"one_thread_ms", one},
          {"all_threads_ms", all},
          {"device_ms", device},
          {"auto_ms", automatic},
          {"times_all_threads", withDevices ? Json(all / device.get<double>()) : Json()},
          {"auto", deviceSum(&dGpuTriMeshDevice::calls) > before ? "opencl" : "cpu"},
          {"answers", same ? "same" : "DIFFERENT"},
          {"hash", hash.hex()}};
}

}  // namespace

Json rayRows(const BenchOptions& options, const std::vector<int>& counts, int alone, int repeat, bool withDevices) {
  Json rows = Json::array();
  const std::vector<BenchMesh> meshes = benchMeshes(options);
  Progress parts(2 * meshes.size() * counts.size());
  for (const BenchMesh& mesh : meshes) {
    const CollisionMesh tree(sortedForLocality(*mesh.mesh), BuildStrategy::kSah);
    const dGpuTriMeshDataID data = meshData(*mesh.mesh, mesh.name);
    const dGeomID geom = dCreateGpuTriMesh(nullptr, data);
    for (const char* way : {"camera", "around"}) {
      for (const int count : counts) {
        const auto rays = way[0] == 'c' ? cameraRays(*mesh.mesh, count) : raysAround(*mesh.mesh, count);
        Json row{{"mesh", mesh.name}, {"rays", way}};
        row.update(rayRow(geom, rays, alone, repeat, withDevices));
        row["device_alone_ms"] = withDevices ? Json(rawRayTime(tree, rays, repeat)) : Json();
        rows.push_back(row);
        parts.step();
      }
    }
    dGeomDestroy(geom);
    dGpuTriMeshDataDestroy(data);
  }
  dGpuTriMeshSetThreadCount(0);
  return rows;
}

}  // namespace otg::cli
