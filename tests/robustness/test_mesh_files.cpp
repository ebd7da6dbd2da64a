// SPDX-License-Identifier: BSD-3-Clause
// The mesh readers: every encoding of the same numbers, the file's order, and no byte read that is not there.
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "mesh_io/readers.h"
#include "support/catch.h"

using otg::Triangle;
using otg::Vec3d;
using otg::mesh_io::MeshFile;

namespace {

template <class T>
std::string bytesOf(T value, bool big) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  std::string text(raw, sizeof(T));
  return big == (std::endian::native == std::endian::big) ? text : std::string(text.rbegin(), text.rend());
}

/// Two triangles and a quadrilateral on five vertices, with a colour before and a list after the coordinates.
std::string binaryPly(bool big) {
  std::string text = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                     "_endian 1.0\r\ncomment format of nothing\r\nelement vertex 5\r\nproperty uchar red\r\n"
                     "property double x\r\nproperty float y\r\nproperty short z\r\nproperty list ushort float extra\r\n"
                     "element camera 2\r\nproperty int id\r\nelement face 3\r\nproperty float quality\r\n"
                     "property list int uint vertex_index\r\nend_header\r\n";
  for (int i = 0; i < 5; ++i) {
    text += bytesOf(static_cast<std::uint8_t>(i), big) + bytesOf(0.1 * i, big) + bytesOf(0.5f * float(i), big) +
            bytesOf(static_cast<std::int16_t>(-i), big) + bytesOf(static_cast<std::uint16_t>(i % 2), big);
    if (i % 2 == 1) text += bytesOf(9.0f, big);
  }
  text += bytesOf(std::int32_t{1}, big) + bytesOf(std::int32_t{2}, big);
  const auto face = [&](std::initializer_list<std::uint32_t> corners) {
    text += bytesOf(1.0f, big) + bytesOf(static_cast<std::int32_t>(corners.size()), big);
    for (const std::uint32_t v : corners) text += bytesOf(v, big);
  };
  face({4, 2, 0});
  face({0, 1, 2, 3});
  face({3, 1, 4000000000u});
  return text;
}

void checkPly(const MeshFile& mesh) {
  REQUIRE(mesh.vertices.size() == 5);
  for (int i = 0; i < 5; ++i) CHECK(mesh.vertices[std::size_t(i)] == Vec3d{0.1 * i, 0.5 * i, double(-i)});
  CHECK(mesh.triangles == std::vector<Triangle>{{{4, 2, 0}}, {{0, 1, 2}}, {{0, 2, 3}}, {{3, 1, 4000000000u}}});
}

}  // namespace

TEST_CASE("PLY in both byte orders, with properties and elements around what matters") {
  checkPly(otg::mesh_io::readPly(binaryPly(false)));
  checkPly(otg::mesh_io::readPly(binaryPly(true)));
}

TEST_CASE("PLY as text") {
  const MeshFile mesh = otg::mesh_io::readPly(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0.1 -2e3 +7\nnan inf -inf\n1e400 -1e400 1e-400\n3 2 1 -1");
  CHECK(mesh.vertices[0] == Vec3d{0.1, -2000, 7});
  CHECK(std::isnan(mesh.vertices[1].x));
  CHECK(mesh.vertices[1].z == -INFINITY);
  CHECK(mesh.vertices[2] == Vec3d{INFINITY, -INFINITY, 0});
  CHECK(mesh.triangles == std::vector<Triangle>{{{2, 1, 0xffffffffu}}});
}

TEST_CASE("Every cut of a PLY file is refused") {
  const std::string whole = binaryPly(false);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    // A copy of exactly that length, so that a read beyond it is seen by the sanitizers.
    const std::vector<char> cut(whole.begin(), whole.begin() + std::ptrdiff_t(length));
    CHECK_THROWS_AS(otg::mesh_io::readPly({cut.data(), cut.size()}), std::runtime_error);
  }
}

