// SPDX-License-Identifier: BSD-3-Clause
// Single frames of a moving scene as input of the ray tracer POV-Ray, which draws them without a display.
#pragma once

#include <string>
#include <vector>

#include "scenes/gltf_animation.h"

namespace otg::scenes {

/// Writes meshes.inc (every surface once, with smooth normals except across sharp edges) and one frame_NNN.pov for each
/// of `frames`, indices into `times` (a body with a single pose stands still). What the frames look like (camera,
/// light, materials) is up to the file look.inc, which each frame includes after declaring
///     FrameTime                  seconds
///     StageCenter, StageRadius   a sphere around the moving bodies in the second half of `times`
/// and which defines the macros MovingBody(Color) and StillBody(Color). Returns the paths of the frame files.
/// Throws std::runtime_error if a file cannot be written.
std::vector<std::string> writePovrayFrames(const std::string& folder, const std::vector<AnimatedBody>& bodies,
                                           const std::vector<double>& times, const std::vector<std::size_t>& frames);

}  // namespace otg::scenes
