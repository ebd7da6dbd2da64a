// SPDX-License-Identifier: BSD-3-Clause
// Single frames of a moving scene as input of the ray tracer POV-Ray, which draws them without a display.
#pragma once

#include <string>
#include <vector>

#include "scenes/recording.h"

namespace otg::scenes {

/// Writes meshes.inc (every surface once, with smooth normals except across sharp edges) and one frame_NNN.pov for each
/// of `frames`, numbers of frames of the recording. What the frames look like (camera, light, materials) is up to the
/// file look.inc, which each frame includes after declaring
///     FrameTime                  seconds
///     StageCenter, StageRadius   a sphere around the moving bodies in the second half of the time.
/// It defines the macros MovingBody(Color), StillBody(Color) and, for `povray Declare=ShowContacts=1`,
/// ContactArrow(Place, Direction, Color). Returns the paths of the frame files. Throws std::runtime_error if a file
/// cannot be written.
std::vector<std::string> writePovrayFrames(const std::string& folder, const Recording& recording,
                                           const std::vector<std::size_t>& frames);

}  // namespace otg::scenes
