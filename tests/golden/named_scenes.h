// SPDX-License-Identifier: BSD-3-Clause
// The scenes whose numbers may only change on purpose, and the files that hold those numbers.
//
// OTG_UPDATE_GOLDEN=1 in the environment writes a file anew; the change then shows in the diff and belongs in a commit
// whose message gives its reason.
#pragma once

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "scenes/generated_meshes.h"
#include "support/catch.h"
#include "support/draw.h"

namespace otg::test {

struct NamedScene {
  const char* name;
  scenes::MeshArrays a, b;
  Transformd bInA;
};

inline std::vector<NamedScene> namedScenes() {
  using namespace scenes;
  const Vec3d x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1}, oblique = {0.48, 0.6, 0.64};
  const auto hills = [](double px, double py) { return 0.2 * std::sin(2 * px) * std::cos(3 * py); };
  const MeshArrays box = makeBox({1, 1, 1}, 1), fineBox = makeBox({1, 1, 1}, 8);
  const MeshArrays sphere = makeSphere(1, 4), torus = makeTorus(1, 0.3, 48, 24), lump = makeLump(1, 5, 0.2, 3);
  return {
      {"box_on_box_aligned", box, box, makeMove({0, 0, 0.999})},
      {"box_on_box_touching", box, box, makeMove({0, 0, 1})},
      {"box_on_box_turned", fineBox, fineBox, makePose(z, 0.5, {0, 0, 0.999})},
      {"box_corner_in_box", fineBox, fineBox, makePose(oblique, 1, {0.2, 0.1, 1.1})},
      {"box_on_ground_2", makeGround(10, 1, 1), box, makeMove({0.3, 0.2, 0.4999})},
      {"box_on_ground_8192", makeGround(10, 1, 64), box, makeMove({0.3, 0.2, 0.4999})},
      {"lump_on_hills", makeGround(6, 1, 48, hills), makeLump(0.8, 4, 0.1, 7), makePose(oblique, 2, {0.1, 0.3, 0.75})},
      {"spheres_overlapping", sphere, sphere, makePose(y, 0.3, {1.8, 0.1, 0})},
      {"sphere_on_itself", makeSphere(1, 3), makeSphere(1, 3), makeMove({0, 0, 0})},
      {"sphere_inside_sphere", sphere, makeSphere(0.5, 3), makeMove({0.1, 0, 0})},
      {"tori_linked", torus, torus, makePose(x, 1.5, {1.0, 0.45, 0})},
      {"tori_stacked", torus, torus, makePose(z, 0.1, {0.01, 0, 0.59})},
      {"bowls_nested", makeBowl(1, 0.1, 48, 12), makeBowl(0.9, 0.1, 48, 12), makePose(x, 0.02, {0, 0, -0.005})},
      {"lumps_shallow", lump, makeLump(1, 5, 0.2, 8), makePose(oblique, 0.7, {1.7, 0.4, 0.1})},
      {"lumps_deep", lump, makeLump(1, 5, 0.2, 8), makePose(oblique, 0.7, {0.6, 0.4, 0.1})},
      {"cylinder_across_box", makeCylinder(0.3, 4, 32, 12), fineBox, makePose(x, 0.8, {0, 0.4, 0.2})},
      {"gears_meshing", makeGear(20, 1, 0.2, 0.3, 0.2), makeGear(12, 0.6, 0.2, 0.3, 0.1),
       makePose(z, 0.26, {1.55, 0, 0.02})},
      {"peg_in_hole", makeBlockWithHole({2, 2, 1}, 0.505), makeBox({0.5, 0.5, 2}, 4),
       makePose(y, 0.02, {0.001, 0, 0.3})},
      {"nut_on_bolt", makeBolt(0.3, 0.1, 0.6, 32), makeNut(0.3, 0.1, 0.25, 0.003, 32),
       makePose(z, 0.7, {0.002, 0, 0.15})},
  };
}

/// Compares lines, each of which begins with a name, with those of a file; or writes the file.
inline void checkGolden(const std::string& file, const std::string& header, const std::vector<std::string>& lines) {
  const char* update = std::getenv("OTG_UPDATE_GOLDEN");
  if (update && std::string(update) == "1") {
    std::ofstream out(file);
    out << header;
    for (const std::string& line : lines) out << line << '\n';
    out.close();
    REQUIRE(out);
    WARN("wrote " << file);
    return;
  }
  const auto nameOf = [](const std::string& line) { return line.substr(0, line.find(' ')); };
  std::ifstream in(file);
  REQUIRE(in);
  std::map<std::string, std::string> expected;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line[0] != '#') expected[nameOf(line)] = line;
  }
  CHECK(expected.size() == lines.size());
  for (const std::string& line : lines) CHECK(expected[nameOf(line)] == line);
}

}  // namespace otg::test
