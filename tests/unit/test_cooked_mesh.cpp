// SPDX-License-Identifier: BSD-3-Clause
// Cooked meshes: the same mesh comes back, and what is no cooked mesh is refused. Meant for AddressSanitizer, too.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include "base/system.h"
#include "bvh/cooked_mesh.h"
#include "support/catch.h"
#include "support/cooked_file.h"
#include "support/mesh_samples.h"
#include "support/ode_world.h"

using namespace otg;
using namespace otg::test;

namespace {

CollisionMesh collisionMesh(const scenes::MeshArrays& arrays, const RepairOptions& repair = {}) {
  return CollisionMesh(buildTriMesh(arrays.input(), repair, MeshOrder::kLocal).mesh, BuildStrategy::kSah);
}

/// Numbers of the sections, as cooked_mesh.cpp has them.
constexpr std::size_t kCounts = 0, kVertices = 2, kTriangles = 3, kDegenerate = 4, kTwin = 7, kCallerTriangle = 13,
                      kNodes = 15;

std::string errorOf(const Bytes& bytes) {
  // From the heap and no longer than it says, so that the sanitizer sees every byte read beyond.
  const std::unique_ptr<unsigned char[]> exact(new unsigned char[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  const UncookedMesh uncooked = uncookMesh({exact.get(), bytes.size()});
  CHECK((uncooked.mesh == nullptr) == !uncooked.error.empty());
  return uncooked.error;
}

/// A folder of this test's own.
class Folder {
 public:
  Folder() {
    static int serial = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("otg_cook_" + std::to_string(processId()) + "_" + std::to_string(serial++));
    REQUIRE(std::filesystem::create_directory(path_));
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string file() const { return (path_ / "mesh.otg").string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace

TEST_CASE("a cooked mesh comes back as it was, whatever the mesh") {
  std::vector<samples::NamedMesh> meshes = samples::ordinaryMeshes();
  for (samples::NamedMesh& sample : samples::pathologicalMeshes()) meshes.push_back(std::move(sample));
  for (const samples::NamedMesh& sample : meshes) {
    INFO(sample.name);
    for (const BuildStrategy strategy : {BuildStrategy::kSah, BuildStrategy::kMeanSplit}) {
      const CollisionMesh before(sample.mesh, strategy);
      const Bytes bytes = cookMesh(before);
      CHECK(read64(bytes, bytes.size() - 8) == checksumOf(bytes));
      const UncookedMesh uncooked = uncookMesh(bytes);
      REQUIRE(uncooked.error == "");
      const CollisionMesh& after = *uncooked.mesh;
      REQUIRE(cookMesh(after) == bytes);
      REQUIRE(after.tree().nodes.size() == before.tree().nodes.size());
      REQUIRE(after.tree().strategy == strategy);
      REQUIRE(validateTree(after.tree(), after.mesh()) == validateTree(before.tree(), before.mesh()));
      const ValidationReport &r = before.mesh().report(), &s = after.mesh().report();
      REQUIRE(r.problems.size() == s.problems.size());
      for (std::size_t i = 0; i < r.problems.size(); ++i) {
        CHECK(r.problems[i].kind == s.problems[i].kind);
        CHECK(r.problems[i].elements == s.problems[i].elements);
        CHECK(r.problems[i].message == s.problems[i].message);
      }
      CHECK(r.valid() == s.valid());
      CHECK(after.mesh().meshClass() == before.mesh().meshClass());
      for (std::uint32_t t = 0; t < after.mesh().triangleCount(); ++t) {
        REQUIRE(after.mesh().triangleOfCaller(after.mesh().callerTriangle(t)) == t);
        REQUIRE(after.mesh().isDegenerate(t) == before.mesh().isDegenerate(t));
      }
    }
  }
}

TEST_CASE("bytes that were changed, cut off, or are something else are refused") {
  const Bytes bytes = cookMesh(collisionMesh(scenes::makeLump(1, 1, 0.2, 3)));
  REQUIRE(errorOf(bytes) == "");
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    Bytes changed = bytes;
    changed[i] ^= static_cast<unsigned char>(1u << (i % 8));
    REQUIRE(!errorOf(changed).empty());
  }
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    REQUIRE(!errorOf(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length))).empty());
  }
  Bytes longer = bytes;
  longer.resize(bytes.size() + 64, 0);
  CHECK(errorOf(longer) == "There is more than the cooked mesh.");
  CHECK(errorOf({}) == "This is no cooked mesh.");
  CHECK(errorOf(Bytes(100, 'x')) == "This is no cooked mesh.");
  Bytes newer = bytes;
  newer[8] = kCookedVersion + 1;
  seal(newer);
  CHECK(errorOf(newer) == "The cooked mesh is of version 6; this library reads version 5.");
  Bytes older = bytes;  // of version 2, whose header was shorter
  older[8] = 2;
  CHECK(errorOf(older) == "The cooked mesh is of version 2; this library reads version 5.");
  CHECK(errorOf(Bytes(older.begin(), older.begin() + 40)) == errorOf(older));
  const std::size_t vertices = sectionsOf(bytes)[kVertices].at;
  Bytes swapped = bytes;  // two pairs of words exchanged that the same lane takes up
  std::swap_ranges(&swapped[vertices], &swapped[vertices] + 16, &swapped[vertices] + 128);
  REQUIRE(swapped != bytes);
  CHECK(errorOf(swapped) == "The cooked mesh is damaged.");
  // What a broken wire does: the same bit wrong in many words. Two highest bits must not make up for each other.
  for (std::size_t bit = 0; bit < 64; ++bit) {
    for (const std::size_t apart : {8u, 16u, 64u, 128u, 256u}) {
      Bytes wired = bytes;
      for (const std::size_t word : {vertices, vertices + apart}) {
        wired[word + bit / 8] ^= static_cast<unsigned char>(1u << (bit % 8));
      }
      CHECK(errorOf(wired) == "The cooked mesh is damaged.");
    }
  }
}

TEST_CASE("numbers that point nowhere are refused, or do no harm, also under a checksum that is right") {
  // Whoever makes such bytes does so on purpose. Every section in turn gets hostile numbers; what is accepted all the
  // same must be walked and collided without harm.
  const OdeSession session;
  const Bytes bytes = cookMesh(collisionMesh(scenes::makeLump(1, 1, 0.2, 3)));
  const Data box(scenes::makeBox({1, 1, 1}));
  const std::vector<Section> sections = sectionsOf(bytes);
  REQUIRE(sections.size() == 20);
  std::mt19937 random(77);
  int refused = 0, accepted = 0;
  const auto offer = [&](Bytes& hostile) {
    seal(hostile);
    const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
    const int status = dGpuTriMeshDataUncook(data, hostile.data(), hostile.size());
    if (status == dGPUTRIMESH_OK) {
      ++accepted;
      const dGeomID a = dCreateGpuTriMesh(nullptr, data), b = dCreateGpuTriMesh(nullptr, box.id);
      dGeomSetPosition(b, 0.6, 0.1, 0.2);
      for (const dContactGeom& c : test::collide(a, b)) CHECK(std::isfinite(c.depth));
      dGeomDestroy(a);
      dGeomDestroy(b);
    } else {
      ++refused;
      CHECK(status == dGPUTRIMESH_ERROR_COOKED);
      CHECK(std::string(dGpuTriMeshDataGetErrorString(data)) != "");
    }
    dGpuTriMeshDataDestroy(data);
  };
  for (const std::size_t head : {8u, 16u, 24u, 32u, 56u}) {
    for (const std::uint64_t wrong : {std::uint64_t{0}, std::uint64_t{19}, std::uint64_t{21}, std::uint64_t{1000},
                                      std::uint64_t{bytes.size() - 64}, ~std::uint64_t{0}, std::uint64_t{1} << 61}) {
      Bytes hostile = bytes;
      write64(hostile, head, wrong);
      offer(hostile);
    }
  }
  for (const Section& section : sections) {
    const std::size_t length = section.size;
    for (const std::uint64_t wrong :
         {std::uint64_t{0}, std::uint64_t(length + 1), std::uint64_t(length + 8), std::uint64_t(length / 2),
          std::uint64_t(bytes.size()), ~std::uint64_t{0}, std::uint64_t{1} << 40, ~std::uint64_t{0} - 6}) {
      Bytes hostile = bytes;
      write64(hostile, section.entry, wrong);
      offer(hostile);
    }
    if (length == 0) continue;
    for (int round = 0; round < 60; ++round) {
      Bytes hostile = bytes;
      const std::size_t at = section.at + random() % length / 4 * 4;
      const std::uint32_t values[] = {0,
                                      1,
                                      0xffffffffu,
                                      0x7fffffffu,
                                      0x80000000u,
                                      0x7fc00000u,
                                      0x7f800000u,
                                      static_cast<std::uint32_t>(random()),
                                      static_cast<std::uint32_t>(random() % 100)};
      const std::uint32_t value = values[random() % std::size(values)];
      for (std::size_t i = 0; i < 4 && at + i < bytes.size() - 8; ++i) {
        hostile[at + i] = static_cast<unsigned char>(value >> (8 * i));
      }
      offer(hostile);
    }
  }
  CHECK(refused > 500);
  CHECK(accepted > 20);  // such as another area in the report
}

TEST_CASE("what does not make a mesh is named, under a checksum that is right") {
  const Bytes bytes = cookMesh(collisionMesh(scenes::makeLump(1, 1, 0.2, 3)));
  const std::vector<Section> sections = sectionsOf(bytes);
  // The first `size` bytes of two elements of a section are exchanged.
  const auto exchanged = [&](std::size_t section, std::size_t a, std::size_t b, std::size_t size) {
    Bytes changed = bytes;
    unsigned char* const at = &changed[sections[section].at];
    std::swap_ranges(at + a, at + a + size, at + b);
    REQUIRE(changed != bytes);
    seal(changed);
    return errorOf(changed);
  };
  const auto with = [&](std::size_t section, std::size_t at, std::uint32_t value) {
    Bytes changed = bytes;
    for (std::size_t i = 0; i < 4; ++i)
      changed[sections[section].at + at + i] = static_cast<unsigned char>(value >> (8 * i));
    REQUIRE(changed != bytes);
    seal(changed);
    return errorOf(changed);
  };
  const auto nodes = sections[kNodes].size / 32;
  CHECK(with(kVertices, 4, 0x7f800000u) == "The cooked mesh has a vertex or bound that is not finite.");
  CHECK(with(kTriangles, 8, 0x00ffffffu) == "The cooked mesh has a number out of range.");
  CHECK(exchanged(kTwin, 0, 40, 4) == "The cooked mesh has neighbours that do not match.");
  CHECK(with(kTwin, 0, 0xffffffffu) == "The cooked mesh has neighbours that do not match.");
  CHECK(with(kTwin, 0, 0x10000000u) == "The cooked mesh has neighbours that do not match.");
  CHECK(with(kDegenerate, sections[kDegenerate].size - 4, 0x01000000u) ==
        "The cooked mesh has bounds or areas that do not match.");  // a triangle with area that says it has none
  CHECK(exchanged(kCallerTriangle, 0, 4, 4) == "The cooked mesh has numbers of triangles that do not match.");
  CHECK(with(kNodes, 28, 0) == "The cooked mesh has nodes that do not make a tree.");       // no root
  CHECK(with(kNodes, 32 + 28, 1) == "The cooked mesh has nodes that do not make a tree.");  // its own parent
  CHECK(with(kNodes, 32 * (nodes - 1) + 28, 0) == "The cooked mesh has nodes that do not make a tree.");  // adopted
  CHECK(with(kNodes, 24, 3) == "The cooked mesh has nodes that do not make a tree.");
  CHECK(with(kNodes, 24, 0xffffffffu) == "The cooked mesh has nodes that do not make a tree.");  // the root as a leaf
  CHECK(with(kNodes, 32 * (nodes - 1) + 24, 0xfffffffeu) == "The cooked mesh has a triangle without a leaf.");
  CHECK(with(kNodes, 32 * (nodes - 1) + 20, 0xff800000u) == "The cooked mesh has a box that is not finite.");
  Bytes deep = bytes;
  const std::size_t depth = sections[kCounts].at + sections[kCounts].size - 16;
  write64(deep, depth, read64(deep, depth) - 1);
  seal(deep);
  CHECK(errorOf(deep) == "The cooked mesh has a tree of another depth.");
}

TEST_CASE("what happens to a file after it was loaded does not matter, and while it is read is noticed") {
  const OdeSession session;
  const Folder folder;
  const Data ground(scenes::makeGround(4, 0.5, 8));
  const scenes::MeshArrays lump = scenes::makeLump(0.5, 5, 0.2, 4);
  const Data built(lump);
  REQUIRE(dGpuTriMeshDataSave(built.id, folder.file().c_str()) == dGPUTRIMESH_OK);
  const dGpuTriMeshDataID loaded = dGpuTriMeshDataCreate();
  REQUIRE(dGpuTriMeshDataLoad(loaded, folder.file().c_str()) == dGPUTRIMESH_OK);
  {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(folder.file().c_str(), "r+b"), std::fclose);
    REQUIRE(file != nullptr);
    const Bytes noise(100000, 0x55);
    REQUIRE(std::fwrite(noise.data(), 1, noise.size(), file.get()) == noise.size());
    REQUIRE(std::fflush(file.get()) == 0);
  }
  std::filesystem::resize_file(folder.file(), 4096);
  const Geom floor(ground), a(built);
  const dGeomID b = dCreateGpuTriMesh(nullptr, loaded);
  for (const dGeomID g : {a.id, b}) dGeomSetPosition(g, 0.1, 0.2, 0.4);
  auto wanted = test::collide(floor.id, a.id);
  REQUIRE(!wanted.empty());
  for (dContactGeom& c : wanted) c.g2 = b;
  CHECK(sameContacts(test::collide(floor.id, b), wanted));
  dGeomDestroy(b);
  CHECK(dGpuTriMeshDataLoad(loaded, folder.file().c_str()) == dGPUTRIMESH_ERROR_COOKED);
  dGpuTriMeshDataDestroy(loaded);
  // A file that loses its end after it was measured, here at every multiple of a prime.
  const Bytes bytes = cookMesh(collisionMesh(lump));
  for (std::size_t left = 0; left < bytes.size(); left += 4099) {
    std::FILE* const file = std::fopen(folder.file().c_str(), "w+b");
    REQUIRE(file != nullptr);
    REQUIRE(std::fwrite(bytes.data(), 1, left, file) == left);
    std::rewind(file);
    const UncookedMesh uncooked = uncookFile(file, bytes.size());
    std::fclose(file);
    CHECK(uncooked.mesh == nullptr);
    CHECK(uncooked.error == (left < 8 ? "This is no cooked mesh." : "The cooked mesh is cut off."));
  }
}

TEST_CASE("a loaded mesh collides with the same contacts as the built one, and can be updated") {
  const OdeSession session;
  const Folder folder;
  const scenes::MeshArrays lump = scenes::makeLump(0.5, 3, 0.2, 4);
  const Data built(lump), ground(scenes::makeGround(4, 0.5, 8));
  REQUIRE(dGpuTriMeshDataSave(built.id, folder.file().c_str()) == dGPUTRIMESH_OK);
  const dGpuTriMeshDataID loaded = dGpuTriMeshDataCreate();
  REQUIRE(dGpuTriMeshDataLoad(loaded, folder.file().c_str()) == dGPUTRIMESH_OK);
  CHECK(std::string(dGpuTriMeshDataGetErrorString(loaded)) == "");
  dGpuTriMeshReport one, two;
  dGpuTriMeshReportInit(&one);
  dGpuTriMeshReportInit(&two);
  REQUIRE(dGpuTriMeshDataGetReport(built.id, &one) == dGPUTRIMESH_OK);
  REQUIRE(dGpuTriMeshDataGetReport(loaded, &two) == dGPUTRIMESH_OK);
  CHECK(std::memcmp(&one, &two, sizeof(one)) == 0);
  const Geom floor(ground);
  for (int round = 0; round < 2; ++round) {
    const Geom a(built);
    const dGeomID b = dCreateGpuTriMesh(nullptr, loaded);
    for (const dGeomID g : {a.id, b}) dGeomSetPosition(g, 0.1, 0.2, 0.4);
    auto wanted = test::collide(floor.id, a.id);
    CHECK(!wanted.empty());
    for (dContactGeom& c : wanted) c.g2 = b;
    CHECK(sameContacts(test::collide(floor.id, b), wanted));
    dGeomDestroy(b);
    std::vector<Vec3f> moved = lump.vertices;
    for (Vec3f& v : moved) v.z *= 1.3f;
    for (const dGpuTriMeshDataID data : {built.id, loaded}) {
      REQUIRE(dGpuTriMeshDataUpdateVerticesSingle(data, moved.data(), 0, static_cast<int>(moved.size())) ==
              dGPUTRIMESH_OK);
    }
  }
  dGpuTriMeshDataDestroy(loaded);
}

TEST_CASE("errors of the C API of cooking") {
  const Folder folder;
  const Data box(scenes::makeBox({1, 1, 1}));
  const dsizeint size = dGpuTriMeshDataCook(box.id, nullptr, 0);
  REQUIRE(size > 0);
  Bytes bytes(size, 0xee);
  CHECK(dGpuTriMeshDataCook(box.id, bytes.data(), size - 1) == size);
  CHECK(bytes == Bytes(size, 0xee));  // nothing was written
  CHECK(dGpuTriMeshDataCook(box.id, bytes.data(), size) == size);
  const dGpuTriMeshDataID data = dGpuTriMeshDataCreate();
  CHECK(dGpuTriMeshDataCook(data, nullptr, 0) == 0);
  CHECK(dGpuTriMeshGetError() == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataCook(box.id, nullptr, 1) == 0);
  CHECK(dGpuTriMeshDataSave(data, folder.file().c_str()) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataSave(box.id, nullptr) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataSave(box.id, "/no/such/folder/mesh") == dGPUTRIMESH_ERROR_FILE);
  CHECK(dGpuTriMeshDataLoad(data, folder.file().c_str()) == dGPUTRIMESH_ERROR_FILE);
  CHECK(dGpuTriMeshDataLoad(data, "/tmp") == dGPUTRIMESH_ERROR_FILE);
  CHECK(dGpuTriMeshDataUncook(data, nullptr, 0) == dGPUTRIMESH_ERROR_ARGUMENT);
  CHECK(dGpuTriMeshDataUncook(nullptr, bytes.data(), size) == dGPUTRIMESH_ERROR_ARGUMENT);
  // Unaligned bytes, and an object that keeps its mesh when others are refused.
  Bytes shifted(size + 3);
  std::copy(bytes.begin(), bytes.end(), shifted.begin() + 3);
  CHECK(dGpuTriMeshDataUncook(data, shifted.data() + 3, size) == dGPUTRIMESH_OK);
  CHECK(dGpuTriMeshDataUncook(data, shifted.data(), size) == dGPUTRIMESH_ERROR_COOKED);
  CHECK(std::string(dGpuTriMeshDataGetErrorString(data)) == "This is no cooked mesh.");
  CHECK(dGpuTriMeshDataCook(data, nullptr, 0) == size);
  dGpuTriMeshDataDestroy(data);
}
