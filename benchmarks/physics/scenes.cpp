// SPDX-License-Identifier: BSD-3-Clause
// The list of all scenes.
#include <algorithm>
#include <filesystem>
#include <iterator>

#include "base/environment.h"
#include "physics/scene.h"

namespace otg::physics {

const std::vector<Scene>& allScenes() {
  static const std::vector<Scene> kScenes = [] {
    std::vector<Scene> all;
    for (auto& family : {boxScenes(), slidingScenes(), curvedScenes(), insertionScenes(), overlapScenes(), dropScenes(),
                         cornerScenes()})
      all.insert(all.end(), family.begin(), family.end());
#ifdef OTG_REAL_USE  // reads mesh files, which needs Assimp
    for (const Scene& scene : realUseScenes()) all.push_back(scene);
#endif
    return all;
  }();
  return kScenes;
}

const std::vector<SpreadLimit>& spreadLimits() {
  static const std::vector<SpreadLimit> kLimits{
      {"slope: the same distance on every tessellation", {"slope_2", "slope_800", "slope_8192"}, "distance", 0.01},
  };
  return kLimits;
}

const Scene* findScene(const std::string& name) {
  const auto& scenes = allScenes();
  const auto found = std::find_if(scenes.begin(), scenes.end(), [&](const Scene& s) { return s.name == name; });
  return found == scenes.end() ? nullptr : &*found;
}

std::string meshFolder() {
  return readEnvironment().meshFolder;
}

std::string missingFile(const Scene& scene) {
  for (const std::string& file : scene.meshFiles) {
    if (meshFolder().empty() || !std::filesystem::exists(std::filesystem::path(meshFolder()) / file)) return file;
  }
  return {};
}

}  // namespace otg::physics
