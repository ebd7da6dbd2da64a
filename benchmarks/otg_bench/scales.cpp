// SPDX-License-Identifier: BSD-3-Clause
#include "otg_bench/scales.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
#include <malloc.h>
#define OTG_COUNTS_BYTES
#endif

#include "cli/query_options.h"
#include "collide/query.h"
#include "ode/geom/geom_class.h"
#include "otg_bench/geoms.h"
#include "scenes/generated_meshes.h"
#include "scenes/simulation.h"

namespace otg::cli {
namespace {

double heldBytes() {
#ifdef OTG_COUNTS_BYTES
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  return 0;
#endif
}

/// A geom of its own with a scale, and what it has cost so far.
class ScaledGeom {
 public:
  ScaledGeom(dGpuTriMeshDataID data, const std::array<double, 3>& scale)
      : before_(heldBytes()), geom_(dCreateGpuTriMesh(nullptr, data)), scale_(scale) {
    setScale();
  }
  ~ScaledGeom() { dGeomDestroy(geom_); }
  ScaledGeom(const ScaledGeom&) = delete;
  ScaledGeom& operator=(const ScaledGeom&) = delete;

  dGeomID geom() const { return geom_; }
  double bytes() const { return heldBytes() - before_; }
  std::shared_ptr<const CollisionMesh> mesh() const { return objectOf(geom_)->sharedMesh(); }
  double setScaleMs() {
    dGeomGpuTriMeshSetScale(geom_, 1, 1, 1);
    return timeOnce([&] { setScale(); });
  }

 private:
  void setScale() {
    if (dGeomGpuTriMeshSetScale(geom_, scale_[0], scale_[1], scale_[2]) != dGPUTRIMESH_OK) {
      throw InputError(fmt::format("the mesh does not bear the scale {}, {}, {}", scale_[0], scale_[1], scale_[2]));
    }
  }
  const double before_;
  const dGeomID geom_;
  const std::array<double, 3> scale_;
};

/// A collision with a small box at a corner of the geom's first triangle.
void collideOnce(dGeomID geom, dGeomID box) {
  dVector3 at, others[2];
  dContactGeom contacts[16];
  dGeomGpuTriMeshGetTriangle(geom, 0, &at, &others[0], &others[1]);
  dGeomSetPosition(box, at[0], at[1], at[2]);
  dCollide(geom, box, 16, contacts, sizeof(dContactGeom));
}

struct PairTimes {
  double ms;
  std::string hash;
};

PairTimes timePairs(const CollisionMesh& mesh, const Transformd& pose, int repeat) {
  Query query;
  query.a = query.b = &mesh;
  query.bInA = pose;
  Workspace workspace;
  findIntersectingPairs(query, workspace);
  const double ms =
      median(repeatTimes(repeat, [&] { return timeOnce([&] { findIntersectingPairs(query, workspace); }); }));
  std::vector<TrianglePair> pairs = workspace.intersecting;
  std::sort(pairs.begin(), pairs.end(),
            [](const TrianglePair& x, const TrianglePair& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; });
  Fnv1a hash;
  hash.add(pairs.data(), pairs.size() * sizeof(TrianglePair));
  return {ms, hash.hex()};
}

void addQueryTimes(const CollisionMesh& image, const BenchOptions& options, Json& row) {
  MeshInput input;
  input.vertices = image.mesh().vertices().data();
  input.vertexCount = image.mesh().vertices().size();
  input.indices = image.mesh().triangles().data();
  input.triangleCount = image.mesh().triangleCount();
  const CollisionMesh built(buildTriMesh(input).mesh, BuildStrategy::kSah);
  const Transformd pose = benchPose(options, built);
  const PairTimes own = timePairs(image, pose, options.repeat), other = timePairs(built, pose, options.repeat);
  row["pairs_ms"] = own.ms;
  row["pairs_built_ms"] = other.ms;
  row["hash"] = own.hash;
  row["answers"] = own.hash == other.hash ? "same" : "DIFFERENT";
}

}  // namespace

Json scaleRows(const BenchOptions& options) {
  Json rows = Json::array();
  const scenes::OdeSession session;
  struct Case {
    const char* what;
    std::array<double, 3> scale;
  };
  constexpr Case kCases[] = {{"scaled", {2, 1, 0.5}},  {"again", {2, 1, 0.5}},  {"first mirrored", {-1, 1, 1}},
                             {"mirrored", {1, -2, 1}}, {"scaled", {1, 1, 4}},   {"scaled", {1, 1, 16}},
                             {"scaled", {4, 1, 0.25}}, {"scaled", {10, 1, 0.1}}};
  for (const BenchMesh& entry : benchMeshes(options)) {
    progress(fmt::format("{}: scales", entry.name));
    const auto triangles = static_cast<double>(entry.mesh->triangleCount());
    const scenes::MeshArrays cube = scenes::makeBox(otgScale(Vec3d{1, 1, 1}, 1e-3 * double{entry.mesh->radius()}));
    const dGpuTriMeshDataID boxData = meshData(*scenes::build(cube), "a box");
    const dGeomID box = dCreateGpuTriMesh(nullptr, boxData);
    const double none = heldBytes();
    dGpuTriMeshDataID data = nullptr;
    const double buildMs = timeOnce([&] { data = meshData(*entry.mesh, entry.name); });
    const auto add = [&](const char* what, const std::array<double, 3>& scale, const CollisionMesh& mesh, double bytes,
                         double collided, double ms) -> Json& {
      rows.push_back({{"mesh", entry.name},
                      {"triangles", entry.mesh->triangleCount()},
                      {"what", what},
                      {"scale", fmt::format("{:g} {:g} {:g}", scale[0], scale[1], scale[2])},
                      {"tree", mesh.boxScale() == nullptr ? "own" : "shared"},
                      {"bytes_per_triangle", bytes / triangles},
                      {"collided_bytes_per_triangle", collided / triangles},
                      {"set_ms", ms}});
      return rows.back();
    };
    {
      const double built = heldBytes() - none;
      const ScaledGeom own(data, {1, 1, 1});
      collideOnce(own.geom(), box);
      addQueryTimes(*own.mesh(), options, add("built", {1, 1, 1}, *own.mesh(), built, heldBytes() - none, buildMs));
      std::vector<std::unique_ptr<ScaledGeom>> kept;
      for (const Case& c : kCases) {
        auto geom = std::make_unique<ScaledGeom>(data, c.scale);
        const double bytes = geom->bytes();
        collideOnce(geom->geom(), box);
        const double collided = geom->bytes();
        const double ms = median(repeatTimes(options.repeat, [&] { return geom->setScaleMs(); }));
        Json& row = add(c.what, c.scale, *geom->mesh(), bytes, collided, ms);
        addQueryTimes(*geom->mesh(), options, row);
        // What a later row has in common with this one.
        collideOnce(geom->geom(), box);
        if (kept.size() < 3) kept.push_back(std::move(geom));
      }
    }
    dGeomDestroy(box);
    dGpuTriMeshDataDestroy(data);
    dGpuTriMeshDataDestroy(boxData);
  }
  return rows;
}

}  // namespace otg::cli
