// SPDX-License-Identifier: BSD-3-Clause
// Heightfields as scene files and `otg collide` have them: JSON to HeightGrid.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "scenes/height_grid.h"

namespace otg::scenes {

/// `where` starts every message. Throws SceneError.
std::shared_ptr<const HeightGrid> readHeightGrid(const nlohmann::json& value, const std::string& where);

/// Whether the path is one of a file with a heightfield: *.json.
bool namesHeightGrid(const std::string& path);
/// A file with one such object. Throws SceneError.
std::shared_ptr<const HeightGrid> loadHeightGrid(const std::string& path);

}  // namespace otg::scenes