TEST_CASE("PLY headers that make no sense are refused") {
  const std::string body = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  for (const std::string& header :
       {std::string("plx\n"), std::string("ply\nend_header\n"), std::string("ply\nformat ascii 1.0\nend_header\n"),
        "ply\nformat morse 1.0\n" + body + "end_header\n1 2 3\n", "ply\nformat ascii 1.0\n" + body + "1 2 3\n",
        std::string("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
        std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
        std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n"),
        std::string("ply\nformat ascii 1.0\nelement vertex many\nend_header\n"),
        "ply\nformat ascii 1.0\n" + body +
            "element face 1\nproperty list uchar float vertex_indices\nend_header\n1 2 3\n3 0 0 0\n",
        "ply\nformat ascii 1.0\n" + body +
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n2 0 0\n",
        "ply\nformat ascii 1.0\n" + body + "end_header\n1 2 x\n"}) {
    INFO(header);
    CHECK_THROWS_AS(otg::mesh_io::readPly(header), std::runtime_error);
  }
}

TEST_CASE("OFF with comments, counts on the first line, polygons, colours and prefixes") {
  for (const std::string start :
       {"OFF\n4 2 0\n", "OFF 4 2 5\n", "# hello\nCOFF # x\n\n4 2 0 # counts\n", "STCNOFF\r\n4 2 0\r\n"}) {
    const MeshFile mesh =
        otg::mesh_io::readOff(start + "0 0 0\n1 0 0 255 0 0\n\n1 1 0 # corner\n0 1 .5\n4 0 1 2 3 0.5 0.5 0.5\n3 3 2 1");
    CHECK(mesh.vertices == std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5}});
    CHECK(mesh.triangles == std::vector<Triangle>{{{0, 1, 2}}, {{0, 2, 3}}, {{3, 2, 1}}});
  }
  for (const std::string bad :
       {"", "OFT\n1 1 1\n", "OFF\n1\n", "OFF\n1 0 0\n1 2\n", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "OFF BINARY\n", "4OFF\n0 0 0\n"}) {
    INFO(bad);
    CHECK_THROWS_AS(otg::mesh_io::readOff(bad), std::runtime_error);
  }
}

TEST_CASE("OBJ keeps the file's vertices and faces") {
  const MeshFile mesh = otg::mesh_io::readObj(
      "# comment\nmtllib x.mtl\no thing\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nvn 0 0 1\nvt 0 0\nv 1 1 0\nusemtl m\n"
      "f 1/1/1 2//1 3/1\ng two\nv 0 1 0\r\nf -4 -2 \\\n -1\nf 1 2 3 4\nf 9 1 2\nf 0 1 2\n");
  CHECK(mesh.vertices == std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  CHECK(mesh.triangles ==
        std::vector<Triangle>{{{0, 1, 2}}, {{0, 2, 3}}, {{0, 1, 2}}, {{0, 2, 3}}, {{8, 0, 1}}, {{0xffffffffu, 0, 1}}});
  for (const std::string bad :
       {"hello\n", "v 1 2\n", "v 1 2 x\n", "v 1 2 3\nf 1 1\n", "v 1 2 3\nf 1 1 a\n", "v 1 2 3\nf 1 \\"}) {
    INFO(bad);
    CHECK_THROWS_AS(otg::mesh_io::readObj(bad), std::runtime_error);
  }
}

TEST_CASE("STL joins equal corners in the order of first appearance") {
  const std::vector<Vec3d> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<Triangle> triangles{{{0, 1, 2}}, {{2, 1, 3}}};
  std::string binary(80, 's');
  binary += bytesOf(std::uint32_t{2}, false);
  std::string text = "solid thing\n";
  for (const Triangle& t : triangles) {
    binary += std::string(12, '\0');
    text += "  facet normal 0 0 1\n outer loop\n";
    for (const std::uint32_t v : t.v) {
      // Minus zero is the same place as zero.
      const Vec3d& p = vertices[v];
      const float z = &t == &triangles[1] && p.z == 0 ? -0.0f : float(p.z);
      for (const float x : {float(p.x), float(p.y), z}) {
        binary += bytesOf(x, false);
      }
      text += "vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(z) + "\n";
    }
    binary += "ab";
    text += "endloop\nendfacet\n";
  }
  text += "endsolid thing\n";
  for (const std::string& file : {binary, text}) {
    const MeshFile mesh = otg::mesh_io::readStl(file);
    CHECK(mesh.vertices == vertices);
    CHECK(mesh.triangles == triangles);
  }
  for (std::size_t length = 0; length < binary.size(); ++length) {
    const std::vector<char> cut(binary.begin(), binary.begin() + std::ptrdiff_t(length));
    CHECK_THROWS_AS(otg::mesh_io::readStl({cut.data(), cut.size()}), std::runtime_error);
  }
  for (const std::string bad : {"solid\nfacet\nvertex 1 2 3\nendfacet\n", "solid\nfacet\nvertex 1 2 3\n",
                                "solid\nhello\n", "solid\nvertex 1 2 3\n", "solid\nfacet\nvertex 1 2\n"}) {
    INFO(bad);
    CHECK_THROWS_AS(otg::mesh_io::readStl(bad), std::runtime_error);
  }
}

TEST_CASE("Joining never merges NaN with anything else") {
  MeshFile mesh;
  mesh.vertices = {{NAN, 0, 0}, {0, 0, 0}, {-0.0, 0, 0}, {0, NAN, 0}};
  mesh.triangles = {{{0, 1, 2}}, {{3, 2, 77}}};
  otg::mesh_io::joinEqualVertices(mesh);
  CHECK(mesh.vertices.size() == 3);
  CHECK(mesh.triangles == std::vector<Triangle>{{{0, 1, 1}}, {{2, 1, otg::kNone}}});
}
