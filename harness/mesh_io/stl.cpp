// SPDX-License-Identifier: BSD-3-Clause
// STL, text and binary. Facets keep their order; equal corners are joined because the format cannot share them.
#include <bit>
#include <cstring>

#include "mesh_io/readers.h"
#include "mesh_io/text.h"

namespace otg::mesh_io {
namespace {

constexpr std::size_t kHeaderBytes = 84;  // 80 free bytes, then the count
constexpr std::size_t kFacetBytes = 50;   // normal and three corners as floats, two bytes of attributes

std::uint32_t littleEndian32(const char* p) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(p[i]);
  return value;
}

void addFacet(MeshFile& mesh) {
  const auto end = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.triangles.push_back({{end - 3, end - 2, end - 1}});
}

MeshFile readBinary(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes) {
    throw std::runtime_error("neither a text STL (no 'solid') nor a binary one (shorter than its header)");
  }
  const std::uint64_t count = littleEndian32(bytes.data() + 80);
  const std::uint64_t expected = kHeaderBytes + kFacetBytes * count;
  if (bytes.size() < expected) {
    throw std::runtime_error("not an STL file, or it is cut off: the binary header announces " + std::to_string(count) +
                             " facets, which need " + std::to_string(expected) + " bytes; the file has " +
                             std::to_string(bytes.size()));
  }
  MeshFile mesh;
  mesh.vertices.reserve(3 * count);
  mesh.triangles.reserve(count);
  for (std::uint64_t facet = 0; facet < count; ++facet) {
    const char* p = bytes.data() + kHeaderBytes + kFacetBytes * facet + 12;
    for (int corner = 0; corner < 3; ++corner, p += 12) {
      mesh.vertices.push_back({std::bit_cast<float>(littleEndian32(p)), std::bit_cast<float>(littleEndian32(p + 4)),
                               std::bit_cast<float>(littleEndian32(p + 8))});
    }
    addFacet(mesh);
  }
  return mesh;
}

MeshFile readText(std::string_view bytes) {
  MeshFile mesh;
  std::string_view line;
  std::size_t number = 0, corners = 0;
  bool inFacet = false;
  try {
    while (takeLine(bytes, line)) {
      ++number;
      const std::string_view word = takeWord(line);
      if (word == "facet") {
        if (inFacet) throw std::runtime_error("a facet inside a facet");
        inFacet = true;
        corners = 0;
      } else if (word == "vertex") {
        if (!inFacet) throw std::runtime_error("a vertex outside of a facet");
        Vec3d p{};
        p.x = parseReal(takeWord(line));
        p.y = parseReal(takeWord(line));
        p.z = parseReal(takeWord(line));
        mesh.vertices.push_back(p);
        ++corners;
      } else if (word == "endfacet") {
        if (corners != 3) throw std::runtime_error("a facet with " + std::to_string(corners) + " corners");
        addFacet(mesh);
        inFacet = false;
      } else if (!word.empty() && word != "solid" && word != "outer" && word != "endloop" && word != "endsolid") {
        throw std::runtime_error("unknown word " + quoted(word));
      }
    }
    if (inFacet) throw std::runtime_error("the file is cut off inside a facet");
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("line " + std::to_string(number) + ": " + error.what());
  }
  return mesh;
}

/// Binary files may start with "solid" too: there the count decides, and text has no zero bytes.
bool isText(std::string_view bytes) {
  std::string_view start = bytes.substr(0, 512);
  if (start.find('\0') != std::string_view::npos) return false;
  if (bytes.size() >= kHeaderBytes &&
      bytes.size() == kHeaderBytes + kFacetBytes * std::uint64_t{littleEndian32(bytes.data() + 80)}) {
    return false;
  }
  std::string_view line;
  while (takeLine(start, line)) {
    const std::string_view word = takeWord(line);
    if (!word.empty()) return word == "solid";
  }
  return false;
}

}  // namespace

MeshFile readStl(std::string_view bytes) {
  MeshFile mesh = isText(bytes) ? readText(bytes) : readBinary(bytes);
  joinEqualVertices(mesh);
  return mesh;
}

}  // namespace otg::mesh_io
