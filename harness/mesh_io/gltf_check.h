// SPDX-License-Identifier: BSD-3-Clause
// What a glTF file must not do to the library that reads it.
#pragma once

#include <string>
#include <string_view>

namespace otg::mesh_io {

/// Throws std::runtime_error for a glTF 2.0 file that would crash readers without limits of their own, or make them
/// fill the memory. The file is text, or binary with its JSON in front. Checked are:
/// - that nodes make trees, as the format requires, of at most kMostGltfLevels levels;
/// - that numbers of nodes, meshes, accessors, views and buffers are those of something;
/// - that what accessors count is in their views, views in their buffers, and buffers in their files;
/// - that no more vertices and indices come out than the buffers have bytes, and kMostGltfRepeats.
/// `folder` is where the files lie that buffers name. They are measured, not read.
void checkGltf(std::string_view bytes, const std::string& folder);

inline constexpr int kMostGltfLevels = 512;
/// Vertices and indices that come of meshes that are placed or used repeatedly.
inline constexpr double kMostGltfRepeats = 2e6;

}  // namespace otg::mesh_io
