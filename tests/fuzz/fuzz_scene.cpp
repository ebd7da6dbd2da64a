// SPDX-License-Identifier: BSD-3-Clause
// Scene files. Meshes of files are looked for in a folder that is not there.
#include <stdexcept>
#include <string>

#include "fuzz/fuzz_target.h"
#include "scenes/simulation.h"

using namespace otg;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const scenes::OdeSession session;
  const std::string text(reinterpret_cast<const char*>(data), size);
  // Millions of triangles are allowed, and take their time.
  if (text.find("000") != std::string::npos || text.find("level") != std::string::npos) return 0;
  try {
    scenes::SceneDescription scene = scenes::parseScene(text, "scene", "/no/such/folder");
    if (scene.bodies.size() > 8) return 0;
    scene.maxContacts = std::min(scene.maxContacts, 16);
    scenes::Simulation simulation(scene);
    for (int i = 0; i < 3; ++i) simulation.step(scene.dt);
  } catch (const std::runtime_error&) {  // what is refused
  }
  return 0;
}

std::vector<fuzz::Input> fuzz::seeds() {
  return {inputOf(R"({"dt": 3e333, "bodies": []})"), inputOf(R"({"bodies": [{"name": "ball", "sphere": 0.5}]})"),
          inputOf(R"({"planes": [{"normal": [0, 0, 1], "offset": 0}], "space": "sap", "stepper": "world",
 "bodies": [{"name": "a", "box": [1, 2, 3], "position": [0, 0, 1], "rotation": [1, 0, 0, 0]},
 {"name": "b", "capsule": [0.3, 1], "static": true}, {"name": "c", "cylinder": [0.2, 1], "collider": "gpu_trimesh"}]})"),
          inputOf(R"({"gravity": [0, 0, -9.81], "dt": 0.01, "mu": "infinity", "meshes": {"m": {"generate": "box",
 "size": [1, 1, 1]}, "g": {"generate": "gear", "teeth": 8, "pitch_radius": 1, "tooth_depth": 0.2, "width": 0.3}},
 "bodies": [{"name": "m", "mesh": "m", "density": 7}, {"name": "g", "mesh": "g", "position": [0, 0, 1]}]})"),
          inputOf(R"({"heightfields": {"h": {"size": [4, 4], "heights": [[0, 0, 1], [0, 1, 1], [2, 2, 3]]},
 "k": {"size": [4, 4], "generate": "hills", "height": 0.2, "length": 3, "samples": [5, 5]}}, "bodies": [
 {"name": "h", "heightfield": "h", "static": true}, {"name": "b", "sphere": 0.5, "linear_velocity": [0, 0, 1]}]})")};
}
