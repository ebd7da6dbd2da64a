// SPDX-License-Identifier: BSD-3-Clause
// Wavefront OBJ: vertices and faces; everything that is not geometry of surfaces is passed over.
#include "mesh_io/readers.h"
#include "mesh_io/text.h"

namespace otg::mesh_io {
namespace {

/// "7", "7/1", "7//3", "-1/2/3": the vertex alone. OBJ counts from 1, and from the newest vertex backwards below 0.
std::uint32_t parseCorner(std::string_view word, std::size_t vertexCount) {
  const std::int64_t index = parseInteger(word.substr(0, word.find('/')));
  return toIndex(index < 0 ? index + static_cast<std::int64_t>(vertexCount) : index - 1);
}

void readLine(std::string_view line, MeshFile& mesh) {
  const std::string_view word = takeWord(line);
  if (word == "v") {
    Vec3d p{};
    p.x = parseReal(takeWord(line));
    p.y = parseReal(takeWord(line));
    p.z = parseReal(takeWord(line));
    mesh.vertices.push_back(p);
  } else if (word == "f" || word == "fo") {
    std::uint32_t first = 0, before = 0;
    int corners = 0;
    for (std::string_view corner = takeWord(line); !corner.empty(); corner = takeWord(line)) {
      const std::uint32_t current = parseCorner(corner, mesh.vertices.size());
      if (corners == 0) first = current;
      if (corners >= 2) mesh.triangles.push_back({{first, before, current}});
      before = current;
      ++corners;
    }
    if (corners < 3) throw std::runtime_error("a face with " + std::to_string(corners) + " corners");
  }
}

}  // namespace

MeshFile readObj(std::string_view bytes) {
  if (bytes.find('\0') != std::string_view::npos) throw std::runtime_error("not an OBJ file: it holds binary data");
  MeshFile mesh;
  std::string_view line;
  std::string joined;
  std::size_t number = 0;
  try {
    while (takeLine(bytes, line)) {
      ++number;
      line = line.substr(0, line.find('#'));
      if (!line.empty() && line.back() == '\\') {  // continued on the next line
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
        continue;
      }
      if (joined.empty()) {
        readLine(line, mesh);
      } else {
        joined.append(line);
        readLine(joined, mesh);
        joined.clear();
      }
    }
    if (!joined.empty()) throw std::runtime_error("the file ends in a continued line");
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("line " + std::to_string(number) + ": " + error.what());
  }
  if (mesh.vertices.empty()) throw std::runtime_error("not an OBJ file: it has no vertices");
  return mesh;
}

}  // namespace otg::mesh_io
