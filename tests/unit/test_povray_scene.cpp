// SPDX-License-Identifier: BSD-3-Clause
// The frames for POV-Ray, read back: surfaces written once, normals smooth where the surface is and sharp where it is
// not, bodies where they were at the frame's time.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/generated_meshes.h"
#include "scenes/povray_scene.h"
#include "support/catch.h"

using namespace otg;

namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path);
  REQUIRE(stream);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// All vectors of the first list called `name` after `from` in `text`.
std::vector<Vec3d> vectors(const std::string& text, const std::string& name, std::size_t from) {
  const std::size_t begin = text.find(name + " {", from), end = text.find('}', begin);
  REQUIRE(begin != std::string::npos);
  std::string list = text.substr(begin, end - begin);
  std::replace_if(
      list.begin(), list.end(), [](char c) { return c == '<' || c == '>' || c == ',' || c == '{'; }, ' ');
  std::istringstream words(list);
  std::string word;
  std::size_t count = 0;
  words >> word >> count;
  std::vector<Vec3d> result;
  for (Vec3d v{}; words >> v.x >> v.y >> v.z;) result.push_back(v);
  CHECK(result.size() == count);
  return result;
}

std::vector<double> matrixOf(const std::string& line) {
  std::smatch match;
  REQUIRE(std::regex_search(line, match, std::regex("matrix <([^>]*)>")));
  std::istringstream numbers(std::regex_replace(match[1].str(), std::regex(","), " "));
  return {std::istream_iterator<double>(numbers), {}};
}

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "otg_test_povray_scene";
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

}  // namespace

TEST_CASE("Frames for POV-Ray say what was there and where") {
  const Folder folder;
  const auto ball = scenes::build(scenes::makeSphere(0.5, 2));
  const auto box = scenes::build(scenes::makeBox({1, 1, 1}));
  const double h = std::sqrt(0.5);
  scenes::Recording recording;
  recording.times = {0, 0.5, 1};
  recording.bodies = {
      {"ground", box, {0.5, 0.5, 0.5}, {{0, 0, -1}}, {{1, 0, 0, 0}}},
      {"one", ball, {1, 0, 0}, {{0, 0, 3}, {0, 0, 2}, {0, 1, 2}}, {{1, 0, 0, 0}, {1, 0, 0, 0}, {h, 0, 0, h}}},
      {"two", ball, {0, 0, 1}, {{5, 0, 3}, {5, 0, 2}, {5, 0, 1}}, {{1, 0, 0, 0}, {1, 0, 0, 0}, {h, h, 0, 0}}}};
  recording.contacts = {{}, {}, {{{0.5, 1, 2}, {0, 0, 1}, 0.01}, {{5, 0, 0.5}, {0, 1, 0}, 0.03}}};
  const auto paths = scenes::writePovrayFrames(folder.path.string(), recording, {0, 2});
  REQUIRE(paths.size() == 2);

  const std::string meshes = read(folder.path / "meshes.inc");
  const std::size_t first = meshes.find("Surface_0"), second = meshes.find("Surface_1");
  REQUIRE(second != std::string::npos);
  CHECK(meshes.find("Surface_2") == std::string::npos);  // both balls share one
  CHECK(vectors(meshes, "vertex_vectors", first).size() == 8);
  CHECK(vectors(meshes, "face_indices", first).size() == 12);
  for (const Vec3d& n : vectors(meshes, "normal_vectors", first)) {  // edges of the box stay sharp
    CHECK(std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)}) > 1 - 1e-6);
  }
  const auto points = vectors(meshes, "vertex_vectors", second), normals = vectors(meshes, "normal_vectors", second);
  const auto faces = vectors(meshes, "face_indices", second), corners = vectors(meshes, "normal_indices", second);
  REQUIRE(faces.size() == ball->triangleCount());
  REQUIRE(corners.size() == faces.size());
  CHECK(normals.size() == points.size());  // one each: smooth everywhere
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Vec3d p = points.at(std::size_t(faces[i].x)), n = normals.at(std::size_t(corners[i].x));
    CHECK(otgDot(p, n) > 0.5 * 0.995);  // radial, on a ball of radius 0.5
  }

  std::istringstream frame(read(paths[1]));
  std::vector<std::string> objects;
  for (std::string line; std::getline(frame, line);) {
    if (line.rfind("object", 0) == 0) objects.push_back(line);
  }
  REQUIRE(objects.size() == 3);
  CHECK(objects[0].find("StillBody(<0.5,0.5,0.5>)") != std::string::npos);
  CHECK(objects[1].find("MovingBody(<1,0,0>)") != std::string::npos);
  CHECK(objects[1].find("Surface_1") != std::string::npos);
  // A quarter turn about z takes x to y, one about x takes y to z; POV-Ray writes the images of x, y, z, then the
  // place.
  const std::vector<double> aboutZ{0, 1, 0, -1, 0, 0, 0, 0, 1, 0, 1, 2}, aboutX{1, 0, 0, 0, 0, 1, 0, -1, 0, 5, 0, 1};
  const auto one = matrixOf(objects[1]), two = matrixOf(objects[2]);
  REQUIRE(one.size() == 12);
  REQUIRE(two.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) {
    CHECK(std::fabs(one[i] - aboutZ[i]) < 1e-7);
    CHECK(std::fabs(two[i] - aboutX[i]) < 1e-7);
  }
  CHECK(read(paths[1]).find("FrameTime = 1;") != std::string::npos);
  CHECK(read(paths[0]).find("ContactArrow(") == std::string::npos);
  // The deepest but 5 % has the last colour, another one a shallower colour.
  CHECK(read(paths[1]).find("ContactArrow(<0.5,1,2>, <0,0,1>, <0.004,0.002,0.242>)") != std::string::npos);
  CHECK(read(paths[1]).find("ContactArrow(<5,0,0.5>, <0,1,0>, <0.004,0.002,0.242>)") != std::string::npos);
}

TEST_CASE("A folder that cannot be made is an error that names it") {
  const auto ball = scenes::build(scenes::makeSphere(0.5, 0));
  scenes::Recording recording;
  recording.times = {0};
  recording.contacts = {{}};
  recording.bodies = {{"one", ball, {1, 0, 0}, {{0, 0, 0}}, {{1, 0, 0, 0}}}};
  std::string message;
  try {
    scenes::writePovrayFrames("/dev/null/frames", recording, {0});
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  CHECK(message.find("/dev/null/frames") != std::string::npos);
}
