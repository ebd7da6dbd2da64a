// SPDX-License-Identifier: BSD-3-Clause
// Reads the OFF files that Debian's libcgal-demo ships.
#include "oracle/off_mesh.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace otg::test {

scenes::MeshArrays readOff(const std::string& path) {
  std::ifstream file(path);
  std::stringstream words;
  for (std::string line; std::getline(file, line);) words << line.substr(0, line.find('#')) << '\n';
  std::string magic;
  std::size_t vertices = 0, faces = 0, edges = 0;
  if (!(words >> magic >> vertices >> faces >> edges) || magic != "OFF") {
    throw std::runtime_error(path + ": not an OFF file");
  }
  scenes::MeshArrays mesh;
  mesh.vertices.resize(vertices);
  for (Vec3f& v : mesh.vertices) words >> v.x >> v.y >> v.z;
  for (std::size_t i = 0; i < faces; ++i) {
    std::size_t corners = 0;
    std::uint32_t first = 0, previous = 0, next = 0;
    words >> corners >> first >> previous;
    for (std::size_t k = 2; k < corners && words; ++k) {
      words >> next;
      mesh.triangles.push_back({{first, previous, next}});
      previous = next;
    }
  }
  if (!words) throw std::runtime_error(path + ": ends early");
  return mesh;
}

}  // namespace otg::test
