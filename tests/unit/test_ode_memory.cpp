// SPDX-License-Identifier: BSD-3-Clause
// Want of memory at every single allocation: a status or no contacts, never an exception, and all is well afterwards.
#include <malloc.h>

#include <cstddef>
#include <cstdlib>
#include <new>

#include "bvh/cooked_mesh.h"
#include "ode/geom/geom_class.h"
#include "support/catch.h"
#include "support/ode_world.h"

namespace {
/// Allocations of this thread that still succeed; negative: all of them.
thread_local long allowance = -1;
/// Bytes that this thread has allocated and not freed.
thread_local long live = 0;

void* allocate(std::size_t size, std::size_t alignment = alignof(std::max_align_t)) {
  if (allowance == 0) throw std::bad_alloc();
  if (allowance > 0) --allowance;
  if (void* const p = std::aligned_alloc(alignment, (size + alignment) / alignment * alignment)) {
    live += static_cast<long>(malloc_usable_size(p));
    return p;
  }
  throw std::bad_alloc();
}

/// Not inlined: a compiler that does so, and not with the function above, sees free() called on what new gave.
[[gnu::noinline]] void release(void* p) noexcept {
  live -= static_cast<long>(malloc_usable_size(p));
  std::free(p);
}
}  // namespace

// This program's own allocation functions, which the library in it uses as well. ODE allocates with malloc.
void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* p, std::align_val_t) noexcept {
  release(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  release(p);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return allocate(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* p, const std::nothrow_t&) noexcept {
  release(p);
}
void operator delete(void* p) noexcept {
  release(p);
}
void operator delete[](void* p) noexcept {
  release(p);
}
void operator delete(void* p, std::size_t) noexcept {
  release(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  release(p);
}

using namespace otg;
using namespace otg::test;

namespace {

/// Runs `work` with ever more allocations until it says that it succeeded; returns how often it failed.
template <class Work>
int failures(Work work) {
  for (long n = 0; n < 1000000; ++n) {
    allowance = n;
    const bool done = work();
    allowance = -1;
    if (done) return static_cast<int>(n);
  }
  return -1;
}

}  // namespace

TEST_CASE("a collision without memory has no contacts, is counted, and the next one is whole") {
  const OdeSession session;
  const Data sphere(scenes::makeSphere(1, 2)), lump(scenes::makeLump(1, 2, 0.3, 9));
  const Geom a(sphere), b(lump);
  dGeomSetPosition(b.id, 0.9, 0.4, 0.1);
  const auto expected = test::collide(a.id, b.id, 64);
  REQUIRE(!expected.empty());
  for (const int traversal : {dGPUTRIMESH_TRAVERSAL_STANDARD, dGPUTRIMESH_TRAVERSAL_QUANTIZED,
                              dGPUTRIMESH_TRAVERSAL_NO_LEAF, dGPUTRIMESH_TRAVERSAL_WIDE}) {
    dGpuTriMeshParams params;
    dGpuTriMeshParamsInit(&params);
    params.traversal = traversal;
    dGeomGpuTriMeshSetParams(a.id, &params);
    dGeomGpuTriMeshResetStats(a.id);
    std::vector<dContactGeom> contacts(64);
    int n = 0;
    const int failed = failures([&] {
      dGpuTriMeshClose();  // scratch memory of earlier collisions would hide allocations
      n = dCollide(a.id, b.id, 64, contacts.data(), sizeof(dContactGeom));
      return n > 0;
    });
    CHECK(failed > 5);
    REQUIRE(n == static_cast<int>(expected.size()));
    for (int i = 0; i < n; ++i) CHECK(sameContact(contacts[i], expected[i]));
    dGpuTriMeshStats stats;
    dGpuTriMeshStatsInit(&stats);
    dGeomGpuTriMeshGetStats(a.id, &stats);
    CHECK(stats.failed_queries == static_cast<duint64>(failed));
  }
}

TEST_CASE("building, updating and creating without memory are errors and change nothing") {
  const OdeSession session;
  const scenes::MeshArrays sphere = scenes::makeSphere(1, 1);
  const int vertexCount = static_cast<int>(sphere.vertices.size());
  const int indexCount = static_cast<int>(3 * sphere.triangles.size());
  const Data box(scenes::makeBox({1, 1, 1}));
  const Geom geom(box);
  bool unchanged = true, stated = true;
  CHECK(failures([&] {
          const int status = dGpuTriMeshDataBuildSingle(box.id, sphere.vertices.data(), 0, vertexCount,
                                                        sphere.triangles.data(), indexCount, 0);
          if (status == dGPUTRIMESH_OK) return true;
          stated = stated && status == dGPUTRIMESH_ERROR_MEMORY && dGpuTriMeshGetError() == status;
          unchanged = unchanged && dGeomGpuTriMeshGetTriangleCount(geom.id) == 12;
          return false;
        }) > 10);
  CHECK(dGeomGpuTriMeshGetTriangleCount(geom.id) == indexCount / 3);
  CHECK(failures([&] {
          const int status = dGpuTriMeshDataUpdateVerticesSingle(box.id, sphere.vertices.data(), 0, vertexCount);
          stated = stated && (status == dGPUTRIMESH_OK || status == dGPUTRIMESH_ERROR_MEMORY);
          return status == dGPUTRIMESH_OK;
        }) > 3);
  const auto bytesOf = [&] {
    std::vector<unsigned char> bytes(dGpuTriMeshDataCook(box.id, nullptr, 0));
    dGpuTriMeshDataCook(box.id, bytes.data(), bytes.size());
    return bytes;
  };
  const std::vector<unsigned char> before = bytesOf();
  const Vec3f place = otgScale(sphere.vertices[7], 1.01f);
  CHECK(failures([&] {
          const int status = dGpuTriMeshDataUpdateRangeSingle(box.id, &place, 0, 7, 1);
          const long rest = allowance;
          allowance = -1;
          unchanged = unchanged && (status == dGPUTRIMESH_OK) == (bytesOf() != before);
          allowance = rest;
          stated = stated && (status == dGPUTRIMESH_OK || status == dGPUTRIMESH_ERROR_MEMORY);
          return status == dGPUTRIMESH_OK;
        }) > 10);
  CHECK(failures([&] {
          const dGeomID created = dCreateGpuTriMesh(nullptr, box.id);
          if (created == nullptr) return false;
          dGeomDestroy(created);
          return true;
        }) > 0);
  CHECK(failures([&] { return dGeomGpuTriMeshSetData(geom.id, nullptr) == dGPUTRIMESH_OK; }) == 0);
  CHECK(failures([&] { return dGeomGpuTriMeshSetData(geom.id, box.id) == dGPUTRIMESH_OK; }) == 1);
  CHECK(failures([&] {
          const dGpuTriMeshDataID created = dGpuTriMeshDataCreate();
          dGpuTriMeshDataDestroy(created);
          return created != nullptr;
        }) == 2);  // the object, and its place among those that are alive
  CHECK(stated);
  CHECK(unchanged);
}

TEST_CASE("without memory no vertex moves, neither of the data's mesh nor of a scaled one") {
  const OdeSession session;
  const scenes::MeshArrays sphere = scenes::makeSphere(1, 1);
  const int count = static_cast<int>(sphere.vertices.size());
  const Data data(sphere);
  const Geom plain(data), stretched(data), mirrored(data), unborne(data);
  REQUIRE(dGeomGpuTriMeshSetScale(stretched.id, 2, 1, 0.5) == dGPUTRIMESH_OK);
  REQUIRE(dGeomGpuTriMeshSetScale(mirrored.id, -1, 1, 1.5) == dGPUTRIMESH_OK);
  REQUIRE(dGeomGpuTriMeshSetScale(unborne.id, 3e38, 1, 1) == dGPUTRIMESH_OK);
  const auto bytesOf = [&] {
    std::vector<std::vector<unsigned char>> bytes;
    for (const dGeomID g : {plain.id, stretched.id, mirrored.id, unborne.id}) {
      const CollisionMesh* const mesh = objectOf(g)->mesh();
      bytes.push_back(mesh == nullptr ? std::vector<unsigned char>() : cookMesh(*mesh));
    }
    return bytes;
  };
  const auto failuresOf = [&](auto&& change) {
    const auto before = bytesOf();
    bool whole = true;
    const int failed = failures([&] {
      const int status = change();
      const long rest = allowance;
      allowance = -1;
      const auto now = bytesOf();
      // All of them or none.
      for (std::size_t i = 0; i < now.size(); ++i) whole = whole && (now[i] != before[i]) == (status == dGPUTRIMESH_OK);
      allowance = rest;
      whole = whole && (status == dGPUTRIMESH_OK || status == dGPUTRIMESH_ERROR_MEMORY);
      return status == dGPUTRIMESH_OK;
    });
    CHECK(whole);
    return failed;
  };
  float by = 1;
  int vertex = 7;
  const auto moveOne = [&] {
    const Vec3f place = otgScale(sphere.vertices[static_cast<std::size_t>(vertex)], by);
    return dGpuTriMeshDataUpdateRangeSingle(data.id, &place, 0, vertex, 1);
  };
  by = 1.01f;
  CHECK(failuresOf(moveOne) > 30);
  by = 1.02f;
  CHECK(failuresOf(moveOne) > 3);  // all is prepared by now
  // One that somebody else holds is made anew, in between.
  std::shared_ptr<const CollisionMesh> held = objectOf(stretched.id)->sharedMesh();
  by = 0.99f;
  CHECK(failuresOf(moveOne) > 10);
  CHECK(objectOf(stretched.id)->mesh() != held.get());
  held = nullptr;
  // All at once, as far as a scale that cannot be borne any more, and back.
  std::vector<Vec3f> all = sphere.vertices;
  const auto moveAll = [&] { return dGpuTriMeshDataUpdateVerticesSingle(data.id, all.data(), 0, count); };
  for (const float factor : {2.f, 0.75f}) {
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = otgScale(sphere.vertices[v], factor);
    CHECK(failuresOf(moveAll) > 10);
    CHECK((objectOf(unborne.id)->mesh() == nullptr) == (factor > 1));
  }
}

TEST_CASE("a scaled mesh takes memory for what its scale changes alone") {
  const OdeSession session;
  const scenes::MeshArrays torus = scenes::makeTorus(2, 0.5, 128, 64);
  const auto triangles = static_cast<double>(torus.triangles.size());
  std::vector<dGeomID> geoms;
  /// Bytes a triangle of one more geom: of its mesh, and with what a collision with the defaults makes.
  const auto cost = [&](dGpuTriMeshDataID data, const MeshScale& s) {
    const long before = live;
    geoms.push_back(dCreateGpuTriMesh(nullptr, data));
    REQUIRE(dGeomGpuTriMeshSetScale(geoms.back(), s[0], s[1], s[2]) == dGPUTRIMESH_OK);
    const long made = live;
    const CollisionMesh& mesh = *objectOf(geoms.back())->mesh();
    mesh.wide();
    mesh.adjacency();
    return std::pair{static_cast<double>(made - before) / triangles, static_cast<double>(live - before) / triangles};
  };
  const long none = live;
  {
    const Data data(torus);
    const double built = static_cast<double>(live - none) / triangles;
    const auto own = cost(data.id, {1, 1, 1});
    INFO("own " << built << ", collided " << built + own.second);
    CHECK(built > 130);
    CHECK(built + own.second > 280);
    for (const MeshScale& scale :
         {MeshScale{2, 1, 1}, MeshScale{-1, 1, 1}, MeshScale{1, -2, 1}, MeshScale{2, 1, 1}, MeshScale{20, 1, 1}}) {
      const auto [made, used] = cost(data.id, scale);
      INFO(scale[0] << " " << scale[1] << ": " << made << ", " << used);
      // Vertices, and then normals, areas and what is summed of them; of the first mirror also the triangles turned
      // round and their edges; of one that is stretched too much a tree in two layouts.
      const bool known = geoms.size() == 5, firstMirrored = geoms.size() == 3, ownTree = geoms.size() == 6;
      CHECK(made < (known ? 1 : firstMirrored ? 56 : ownTree ? 72 : 7));
      CHECK(used < (known ? 1 : firstMirrored ? 170 : ownTree ? 260 : 64));
    }
    const TriMesh &plain = objectOf(geoms[0])->mesh()->mesh(), &scaled = objectOf(geoms[1])->mesh()->mesh();
    CHECK(plain.triangles().data() == scaled.triangles().data());
    CHECK(plain.topology().twin.data() == scaled.topology().twin.data());
    CHECK(&plain.adjacencyLinks() == &scaled.adjacencyLinks());
    CHECK(plain.vertices().data() != scaled.vertices().data());
    for (const std::size_t i : {1, 2, 3}) {
      CHECK(&objectOf(geoms[i])->mesh()->wide() == &objectOf(geoms[0])->mesh()->wide());
      CHECK(&objectOf(geoms[i])->mesh()->tree() == &objectOf(geoms[0])->mesh()->tree());
    }
    CHECK(&objectOf(geoms[5])->mesh()->tree() != &objectOf(geoms[0])->mesh()->tree());
    // What moves of some vertices need beside a mesh: of images less, which share the greater part of it.
    const long beforeMove = live;
    const Vec3f place = otgScale(torus.vertices[5], 1.0001f);
    REQUIRE(dGpuTriMeshDataUpdateRangeSingle(data.id, &place, 0, 5, 1) == dGPUTRIMESH_OK);
    const double moved = static_cast<double>(live - beforeMove) / triangles;
    INFO("moved " << moved);
    CHECK(moved > 100);
    CHECK(moved < 90 + 3 * 15 + 75);  // the data's own, three images, one with a tree of its own
    // Of two mirrors, the second shares with the first.
    CHECK(objectOf(geoms[2])->mesh()->mesh().triangles().data() ==
          objectOf(geoms[3])->mesh()->mesh().triangles().data());
    CHECK(objectOf(geoms[1])->mesh() == objectOf(geoms[4])->mesh());
    for (const dGeomID g : geoms) dGeomDestroy(g);
  }
  CHECK(live - none < 4096);
}
