// SPDX-License-Identifier: BSD-3-Clause
// OFF text files, with the optional prefixes for what follows a vertex (colour, normal, texture), which is skipped.
#include "mesh_io/readers.h"
#include "mesh_io/text.h"

namespace otg::mesh_io {
namespace {

/// Lines without comments and without empty ones, counted for messages.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}
  std::string_view take() {
    std::string_view line;
    while (takeLine(rest_, line)) {
      ++number_;
      line = line.substr(0, line.find('#'));
      std::string_view probe = line;
      if (!takeWord(probe).empty()) return line;
    }
    throw std::runtime_error("the file is cut off");
  }
  std::size_t number() const { return number_; }
  std::size_t bytesLeft() const { return rest_.size(); }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

MeshFile readBody(Lines& lines) {
  std::string_view line = lines.take();
  std::string_view probe = line;
  std::string_view word = takeWord(probe);
  if (!word.ends_with("OFF")) throw std::runtime_error("not an OFF file: it does not start with 'OFF'");
  const std::string_view prefix = word.substr(0, word.size() - 3);
  if (prefix.find_first_not_of("STCN") != std::string_view::npos) {
    throw std::runtime_error("the OFF variant " + quoted(word) + " is not supported");
  }
  line = probe;
  word = takeWord(probe);
  if (word == "BINARY") throw std::runtime_error("binary OFF is not supported");
  if (word.empty()) line = lines.take();
  const std::int64_t vertexCount = parseInteger(takeWord(line));
  const std::int64_t faceCount = parseInteger(takeWord(line));
  if (vertexCount < 0 || faceCount < 0) throw std::runtime_error("a negative count");
  // A vertex takes six bytes at least ("0 0 0\n"), a triangle eight; the last line may lack its end.
  if (std::uint64_t(vertexCount) > lines.bytesLeft() / 6 + 1 || std::uint64_t(faceCount) > lines.bytesLeft() / 8 + 1) {
    throw std::runtime_error("the file is cut off: it announces " + std::to_string(vertexCount) + " vertices and " +
                             std::to_string(faceCount) + " faces, but only " + std::to_string(lines.bytesLeft()) +
                             " bytes follow");
  }
  MeshFile mesh;
  mesh.vertices.resize(static_cast<std::size_t>(vertexCount));
  for (Vec3d& vertex : mesh.vertices) {
    line = lines.take();
    vertex.x = parseReal(takeWord(line));
    vertex.y = parseReal(takeWord(line));
    vertex.z = parseReal(takeWord(line));
  }
  mesh.triangles.reserve(static_cast<std::size_t>(faceCount));
  for (std::int64_t face = 0; face < faceCount; ++face) {
    line = lines.take();
    const std::int64_t corners = parseInteger(takeWord(line));
    if (corners < 3) {
      throw std::runtime_error("face " + std::to_string(face) + " has " + std::to_string(corners) + " corners");
    }
    const std::uint32_t first = toIndex(parseInteger(takeWord(line)));
    std::uint32_t before = toIndex(parseInteger(takeWord(line)));
    for (std::int64_t k = 2; k < corners; ++k) {
      const std::uint32_t current = toIndex(parseInteger(takeWord(line)));
      mesh.triangles.push_back({{first, before, current}});
      before = current;
    }
  }
  return mesh;
}

}  // namespace

MeshFile readOff(std::string_view bytes) {
  Lines lines(bytes);
  try {
    return readBody(lines);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("line " + std::to_string(lines.number()) + ": " + error.what());
  }
}

}  // namespace otg::mesh_io
